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
    none, each = np.zeros(len(methods)), np.arange(len(values))
    time = np.full(len(values), np.nan)
    return Group(
        labels, methods, values, none, none, each, each, 1, time, time, time, time, each, each
    )
