"""The difference between the results of two calls of one step."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

from nodegraph.lock.sketch import FLOOR, TOLERANCE, sketch
from nodegraph.plugin.hook_results import HookResults
from nodegraph.runs.compare import value_differences
from nodegraph.store import Packed, Packer, Unstorable

_SAME_NUMBERS = "equal numbers with other bits or another layout in memory"


class AuditGrade(StrEnum):
    """The outcome of an audit, from the best to the worst."""

    IDENTICAL = "identical"
    CLOSE = "close"
    SKIPPED = "skipped"
    REFUSED = "refused"
    FAILED = "failed"
    MUTATES = "mutates"
    DIFFERS = "differs"

    @property
    def rank(self) -> int:
        """The position in the order from the best to the worst."""
        return list(AuditGrade).index(self)

    @property
    def passes(self) -> bool:
        """Whether the step gives the same result each time, if any."""
        return self.rank <= AuditGrade.REFUSED.rank


@dataclass(frozen=True)
class CallResult:
    """The values that a call returned, ready for comparisons.

    Attributes
    ----------
    values : tuple
        One per output, as a store would return it.
    digests : tuple of str
        One per output; empty where the value cannot be stored.
    packed : tuple of Packed or None
        None where a store does not return the value itself.
    """

    values: tuple[object, ...]
    digests: tuple[str, ...]
    packed: tuple[Packed | None, ...]

    @classmethod
    def of(cls, values: Iterable[object], packer: Packer) -> CallResult:
        """Return the result of a call that returned these values."""
        outputs = [_stored_form(value, packer) for value in values]
        return cls(
            tuple(value for value, _ in outputs),
            tuple(packed.digest if packed else "" for _, packed in outputs),
            tuple(packed if packed and packed.faithful else None for _, packed in outputs),
        )


@dataclass(frozen=True)
class Drift:
    """The grade and the differences of two results.

    Attributes
    ----------
    grade : AuditGrade
        Identical to the bit, close up to rounding, or different.
    differences : tuple of str
        A sentence for each.
    """

    grade: AuditGrade = AuditGrade.IDENTICAL
    differences: tuple[str, ...] = ()


def drift(
    first: CallResult,
    second: CallResult,
    ports: Sequence[str],
    hooks: HookResults,
    floor: float = 0.0,
) -> Drift:
    """Return how far two results of one call are apart.

    Numbers are close if they differ by no more than the tolerance of locks, relative to the root
    mean square of those at the same place of the value. Everything but floats must be equal, and
    the same floats must be missing.

    Parameters
    ----------
    first, second
    ports
        Names of the outputs.
    hooks
        The hooks of plugins, which describe differences.
    floor
        Smaller numbers are compared as if they were of this size.
    """
    grades = [AuditGrade.IDENTICAL]
    differences: list[str] = []
    for position, port in enumerate(ports):
        if first.digests[position] and first.digests[position] == second.digests[position]:
            continue
        texts = value_differences(first.values[position], second.values[position], hooks)
        grade = _grade(first.packed[position], second.packed[position], texts, floor)
        if grade is AuditGrade.CLOSE and not texts:
            differences.append(_SAME_NUMBERS)
        differences += [f"{port}: {text}" if len(ports) > 1 else text for text in texts]
        grades.append(grade)
    return Drift(max(grades, key=lambda grade: grade.rank), tuple(differences))


def floor_of(inputs: Mapping[str, object], packer: Packer) -> float:
    """Return the size below which the results of a call may be rounding errors of its inputs."""
    packed = {port: _stored_form(value, packer)[1] for port, value in inputs.items()}
    leaves = sketch({port: value for port, value in packed.items() if value is not None}).leaves
    return FLOOR * max((leaf.size for leaf in leaves.values()), default=0.0)


def _grade(
    first: Packed | None, second: Packed | None, differences: tuple[str, ...], floor: float
) -> AuditGrade:
    if first is None or second is None:
        return AuditGrade.DIFFERS if differences else AuditGrade.IDENTICAL
    sketches = sketch({"": first}), sketch({"": second})
    if sketches[0].exact != sketches[1].exact:
        return AuditGrade.DIFFERS if differences else AuditGrade.CLOSE
    scales = {place: max(leaf.size, floor) for place, leaf in sketches[0].leaves.items()}
    measured = [sketch.against(scales) for sketch in sketches]
    distance = measured[0].apart(measured[1].projections)
    return AuditGrade.CLOSE if distance <= TOLERANCE else AuditGrade.DIFFERS


def _stored_form(value: object, packer: Packer) -> tuple[object, Packed | None]:
    """Return a value as a store would return it, and packed."""
    try:
        packed = packer.pack(value)
    except Unstorable:
        return value, None
    return value if packed.faithful else packer.unpack(packed.head, packed.buffers), packed
