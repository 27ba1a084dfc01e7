"""An array as a few numbers for each part of it, which tell where another one differs."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph.paper.frozen.projection import along_one

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST = 64
"""Parts of an axis at most."""

FEWEST = 2

_ROUNDING = 2.0**-22
"""Of a number of this module: it is kept in four bytes."""

_LARGEST = 1e30
"""A part is the root of its size times as large, and that size may have sixteen digits."""

_CLEARLY = 0.25
"""Of the part that differs most: parts that differ by less are not among those named as such."""


@dataclass(frozen=True)
class Parts:
    """An array, part by part along its first axes.

    Attributes
    ----------
    shape : tuple of int
    sums : tuple of array of float64
        For each of the first axes, a number per part of it: the product of that part with
        pseudo-random weights of variance 1, over the root of its size.
    """

    shape: tuple[int, ...]
    sums: tuple[NDArray[np.float64], ...]

    @property
    def text(self) -> str:
        """It in two words, the first one being the shape."""
        sizes = "x".join(map(str, self.shape))
        counts = ",".join(str(one.size) for one in self.sums)
        content = np.concatenate(self.sums).astype("<f4").tobytes()
        return f"{sizes} {counts} {base64.b64encode(content).decode('ascii')}"

    @classmethod
    def read(cls, text: str) -> Parts:
        """Return what its text says.

        Raises
        ------
        ValueError
            If it says nothing.
        """
        sizes, counts, content = text.split(" ")
        numbers = np.frombuffer(base64.b64decode(content, validate=True), "<f4").astype(np.float64)
        ends = np.cumsum([int(one) for one in counts.split(",")])
        if ends[-1] != numbers.size:
            raise ValueError("not as many numbers as there should be")
        shape = tuple(int(one) for one in sizes.split("x"))
        return cls(shape, tuple(np.split(numbers, ends[:-1])))

    def apart(self, other: Parts, least: float) -> tuple[list[Span], ...]:
        """Return, for each of the first axes, which of its members differ.

        Parameters
        ----------
        other
            Of the same shape and with as many parts.
        least
            Size of a difference that counts.
        """
        return tuple(
            list(_spans(np.abs(one - here), np.maximum(least, _ROUNDING * np.abs(one)), members))
            for one, here, members in zip(self.sums, other.sums, self.shape, strict=False)
            if one.size == here.size
        )


@dataclass(frozen=True)
class Span:
    """Members of an axis that stand together: first, last, and whether they differ most."""

    first: int
    last: int
    most: bool


def parts_of(name: str, array: NDArray[Any], axes: int, most: int) -> Parts | None:
    """Return an array part by part; None if it has numbers that are too large for four bytes.

    Parameters
    ----------
    name
        Chooses the weights, as for `nodegraph.paper.frozen.projection.project`.
    array
        Of floats; what is missing or infinite counts as 0.
    axes
        How many of the first axes are taken.
    most
        Parts of each at most.
    """
    values = np.nan_to_num(array.astype(np.float64), posinf=0.0, neginf=0.0)
    if np.abs(values).max(initial=0.0) > _LARGEST:
        return None
    weighted = along_one(name, values.ravel()).reshape(values.shape)
    return Parts(values.shape, tuple(_sums(weighted, axis, most) for axis in range(axes)))


def _sums(weighted: NDArray[np.float64], axis: int, most: int) -> NDArray[np.float64]:
    members = weighted.shape[axis]
    if not weighted.size:
        return np.zeros(0)
    starts = _starts(members, min(members, most))
    others = tuple(one for one in range(weighted.ndim) if one != axis)
    sizes = np.diff([*starts, members]) * (weighted.size // members)
    return np.asarray(np.add.reduceat(weighted.sum(axis=others), starts) / np.sqrt(sizes))


def _starts(members: int, parts: int) -> list[int]:
    return [part * members // parts for part in range(parts)]


def _spans(apart: NDArray[np.float64], least: NDArray[np.float64], members: int) -> Iterator[Span]:
    """Yield the members that differ; neighbours that are alike in that as one."""
    differ = np.flatnonzero(apart > least)
    if not differ.size:
        return
    clear = apart > _CLEARLY * apart.max()
    ends = [*_starts(members, apart.size), members]
    first = int(differ[0])
    for part, following in zip(differ, [*differ[1:], -1], strict=True):
        if following != part + 1 or clear[following] != clear[part]:
            yield Span(ends[first], ends[part + 1] - 1, bool(clear[part]))
            first = int(following)
