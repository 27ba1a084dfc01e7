"""What explains a metric, in sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed

if TYPE_CHECKING:
    from nodegraph_compare.question import Question
    from nodegraph_mocap import Table

_LEAST = 0.005
_MOST = 6


def answers(table: Table, question: Question) -> list[str]:
    """Return how much the largest sources explain, and with what the best changes."""
    if not table["variance"].notna().any():
        return ["no full table of combinations is left; nothing can be said."]
    if not table["variance"].sum() > 0.0:
        return [f"{question.metric} is the same in all combinations; nothing is to be explained."]
    ordered = table.sort_values("eta squared", ascending=False, kind="stable").head(_MOST)
    shares = [
        f"{source} {share:.0%}"
        for source, share in zip(ordered["source"], ordered["eta squared"], strict=True)
        if share >= _LEAST
    ]
    told = [f"Share of the variance of {question.metric}: {', '.join(shares)}."]
    changes = [
        f"{share:.0%} of the time with {source}"
        for source, share in zip(table["source"], table["winner changes"], strict=True)
        if np.isfinite(share)
    ]
    if changes:
        told.append(
            f"From one label to another, the best {question.compare} changes {listed(changes)}."
        )
    return told
