"""Features as rows of the matrix of the leading principal components' vectors."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_select.features import Features

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ROUNDING = 1e-12
"""Of the sum of variances: what lies so close to a share has reached it."""


def leading_vectors(
    features: Features, *, variance: float, standardize: bool
) -> NDArray[np.float64]:
    """Return the (p, q) matrix of the first q eigenvectors of the features' covariance.

    q is the smallest number whose eigenvalues, largest first, have that share of the sum of all.

    Parameters
    ----------
    features
        p of them.
    variance
        The share, above 0 and up to 1.
    standardize
        Whether each feature is divided by its standard deviation first, which makes the
        covariance a correlation. One that does not move stays 0, with a warning.
    """
    values = _standardized(features) if standardize else features.values
    eigenvalues, vectors = np.linalg.eigh(values.T @ values / len(values))
    shares = np.maximum(eigenvalues[::-1], 0.0)
    reached = np.cumsum(shares) / shares.sum()
    kept = 1 + int(np.searchsorted(reached, min(variance, reached[-1]) - _ROUNDING))
    return np.ascontiguousarray(vectors[:, ::-1][:, :kept])


def _standardized(features: Features) -> NDArray[np.float64]:
    spread, still = features.spread, features.still
    if still.any():
        markers = sorted({features.markers[feature // 3] for feature in np.flatnonzero(still)})
        warnings.warn(
            f"{np.count_nonzero(still)} of {still.size} features do not move and cannot be "
            f"standardized, they stay 0: coordinates of {', '.join(markers)}",
            stacklevel=4,
        )
    return np.asarray(np.where(still, 0.0, features.values / np.where(still, 1.0, spread)))
