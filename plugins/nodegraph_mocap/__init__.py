"""Types that travel between nodes that process motion capture."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from nodegraph import Files, Kind, Viewer, hookimpl
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.detections import Detections
from nodegraph_mocap.face_model import BlendshapeModel, HeadMotion, Weights
from nodegraph_mocap.head import Head
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.marks import Mark, Marks
from nodegraph_mocap.playback import Panel, Playback
from nodegraph_mocap.recording import Mask, Origin, Trajectories, check_markers
from nodegraph_mocap.selection import Selection
from nodegraph_mocap.streaming import AnimationFrame, HeadPose, MarkerFrame
from nodegraph_mocap.tuning import Tuning
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
    "Mark",
    "MarkerFrame",
    "MarkerSet",
    "Marks",
    "Mask",
    "Origin",
    "Panel",
    "Playback",
    "Selection",
    "StoredFigure",
    "Table",
    "Trajectories",
    "Tuning",
    "Weights",
    "check_markers",
    "figure_text",
]


@hookimpl
def nodegraph_kinds() -> Iterable[Kind]:
    """Return how this package's types appear, are compared, streamed, and tested."""
    from nodegraph_mocap.kinds import kinds

    return kinds()


@hookimpl
def nodegraph_viewers() -> Iterable[Viewer]:
    """Return what shows this package's values on a page."""
    from nodegraph_mocap.kinds import viewer

    return (viewer(),)


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
