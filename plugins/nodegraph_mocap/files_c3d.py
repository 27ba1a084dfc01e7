"""Recordings in C3D files.

Files are written by ezc3d. They are read here: ezc3d 1.7 ends the process on some damaged
files, returns fewer frames from a file that was cut short and shifted numbers from one whose
header and parameters disagree, all without a word, and reads no more than 65535 frames. What
both can read is equal bit for bit.
"""

from __future__ import annotations

import contextlib
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nodegraph_mocap.c3d_layout import LARGEST_COUNT, Description, read_description
from nodegraph_mocap.c3d_parameters import DEC, Parameters
from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.samples_missing import mark_missing
from nodegraph_mocap.units import to_millimetres


def read_c3d(path: Path, *, zeros_missing: bool = True) -> Trajectories:
    """Read the points of a C3D file; analog channels and events are left out.

    Parameters
    ----------
    path
        The file.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing.

    Returns
    -------
    Trajectories
        In millimetres; a sample whose residual is negative is missing. A subject's prefix
        (``subject:marker``) that all markers share is taken off their names.

    Raises
    ------
    ValueError
        If it is no C3D file, is damaged or cut short, or holds no frames or no points.

    Warns
    -----
    UserWarning
        If samples are partly missing or infinite, markers lack a name or share one, or the
        unit of length is unknown.
    """
    try:
        with _told_of(path):
            return _read(path, zeros_missing)
    except ValueError as error:
        raise ValueError(f"{path}: not a readable C3D recording: {error}") from None


def write_c3d(recording: Trajectories, path: Path) -> None:
    """Write a recording as C3D: 32-bit floating-point millimetres, missing as residual -1.

    Raises
    ------
    ValueError
        If it has more frames, or longer or more markers, than the format can count, or a
        position beyond 32-bit numbers.
    """
    _check_writable(recording)
    with tempfile.TemporaryDirectory() as folder:
        # The library adds ".c3d" to any other suffix, and reports no failure to write.
        written = Path(folder) / "recording.c3d"
        _write(recording, written)
        content = written.read_bytes()
    path.write_bytes(content)


def c3d_bytes(recording: Trajectories) -> bytes:
    """Return a recording as the bytes of a C3D file; see `write_c3d`."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "recording.c3d"
        write_c3d(recording, path)
        return path.read_bytes()
