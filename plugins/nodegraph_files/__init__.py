"""Read and write recordings, heads, models, weights, marks and marker sets."""

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from nodegraph import Format, hookimpl
from nodegraph_files.c3d import c3d_bytes, read_c3d, write_c3d
from nodegraph_files.glb.moving import RawAnimation
from nodegraph_files.glb.writing import animation_bytes, head_bytes
from nodegraph_files.head import RawHead
from nodegraph_files.marker_set import marker_set_text, read_marker_set_yaml
from nodegraph_files.npz import model_bytes, npz_bytes, read_model_npz, read_npz, write_npz
from nodegraph_files.paths import sample_folder
from nodegraph_files.text.csv import csv_bytes, read_csv, write_csv
from nodegraph_files.text.live_link import read_live_link
from nodegraph_files.text.mot import read_mot
from nodegraph_files.text.trc import read_trc, trc_bytes, write_trc

__all__ = [
    "RawAnimation",
    "RawHead",
    "animation_bytes",
    "c3d_bytes",
    "csv_bytes",
    "head_bytes",
    "marker_set_text",
    "model_bytes",
    "npz_bytes",
    "read_c3d",
    "read_csv",
    "read_live_link",
    "read_marker_set_yaml",
    "read_model_npz",
    "read_mot",
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
def nodegraph_nodes() -> Iterable[Callable[..., object]]:
    """Return the nodes of this package."""
    from nodegraph_files import readers, writers

    return (
        readers.read_recording,
        readers.read_truth,
        readers.read_marker_set,
        readers.read_weights,
        readers.read_head,
        readers.read_animation,
        readers.read_model,
        readers.read_marks,
        readers.read_selection,
        writers.write_c3d,
        writers.write_trc,
        writers.write_csv,
        writers.write_npz,
        writers.write_marker_set,
        writers.write_model,
        writers.write_weights,
        writers.write_mask,
        writers.write_selection,
        writers.write_glb,
    )


@hookimpl
def nodegraph_formats() -> Iterable[Format]:
    """Return the formats that are read; of those that fit a file, the first."""
    from nodegraph_files import c3d, npz, obj
    from nodegraph_files.glb import moving, reading
    from nodegraph_files.text import csv, live_link, marks, maya, mot, trc, weights

    recordings = (c3d.FORMAT, npz.FORMAT, trc.FORMAT, mot.FORMAT, maya.FORMAT, csv.FORMAT)
    of_weights = (live_link.FORMAT, weights.FORMAT)
    of_heads = (reading.FORMAT, moving.FORMAT, obj.FORMAT)
    return (*recordings, *of_weights, marks.FORMAT, npz.MODEL_FORMAT, *of_heads)


@hookimpl
def nodegraph_readers() -> Mapping[str, Callable[[Path], str | None]]:
    """Return what recognizes the files that the nodes of this package read."""
    from nodegraph_files.recognition import readers

    return readers()


@hookimpl
def nodegraph_places() -> Mapping[str, Callable[[str], Path]]:
    """Return what finds ``sample:NAME``."""
    from nodegraph_files.paths import sample_folder

    return {"sample": sample_folder}
