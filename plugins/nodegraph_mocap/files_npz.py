"""Recordings as NumPy archives, the exact form: what is written reads back bit for bit."""

from __future__ import annotations

import json
import zipfile
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from nodegraph_mocap.files_marker_set import marker_set_of, plain_marker_set
from nodegraph_mocap.recording import Trajectories

_REQUIRED = ("positions", "markers", "rate")


def read_npz(path: Path) -> Trajectories:
    """Read a recording from a NumPy archive.

    The archive holds ``positions`` (T, M, 3) in mm, ``markers`` (M,) and ``rate``, and may hold
    ``origin``, ``sigma`` (T, M) and ``marker_set`` (a text of JSON).

    Raises
    ------
    ValueError
        If it is no such archive, or lacks an array; the message lists those that are there.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            return _recording({name: archive[name] for name in archive.files})
    except (ValueError, KeyError, OSError, EOFError, zipfile.BadZipFile) as error:
        raise ValueError(f"{path}: not a readable NPZ recording: {error}") from None


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


def _recording(arrays: dict[str, Any]) -> Trajectories:
    lacking = [name for name in _REQUIRED if name not in arrays]
    if lacking:
        there = ", ".join(arrays) or "nothing"
        raise ValueError(f"no array {lacking[0]!r}; there is {there}")
    described = arrays.get("marker_set")
    return Trajectories(
        positions=np.array(arrays["positions"], dtype=np.float64),
        markers=tuple(str(name) for name in np.atleast_1d(arrays["markers"])),
        rate=float(arrays["rate"]),
        marker_set=None if described is None else marker_set_of(json.loads(str(described))),
        origin=arrays.get("origin"),  # type: ignore[arg-type]
        sigma=arrays.get("sigma"),
    )
