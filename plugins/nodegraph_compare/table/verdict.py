"""What may be said of one group of methods: in sentences, in the table, and in the overview."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.scope import caution, scope
from nodegraph_compare.table.sensitivity import behind_by_all_rules, objections, tied_with_best

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
    """

    speech: Speech
    scope: str
    caution: str
    objection: str
    best: NDArray[np.bool_]
    tied: NDArray[np.bool_]
    behind: NDArray[np.bool_]


def verdict_on(summary: Summary, question: Question, blocks: str) -> Verdict:
    """Return the verdict on a group.

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
    behind = behind_by_all_rules(summary)
    return Verdict(
        speech=units.speech,
        scope=scope(units, question, blocks),
        caution=few,
        objection=objection,
        best=summary.bests,
        tied=tied_with_best(summary),
        behind=behind,
    )
