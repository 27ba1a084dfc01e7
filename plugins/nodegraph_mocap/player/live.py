"""Recordings and animations on the page of a stream, drawn by the player."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from nodegraph import LiveView
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.playback import Playback
from nodegraph_mocap.player.data import packed
from nodegraph_mocap.player.page import script_or_style
from nodegraph_mocap.player.panels import panel_of
from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.streaming import AnimationFrame, MarkerFrame

_SCRIPTS = ("data", "camera", "markers", "mesh", "controls", "gestures", "live")
_ROOM = 1.1
"""A head moves away from where it is in the first frame."""

_ENOUGH = 0.5
"""Share of the markers that have to be there to find out from where they are seen."""


def view_of_markers() -> LiveView:
    """Return how recordings appear on the page of a stream."""
    return LiveView(_begin, _of_markers, "mocap/live", *_scripts_and_styles())


def view_of_animations() -> LiveView:
    """Return how animations appear on the page of a stream."""
    return LiveView(_begin, _of_animation, "mocap/live", *_scripts_and_styles())


def _scripts_and_styles() -> tuple[tuple[str, ...], tuple[str, ...]]:
    scripts = tuple(script_or_style(f"{name}.js") for name in _SCRIPTS)
    return scripts, (script_or_style("player.css"), script_or_style("live.css"))


def _begin(values: Mapping[str, Trajectories | Animation]) -> str | None:
    """Return a playback of one frame, None if not enough of one is known."""
    if not all(map(_is_known, values.values())):
        return None
    panels = [panel_of(label, value, "auto") for label, value in values.items()]
    roomy = tuple(replace(panel, radius=_ROOM * panel.radius) for panel in panels)
    return base64.b64encode(packed(Playback(panels=roomy))).decode()


def _is_known(value: Trajectories | Animation) -> bool:
    if isinstance(value, Trajectories):
        return bool(value.present.mean() >= _ENOUGH)
    motion = value.head_motion
    return motion is None or bool(np.isfinite(motion.translations).all())


def _of_markers(frame: MarkerFrame) -> bytes:
    return frame.positions.astype("<f4").tobytes() + frame.origin.tobytes()


def _of_animation(frame: AnimationFrame) -> bytes:
    weights = frame.weights.astype("<f4").tobytes()
    if frame.pose is None:
        return weights
    turned = frame.pose.scale * frame.pose.rotation
    return b"".join(
        [weights, *(part.astype("<f4").tobytes() for part in (turned, frame.pose.translation))]
    )
