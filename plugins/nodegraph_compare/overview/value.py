"""The overview of a comparison as a value: its verdicts, and the blocks behind them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from nodegraph import Value

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.verdict import Metric, Verdicts
    from nodegraph_tables import Answer


@dataclass(frozen=True, eq=False, kw_only=True)
class Blocks(Value):
    """The B blocks of one group.

    Attributes
    ----------
    cluster : (B,) array of int
        The cluster of each block; -1 for a block that is not used.
    suspect : mapping of int to str
        The blocks whose truth is suspect, with the reasons.
    rows : mapping of str to (B,) array of int
        What identifies the blocks: places in `Overview.columns`.
    start, frames : (B,) arrays of float64
        When a block begins and how long it is; NaN where that is not known.
    errors : mapping of str to (B, K) array of float32
        Of each metric, with the fallback's value where a method has none.
    """

    cluster: NDArray[np.int64]
    suspect: Mapping[int, str]
    rows: Mapping[str, NDArray[np.int64]]
    start: NDArray[np.float64]
    frames: NDArray[np.float64]
    errors: Mapping[str, NDArray[np.float32]]


@dataclass(frozen=True, eq=False, kw_only=True)
class Overview(Value):
    """A comparison of K methods by one number, group by group, with the blocks behind it.

    Attributes
    ----------
    verdicts : Verdicts
    answer : Answer
        Of the verdicts.
    metrics : tuple of Metric
        What is compared, then the metrics shown next to it, then up to three more numbers of the
        same blocks.
    columns : mapping of str to tuple of label
        The labels of what identifies blocks.
    blocks : tuple of Blocks
        Of each group.
    """

    verdicts: Verdicts
    answer: Answer
    metrics: tuple[Metric, ...]
    columns: Mapping[str, tuple[Label, ...]]
    blocks: tuple[Blocks, ...]
