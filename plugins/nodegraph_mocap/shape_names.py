"""Names of shapes, which programs write differently: ``EyeBlinkLeft``, ``eyeBlink_L``."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping

_SIDES = {"l": "left", "r": "right"}
_SIDE = re.compile(r"[_.\- ]([lr])$")
_BETWEEN_WORDS = re.compile(r"[_.\- ]+")


def matched(names: Iterable[str], others: Iterable[str]) -> Mapping[str, str]:
    """Return which of `others` each name means.

    A name means the one that is written the same, or else the one that differs from it only in
    capitals, in what stands between words, and in ``_L`` and ``_R`` for left and right: so
    ``EyeBlinkLeft`` (Live Link Face), ``eyeBlinkLeft`` (ARKit) and ``eyeBlink_L`` (Face Cap) are
    one shape.

    Parameters
    ----------
    names, others
        Names of shapes, each without repetition.

    Returns
    -------
    mapping of name to other
        In the order of `names`; a name that none of the others matches is not in it.

    Raises
    ------
    ValueError
        If a name could mean two of the others, or two names mean the same one; it names both.
    """
    known = list(others)
    alike = defaultdict(list)
    for other in known:
        alike[_plain(other)].append(other)
    matches: dict[str, str] = {}
    taken: dict[str, str] = {}
    for name in names:
        meant = [name] if name in known else alike.get(_plain(name), [])
        if len(meant) > 1:
            raise ValueError(f"shape {name!r} may be {meant[0]!r} or {meant[1]!r}; rename one")
        for other in meant:
            if other in taken:
                raise ValueError(f"shapes {taken[other]!r} and {name!r} both mean {other!r}")
            matches[name], taken[other] = other, name
    return matches


def _plain(name: str) -> str:
    """Return what all ways of writing a name have in common."""
    small = name.strip().casefold()
    sided = _SIDE.sub(lambda side: _SIDES[side[1]], small)
    return _BETWEEN_WORDS.sub("", sided)
