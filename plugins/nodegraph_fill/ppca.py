"""Frames as draws of a normal distribution of few components and noise."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.low_rank import Entries, Mixing
from nodegraph_fill.whole_take import Estimate, TakeMatrix, whole_take
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_PART, _PARTS = 0.5, 5
"""Seconds of the parts of which every fifth is left out at once."""
_LEAST_NOISE = 1e-8
"""Least variance of the noise, relative to the mean variance of a coordinate."""
_SETTLED = 0.01
"""Largest last step of a coordinate, in deviations of the noise."""
_MOST_ROUNDS = 1000


@whole_take(
    "fill.ppca",
    cite="tipping_bishop1999",
    adapted=(
        "from Tipping and Bishop 1999: the number of components is that under which half seconds "
        "that were left out are most likely"
    ),
)
def ppca(recording: Trajectories, gaps: Gaps) -> Estimate:
    """Fill gaps by probabilistic principal component analysis (Tipping & Bishop, 1999).

    A frame, all coordinates in a row, is ``x = W z + mu + e``, z standard normal of q components
    and e noise of the variance v, alike in all coordinates: x is normal with the mean mu and the
    covariance ``C = W W' + v I``, and frames are independent of each other. W, mu and v are those
    under which the present samples are most likely; the mean of the missing ones, given those
    that are present in their frame, fills the gaps. No frame need be complete.

    EM finds them. Given C, the missing samples m of a frame have the mean
    ``mu_m - inv(K_mm) K_mo (x_o - mu_o)`` and the covariance ``inv(K_mm)``, with ``K = inv(C)``
    and o what is present. From these, the mean over the frames is the next mu and the covariance,
    that of the missing samples included, is ``U L U'``, whose greatest q eigenvalues L_q and
    their vectors give ``v`` as the mean of the others and ``W = U_q sqrt(L_q - v)``. It begins
    from straight lines through the gaps, is sped up by Anderson's mixing of the rounds, and ends
    when no sample moves by more than a hundredth of the noise's deviation.

    q is that of the greatest likelihood, too: of every fifth half second of the take with
    straight lines through the gaps, under mean, W and v of the other four, summed over the five.

    For `ends` met, the estimate beside a gap is that which leaves the samples there out, as those
    in the gap are.

    Given q, time is not part of the model: what came before and after a frame tells it nothing.
    Does not depend on where the origin lies, how the axes are turned, or the unit. The head's
    motion is part of the components: remove it first, where it is large.

    Looks at the whole take.
    """
    matrix = TakeMatrix.of(recording)
    lines = matrix.with_lines()
    if not np.ptp(lines, axis=0).any():
        # nothing ever moves
        return Estimate(matrix.positions(lines))
    components = _components(lines, math.ceil(_PART * recording.rate))
    model, unsettled = _learnt(lines, matrix.missing, components)
    lines[matrix.missing] = model.means(lines, Entries(matrix.missing))
    hidden = matrix.hidden_ends(gaps)
    rows = matrix.rows[hidden.frame]
    rows[hidden.missing] = model.means(rows, Entries(hidden.missing))
    ends = hidden.of_gaps(matrix.positions(rows))
    return Estimate(matrix.positions(lines), ends=ends, unsettled=unsettled)


@dataclass(frozen=True)
class _Normal:
    """A normal distribution of rows.

    Attributes
    ----------
    middle : (P,) array of float64
    noise : float
        v.
    precision : (P, P) array of float64
        ``v inv(C)``.
    """

    middle: NDArray[np.float64]
    noise: float
    precision: NDArray[np.float64]

    @staticmethod
    def of(
        middle: NDArray[np.float64], covariance: NDArray[np.float64], components: int
    ) -> _Normal:
        """Return the most likely one for rows of some mean and covariance."""
        values, vectors = np.linalg.eigh(covariance)
        rest, most = values[:-components], values[-components:]
        noise = max(float(rest.mean()), _LEAST_NOISE * float(values.mean()))
        basis = vectors[:, -components:]
        shares = 1.0 - noise / np.maximum(most, noise)
        return _Normal(middle, noise, np.eye(len(middle)) - (basis * shares) @ basis.T)

    def means(self, rows: NDArray[np.float64], entries: Entries) -> NDArray[np.float64]:
        """Return the means of the entries that rows lack, (E,), given the others."""
        known = np.where(entries.mask, 0.0, rows - self.middle)
        pull = entries.product(known, self.precision)
        middle = np.broadcast_to(self.middle, rows.shape)[entries.mask]
        return np.asarray(middle - entries.inverse(self.precision)(pull))


def _learnt(
    lines: NDArray[np.float64], missing: NDArray[np.bool_], components: int
) -> tuple[_Normal, str]:
    """Return the distribution, and what to warn of if the rounds have not settled."""
    lacking = missing.any(axis=1)
    whole, some, entries = lines[~lacking], lines[lacking], Entries(missing[lacking])
    square, total, count = whole.T @ whole, whole.sum(axis=0), len(lines)
    spread, mixing = np.zeros_like(square), Mixing()
    for _ in range(_MOST_ROUNDS):
        middle = (total + some.sum(axis=0)) / count
        covariance = (square + some.T @ some + spread) / count - np.outer(middle, middle)
        model = _Normal.of(middle, covariance, components)
        means = model.means(some, entries)
        step = means - some[entries.mask]
        if np.abs(step).max(initial=0.0) <= _SETTLED * math.sqrt(model.noise):
            return model, ""
        spread = model.noise * entries.inverses(model.precision)
        mixed = mixing.extrapolated(np.concatenate([means, spread.ravel()]), step)
        some[entries.mask], spread = mixed[: len(means)], mixed[len(means) :].reshape(spread.shape)
    return model, f"not settled after {_MOST_ROUNDS} rounds"


def _components(rows: NDArray[np.float64], part: int) -> int:
    """Return the number under which parts of some rows are most likely, given the others."""
    count, size = rows.shape
    fold = np.arange(count) // min(part, math.ceil(count / _PARTS)) % _PARTS
    learnt = count - max(np.bincount(fold))
    most = max(min(size, int(learnt)) - 1, 1)
    kept, likelihood = np.arange(1, most + 1), np.zeros(most)
    least = _LEAST_NOISE * float(rows.var(axis=0).mean())
    for each in range(_PARTS):
        others, left = rows[fold != each], rows[fold == each]
        middle = others.mean(axis=0)
        values, vectors = np.linalg.eigh((others - middle).T @ (others - middle) / len(others))
        values, vectors = values[::-1], vectors[:, ::-1]
        along = (((left - middle) @ vectors) ** 2).sum(axis=0)
        beyond = values.sum() - np.cumsum(values)[:most]
        noise = np.maximum(beyond / (size - kept), least)
        first = np.maximum(values[:most], least)
        explained = np.cumsum(len(left) * np.log(first) + along[:most] / first)
        outside = (along.sum() - np.cumsum(along)[:most]) / noise
        likelihood -= explained + (size - kept) * len(left) * np.log(noise) + outside
    return 1 + int(likelihood.argmax())
