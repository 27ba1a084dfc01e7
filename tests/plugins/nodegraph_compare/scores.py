"""Scores to be compared: a table of a gap per row, and a group of blocks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from nodegraph import Label
from nodegraph_compare.blocks import Group


def scored(*values: float) -> pd.DataFrame:
    return pd.DataFrame({"gap": range(len(values)), "rmse": np.array(values, dtype=float)})


def group_of(labels: tuple[Label, ...], methods: tuple[Label, ...], values: Any) -> Group:
    """A group of which each block is a cluster of its own, at a time that nobody knows."""
    nothing, blocks = np.zeros(len(methods)), np.arange(len(values))
    times = [np.full(len(values), np.nan)] * 4
    return Group(
        labels, methods, values, nothing, nothing, blocks, blocks, 1, *times, blocks, blocks
    )
