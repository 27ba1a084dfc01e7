"""Marks: what a person has said of samples, span by span."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from nodegraph import Value, listed

BESIDE = ".marks.csv"
"""What ends the name of the file of marks beside a take."""

Kind = Literal["bad", "named", "swapped"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True, kw_only=True)
class Mark(Value):
    """A span of a marker that a person has marked.

    Attributes
    ----------
    marker : str
    start, frames : int
        The first frame, counted from 0, and the number of frames.
    kind : {"bad", "named", "swapped"}
        The samples are to be left out, are those of the marker `other`, or have been mistaken for
        those of `other` and the other way round.
    other : str
        Empty for samples that are bad.

    Raises
    ------
    ValueError
        If the span is empty or begins before the take, `kind` is another, or `other` does not fit
        it.
    """

    marker: str
    start: int
    frames: int
    kind: Kind = "bad"
    other: str = ""

    def __post_init__(self) -> None:
        if self.start < 0 or self.frames < 1:
            raise ValueError(f"{self.frames} frames from frame {self.start} on are no span")
        if self.kind not in KINDS:
            raise ValueError(f"samples are marked as {listed(KINDS)}, not {self.kind!r}")
        if (self.kind == "bad") != (not self.other.strip()) or self.other == self.marker:
            what = "none" if self.kind == "bad" else "the name of another"
            raise ValueError(f"a marker that is {self.kind} has {what} beside it")

    @property
    def stop(self) -> int:
        """The first frame after the span."""
        return self.start + self.frames


@dataclass(frozen=True, kw_only=True)
class Marks(Value):
    """Marks in the order in which a person made them: each holds for what those before it leave.

    Attributes
    ----------
    marks : tuple of Mark
    """

    marks: tuple[Mark, ...] = ()
