"""What may be said of one group of methods: in sentences, in the table, and in the overview."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.scope import caution, scope
from nodegraph_compare.table.sensitivity import behind_by_all_rules, objections

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_compare.question import Question
    from nodegraph_compare.table.summary import Summary
    from nodegraph_compare.units import Speech


@dataclass(frozen=True)
class Verdict:
    """Which of K methods are the best, which are not clearly apart from them, which are behind.

    Attributes
    ----------
    speech : str
        ``nothing`` and ``described``: there are too few units for a verdict; ``provisional``;
        ``settled``.
    scope : str
        What it holds for: ``over 8 actors``, ``for further gaps in this recording``.
    caution : str
        Why nothing can be said, or what too few units leave open; empty where they are enough.
    objection : str
        What is the best by other rules for missing blocks, so that no verdict stands; empty where
        the same is.
    best, tied, behind : (K,) arrays of bool
        Behind are those that are clearly worse by every rule for missing blocks, tied all others
        with a number. Both are empty without a verdict.
    by_fallback : (K,) array of bool
        Clearly worse only with the fallback's values in place of missing ones.
    """

    speech: Speech
    scope: str
    caution: str
    objection: str
    best: NDArray[np.bool_]
    tied: NDArray[np.bool_]
    behind: NDArray[np.bool_]
    by_fallback: NDArray[np.bool_]

    @property
    def stands(self) -> bool:
        """Whether there is a verdict: units enough, a better end, and rules that agree."""
        judged = self.speech in ("provisional", "settled")
        return judged and not self.objection and bool(self.best.any())


def verdict_on(summary: Summary, question: Question, blocks: str) -> Verdict:
    """Return what may be said of a group.

    Parameters
    ----------
    summary
        With its variants.
    question
        Of the comparison.
    blocks
        What several blocks are called.
    """
    units = summary.units
    objection = "" if summary.best is None else objections(summary, blocks)
    few = caution(units, question)
    if units.speech == "nothing":
        few = units.why or f"{units.count} units"
    none = np.zeros(summary.level.shape, dtype=bool)
    stands = summary.judged and summary.best is not None and not objection
    behind = behind_by_all_rules(summary) if stands else none
    worse = (summary.blocks > 0) & ~summary.bests
    return Verdict(
        speech=units.speech,
        scope=scope(units, question, blocks),
        caution=few,
        objection=objection,
        best=summary.bests,
        tied=worse & ~behind if stands else none,
        behind=behind,
        by_fallback=summary.behind & ~behind if stands else none,
    )
