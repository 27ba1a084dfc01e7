"""The statistics of one group of methods, over the blocks that all of them have."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.statistics import holm, interval, resampled_means, signed_rank

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_compare.blocks import Group


@dataclass(frozen=True)
class Summary:
    """Statistics of K methods over the blocks that every usable method has.

    Attributes
    ----------
    group : Group
    values : (N, K) array of float64
        The complete blocks.
    resampled : (R, K) array of float64
        Bootstrap means, paired; all NaN with fewer than two blocks.
    mean, rms, median, sd, low, high : (K,) arrays of float64
        NaN for a method without any number; `sd` and the interval with fewer than two blocks.
    """

    group: Group
    values: NDArray[np.float64]
    resampled: NDArray[np.float64]
    mean: NDArray[np.float64]
    rms: NDArray[np.float64]
    median: NDArray[np.float64]
    sd: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @property
    def best(self) -> int | None:
        """The column with the lowest mean, the first of equals; None if there is no block."""
        return int(np.nanargmin(self.mean)) if np.isfinite(self.mean).any() else None

    @property
    def blocks(self) -> NDArray[np.intp]:
        """(K,), the number of blocks used; 0 for a method without any number."""
        return np.where(np.isfinite(self.mean), len(self.values), 0)


@dataclass(frozen=True)
class Differences:
    """Paired differences of each method to one of them; NaN for that one.

    Attributes
    ----------
    mean, low, high, p, better : (K,) arrays of float64
        Method minus baseline and its interval, the signed-rank p after Holm's correction, and
        the share of blocks in which the method has the lower value.
    """

    mean: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    p: NDArray[np.float64]
    better: NDArray[np.float64]


def summarise(group: Group, *, seed: int) -> Summary:
    """Return the statistics of a group."""
    values = group.values[group.complete]
    blocks, methods = values.shape
    nothing = np.full(methods, np.nan)
    few = blocks < 2
    resampled = np.full((1, methods), np.nan) if few else resampled_means(values, seed=seed)
    low, high = interval(resampled)
    return Summary(
        group,
        values,
        resampled,
        mean=values.mean(axis=0) if blocks else nothing,
        rms=np.sqrt((values**2).mean(axis=0)) if blocks else nothing,
        median=np.median(values, axis=0) if blocks else nothing,
        sd=nothing if few else values.std(axis=0, ddof=1),
        low=low,
        high=high,
    )


def differences(summary: Summary, baseline: int) -> Differences:
    """Return the paired differences of a group's methods to the one at place `baseline`."""
    values = summary.values - summary.values[:, [baseline]]
    values[:, baseline] = np.nan
    resampled = summary.resampled - summary.resampled[:, [baseline]]
    resampled[:, baseline] = np.nan
    known = np.asarray(np.isfinite(values).any(axis=0))
    low, high = interval(resampled)
    nothing = np.full(known.shape, np.nan)
    p = nothing.copy()
    p[known] = [signed_rank(one) for one in values.T[known]]
    return Differences(
        mean=values.mean(axis=0) if len(values) else nothing,
        low=low,
        high=high,
        p=holm(p),
        better=np.where(known, (values < 0).mean(axis=0), np.nan) if len(values) else nothing,
    )
