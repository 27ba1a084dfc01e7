"""Types that travel between nodes that process motion capture."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from nodegraph import Comparison, Detail, Files, LiveView, Renderer, Streamable, hookimpl
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.detections import Detections
from nodegraph_mocap.face_model import BlendshapeModel, HeadMotion, Weights
from nodegraph_mocap.head import Head
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.playback import Panel, Playback
from nodegraph_mocap.recording import Mask, Origin, Trajectories, check_markers
from nodegraph_mocap.selection import Selection
from nodegraph_mocap.streaming import AnimationFrame, HeadPose, MarkerFrame
from nodegraph_tables import Figure, StoredFigure, Table, figure_text

__all__ = [
    "Animation",
    "AnimationFrame",
    "BlendshapeModel",
    "Detections",
    "Figure",
    "Files",
    "Head",
    "HeadMotion",
    "HeadPose",
    "MarkerFrame",
    "MarkerSet",
    "Mask",
    "Origin",
    "Panel",
    "Playback",
    "Selection",
    "StoredFigure",
    "Table",
    "Trajectories",
    "Weights",
    "check_markers",
    "figure_text",
]


@hookimpl
def nodegraph_renderers() -> Iterable[Renderer]:
    """Return how playbacks appear in a report."""
    from nodegraph_mocap.player.page import playback_renderers

    return playback_renderers()


@hookimpl
def nodegraph_details() -> Iterable[Detail]:
    """Return how blocks of a comparison of recordings are shown."""
    from nodegraph_mocap.gap.view import details

    return details()


@hookimpl
def nodegraph_comparisons() -> Iterable[Comparison]:
    """Return how recordings, masks and weights are compared."""
    from nodegraph_mocap.comparisons import comparisons

    return comparisons()


@hookimpl
def nodegraph_streamables() -> Iterable[Streamable]:
    """Return how values of this package's types become frames."""
    from nodegraph_mocap.streaming import streamables

    return streamables()


@hookimpl
def nodegraph_live_views() -> Iterable[LiveView]:
    """Return how recordings and animations appear on the page of a stream."""
    from nodegraph_mocap.player.live import live_views

    return live_views()


@hookimpl
def nodegraph_specimens() -> Mapping[type, Callable[[], Mapping[str, object]]]:
    """Return small values of this package's types, on which nodes are tested."""
    from nodegraph_mocap.specimens import specimens

    return specimens()


@hookimpl
def nodegraph_graphs() -> Iterable[Path]:
    """Return the shipped graphs: beside this file in a wheel, at the top of a checkout."""
    inside = Path(__file__).with_name("graphs")
    folder = inside if inside.is_dir() else Path(__file__).parents[2] / "graphs"
    return sorted(folder.glob("*.yaml"))


@hookimpl
def nodegraph_templates() -> Mapping[str, Path]:
    """Return what ``nodegraph new`` writes."""
    folder = Path(__file__).with_name("templates")
    return {kind: folder / kind for kind in ("plugin", "graph")}
