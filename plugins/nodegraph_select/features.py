"""A recording's features: three per marker, one per coordinate."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Refusal

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

_STILL = 1e-9
"""Share of the largest spread below which a coordinate moves by no more than rounding."""

_SEEN = 1e-6
"""Millimetres. Alignment leaves a rigid head 1e-11 at a metre from the origin, 1e-8 at a kilometre;
the best cameras see 1e-3. What spreads less is the rounding of double numbers, not a face."""


@dataclass(frozen=True, eq=False)
class Features:
    """The features from which the methods choose.

    Attributes
    ----------
    markers : tuple of M str
        In the order of their names, so that nothing hangs on the order in a file.
    values : (T, 3 M) array of float64
        Millimetres; x, y, z of each marker, each less its mean over the take.
    """

    markers: tuple[str, ...]
    values: NDArray[np.float64]

    @property
    def spread(self) -> NDArray[np.float64]:
        """(3 M,), standard deviation of each feature in millimetres."""
        return np.asarray(np.sqrt(np.mean(self.values**2, axis=0)))

    @property
    def rounding(self) -> float:
        """Millimetres: what spreads no more than this does not move."""
        return max(_STILL * float(self.spread.max(initial=0.0)), _SEEN)

    @property
    def still(self) -> NDArray[np.bool_]:
        """(3 M,), whether a feature does not move."""
        return np.asarray(self.spread <= self.rounding)

    @property
    def variances(self) -> NDArray[np.float64]:
        """(M,), square millimetres: of each marker, summed over its three coordinates."""
        return np.asarray((self.spread**2).reshape(-1, 3).sum(axis=1))


def features_of(recording: Trajectories) -> Features:
    """Return the features of a recording that has every sample; 0 where one does not move.

    Raises
    ------
    Refusal
        If samples are missing, there are fewer than two frames or no marker, or nothing moves by
        more than rounding.
    """
    _check(recording)
    markers = tuple(sorted(recording.markers))
    positions = recording.positions[:, [recording.markers.index(name) for name in markers]]
    values = (positions - positions[0]).reshape(recording.frames, -1)
    features = Features(markers, values - values.mean(axis=0))
    if features.still.all():
        raise Refusal(
            f"no marker moves in {recording.frames} frames: the largest standard deviation of a "
            f"coordinate is {features.spread.max():.1g} mm; up to {_SEEN:g} mm is rounding"
        )
    return replace(features, values=np.where(features.still, 0.0, features.values))


def _check(recording: Trajectories) -> None:
    lacking = np.count_nonzero(~recording.present, axis=0)
    if lacking.any():
        most = int(lacking.argmax())
        raise Refusal(
            f"needs every sample: {lacking.sum()} of {recording.origin.size} are missing, in "
            f"{np.count_nonzero(lacking)} of {len(lacking)} markers, most in "
            f"{recording.markers[most]!r} ({lacking[most]}); fill them first"
        )
    if recording.frames < 2:
        raise Refusal(f"needs two frames to see what moves, there are {recording.frames}")
    if not recording.markers:
        raise Refusal("needs a marker, there is none")
