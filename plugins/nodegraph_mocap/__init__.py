"""What travels between nodes that process motion capture, and how files become it."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from nodegraph import Comparison, Conclusion, Files, Renderer, Storage, hookimpl
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.detections import Detections
from nodegraph_mocap.face_model import BlendshapeModel, HeadMotion, Weights
from nodegraph_mocap.files.c3d import c3d_bytes, read_c3d, write_c3d
from nodegraph_mocap.files.marker_set_yaml import marker_set_text, read_marker_set
from nodegraph_mocap.files.model import model_bytes, read_model_npz
from nodegraph_mocap.files.npz import npz_bytes, read_npz, write_npz
from nodegraph_mocap.glb.writing import animation_bytes, head_bytes
from nodegraph_mocap.head import Head
from nodegraph_mocap.in_figures import figure_text
from nodegraph_mocap.known_markers import check_markers
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.playback import Panel, Playback
from nodegraph_mocap.recording import Mask, Origin, Trajectories
from nodegraph_mocap.samples import sample_folder
from nodegraph_mocap.selection import Selection
from nodegraph_mocap.shown.stored_figure import StoredFigure
from nodegraph_mocap.tables import Figure, Table
from nodegraph_mocap.text.csv_table import csv_bytes, read_csv, write_csv
from nodegraph_mocap.text.live_link import read_live_link
from nodegraph_mocap.text.trc import read_trc, trc_bytes, write_trc

__all__ = [
    "Animation",
    "BlendshapeModel",
    "Detections",
    "Figure",
    "Files",
    "Head",
    "HeadMotion",
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
    "animation_bytes",
    "c3d_bytes",
    "check_markers",
    "csv_bytes",
    "figure_text",
    "head_bytes",
    "marker_set_text",
    "model_bytes",
    "npz_bytes",
    "read_c3d",
    "read_csv",
    "read_live_link",
    "read_marker_set",
    "read_model_npz",
    "read_npz",
    "read_trc",
    "sample_folder",
    "trc_bytes",
    "write_c3d",
    "write_csv",
    "write_npz",
    "write_trc",
]


@hookimpl
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:
    """Return the nodes of this package."""
    from nodegraph_mocap import writers
    from nodegraph_mocap.read_head import read_head
    from nodegraph_mocap.read_markers import read_marker_set
    from nodegraph_mocap.read_model import read_model
    from nodegraph_mocap.read_recording import read_recording
    from nodegraph_mocap.read_weights import read_weights
    from nodegraph_mocap.write_glb import write_glb

    return (
        read_recording,
        read_marker_set,
        read_weights,
        read_head,
        read_model,
        writers.write_c3d,
        writers.write_trc,
        writers.write_csv,
        writers.write_npz,
        writers.write_marker_set,
        writers.write_model,
        write_glb,
    )


@hookimpl
def nodegraph_renderers() -> Iterable[Renderer]:
    """Return how tables, figures and playbacks appear in a report."""
    from nodegraph_mocap.shown.playback_page import playback_renderers
    from nodegraph_mocap.shown.renderers import renderers

    return (*renderers(), *playback_renderers())


@hookimpl
def nodegraph_comparisons() -> Iterable[Comparison]:
    """Return how recordings and tables are told apart."""
    from nodegraph_mocap.shown.comparisons import comparisons

    return comparisons()


@hookimpl
def nodegraph_conclusions() -> Iterable[Conclusion]:
    """Return what a study concludes from tables."""
    from nodegraph_mocap.shown.conclusions import conclusions

    return conclusions()


@hookimpl
def nodegraph_storages() -> Iterable[Storage]:
    """Return how tables and figures are kept."""
    from nodegraph_mocap.shown.storages import storages

    return storages()


@hookimpl
def nodegraph_specimens() -> Mapping[type, Callable[[], Mapping[str, Any]]]:
    """Return small values of this package's types, on which nodes are tested."""
    from nodegraph_mocap.specimens import specimens

    return specimens()


@hookimpl
def nodegraph_places() -> Mapping[str, Callable[[str], Path]]:
    """Return what finds ``sample:NAME``."""
    return {"sample": sample_folder}


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
