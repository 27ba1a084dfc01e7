"""Rules by which samples of a file count as missing."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.frame_ranges import chunks

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


def mark_missing(
    positions: NDArray[np.float64],
    lost: NDArray[np.bool_],
    markers: Sequence[str],
    *,
    zeros_missing: bool,
) -> NDArray[np.float64]:
    """Return positions in which a sample is there or missing as a whole.

    Warnings count the samples that the file does not itself call missing: those that lack a
    coordinate, those that are infinite and those at exactly (0, 0, 0).

    Parameters
    ----------
    positions
        (T, M, 3) as read; changed in place, because a long recording has no room for two.
    lost
        (T, M), samples that the file itself calls missing.
    markers
        Their names, for warnings.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) is missing.
    """
    infinite, partly, zero = (
        _Counted("are infinite", markers),
        _Counted("lack a coordinate", markers),
        _Counted("are at exactly (0, 0, 0)", markers),
    )
    for piece in chunks(len(positions), positions[:1].nbytes):
        some, known = positions[piece], lost[piece]
        if known.any():
            some[known] = np.nan
        lacking = _lacking(some)
        if lacking is not None:
            unbounded = np.asarray(np.isinf(some).any(axis=2))
            infinite.add(unbounded, piece.start)
            partly.add(lacking & ~unbounded & ~np.isnan(some).all(axis=2), piece.start)
            some[lacking] = np.nan
        if zeros_missing and (at_zero := some == 0).any():
            zeros = _every(at_zero)
            zero.add(zeros, piece.start)
            some[zeros] = np.nan
    for counted in (infinite, partly, zero):
        counted.warn()
    return positions


def _lacking(positions: NDArray[np.float64]) -> NDArray[np.bool_] | None:
    """Return which samples are not finite, or None if each is that or wholly NaN."""
    finite = np.isfinite(positions)
    if finite.all():
        return None
    lacking = ~_every(finite)
    wholly = np.count_nonzero(np.isnan(positions)) == 3 * np.count_nonzero(lacking)
    return None if wholly else lacking


def _every(true: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return where it is true of all three coordinates.

    Over an axis of three, `numpy.all` takes twenty times as long as two bitwise operations.
    """
    return np.asarray(true[..., 0] & true[..., 1] & true[..., 2])


@dataclass
class _Counted:
    """The number of samples that are missing for one reason, and the first of them."""

    what: str
    markers: Sequence[str]
    count: int = 0
    first: str = ""

    def add(self, samples: NDArray[np.bool_], before: int) -> None:
        """Count the samples of a piece, given the number of frames before it."""
        count = int(np.count_nonzero(samples))
        if count and not self.count:
            frame, marker = np.argwhere(samples)[0]
            self.first = f"in frame {frame + before}, marker {self.markers[marker]}"
        self.count += count

    def warn(self) -> None:
        """Warn, if there are any."""
        if self.count:
            warnings.warn(
                f"{self.count} samples {self.what} and count as missing; the first is {self.first}",
                stacklevel=4,
            )
