"""Which samples of a file count as missing."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray


def mark_missing(
    positions: NDArray[np.float64], lost: NDArray[np.bool_], *, zeros_missing: bool
) -> NDArray[np.float64]:
    """Return positions in which a sample is there or missing as a whole.

    Parameters
    ----------
    positions
        (T, M, 3) as read.
    lost
        (T, M), samples that the file itself calls missing.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) is missing.
    """
    broken = ~np.isfinite(positions).all(axis=2)
    partly = broken & ~np.isnan(positions).all(axis=2) & ~lost
    if partly.any():
        warnings.warn(
            f"{np.count_nonzero(partly)} samples lack a coordinate or are infinite; they count as "
            "missing",
            stacklevel=3,
        )
    missing = lost | broken
    if zeros_missing:
        missing |= (positions == 0).all(axis=2)
    return np.where(missing[..., None], np.nan, positions)
