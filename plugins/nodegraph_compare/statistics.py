"""Bootstrap intervals, signed-rank tests and Holm's correction, on paired blocks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

RESAMPLES = 2000
CONFIDENCE = 0.95
_DRAWN_AT_ONCE = 4_000_000


def resampled_means(values: NDArray[np.float64], *, seed: int) -> NDArray[np.float64]:
    """Return the bootstrap means of paired columns (Efron 1979).

    Blocks are drawn with replacement, the same blocks for every column, so that the difference
    of two columns of the result is the bootstrap of their paired difference.

    Parameters
    ----------
    values
        (B, K), a row per block, B at least 1.
    seed
        Of the draw; equal seeds draw equal blocks.

    Returns
    -------
    (RESAMPLES, K) array of float64
    """
    blocks = len(values)
    generator = np.random.default_rng(seed)
    at_once = max(1, _DRAWN_AT_ONCE // blocks)
    parts = [
        _how_often(generator, min(at_once, RESAMPLES - done), blocks) @ values / blocks
        for done in range(0, RESAMPLES, at_once)
    ]
    return np.concatenate(parts)


def interval(resampled: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lower and upper ends of the percentile interval of each column."""
    tail = 50 * (1 - CONFIDENCE)
    low, high = np.percentile(resampled, [tail, 100 - tail], axis=0)
    return np.asarray(low), np.asarray(high)


def signed_rank(differences: NDArray[np.float64]) -> float:
    """Return the two-sided p of Wilcoxon's signed-rank test (1945) of paired differences.

    Differences of exactly zero are dropped, as Wilcoxon does; if all are zero, p is 1. The exact
    distribution is used for up to 50 differences without ties, else the normal approximation.
    """
    if not np.any(differences):
        return 1.0
    from scipy.stats import wilcoxon

    return float(wilcoxon(differences).pvalue)


def holm(p: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return p values adjusted for their number by Holm's step-down method (1979).

    The i-th smallest of n, from 0, becomes the largest of ``(n - j) p_j`` over ``j <= i``, at
    most 1. NaN stays NaN and does not count.
    """
    adjusted = np.full(p.shape, np.nan)
    known = np.flatnonzero(~np.isnan(p))
    order = known[np.argsort(p[known], kind="stable")]
    factors = np.arange(len(order), 0, -1)
    adjusted[order] = np.minimum(np.maximum.accumulate(factors * p[order]), 1.0)
    return adjusted


def _how_often(generator: np.random.Generator, draws: int, blocks: int) -> NDArray[np.float64]:
    """Return how often each of `blocks` blocks occurs in each of `draws` resamples."""
    drawn = generator.integers(blocks, size=(draws, blocks))
    drawn += blocks * np.arange(draws)[:, np.newaxis]
    counts = np.bincount(drawn.ravel(), minlength=draws * blocks)
    return counts.reshape(draws, blocks).astype(np.float64)
