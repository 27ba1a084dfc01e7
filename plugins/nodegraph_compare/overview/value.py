"""The overview of a comparison as a value: verdicts of its groups, and the numbers behind them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from nodegraph import Value

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.units import Speech
    from nodegraph_tables import BetterEnd


@dataclass(frozen=True)
class Metric(Value):
    """A column of numbers: its unit, and which end of it is better."""

    name: str
    unit: str
    better: BetterEnd


@dataclass(frozen=True, eq=False, kw_only=True)
class WithoutSuspects(Value):
    """What a group says without its suspect blocks; places are those of `Overview.methods`."""

    mean: NDArray[np.float64]
    best: tuple[int, ...]
    tied: tuple[int, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class GroupOverview(Value):
    """One combination of the labels of `within`: B blocks of K methods.

    Places are those of `Overview.methods`; NaN stands for a method without any number.

    Attributes
    ----------
    labels : tuple of label
        Of `Overview.within`.
    speech, scope, caution, objection : str
        See `nodegraph_compare.table.verdict.Verdict`.
    best, tied, behind : tuple of int
    better, worse : tuple of int
        Methods clearly apart from the baseline `Overview.against`, by every rule for missing
        blocks; empty without it, or with too few units.
    mean, low, high, median, rank : (K,) arrays of float64
        See `nodegraph_compare.table.summary.Summary`.
    ratio, ratio_low, ratio_high : (K,) arrays of float64
        To the best: the ratio of mean errors, or the difference of means; see `Overview.ratio`.
    difference, difference_low, difference_high : (K,) arrays of float64
        Of means to that of the best, in the metric's unit.
    p_of_step : (K,) array of float64
        Of the difference to the one before, where they follow one another.
    missing : (K,) array of int
        Blocks in which the method has no number of its own.
    used : int
        Blocks in which every method has a number, over which the statistics are.
    unit : (B,) array of int
        The independent unit of each block; -1 for a block that is not used.
    suspect : mapping of int to str
        The blocks whose truth is suspect, with the reasons.
    without_suspects : WithoutSuspects or None
    rows : mapping of str to (B,) array of int
        What identifies the blocks: places in `Overview.columns`.
    start, frames : (B,) arrays of float64
        When a block begins and how long it is; NaN where that is not known.
    errors : mapping of str to (B, K) array of float32
        Of each metric, with the fallback's value where a method has none.
    """

    labels: tuple[Label, ...]
    speech: Speech
    scope: str
    caution: str
    objection: str
    best: tuple[int, ...]
    tied: tuple[int, ...]
    behind: tuple[int, ...]
    better: tuple[int, ...]
    worse: tuple[int, ...]
    mean: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    median: NDArray[np.float64]
    rank: NDArray[np.float64]
    ratio: NDArray[np.float64]
    ratio_low: NDArray[np.float64]
    ratio_high: NDArray[np.float64]
    difference: NDArray[np.float64]
    difference_low: NDArray[np.float64]
    difference_high: NDArray[np.float64]
    p_of_step: NDArray[np.float64]
    missing: NDArray[np.int64]
    used: int
    unit: NDArray[np.int64]
    suspect: Mapping[int, str]
    without_suspects: WithoutSuspects | None
    rows: Mapping[str, NDArray[np.int64]]
    start: NDArray[np.float64]
    frames: NDArray[np.float64]
    errors: Mapping[str, NDArray[np.float32]]

    @property
    def judged(self) -> bool:
        """Whether there are units enough for a verdict."""
        return self.speech in ("provisional", "settled")

    @property
    def stands(self) -> bool:
        """Whether there is a verdict."""
        return self.judged and not self.objection and bool(self.best)


@dataclass(frozen=True, eq=False, kw_only=True)
class Overview(Value):
    """A comparison of K methods by one number, group by group, with the blocks behind it.

    Attributes
    ----------
    metrics : tuple of Metric
        What is compared, then the metrics shown next to it, then up to three more numbers of the
        same blocks.
    beside : int
        How many of the metrics are shown next to it.
    compare : str
        What the methods are labels of; empty where nothing is compared.
    is_sequence : bool
        Whether they follow one another, such as the steps of a chain, in this order.
    within : tuple of str
        What the groups are combinations of.
    blocks, units : str
        What several blocks, and several independent units, are called: ``gaps``, ``actors``.
    ratio : bool
        Whether methods are compared by ratios, not by differences.
    baseline : label or None
        The method that the others are seen against at first.
    against : int or None
        The place of the baseline that the answer compares every method to.
    methods : tuple of label
    adapted : tuple of int
        Methods that differ from what was published.
    ahead : tuple of int
        Methods that look at the whole take.
    columns : mapping of str to tuple of label
        The labels of what identifies blocks.
    groups : tuple of GroupOverview
    """

    metrics: tuple[Metric, ...]
    beside: int
    compare: str
    is_sequence: bool
    within: tuple[str, ...]
    blocks: str
    units: str
    ratio: bool
    baseline: Label | None
    against: int | None
    methods: tuple[Label, ...]
    adapted: tuple[int, ...]
    ahead: tuple[int, ...]
    columns: Mapping[str, tuple[Label, ...]]
    groups: tuple[GroupOverview, ...]

    @property
    def metric(self) -> Metric:
        """What is compared."""
        return self.metrics[0]
