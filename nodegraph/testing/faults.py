"""What is wrong with a node, each fault once, with the specimens that show it."""

from __future__ import annotations


class Faults:
    """Collects faults, so that all of them are told at once."""

    def __init__(self) -> None:
        self._found: dict[str, list[tuple[str, str]]] = {}

    def __bool__(self) -> bool:
        return bool(self._found)

    def add(self, fault: str, *, specimen: str = "", detail: str = "") -> None:
        """Note a fault: what is wrong and what to change, where it shows, and how.

        Parameters
        ----------
        fault
            What is wrong, and what to change.
        specimen
            On which it shows.
        detail
            How it shows there.
        """
        self._found.setdefault(fault, []).append((specimen, detail))

    def text(self) -> str:
        """Return a line per fault."""
        return "\n".join(f"- {fault}{_shown(seen)}" for fault, seen in self._found.items())


def _shown(seen: list[tuple[str, str]]) -> str:
    specimen = seen[0][0]
    details = dict.fromkeys(detail for one, detail in seen if one == specimen and detail)
    where = f"on {specimen!r}" if specimen else ""
    told = ": ".join(part for part in (where, "; ".join(details)) if part)
    others = list(dict.fromkeys(repr(one) for one, _ in seen[1:] if one != specimen))
    more = f"; also on {', '.join(others)}" if others else ""
    return f"\n    {told}{more}" if told else ""
