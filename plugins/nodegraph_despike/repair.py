"""The recording with its repaired samples, marked and counted, for all despikers."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Window, WindowForm
from nodegraph_despike.vector_median import reach_of
from nodegraph_mocap import MarkerFrame, Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Repairing:
    """A recording whose impulses are repaired.

    Attributes
    ----------
    recording
        Trajectories, with or without gaps.

    Returns
    -------
    Trajectories
        The recording with repaired samples, their origin `Origin.REPAIRED`, their sigma NaN.
    """

    recording: Trajectories


def repaired(recording: Trajectories, positions: NDArray[np.float64]) -> Trajectories:
    """Return the recording with repaired samples, and warn how many; called by a node.

    A sample is repaired when its position is another one: those whose repair is what they were
    keep their origin. What is known of the precision of a sample does not hold for what was put
    in its place, so that `sigma` is NaN there.

    Parameters
    ----------
    recording
        As it came.
    positions
        (T, M, 3) millimetres, with other values where samples were repaired.

    Returns
    -------
    Trajectories
        The recording itself where nothing was repaired.
    """
    differs = positions != recording.positions
    # Over an axis of three, `any` takes twenty times as long as two bitwise operations.
    changed = recording.present & (differs[..., 0] | differs[..., 1] | differs[..., 2])
    count = np.count_nonzero(changed)
    if not count:
        return recording
    moved = np.linalg.norm(positions[changed] - recording.positions[changed], axis=1)
    share = count / np.count_nonzero(recording.present)
    warnings.warn(
        f"{count} sample{'' if count == 1 else 's'} repaired ({100 * share:.3g} % of those "
        f"present), moved by {moved.mean():.3g} mm on average, by {moved.max():.3g} mm at most",
        stacklevel=4,
    )
    sigma = None if recording.sigma is None else np.where(changed, np.nan, recording.sigma)
    return recording.with_samples(positions, changed=changed, origin=Origin.REPAIRED, sigma=sigma)


def repaired_frame(frame: MarkerFrame, positions: NDArray[np.float64]) -> MarkerFrame:
    """Return one frame with repaired samples, marked as `repaired` marks them.

    Parameters
    ----------
    frame
        As it came.
    positions
        (M, 3) millimetres, with other values where samples were repaired.
    """
    differs = positions != frame.positions
    changed = differs[:, 0] | differs[:, 1] | differs[:, 2]
    changed &= frame.present
    return MarkerFrame(
        positions.copy(),
        frame.marked(changed, Origin.REPAIRED),
        None if frame.sigma is None else np.where(changed, np.nan, frame.sigma),
    )


def window_form(repair: Callable[..., NDArray[np.float64]]) -> WindowForm:
    """Return how a despiker whose window has `reach` frames on each side computes a frame.

    Parameters
    ----------
    repair
        ``repair(positions, **settings)`` returns the positions, (T, M, 3) mm, with other values
        where samples are repaired.
    """

    def repaired_at(window: Window[MarkerFrame, Trajectories], **settings: object) -> MarkerFrame:
        positions = repair(window.frames.positions, **settings)
        return repaired_frame(window.frames.at(window.now), positions[window.now])

    return WindowForm(repaired_at, before=reach_of, after=reach_of)
