"""Bootstrap intervals of means over blocks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.ties import ROUNDING, differ

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import NDArray

RESAMPLES = 2000
CONFIDENCE = 0.95
FEWEST = 3
"""Fewer blocks have no interval."""

_FEW = 5
_DRAWN_AT_ONCE = 4_000_000
_FARTHEST = 10.0
_TAILS = (50 * (1 - CONFIDENCE), 50 * (1 + CONFIDENCE))

Ends = tuple["NDArray[np.float64]", "NDArray[np.float64]"]


class Bootstrap:
    """Studentised bootstrap intervals of means (Efron 1979; Hall 1988).

    Blocks are drawn with replacement. With the mean m of B blocks and its standard error
    ``e = sd / sqrt(B)``, each draw gives ``t* = (m* - m) / e*``, and the 95 % interval is
    ``[m - q(0.975) e, m - q(0.025) e]`` with the quantiles q of 2000 t*.

    The plain percentile interval is too short for few blocks. Coverage of the true mean
    in 4000 simulated studies, of this interval / the percentile interval (nominal: 95 %):

    ================ ============= ============= ============= =============
    blocks           5             10            20            40
    ================ ============= ============= ============= =============
    normal           96 % / 84 %   95 % / 91 %   95 % / 94 %   94 % / 93 %
    exponential      92 % / 78 %   94 % / 85 %   94 % / 90 %   94 % / 92 %
    log-normal       89 % / 72 %   91 % / 80 %   92 % / 85 %   92 % / 88 %
    ================ ============= ============= ============= =============

    With three or four blocks, where resampling carries too little information, the interval is
    Student's; with fewer there is none. An end that lies more than ten times as far from the mean
    as Student's is replaced by that: it comes of resamples of blocks that are equal or nearly so,
    and is infinite where they are. Blocks that differ by rounding alone count as equal. Equal seeds
    and equal numbers of blocks draw equal blocks.

    Parameters
    ----------
    seed
        Of the draws.
    """

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self._kept: dict[int, list[NDArray[np.float64]]] = {}

    def interval(self, values: NDArray[np.float64]) -> Ends:
        """Return the lower and the upper ends for the columns of `values`, (B, K); else NaN."""
        blocks, columns = values.shape
        if blocks < FEWEST:
            return np.full(columns, np.nan), np.full(columns, np.nan)
        mean = values.mean(axis=0)
        error = values.std(axis=0, ddof=1) / np.sqrt(blocks)
        varied = differ(values)  # where all are equal, nothing is uncertain
        apart = (values - mean) / np.where(varied, error, 1.0)
        low, high = student = _student(blocks)
        if blocks >= _FEW:
            low, high = (
                np.where(np.abs(quantile) > _FARTHEST * np.abs(known), known, quantile)
                for quantile, known in zip(self._quantiles(apart), student, strict=True)
            )
        low, high = (np.where(varied, quantile, 0.0) for quantile in (low, high))
        return mean - high * error, mean - low * error

    def _quantiles(self, apart: NDArray[np.float64]) -> Ends:
        """Return the quantiles of t* of columns of mean 0 and standard error 1."""
        blocks = len(apart)
        squared = np.square(apart)
        parts = []
        for counts in self._draws(blocks):
            mean = counts @ apart / blocks
            variance = counts @ squared / blocks - np.square(mean)
            none = variance <= ROUNDING * blocks
            spread = np.sqrt(np.where(none, 1.0, variance) / (blocks - 1))
            parts.append(np.where(none, np.copysign(np.inf, mean), mean / spread))
        low, high = np.percentile(np.concatenate(parts), _TAILS, axis=0, method="nearest")
        return np.asarray(low), np.asarray(high)

    def _draws(self, blocks: int) -> Iterable[NDArray[np.float64]]:
        """Return, in parts, how often each block occurs in each resample; few ones are kept."""
        if RESAMPLES * blocks > _DRAWN_AT_ONCE:
            return _drawn(np.random.default_rng(self._seed), blocks)
        if blocks not in self._kept:
            self._kept = {blocks: list(_drawn(np.random.default_rng(self._seed), blocks))}
        return self._kept[blocks]


def _student(blocks: int) -> Ends:
    from scipy.stats import t

    quantile = np.asarray(t.ppf((1 + CONFIDENCE) / 2, blocks - 1))
    return -quantile, quantile


def _drawn(generator: np.random.Generator, blocks: int) -> Iterator[NDArray[np.float64]]:
    at_once = max(1, _DRAWN_AT_ONCE // blocks)
    for first in range(0, RESAMPLES, at_once):
        draws = min(at_once, RESAMPLES - first)
        drawn = generator.integers(blocks, size=(draws, blocks))
        drawn += blocks * np.arange(draws)[:, np.newaxis]
        counts = np.bincount(drawn.ravel(), minlength=draws * blocks)
        yield counts.reshape(draws, blocks).astype(np.float64)
