"""What a comparison with a lock comes to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from nodegraph.paper.frozen.compared import Compared

Grade = Literal["identical", "within tolerance", "same conclusions", "diverged"]


@dataclass(frozen=True)
class Verdict:
    """What a comparison comes to.

    Attributes
    ----------
    grade : str
        How far the results are those of the lock.
    turned : bool
        Whether the study concludes something else: a tie may turn with the last digit.
    """

    grade: Grade
    turned: bool = False

    @property
    def holds(self) -> bool:
        """Whether the study still gives its results, and the same conclusions."""
        return self.grade != "diverged" and not self.turned

    @property
    def text(self) -> str:
        """The verdict in a few words."""
        beside = self.turned and self.grade != "diverged"
        return f"{self.grade}, but conclusions changed" if beside else self.grade


def verdict(found: Compared, conclusions: bool, changed: Sequence[str]) -> Verdict:
    """Return what a comparison comes to.

    Results beyond the tolerance are put down to libraries and processors only if nothing of the
    study itself explains them: a method that was edited has diverged, whatever follows from it.

    Parameters
    ----------
    found
    conclusions
        Whether the study draws any.
    changed
        Conclusions that are others.
    """
    return Verdict(_grade(found, conclusions and not changed), bool(changed))


def _grade(found: Compared, concludes_the_same: bool) -> Grade:
    lone = found.only_locked or found.only_now
    if lone or any(one.change.own for one in found.origins):
        return "diverged"
    if found.origins or found.followers:
        return "same conclusions" if concludes_the_same else "diverged"
    return "within tolerance" if found.near else "identical"
