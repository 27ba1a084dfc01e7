"""What a comparison with a lock comes to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from nodegraph.paper.frozen.compared import Compared

Verdict = Literal["identical", "within tolerance", "same conclusions", "diverged"]


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
    moved = found.origins or found.followers
    lone = found.only_locked or found.only_now
    if lone or any(one.change.own for one in found.origins):
        return "diverged"
    if moved:
        return "same conclusions" if conclusions and not changed else "diverged"
    return "within tolerance" if found.near else "identical"
