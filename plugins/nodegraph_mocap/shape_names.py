"""Names of shapes, which programs write differently: ``EyeBlinkLeft``, ``eyeBlink_L``."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from nodegraph import listed

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

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


def places_of(names: Sequence[str], others: Sequence[str], face: str, shape: str) -> list[int]:
    """Return the place among the others of the one that each weight's name means.

    Parameters
    ----------
    names, others
        As of `matched`.
    face, shape
        What has the others, and what they are, for messages: ``head``, ``morph target``.

    Raises
    ------
    ValueError
        If a name means none of them, or as `matched` does.
    """
    meant = matched(names, others)
    without = [name for name in names if name not in meant]
    if without:
        raise ValueError(
            f"the {face} has no {shape} for the weights {listed(without)}; it has {listed(others)}"
        )
    return [others.index(meant[name]) for name in names]


@dataclass(frozen=True)
class Sides:
    """Weights with shapes split into left and right, or joined, as another face has them.

    Attributes
    ----------
    names : tuple of str
        Names of the K weights after that.
    columns : tuple of (int, int)
        For each of them, the two weights before that of which it is the mean: mostly one twice.
    notes : tuple of str
        Weights that were split and weights that were joined.
    """

    names: tuple[str, ...]
    columns: tuple[tuple[int, int], ...]
    notes: tuple[str, ...]

    def of(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (..., K) weights, given those before that."""
        first, second = ([pair[side] for pair in self.columns] for side in (0, 1))
        return (values[..., first] + values[..., second]) / 2


def sides_as(names: Sequence[str], others: Sequence[str]) -> Sides:
    """Return how weights of these names become weights of shapes with the others' sides.

    Programs differ in which shapes have a left and a right side: ARKit's ``browInnerUp`` and
    ``cheekPuff`` are ``browInnerUp_L``, ``browInnerUp_R``, ``cheekPuff_L`` and ``cheekPuff_R`` in
    ICT-FaceKit. A weight without sides counts for both of them, and two sides for their mean.
    """
    split, joined = _halves(names, others), _halves(others, names)
    left_out = {half for halves in joined.values() for half in halves}
    place = {name: number for number, name in enumerate(names)}
    columns: dict[str, tuple[int, int]] = {}
    for name in names:
        if name not in left_out:
            columns |= dict.fromkeys(split.get(name, (name,)), (place[name], place[name]))
    columns |= {name: (place[left], place[right]) for name, (left, right) in joined.items()}
    notes = (
        f"{len(split)} weights without sides count for the left and the right shape: "
        f"{listed(split)}" if split else "",
        f"{len(joined)} shapes without sides get the mean of a left and a right weight: "
        f"{listed(joined)}" if joined else "",
    )  # fmt: skip
    return Sides(tuple(columns), tuple(columns.values()), tuple(note for note in notes if note))


def _halves(names: Sequence[str], others: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Return the names that none of the others matches, but a left and a right one do."""
    matches = matched(names, others)
    spare = [name for name in names if name not in matches]
    free = [other for other in others if other not in set(matches.values())]
    sides = [matched([f"{name}_{side}" for name in spare], free) for side in "LR"]
    pairs = {name: (sides[0].get(f"{name}_L"), sides[1].get(f"{name}_R")) for name in spare}
    return {name: (left, right) for name, (left, right) in pairs.items() if left and right}


def _plain(name: str) -> str:
    """Return what all ways of writing a name have in common."""
    small = name.strip().casefold()
    sided = _SIDE.sub(lambda side: _SIDES[side[1]], small)
    return _BETWEEN_WORDS.sub("", sided)
