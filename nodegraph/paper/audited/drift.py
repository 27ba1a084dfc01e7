"""Whether two results of one call are the same to the bit, or but for rounding, or not."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from nodegraph.hooks import Comparison
from nodegraph.paper.frozen.sketch import FLOOR, TOLERANCE, sketch
from nodegraph.paper.values import told_apart
from nodegraph.store import Packed, Packer, Unstorable

Grade = Literal["identical", "close", "differs"]

_LAYOUT = "equal numbers, whose bits or places in memory are others"


@dataclass(frozen=True)
class Given:
    """What a call gave.

    Attributes
    ----------
    values : tuple
        One per output; what stands in for it where it cannot be kept as itself.
    digests : tuple of str
        One per output, of its content; empty where there is none.
    packed : tuple of Packed or None
        Of the outputs that are kept as themselves.
    """

    values: tuple[Any, ...]
    digests: tuple[str, ...]
    packed: tuple[Packed | None, ...]

    @classmethod
    def of(cls, values: Iterable[Any], packer: Packer) -> Given:
        """Return values such that they can be compared."""
        taken = [_taken(value, packer) for value in values]
        return cls(
            tuple(value for value, _ in taken),
            tuple(one.digest if one is not None else "" for _, one in taken),
            tuple(one if one is not None and one.faithful else None for _, one in taken),
        )


@dataclass(frozen=True)
class Drift:
    """How far two results are apart.

    Attributes
    ----------
    grade : str
        ``identical`` to the bit; ``close``, up to what rounding makes of the numbers; or
        ``differs``.
    said : tuple of str
        What differs, in words.
    """

    grade: Grade = "identical"
    said: tuple[str, ...] = ()


def drift(
    one: Given,
    other: Given,
    ports: Sequence[str],
    comparisons: Iterable[Comparison],
    floor: float = 0.0,
) -> Drift:
    """Return how far two results of one call are apart.

    Numbers are close if they differ by no more than the ``TOLERANCE`` of locks, relative to the
    root mean square of those at the same place of the value. Whatever is no float must be equal,
    and so must be which floats are missing.

    Parameters
    ----------
    one, other
    ports
        Names of the outputs.
    comparisons
        Say in words of their field how two values differ.
    floor
        The size below which numbers count as of that size.
    """
    kinds = tuple(comparisons)
    found: list[Drift] = []
    for place, port in enumerate(ports):
        if not one.digests[place] or one.digests[place] != other.digests[place]:
            words = told_apart(one.values[place], other.values[place], kinds)
            grade = _grade(one.packed[place], other.packed[place], words, floor)
            several = len(ports) > 1
            said = tuple(f"{port}: {text}" if several else text for text in words)
            found.append(Drift(grade, said or ((_LAYOUT,) if grade == "close" else ())))
    grades: list[Grade] = ["identical", *(drifted.grade for drifted in found)]
    return Drift(
        max(grades, key=_RANK.__getitem__),
        tuple(text for drifted in found for text in drifted.said),
    )


def floor_of(inputs: Mapping[str, Any], packer: Packer) -> float:
    """Return the size below which the results of a call may be rounding of its inputs."""
    packed = {port: _taken(value, packer)[1] for port, value in inputs.items()}
    found = sketch({port: one for port, one in packed.items() if one is not None})
    return FLOOR * max((leaf.size for leaf in found.leaves.values()), default=0.0)


_RANK: Mapping[Grade, int] = {"identical": 0, "close": 1, "differs": 2}


def _grade(one: Packed | None, other: Packed | None, words: tuple[str, ...], floor: float) -> Grade:
    if one is None or other is None:
        return "differs" if words else "identical"
    first, second = sketch({"": one}), sketch({"": other})
    if first.exact != second.exact:
        return "differs" if words else "close"
    scales = {place: max(leaf.size, floor) for place, leaf in first.leaves.items()}
    apart = first.against(scales).apart(second.against(scales).projections)
    return "close" if apart <= TOLERANCE else "differs"


def _taken(value: Any, packer: Packer) -> tuple[Any, Packed | None]:
    try:
        packed = packer.pack(value)
    except Unstorable:
        return value, None
    return value if packed.faithful else packer.unpack(packed.head, packed.buffers), packed
