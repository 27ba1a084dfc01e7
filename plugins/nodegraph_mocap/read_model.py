"""Read a blendshape model, and the face at rest that it starts from."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from nodegraph import InputFile, node
from nodegraph_mocap.face_model import BlendshapeModel
from nodegraph_mocap.files.marker_set_beside import marker_set_for, with_marker_set
from nodegraph_mocap.files.model import read_model_npz
from nodegraph_mocap.paths import find_file
from nodegraph_mocap.recording import Trajectories

_MODELS = ("model.npz",)
_RATE = 1.0
"""A single frame has no rate, but a recording needs one."""


class Model(NamedTuple):
    """What `read.model` gives."""

    model: BlendshapeModel
    neutral: Trajectories


@node("read.model")
def read_model(*, path: InputFile, marker_set: InputFile | None = None) -> Model:
    """Read a blendshape model: NPZ with ``neutral``, ``shapes``, ``shape_names``, ``markers``.

    Parameters
    ----------
    path
        A file, a folder that holds ``model.npz``, or ``sample:NAME``.
    marker_set
        A marker-set file (YAML) for `neutral`. By default ``markers.yaml`` of the folder, or none.

    Returns
    -------
    model : BlendshapeModel
        In millimetres.
    neutral : Trajectories
        The model's face at rest: a recording of one frame, its rate set to 1 Hz, with the marker
        set.

    Raises
    ------
    ValueError
        If the file cannot be read, or lacks a marker that the set names.
    """
    file = find_file(path, _MODELS)
    model = read_model_npz(file)
    neutral = Trajectories(positions=model.neutral[None], markers=model.markers, rate=_RATE)
    found = marker_set_for(Path(path), file, marker_set)
    return Model(model, with_marker_set(neutral, found, file))
