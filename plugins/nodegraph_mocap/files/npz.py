"""Recordings as NumPy archives, the exact form: what is written reads back bit for bit."""

from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path
from typing import IO, Any

import numpy as np

from nodegraph_mocap.files.marker_set_yaml import marker_set_of, plain_marker_set
from nodegraph_mocap.files.npz_arrays import npz_arrays
from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.samples_missing import mark_missing

_KINDS = {
    "positions": "fiu",
    "markers": "U",
    "rate": "fiu",
    "origin": "iu",
    "sigma": "fiu",
    "marker_set": "U",
}
_REQUIRED = ("positions", "markers", "rate")


def read_npz(path: Path, *, zeros_missing: bool = True) -> Trajectories:
    """Read a recording from a NumPy archive.

    The archive holds ``positions`` (T, M, 3) in mm, ``markers`` (M,) and ``rate``, and may hold
    ``origin``, ``sigma`` (T, M) and ``marker_set`` (a text of JSON). What else it holds is not
    read.

    Parameters
    ----------
    path
        The file.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing, where the archive does not say
        itself by ``origin`` which are.

    Raises
    ------
    ValueError
        If it is no such archive, or lacks an array; the message lists those that are there.
    """
    try:
        return _recording(npz_arrays(path, _KINDS, _REQUIRED), zeros_missing)
    except (ValueError, TypeError, RecursionError) as error:
        raise ValueError(f"{path}: not a readable NPZ recording: {error}") from None


def write_npz(recording: Trajectories, path: Path) -> None:
    """Write a recording as a NumPy archive; see `npz_bytes`."""
    with path.open("wb") as stream:
        _write(recording, stream)


def npz_bytes(recording: Trajectories) -> bytes:
    """Return a recording as the bytes of a NumPy archive."""
    target = BytesIO()
    _write(recording, target)
    return target.getvalue()


def _write(recording: Trajectories, target: IO[bytes]) -> None:
    arrays: dict[str, Any] = {
        "positions": recording.positions,
        "markers": np.array(recording.markers, dtype=np.str_),
        "rate": np.float64(recording.rate),
        "origin": recording.origin,
    }
    if recording.sigma is not None:
        arrays["sigma"] = recording.sigma
    if recording.marker_set is not None:
        arrays["marker_set"] = np.str_(json.dumps(plain_marker_set(recording.marker_set)))
    np.savez_compressed(target, **arrays)


def _recording(arrays: dict[str, Any], zeros_missing: bool) -> Trajectories:
    positions = np.asarray(arrays["positions"], dtype=np.float64)
    if positions.ndim != 3 or positions.shape[2] != 3:
        raise ValueError(f"positions must be (frames, markers, 3), got {positions.shape}")
    if "origin" not in arrays:
        nothing = np.zeros(positions.shape[:2], dtype=np.bool_)
        positions = mark_missing(positions, nothing, zeros_missing=zeros_missing)
    described = arrays.get("marker_set")
    return Trajectories(
        positions=positions,
        markers=tuple(str(name) for name in np.atleast_1d(arrays["markers"])),
        rate=float(arrays["rate"]),
        marker_set=None if described is None else marker_set_of(json.loads(str(described))),
        origin=arrays.get("origin"),  # type: ignore[arg-type]
        sigma=arrays.get("sigma"),
    )
