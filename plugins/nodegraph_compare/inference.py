"""Inference from a few independent units: intervals, tests, equivalence, probabilities.

Every function takes one number per unit and method, ``y`` of shape (C, K), lower being better: of
an error that is a ratio scale the logarithm of the unit's mean error, else the mean itself. The
units, such as actors, weigh equally.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from nodegraph_compare import studentised_range
from nodegraph_compare.ties import ROUNDING

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]

LEVEL: Final = 0.05
CONFIDENCE: Final = 1 - LEVEL
FEWEST: Final = 3
"""Fewer units have no interval."""

FEWEST_JUDGED: Final = 5
"""Fewer units are described, without p and without a verdict."""

FEWEST_SETTLED: Final = 8
"""Number of units below which a result is provisional."""

FEWEST_FLIPPED: Final = 6
"""With fewer units, the smallest p of sign flips is above 5 %."""

_MOST_ENUMERATED = 12
_FLIPS = 4095
_GRID = 80
_LEAST = 1e-300
"""Variance that stands for none at all."""


@dataclass(frozen=True)
class Contrasts:
    """Differences d of K methods to one of them over C units, d > 0 where the method is worse.

    Attributes
    ----------
    d : (C, K) array
    mean, own : (K,) arrays
        Of d, and its standard error.
    low, high, p : (K,) arrays
        The floored Tukey rule in steps, see `contrasts`; p is 1 for the reference.
    freedom : int
        Degrees of freedom of the units.
    """

    d: Numbers
    mean: Numbers
    own: Numbers
    low: Numbers
    high: Numbers
    p: Numbers
    freedom: int

    @property
    def p_alone(self) -> Numbers:
        """(K,), of the paired t-test, not adjusted."""
        from scipy.special import stdtr

        return np.asarray(2 * stdtr(self.freedom, -np.abs(_divided(self.mean, self.own))))

    @property
    def p_of_flips(self) -> Numbers:
        """(K,), of a test that only takes d to be symmetric about 0; not adjusted.

        The share of all signs that the units' differences could have with a mean at least as far
        from 0; of more than twelve units, of 4095 random ones.
        """
        count = self.d.shape[-2]
        if count <= _MOST_ENUMERATED:
            places = np.arange(2 ** (count - 1))
            signs = 1.0 - 2.0 * ((places[:, np.newaxis] >> np.arange(count)) & 1)
        else:
            signs = np.random.default_rng(0).choice([-1.0, 1.0], (_FLIPS + 1, count))
            signs[0] = 1.0
        sums = np.abs(signs @ self.d)
        least = np.abs(self.d.sum(axis=-2)) - ROUNDING * np.abs(self.d).sum(axis=-2)
        return np.asarray((sums >= least).mean(axis=-2))

    @property
    def margin(self) -> Numbers:
        """(K,), the smallest margin within which the difference is shown to be.

        The largest magnitude in the 90 % t interval: two one-sided tests at 5 % each show every
        larger margin (Schuirmann 1987).
        """
        reach = student(1 - LEVEL, self.freedom) * self.own
        return np.maximum(np.abs(self.mean - reach), np.abs(self.mean + reach))

    @property
    def effect(self) -> Numbers:
        """(K,), the mean over the sd of d with Hedges' correction, ``1 - 3 / (4 C - 5)``."""
        sd = self.own * np.sqrt(self.d.shape[-2])
        return _divided(self.mean, sd) * (1 - 3 / (4 * self.freedom - 1))


def contrasts(
    y: Numbers, reference: int, strata: NDArray[np.intp] | None = None, *, in_steps: bool = True
) -> Contrasts:
    """Return the differences of all methods to one of them, and which are clear.

    The floored Tukey rule (Tukey 1953): with the residuals of y after removal of the means of
    units and methods, ``MSE = sum(residuals^2) / ((K - 1)(C - 1))``, the standard error of a pair
    is its own, ``sd(d) / sqrt(C)``, but never less than the pooled ``sqrt(2 MSE / C)``. Divided by
    it, ``|mean(d)|`` is compared to the studentised range of K means, ``(K - 1)(C - 1)`` degrees
    of freedom, over sqrt(2): there is one p for a pair, whichever of all methods is the best. Of
    two methods it is the paired t-test.

    In steps: methods with p of at most 5 % are set aside, and the rest is judged again by itself,
    until nothing falls. Of methods equal to the reference any is called apart in at most about
    5 % of studies, whatever the others are: a first false step is taken where all of them are
    judged together. Without steps the variance of one distant method decides between all others.
    The interval of a method is that of the step in which it falls, or of the last; p is as well,
    but no less than that of any method that fell before.

    Where units are parts of S recordings, the claim is about these: their means are removed, which
    leaves C - S degrees of freedom for C - 1.

    Parameters
    ----------
    y
        (C, K), K of two or more.
    reference
        The place of the method that others are compared to.
    strata
        (C,), the recording of each unit, where units are parts of recordings; equally many each.
    in_steps
        Whether to judge again what is left; otherwise all differences are of the first step.
    """
    size = ROUNDING * np.maximum(np.abs(y).max(axis=0), 1e-3 * np.abs(y).max())
    d = y - y[:, [reference]]
    d = np.where(np.abs(d) <= size, 0.0, d)
    mean = d.mean(axis=0)
    within, freedom = _centred(d, strata)
    own = _exact(np.sqrt(np.square(within).sum(axis=0) / freedom / len(y)), size, len(y))
    low, high, p = (np.zeros(y.shape[1]) for _ in range(3))
    left, least = np.arange(y.shape[1]), 0.0
    while True:
        error = np.maximum(own[left], _exact(_pooled(y[:, left], strata), size[left], len(y)))
        ratio = np.abs(_divided(mean[left], error))
        methods, pooled_freedom = len(left), (len(left) - 1) * freedom
        limit = range_quantile(methods, pooled_freedom)
        low[left], high[left] = mean[left] - limit * error, mean[left] + limit * error
        apart = ratio >= limit
        falls = apart if in_steps and 0 < np.count_nonzero(apart) < methods - 1 else apart | True
        chances = _range_survival(ratio[falls], methods, pooled_freedom)
        p[left[falls]] = np.maximum(chances, least)
        if falls.all():
            return Contrasts(d, mean, own, low, high, p, freedom)
        left, least = left[~falls], max(least, float(chances.max()))


def _pooled(y: Numbers, strata: NDArray[np.intp] | None) -> float:
    """Return the standard error of a difference from what all methods vary by."""
    residuals, freedom = _centred(y - y.mean(axis=1, keepdims=True), strata)
    square = np.square(residuals).sum() / ((y.shape[1] - 1) * freedom)
    return float(np.sqrt(2 * square / len(y)))


def _exact(error: Numbers | float, size: Numbers, count: int) -> Numbers:
    """Return a standard error without what is left by rounding."""
    return np.where(error * np.sqrt(count) <= size, 0.0, error)


def _range_survival(ratio: Numbers, methods: int, freedom: float) -> Numbers:
    """Return p of differences over their standard errors, by the studentised range."""
    sizes, place = np.unique(ratio, return_inverse=True)
    return studentised_range.survival(np.sqrt(2) * sizes, methods, freedom)[place]


def _centred(values: Numbers, strata: NDArray[np.intp] | None) -> tuple[Numbers, int]:
    """Return values without the means of their strata, and the degrees of freedom left."""
    count = values.shape[-2]
    if strata is None:
        return values - values.mean(axis=-2, keepdims=True), count - 1
    member = strata[:, np.newaxis] == np.unique(strata)
    share = member @ (member / member.sum(axis=0)).T
    return values - share @ values, count - member.shape[1]


def mean_interval(y: Numbers, strata: NDArray[np.intp] | None = None) -> tuple[Numbers, Numbers]:
    """Return the ends of Student's 95 % interval of the mean over units, (..., K)."""
    within, freedom = _centred(y, strata)
    error = np.sqrt(np.square(within).sum(axis=-2) / freedom / y.shape[-2])
    reach = student((1 + CONFIDENCE) / 2, freedom) * error
    mean = y.mean(axis=-2)
    return mean - reach, mean + reach


def posterior(
    d: Numbers, variance: Numbers | float, margin: float, *, new: bool = False
) -> tuple[Numbers, Numbers, Numbers]:
    """Return the probabilities that the mean of d is below, within, and above a margin about 0.

    ``d_c ~ N(mu, tau^2 + v)`` with v the variance of a unit's own mean, pooled over units, mu
    flat, and tau half-Cauchy with the sd of d as its scale (Gelman 2006), on a grid of its
    quantiles, ``tau = sd tan(pi u / 2)``, ``u = (i + 1/2) / 80``. Given tau, mu is normal with
    mean ``mean(d)`` and variance ``(tau^2 + v) / C``.

    Parameters
    ----------
    d
        (..., C), differences of two methods.
    variance
        v, (...).
    margin
        Half the width of what counts as equal.
    new
        Whether of the difference for a further unit, whose variance is larger by tau^2, in place
        of the mean over all units.
    """
    from scipy.special import ndtr

    count = d.shape[-1]
    mean = d.mean(axis=-1)[..., np.newaxis]
    squares = np.square(d - mean).sum(axis=-1)[..., np.newaxis]
    quantile = (np.arange(_GRID) + 0.5) / _GRID
    between = squares / (count - 1) * np.square(np.tan(np.pi * quantile / 2))
    total = np.maximum(between + np.asarray(variance)[..., np.newaxis], _LEAST)
    weight = -(count - 1) / 2 * np.log(total) - squares / (2 * total)
    weight = np.exp(weight - weight.max(axis=-1, keepdims=True))
    weight /= weight.sum(axis=-1, keepdims=True)
    sd = np.sqrt(total / count + (between if new else 0.0))
    below = (weight * ndtr((-margin - mean) / sd)).sum(axis=-1)
    above = (weight * ndtr((mean - margin) / sd)).sum(axis=-1)
    return below, 1 - below - above, above


@lru_cache(maxsize=256)
def range_quantile(methods: int, freedom: float) -> float:
    """Return how many standard errors apart two of k means must be (Tukey 1953), 5 % over all.

    The 95 % quantile of the studentised range, over sqrt(2): of two means, Student's quantile.
    """
    return studentised_range.quantile(LEVEL, methods, freedom) / float(np.sqrt(2))


@lru_cache(maxsize=256)
def student(share: float, freedom: int) -> float:
    """Return a quantile of Student's t distribution."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, share))


def _divided(mean: Numbers, error: Numbers) -> Numbers:
    """Return mean over error; where there is no error, 0 for a mean of 0, else infinite."""
    sure = np.where(mean == 0.0, 0.0, np.copysign(np.inf, mean))
    return np.where(error > 0.0, mean / np.where(error > 0.0, error, 1.0), sure)
