"""Blendshape models as NumPy archives."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph import InputFile, node
from nodegraph_files.marker_set import marker_set_for, with_marker_set
from nodegraph_files.npz import npz_arrays
from nodegraph_files.paths import find_file
from nodegraph_mocap.face_model import BlendshapeModel
from nodegraph_mocap.recording import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


_KINDS = {"neutral": "fiu", "shapes": "fiu", "shape_names": "U", "markers": "U"}


def read_model_npz(path: Path) -> BlendshapeModel:
    """Read a blendshape model.

    The archive holds ``neutral`` (M, 3) and ``shapes`` (K, M, 3) offsets at weight 1, in mm, and
    ``shape_names`` (K,) and ``markers`` (M,). Other arrays may be there, and are not read.

    Raises
    ------
    ValueError
        If it is no such archive, lacks an array, or a number is missing or infinite.
    """
    try:
        arrays = npz_arrays(path, _KINDS, tuple(_KINDS))
        return BlendshapeModel(
            neutral=arrays["neutral"],
            shapes=arrays["shapes"],
            names=_names(arrays["shape_names"]),
            markers=_names(arrays["markers"]),
        )
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path}: not a readable NPZ model: {error}") from None


def model_bytes(model: BlendshapeModel) -> bytes:
    """Return a blendshape model as the bytes of a NumPy archive, which reads back equal."""
    target = BytesIO()
    np.savez(
        target,
        neutral=model.neutral,
        shapes=model.shapes,
        shape_names=np.array(model.names, dtype=np.str_),
        markers=np.array(model.markers, dtype=np.str_),
    )
    return target.getvalue()


def _names(array: NDArray[np.str_]) -> tuple[str, ...]:
    return tuple(str(name) for name in array.ravel())


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
