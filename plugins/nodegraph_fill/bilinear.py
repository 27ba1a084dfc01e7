"""Slow waves of a few shapes: cosines over time times principal components over the markers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import Refusal, Unit
from nodegraph_fill.gaps import Gaps
from nodegraph_fill.low_rank import Entries, LowRank
from nodegraph_fill.tuning import Tune
from nodegraph_fill.whole_take import Estimate, TakeMatrix, whole_take
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SHRINKAGE = 0.001
_STRAIGHT = 0.03
"""Cost of a step away from the straight line, relative to one away from the model."""
_MOST_ROUNDS = 1000
_TOLERANCE = 1e-13
"""Largest last residual, relative to the norm of the known samples."""
_SLIGHT = 1e-9
"""Relative margin by which a cosine exactly at the cut-off is kept, however that was rounded."""


@whole_take(
    "fill.bilinear",
    cite="akhter2012",
    adapted=(
        "from Akhter et al. 2012: the basis of shapes is learnt from the take itself, and a "
        "small weight on straight lines decides what the model leaves open"
    ),
)
def bilinear(
    recording: Trajectories,
    gaps: Gaps,
    *,
    cutoff: Annotated[float, Field(gt=0, allow_inf_nan=False), Unit("Hz"), Tune(6.0, 12.0)] = 6.0,
    variance: Annotated[float, Field(gt=0, le=1), Tune(0.995, 0.999)] = 0.995,
) -> Estimate:
    """Fill gaps by a bilinear spatiotemporal basis (Akhter, Simon, Khan, Matthews & Sheikh, 2012).

    The take, a matrix X of a row per frame and three columns per marker without their means, is
    ``Theta C B'``: the columns of Theta are the cosines ``cos(pi k (t + 1/2) / T)`` over all T
    frames whose frequency ``k rate / (2 T)`` is not above the cut-off (DCT-II, by
    `scipy.fft`), those of B a few principal components of the shape, and C the coefficients.
    Missing are those entries of X with the least ``|X - Theta C B'|^2``, for the best C, plus
    0.03 times their squared distance to the straight line through the gap, which decides where
    the model leaves them open; at a take's end, to the marker's nearest sample. Theta and B
    being orthogonal, that is a system of linear equations, solved by conjugate gradients; it
    is where alternating between C and the missing entries would end.

    B are the eigenvectors of the covariance of the take as `fill.soft_impute` completes it
    (shrinkage 0.001), the first that have the share `variance` of it. Akhter et al. take it
    from training takes. No frame need be complete. The take is treated as a whole, however
    long: its cosines are many, but never written down.

    Does not depend on where the origin lies, how the axes are turned, or the unit. The
    head's motion is part of the shape: remove it first, where it is large.

    Looks at the whole take.

    Parameters
    ----------
    cutoff
        The highest frequency of the cosines. 6 Hz holds what faces do slowly; quicker motion of
        the shape's components is lost.
    variance
        Share of the variance that the components of the shape keep.

    Raises
    ------
    Refusal
        If there are gaps to fill, and the cut-off is not below half the frame rate.
    """
    if not 2.0 * cutoff < recording.rate:
        raise Refusal(
            f"needs a cut-off below half the frame rate, {recording.rate / 2.0:g} Hz, got "
            f"{cutoff:g} Hz"
        )

    matrix = TakeMatrix.of(recording)
    low_rank = LowRank.of(recording, _SHRINKAGE)
    shape = low_rank.principal(variance)
    cosines = 1 + math.floor(2.0 * cutoff / recording.rate * recording.frames + _SLIGHT)
    basis = _Basis(shape.basis, cosines)
    straight = matrix.with_lines() - shape.middle
    completed, unsettled = _completed(basis, straight, matrix.missing)
    positions = matrix.positions(basis.nearest(completed) + shape.middle)
    return Estimate(positions, unsettled=low_rank.unsettled or unsettled)


@dataclass(frozen=True)
class _Basis:
    """The shape's components, (P, K), and the number of cosines."""

    shapes: NDArray[np.float64]
    cosines: int

    def nearest(self, rows: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the rows, (T, P), that the basis can say and that are nearest to these."""
        return np.asarray(self.slow(rows @ self.shapes) @ self.shapes.T)

    def slow(self, states: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what the cosines hold of states, (T, K)."""
        from scipy.fft import dct, idct

        waves = dct(states, axis=0, norm="ortho")
        waves[self.cosines :] = 0.0
        return np.asarray(idct(waves, axis=0, norm="ortho"))


def _completed(
    basis: _Basis, straight: NDArray[np.float64], missing: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], str]:
    """Return the rows with their missing entries moved from the straight lines to the least.

    Returned is besides what to warn of, if the rounds have not settled.
    """
    entries, unsettled = Entries(missing), ""
    rest = -(straight - basis.nearest(straight))[missing]
    ahead, moved = rest.copy(), np.zeros_like(rest)
    square, enough = rest @ rest, (_TOLERANCE * float(np.linalg.norm(straight))) ** 2
    for _ in range(_MOST_ROUNDS):
        if square <= enough:
            break
        within = entries.product(basis.slow(entries.rows(ahead, basis.shapes)), basis.shapes)
        turned = (1.0 + _STRAIGHT) * ahead - within
        length = square / (ahead @ turned)
        moved += length * ahead
        rest -= length * turned
        before, square = square, rest @ rest
        ahead = rest + square / before * ahead
    else:
        unsettled = f"not settled after {_MOST_ROUNDS} rounds"
    completed = straight.copy()
    completed[missing] += moved
    return completed, unsettled
