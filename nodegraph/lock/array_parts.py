"""An array as a few numbers per part of its axes, which show where another array differs."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nodegraph.lock.sketch import first_weighted

Axes = tuple[tuple[str, tuple[str, ...]], ...]
"""The first axes of an array: a word for their members, and the members' names."""

_MOST_NAMES = 5
"""Members of an axis that are listed at most."""

_ROUNDING = 2.0**-22
"""Relative rounding error of a sum, which is stored in four bytes."""

_LARGEST = 1e30
"""The sum of a part exceeds its values by the root of its size, which may have sixteen digits."""

_CLEARLY = 0.25
"""Fraction of the largest difference above which a part is among those that differ most."""


@dataclass(frozen=True)
class Parts:
    """The sums of an array over parts of its first axes.

    Attributes
    ----------
    shape : tuple of int
    sums : tuple of array of float64
        For each of the first axes, a sum per part: of the values times pseudo-random weights of
        variance 1, divided by the root of their number.
    """

    shape: tuple[int, ...]
    sums: tuple[NDArray[np.float64], ...]

    @property
    def text(self) -> str:
        """Shape, numbers of parts and sums as three words."""
        sizes = "x".join(map(str, self.shape))
        counts = ",".join(str(sums.size) for sums in self.sums)
        content = np.concatenate(self.sums).astype("<f4").tobytes()
        return f"{sizes} {counts} {base64.b64encode(content).decode('ascii')}"

    @classmethod
    def read(cls, text: str) -> Parts:
        """Return the sums of a text.

        Raises
        ------
        ValueError
            If the text has another form.
        """
        sizes, counts, content = text.split(" ")
        numbers = np.frombuffer(base64.b64decode(content, validate=True), "<f4").astype(np.float64)
        ends = np.cumsum([int(count) for count in counts.split(",")])
        if ends[-1] != numbers.size:
            raise ValueError(f"{numbers.size} numbers instead of {ends[-1]}")
        shape = tuple(int(size) for size in sizes.split("x"))
        return cls(shape, tuple(np.split(numbers, ends[:-1])))

    def differing(self, other: Parts, least: float) -> tuple[list[Span], ...]:
        """Return for each of the first axes which members differ.

        Parameters
        ----------
        other
            Of the same shape; an axis that has another number of parts is not compared.
        least
            Smaller differences do not count.
        """
        axes = zip(self.sums, other.sums, self.shape, strict=False)
        return tuple(list(_spans(was, now, least, members)) for was, now, members in axes)


@dataclass(frozen=True)
class Span:
    """Neighbours on an axis that differ: first, last, and whether they differ most."""

    first: int
    last: int
    most: bool


def parts_of(name: str, array: NDArray[np.generic], axes: int, most: int) -> Parts | None:
    """Return the sums of an array; None if its numbers are too large for four bytes.

    Parameters
    ----------
    name
        Chooses the weights, as for `nodegraph.lock.sketch.project`.
    array
        Of floats; NaN and infinity count as 0.
    axes
        Number of axes, from the first.
    most
        Largest number of parts of each.
    """
    values = np.nan_to_num(array.astype(np.float64), posinf=0.0, neginf=0.0)
    if np.abs(values).max(initial=0.0) > _LARGEST:
        return None
    weighted = first_weighted(name, values.ravel()).reshape(values.shape)
    return Parts(values.shape, tuple(_sums(weighted, axis, most) for axis in range(axes)))


def _sums(weighted: NDArray[np.float64], axis: int, most: int) -> NDArray[np.float64]:
    members = weighted.shape[axis]
    if not weighted.size:
        return np.zeros(0)
    starts = _starts(members, min(members, most))
    other_axes = tuple(other for other in range(weighted.ndim) if other != axis)
    sizes = np.diff([*starts, members]) * (weighted.size // members)
    return np.asarray(np.add.reduceat(weighted.sum(axis=other_axes), starts) / np.sqrt(sizes))


def _starts(members: int, parts: int) -> list[int]:
    return [part * members // parts for part in range(parts)]


def _spans(
    was: NDArray[np.float64], now: NDArray[np.float64], least: float, members: int
) -> Iterator[Span]:
    """Yield the members that differ, with neighbours merged."""
    if was.size != now.size:
        return
    sizes = np.abs(was - now)
    differ = np.flatnonzero(sizes > np.maximum(least, _ROUNDING * np.abs(was)))
    if not differ.size:
        return
    clear = sizes > _CLEARLY * sizes.max()
    ends = [*_starts(members, sizes.size), members]
    first = int(differ[0])
    for part, following in zip(differ, [*differ[1:], -1], strict=True):
        if following != part + 1 or clear[following] != clear[part]:
            yield Span(ends[first], ends[part + 1] - 1, bool(clear[part]))
            first = int(following)


def part_difference(was: Parts, now: Parts, axes: Axes, least: float) -> str:
    """Return the differences in shape or in members of the axes as text; empty without any.

    A difference may be within the rounding of the sums of one axis and not of another.
    """
    if was.shape != now.shape:
        shapes = [" x ".join(map(str, parts.shape)) for parts in (was, now)]
        return f"had the shape {shapes[0]}, now {shapes[1]}"
    members = zip(was.differing(now, least), axes, was.shape, strict=False)
    places = ", of ".join(_with_largest(*axis) for axis in members if axis[0])
    return f"differs in {places}" if places else ""


def _with_largest(spans: list[Span], axis: tuple[str, tuple[str, ...]], members: int) -> str:
    text = _listed(spans, *axis, members)
    most = [span for span in spans if span.most]
    return text if len(most) == len(spans) else f"{text} (most in {_listed(most, *axis, members)})"


def _listed(spans: list[Span], word: str, names: tuple[str, ...], members: int) -> str:
    ranges = list(_merged(spans))
    places = [at for first, last in ranges for at in range(first, last + 1)]
    several = f"{word}s" if len(places) > 1 else word
    if len(places) == members:
        return f"all {members} {several}"
    if names:
        more = f" and {len(places) - _MOST_NAMES} more" if len(places) > _MOST_NAMES else ""
        return f"{several} {', '.join(names[at] for at in places[:_MOST_NAMES])}{more}"
    if len(ranges) > _MOST_NAMES:
        return f"{len(places)} {several} between {places[0]} and {places[-1]}"
    texts = (str(first) if first == last else f"{first} to {last}" for first, last in ranges)
    return f"{several} {', '.join(texts)}"


def _merged(spans: Sequence[Span]) -> Iterator[tuple[int, int]]:
    """Yield the first and last member of spans, merged where they touch."""
    first, last = spans[0].first, spans[0].last
    for span in spans[1:]:
        if span.first > last + 1:
            yield first, last
            first = span.first
        last = span.last
    yield first, last
