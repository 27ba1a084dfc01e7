"""Whether a study still gives what is in its lock: identical to diverged, and what changed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

from nodegraph.lock.lockfile import Lock
from nodegraph.lock.results import Results
from nodegraph.runs.compare import Agreement, Agreements, Judged, Pair, same_syntax, version_changes
from nodegraph.runs.record import Record

_DECIMALS = re.compile(r"[-+]?(?:(?<!\d)\d+)?\.\d+(?:e[-+]?\d+)?", re.I)


class Grade(StrEnum):
    """The agreement of the results of a study with its lock, from the best to the worst."""

    IDENTICAL = "identical"
    WITHIN_TOLERANCE = "within tolerance"
    SAME_CONCLUSIONS = "same conclusions"
    DIVERGED = "diverged"


class BySketch:
    """Judges results of a run by the digests and sketches in a lock.

    Parameters
    ----------
    lock
    results
        The results of the run whose record is the second of each pair.
    """

    def __init__(self, lock: Lock, results: Results) -> None:
        self._lock = lock
        self._results = results

    def __call__(self, pair: Pair) -> Judged:
        """Return the agreement of a combination."""
        was, now = pair.was, pair.now
        if not (was.has_result and now.has_result):
            if _without_decimals(was.ending) == _without_decimals(now.ending):
                return Judged(Agreement.SAME)
            return Judged(Agreement.OTHER, text=f"was {was.ending}, now {now.ending}")
        opaque = self._results.opaque(now.step)
        values, drawings = (
            [[text for text, is_opaque in zip(digests, opaque, strict=False) if is_opaque == kind]
             for digests in (was.digests, now.digests)]
            for kind in (False, True)
        )  # fmt: skip
        if not any([*was.digests, *now.digests]):
            return Judged(Agreement.UNKNOWN)
        judged = Judged(Agreement.SAME) if values[0] == values[1] else self._measured(pair)
        if judged.agreement is Agreement.OTHER or drawings[0] == drawings[1]:
            return judged
        return self._drawn(pair, judged)

    def _measured(self, pair: Pair) -> Judged:
        summary, text = self._results.sketch(pair.now.step), pair.was.sketch
        if summary is None or not text:
            return Judged(Agreement.OTHER)
        sizes = self._lock.sizes.get(pair.was.cells[0].group, {})
        same, distance = summary.compared(text, sizes)
        if not same:
            text = "types, shapes, texts or which samples are missing differ"
            return Judged(Agreement.OTHER, distance, text)
        near = distance <= self._lock.tolerance
        return Judged(Agreement.NEAR if near else Agreement.OTHER, distance)

    def _drawn(self, pair: Pair, values: Judged) -> Judged:
        """Return the agreement of a result whose drawings or files differ."""
        if pair.follows:
            return Judged(Agreement.OTHER, values.distance)
        near = values.agreement is Agreement.NEAR or Agreement.NEAR in pair.feeds
        if self._results.has_files(pair.now.step) and (not near or pair.change.own):
            return Judged(Agreement.OTHER, text="the bytes of its files differ")
        return Judged(Agreement.NEAR if near else Agreement.REDRAWN, values.distance)


def changes_everywhere(was: Record, now: Record) -> Iterator[str]:
    """Yield the changes of the study as a whole: of code, versions and the content of files."""
    pairs = [(method, now.code[method]) for method in was.code if method in now.code]
    edited = sum(
        any(was.units.get(name) != now.units.get(name) for name in code.units) for _, code in pairs
    )
    if edited and same_syntax(was, now):
        yield f"the code of {edited} of {len(pairs)} methods differs"
    yield from version_changes(was.versions, now.versions, {**was.versions, **now.versions})
    before, after = was.files(), now.files()
    for name, digest in before.items():
        if after.get(name, digest) != digest:
            yield f"the content of {name} changed"


@dataclass(frozen=True)
class VerifyOutcome:
    """The outcome of a comparison.

    Attributes
    ----------
    grade : Grade
    conclusions_changed : bool
        Possible even within the tolerance: the last digit may decide a tie.
    """

    grade: Grade
    conclusions_changed: bool = False

    @property
    def holds(self) -> bool:
        """Whether the study still has its results and its conclusions."""
        return self.grade is not Grade.DIVERGED and not self.conclusions_changed

    @property
    def text(self) -> str:
        """The grade in a few words."""
        if self.conclusions_changed and self.grade is not Grade.DIVERGED:
            return f"{self.grade}, but conclusions changed"
        return self.grade


def outcome_of(agreements: Agreements, conclusions: bool, changed: Sequence[str]) -> VerifyOutcome:
    """Return the outcome of a comparison.

    Results beyond the tolerance may have the same conclusions only if the study itself did not
    change: an edited method has diverged, whatever follows from it.

    Parameters
    ----------
    agreements
    conclusions
        Whether the study draws any.
    changed
        The conclusions that changed.
    """
    own_changes = any(pair.change.own for pair, _ in agreements.origins)
    if agreements.only_was or agreements.only_now or own_changes:
        grade = Grade.DIVERGED
    elif agreements.beyond:
        grade = Grade.SAME_CONCLUSIONS if conclusions and not changed else Grade.DIVERGED
    else:
        grade = Grade.WITHIN_TOLERANCE if agreements.near else Grade.IDENTICAL
    return VerifyOutcome(grade, bool(changed))


def _without_decimals(reason: str) -> str:
    """Return a reason without decimal numbers, which may differ by rounding."""
    return _DECIMALS.sub("#", reason)
