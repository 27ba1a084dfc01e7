"""All that nodegraph knows of the types that travel: how they appear, and are compared."""

from __future__ import annotations

from functools import partial

from nodegraph import Kind, Viewer, late
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.detections import Detections
from nodegraph_mocap.face_model import BlendshapeModel, HeadMotion, Weights
from nodegraph_mocap.head import Head
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.marks import BESIDE, Marks
from nodegraph_mocap.playback import Playback
from nodegraph_mocap.recording import Mask, Trajectories
from nodegraph_mocap.selection import Selection
from nodegraph_mocap.streaming import STREAMS

_COMPARISONS = "nodegraph_mocap.comparisons"
_SPECIMENS = "nodegraph_mocap.specimens"
_FACTS = "nodegraph_mocap.facts"
_LIVE = "nodegraph_mocap.player.live"


def kinds() -> tuple[Kind, ...]:
    """Return what this package knows of its types."""
    return (
        Kind(
            Trajectories,
            compare=late(f"{_COMPARISONS}:compare_recordings"),
            facts=late(f"{_FACTS}:facts_of_recording"),
            stream=partial(STREAMS.__getitem__, Trajectories),
            live_view=late(f"{_LIVE}:view_of_markers"),
            detail=late("nodegraph_mocap.gap.view:detail"),
            specimens=late(f"{_SPECIMENS}:recordings"),
        ),
        Kind(
            Mask,
            compare=late(f"{_COMPARISONS}:compare_masks"),
            stream=partial(STREAMS.__getitem__, Mask),
            specimens=late(f"{_SPECIMENS}:masks"),
        ),
        Kind(
            Weights,
            compare=late(f"{_COMPARISONS}:compare_weights"),
            facts=late(f"{_FACTS}:facts_of_weights"),
            stream=partial(STREAMS.__getitem__, Weights),
            specimens=late(f"{_SPECIMENS}:weights"),
        ),
        Kind(
            HeadMotion,
            stream=partial(STREAMS.__getitem__, HeadMotion),
            specimens=late(f"{_SPECIMENS}:head_motions"),
        ),
        Kind(
            Animation,
            facts=late(f"{_FACTS}:facts_of_animation"),
            stream=partial(STREAMS.__getitem__, Animation),
            live_view=late(f"{_LIVE}:view_of_animations"),
            specimens=late(f"{_SPECIMENS}:animations"),
        ),
        Kind(
            Detections,
            stream=partial(STREAMS.__getitem__, Detections),
            specimens=late(f"{_SPECIMENS}:detections"),
        ),
        Kind(Playback, render=late("nodegraph_mocap.player.page:render_playback")),
        Kind(
            MarkerSet,
            facts=late(f"{_FACTS}:facts_of_marker_set"),
            specimens=late(f"{_SPECIMENS}:marker_sets"),
        ),
        Kind(
            Marks,
            facts=late(f"{_FACTS}:facts_of_marks"),
            specimens=late(f"{_SPECIMENS}:marks"),
        ),
        Kind(
            Selection,
            facts=late(f"{_FACTS}:facts_of_selection"),
            specimens=late(f"{_SPECIMENS}:selections"),
        ),
        Kind(
            BlendshapeModel,
            facts=late(f"{_FACTS}:facts_of_model"),
            specimens=late(f"{_SPECIMENS}:models"),
        ),
        Kind(
            Head,
            facts=late(f"{_FACTS}:facts_of_head"),
            specimens=late(f"{_SPECIMENS}:heads"),
        ),
    )


def viewer() -> Viewer:
    """Return what shows values that are seen in space or over time."""
    types = (Trajectories, Animation, Weights, Head, BlendshapeModel, MarkerSet, Marks)
    return Viewer(types, late("nodegraph_mocap.player.viewer:view"), beside=BESIDE)
