"""Playbacks: recordings and animations that a report plays side by side, on one clock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Value
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.checks import finite, set_fields
from nodegraph_mocap.face_model import Weights
from nodegraph_mocap.marks import Mark
from nodegraph_mocap.recording import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SQUARE = 1e-6


@dataclass(frozen=True, eq=False, kw_only=True)
class Strip(Value):
    """Where samples of a recording are missing, made or look like impulses, in all its frames.

    Attributes
    ----------
    missing, filled, repaired : (S, M) arrays of uint8
        How much of each of S stretches of equal length is so: 0 none, 255 all of it.
    impulse_markers : (N,) array of int64
        Columns of the markers.
    impulse_seconds : (N,) array of float64
    left_out : int
        How many impulses more there are.
    """

    missing: NDArray[np.uint8]
    filled: NDArray[np.uint8]
    repaired: NDArray[np.uint8]
    impulse_markers: NDArray[np.int64]
    impulse_seconds: NDArray[np.float64]
    left_out: int = 0


@dataclass(frozen=True, eq=False, kw_only=True)
class Panel(Value):
    """One recording or animation, and from where it is seen at first.

    Attributes
    ----------
    label : str
    shown : Trajectories or Animation
    centre : (3,) array of float64
        The point in the middle of the picture, millimetres.
    right, up : (3,) arrays of float64
        Unit vectors along the picture's axes, at right angles.
    radius : float
        Millimetres from the middle to the picture's edge that hold what there is to see.
    strip : Strip or None
        The strip of a recording: what is to be seen over its time.
    marks : tuple of Mark
        Of a recording, what a person has said of its samples: it is shown with them applied.
    can_be_marked : bool
        Whether the reader may add marks.

    Raises
    ------
    ValueError
        If there is no frame, a number is missing, the axes are not unit vectors at right angles,
        or the radius is not positive.
    """

    label: str
    shown: Trajectories | Animation
    centre: NDArray[np.float64]
    right: NDArray[np.float64]
    up: NDArray[np.float64]
    radius: float
    strip: Strip | None = None
    marks: tuple[Mark, ...] = ()
    can_be_marked: bool = False

    def __post_init__(self) -> None:
        if not self.shown.frames:
            raise ValueError(f"{self.label or 'what is to be played'} has no frame")
        if not (np.isfinite(self.radius) and self.radius > 0):
            raise ValueError(f"radius must be positive, got {self.radius}")
        centre, right, up = (
            finite(name, getattr(self, name), (3,)) for name in ("centre", "right", "up")
        )
        axes = np.stack([right, up])
        if np.abs(axes @ axes.T - np.eye(2)).max() > _SQUARE:
            raise ValueError(f"right {right} and up {up} are not unit vectors at right angles")
        set_fields(self, centre=centre, right=right, up=up, radius=float(self.radius))

    @property
    def seconds(self) -> float:
        """Duration: each frame is shown until the next one begins."""
        return self.shown.frames / self.shown.rate


@dataclass(frozen=True, eq=False, kw_only=True)
class Curves(Value):
    """Weights that are drawn over the time of a playback, a row per shape.

    Attributes
    ----------
    label : str
    weights : Weights

    Raises
    ------
    ValueError
        If there is no frame.
    """

    label: str
    weights: Weights

    def __post_init__(self) -> None:
        if not self.weights.frames:
            raise ValueError(f"{self.label or 'what is to be drawn'} has no frame")

    @property
    def seconds(self) -> float:
        """Duration: each frame counts until the next one begins."""
        return self.weights.frames / self.weights.rate


@dataclass(frozen=True, eq=False, kw_only=True)
class Playback(Value):
    """Panels that are played side by side on one clock, seen from one side, and curves below them.

    The clock counts seconds. A panel shows the frame that began last, and its last frame after
    it has ended, so that panels of other rates and lengths keep together.

    Attributes
    ----------
    panels : tuple of Panel
    truth : Panel or None
        A recording with which those among the panels are compared, marker by marker.
    every : int
        Step between frames of the original that are here; 1 where all are.
    notes : tuple of str
        Notes for the viewer: combinations that are absent, samples that are not shown.
    curves : tuple of Curves

    Raises
    ------
    ValueError
        If there is neither a panel nor a curve, `every` is not positive, the truth is not a
        recording, or a recording has another number of frames or another rate than the truth.
    """

    panels: tuple[Panel, ...]
    truth: Panel | None = None
    every: int = 1
    notes: tuple[str, ...] = ()
    curves: tuple[Curves, ...] = ()

    def __post_init__(self) -> None:
        if not self.panels and not self.curves:
            raise ValueError("there is nothing to play")
        if self.every < 1:
            raise ValueError(f"every must be at least 1, got {self.every}")
        if self.truth:
            _check_comparable(self.panels, self.truth)

    @property
    def with_truth(self) -> tuple[Panel, ...]:
        """The panels, before them the truth if there is one."""
        return (self.truth, *self.panels) if self.truth else self.panels

    @property
    def seconds(self) -> float:
        """Duration of the longest panel or curve."""
        parts: list[Panel | Curves] = [*self.panels, *self.curves]
        return max(part.seconds for part in parts)


def _check_comparable(panels: tuple[Panel, ...], truth: Panel) -> None:
    known = truth.shown
    if not isinstance(known, Trajectories):
        raise ValueError("the truth must be a recording")
    for panel in panels:
        shown = panel.shown
        if not isinstance(shown, Trajectories):
            continue
        of = f" of {panel.label}" if panel.label else ""
        if shown.frames != known.frames:
            raise ValueError(
                f"the truth has {known.frames} frames, the recording{of} {shown.frames}"
            )
        if shown.rate != known.rate:
            raise ValueError(
                f"the truth has {known.rate:g} Hz, the recording{of} {shown.rate:g} Hz"
            )
