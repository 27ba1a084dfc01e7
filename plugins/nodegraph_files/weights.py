"""Read weights of blendshapes, whatever their file form."""

from __future__ import annotations

import warnings

import numpy as np

from nodegraph import InputFile, node
from nodegraph_files.paths import find_file
from nodegraph_files.text.live_link import read_live_link
from nodegraph_mocap.face_model import Weights

_WEIGHTS = ("weights.csv",)


@node("read.weights")
def read_weights(*, path: InputFile) -> Weights:
    """Read weights of blendshapes over time: the CSV files of Live Link Face.

    Frames that the timecode skips are rows of NaN. The columns of head and eye rotations are no
    weights and are left out.

    Parameters
    ----------
    path
        A file, or a folder that holds ``weights.csv``.

    Returns
    -------
    Weights
        With names as written, such as ``EyeBlinkLeft``.

    Raises
    ------
    ValueError
        If the file cannot be read or holds no frames.
    """
    weights = read_live_link(find_file(path, _WEIGHTS))
    if np.isnan(weights.values).all():
        warnings.warn(f"{path}: every weight is missing", stacklevel=2)
    return weights
