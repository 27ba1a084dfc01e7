"""Write recordings, models, weights and what was chosen as files in the folder of the run."""

from __future__ import annotations

import csv
import io
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import Field

from nodegraph import Files, node
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.face_model import BlendshapeModel, Weights
from nodegraph_mocap.frame_ranges import runs_of
from nodegraph_mocap.head import Head
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.recording import Mask, Origin, Trajectories
from nodegraph_mocap.selection import Selection


@dataclass(frozen=True, kw_only=True)
class File:
    """A file that a node writes.

    Attributes
    ----------
    name
        Name of the file, without its suffix.
    """

    name: Annotated[str, Field(min_length=1)]

    def of(self, suffix: str, content: bytes) -> Files:
        """Return one file, with a suffix unless its name has it."""
        named = self.name.lower().endswith(suffix)
        return Files({self.name if named else self.name + suffix: content})


@node("write.c3d", shares=File(name="recording"))
def write_c3d(recording: Trajectories, *, file: File) -> Files:
    """Write a recording as C3D: millimetres in 32 bits, missing samples with residual -1.

    The marker set is a file of its own: `write.marker_set_yaml`.

    Parameters
    ----------
    recording
        Any.

    Raises
    ------
    ValueError
        If the form cannot hold the recording: too many frames, too long names.
    """
    from nodegraph_files.c3d import c3d_bytes

    return file.of(".c3d", _checked(recording, c3d_bytes(recording)))


@node("write.trc", shares=File(name="recording"))
def write_trc(recording: Trajectories, *, file: File) -> Files:
    """Write a recording as TRC, the tab-separated form of OpenSim, in millimetres.

    The marker set is a file of its own: `write.marker_set_yaml`.

    Parameters
    ----------
    recording
        Any.

    Raises
    ------
    ValueError
        If the form cannot hold a marker's name.
    """
    from nodegraph_files.text.trc import trc_bytes

    return file.of(".trc", _checked(recording, trc_bytes(recording)))


@node("write.csv", shares=File(name="recording"))
def write_csv(recording: Trajectories, *, file: File) -> Files:
    """Write a recording as CSV: a row per frame, three columns per marker, in millimetres.

    The marker set is a file of its own: `write.marker_set_yaml`.

    Parameters
    ----------
    recording
        Any.

    Raises
    ------
    ValueError
        If the form cannot hold a marker's name.
    """
    from nodegraph_files.text.csv import csv_bytes

    return file.of(".csv", _checked(recording, csv_bytes(recording)))


@node("write.npz", shares=File(name="recording"))
def write_npz(recording: Trajectories, *, file: File) -> Files:
    """Write a recording as a NumPy archive: the one form that keeps all of it, bit for bit.

    Parameters
    ----------
    recording
        Any.
    """
    from nodegraph_files.npz import npz_bytes

    return file.of(".npz", npz_bytes(recording))


@node("write.marker_set_yaml", shares=File(name="markers"))
def write_marker_set(marker_set: MarkerSet, *, file: File) -> Files:
    """Write a marker set as YAML, to be looked at, corrected, and read again.

    Parameters
    ----------
    marker_set
        Any.
    """
    from nodegraph_files.marker_set import marker_set_text

    return file.of(".yaml", marker_set_text(marker_set).encode())


@node("write.model_npz", shares=File(name="model"))
def write_model(model: BlendshapeModel, *, file: File) -> Files:
    """Write a blendshape model as a NumPy archive, bit for bit.

    Parameters
    ----------
    model
        Any.
    """
    from nodegraph_files.npz import model_bytes

    return file.of(".npz", model_bytes(model))


@node("write.weights_csv", shares=File(name="weights"))
def write_weights(weights: Weights, *, file: File) -> Files:
    """Write weights as CSV: a row per frame with its time in seconds, a column per shape.

    Parameters
    ----------
    weights
        Any; the cell of a weight that is not known is empty.
    """
    times = np.arange(weights.frames) / weights.rate
    rows = [
        [time, *("" if value != value else value for value in values)]
        for time, values in zip(times.tolist(), weights.values.tolist(), strict=True)
    ]
    return file.of(".csv", _csv(["time", *weights.names], rows))


@node("write.mask_csv", shares=File(name="mask"))
def write_mask(mask: Mask, *, file: File) -> Files:
    """Write a mask as CSV: a row per run of samples, with marker, first frame and frames.

    Parameters
    ----------
    mask
        Such as the samples that `gaps.cut` has hidden.

    Returns
    -------
    Files
        One file. The first frame of a recording is 0.
    """
    runs = runs_of(mask.hidden)
    columns = (runs.marker.tolist(), runs.start.tolist(), (runs.stop - runs.start).tolist())
    rows = [[mask.markers[m], start, frames] for m, start, frames in zip(*columns, strict=True)]
    return file.of(".csv", _csv(["marker", "start", "frames"], rows))


@node("write.selection_yaml", shares=File(name="selection"))
def write_selection(selection: Selection, *, file: File) -> Files:
    """Write a selection as YAML: the names are a list for the setting of `markers.keep`.

    Parameters
    ----------
    selection
        Any.

    Returns
    -------
    Files
        One file with `chosen`; with `pairs` and `frequencies` in the same order, and with
        `columns` and `history`, where the selection has them. A number that is not known is null.
    """
    from nodegraph_files.selection import selection_text

    return file.of(".yaml", selection_text(selection).encode())


def _csv(header: Sequence[str], rows: Iterable[Sequence[object]]) -> bytes:
    text = io.StringIO(newline="")
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(header)
    lines.writerows(rows)
    return text.getvalue().encode()


def _checked(recording: Trajectories, content: bytes) -> bytes:
    """Return the content; say what of the recording it cannot keep."""
    estimated = np.isin(recording.origin, (Origin.FILLED, Origin.REPAIRED))
    lost = (
        [f"which {np.count_nonzero(estimated):,} samples are filled or repaired"]
        if estimated.any()
        else []
    )
    lost += ["sigma"] if recording.sigma is not None else []
    if lost:
        warnings.warn(
            f"the file cannot say {', '.join(lost)}; write.npz keeps all of it", stacklevel=4
        )
    return content


@node("write.glb")
def write_glb(animation: Animation | None = None, head: Head | None = None) -> Files:
    """Write an animation, a head or both as GLB files, which most 3D programs open.

    Lengths are in metres, in single precision. Morph targets keep their names, and ``read.head``
    finds the markers again. A missing weight repeats the last known one, with a warning.

    Parameters
    ----------
    animation
        Becomes ``animation.glb``: the head with its weights and motion, a key per frame.
    head
        Becomes ``head.glb``: a head at rest.

    Raises
    ------
    ValueError
        If neither is fed, a head has no faces, or an animation has no frames or a frame that is a
        reflection.
    """
    from nodegraph_files.glb.writing import animation_bytes, head_bytes

    files = {}
    if animation is not None:
        files["animation.glb"] = animation_bytes(animation)
    if head is not None:
        files["head.glb"] = head_bytes(head)
    if not files:
        raise ValueError("feed an animation or a head: there is nothing to write")
    return Files(files)
