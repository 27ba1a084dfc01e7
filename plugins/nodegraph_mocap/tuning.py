"""What a method has chosen by the recording that it was given."""

from __future__ import annotations

from dataclasses import dataclass

from nodegraph import Value

Choice = str | int | float | bool | None


@dataclass(frozen=True)
class Tuning(Value):
    """The settings of a method before and after they were tuned on the recording itself.

    Attributes
    ----------
    settings : tuple of (str, Choice, Choice)
        The name of each setting that was tuned, its value before and the one that was chosen.
    gaps : int
        How many gaps of known content were hidden from the recording to tune on.
    tries : int
        How many combinations of values were tried.
    before, after : float
        The mean error in those gaps, mm; NaN if they were too few.
    """

    settings: tuple[tuple[str, Choice, Choice], ...]
    gaps: int
    tries: int
    before: float
    after: float
