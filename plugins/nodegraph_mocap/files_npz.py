"""Recordings as NumPy archives, the exact form: what is written reads back bit for bit."""

from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from nodegraph_mocap.files_marker_set import marker_set_of, plain_marker_set
from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.samples_missing import mark_missing

_REQUIRED = ("positions", "markers", "rate")
_KINDS = {"positions": "fiu", "markers": "U", "rate": "fiu", "origin": "iu", "sigma": "fiu"}


def read_npz(path: Path, *, zeros_missing: bool = True) -> Trajectories:
    """Read a recording from a NumPy archive.

    The archive holds ``positions`` (T, M, 3) in mm, ``markers`` (M,) and ``rate``, and may hold
    ``origin``, ``sigma`` (T, M) and ``marker_set`` (a text of JSON).

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
        arrays = _arrays(path)
        return _recording(arrays, zeros_missing)
    except (ValueError, TypeError, RecursionError) as error:
        raise ValueError(f"{path}: not a readable NPZ recording: {error}") from None


def write_npz(recording: Trajectories, path: Path) -> None:
    """Write a recording as a NumPy archive; see `npz_bytes`."""
    path.write_bytes(npz_bytes(recording))


def npz_bytes(recording: Trajectories) -> bytes:
    """Return a recording as the bytes of a NumPy archive."""
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
    target = BytesIO()
    np.savez_compressed(target, **arrays)
    return target.getvalue()


def _arrays(path: Path) -> dict[str, Any]:
    try:
        with np.load(path, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}
    except Exception as error:
        # zipfile, zlib and NumPy's header parser each have errors of their own for bad bytes.
        raise ValueError(str(error) or type(error).__name__) from None


def _recording(arrays: dict[str, Any], zeros_missing: bool) -> Trajectories:
    lacking = [name for name in _REQUIRED if name not in arrays]
    if lacking:
        there = ", ".join(arrays) or "nothing"
        raise ValueError(f"no array {', '.join(lacking)}; there is {there}")
    for name, kinds in _KINDS.items():
        if name in arrays and arrays[name].dtype.kind not in kinds:
            raise ValueError(f"array {name!r} is of type {arrays[name].dtype}")
    positions = np.array(arrays["positions"], dtype=np.float64)
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
