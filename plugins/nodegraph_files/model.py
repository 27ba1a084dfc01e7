"""Blendshape models as NumPy archives."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Format
from nodegraph_files.npz import is_archive, npz_arrays
from nodegraph_mocap.face_model import BlendshapeModel

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


FORMAT = Format("NPZ", BlendshapeModel, (".npz",), read_model_npz, is_archive)
