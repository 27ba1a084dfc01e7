"""Names that a recording must have."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence

_LISTED = 20


def check_known(names: Iterable[str], markers: Sequence[str], *, what: str = "marker") -> None:
    """Refuse names that are not among the markers.

    Parameters
    ----------
    names
        What is asked for.
    markers
        What there is.
    what
        What the message calls a name.

    Raises
    ------
    ValueError
        With the names, for each the nearest marker if one is near, and all that there are.
    """
    known = set(markers)
    unknown = [name for name in dict.fromkeys(names) if name not in known]
    if unknown:
        told = "; ".join(_told(name, markers) for name in unknown)
        raise ValueError(f"no {what} {told}; there are {listed(markers)}")


def check_once(names: Iterable[str], *, what: str = "names") -> None:
    """Refuse names that stand twice.

    Raises
    ------
    ValueError
        With those names.
    """
    given = list(names)
    repeated = sorted({name for name in given if given.count(name) > 1})
    if repeated:
        raise ValueError(f"{what}: listed twice: {', '.join(repeated)}")


def listed(names: Iterable[str]) -> str:
    """Return the first twenty names, and how many more there are."""
    every = list(names)
    more = f", and {len(every) - _LISTED} more" if len(every) > _LISTED else ""
    return (", ".join(every[:_LISTED]) or "none") + more


def _told(name: str, markers: Sequence[str]) -> str:
    lower = {marker.lower(): marker for marker in markers}
    close = difflib.get_close_matches(name.lower(), lower, n=1, cutoff=0.6)
    return f"{name!r} (did you mean {lower[close[0]]!r}?)" if close else repr(name)
