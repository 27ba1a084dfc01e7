"""The faults of a node, collected so that all of them are reported at once."""

from __future__ import annotations


class Faults:
    """Faults in the order in which they were noted, each with the specimens that show it."""

    def __init__(self) -> None:
        self._faults: dict[str, list[tuple[str, str]]] = {}

    def __bool__(self) -> bool:
        return bool(self._faults)

    def add(self, fault: str, *, specimen: str = "", detail: str = "") -> None:
        """Note a fault.

        Parameters
        ----------
        fault
            The fault, and what to change.
        specimen
            The specimen that shows it.
        detail
            How it shows there.
        """
        self._faults.setdefault(fault, []).append((specimen, detail))

    def text(self) -> str:
        """Return a line per fault, each followed by the specimens that show it."""
        return "\n".join(f"- {fault}{_evidence(seen)}" for fault, seen in self._faults.items())


def _evidence(seen: list[tuple[str, str]]) -> str:
    specimen = seen[0][0]
    details = dict.fromkeys(detail for name, detail in seen if name == specimen and detail)
    where = f"on {specimen!r}" if specimen else ""
    evidence = ": ".join(part for part in (where, "; ".join(details)) if part)
    others = list(dict.fromkeys(repr(name) for name, _ in seen[1:] if name != specimen))
    more = f"; also on {', '.join(others)}" if others else ""
    return f"\n    {evidence}{more}" if evidence else ""
