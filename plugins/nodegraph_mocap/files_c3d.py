"""Recordings in C3D files.

Files are written by ezc3d. They are read here: ezc3d 1.7 ends the process on some damaged
files, returns fewer frames from a file that was cut short and shifted numbers from one whose
header and parameters disagree, all without a word, and reads no more than 65535 frames. What
both can read is equal bit for bit.
"""

from __future__ import annotations

import itertools
import struct
import tempfile
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nodegraph_mocap.c3d_layout import LARGEST_COUNT, Description, read_description
from nodegraph_mocap.c3d_parameters import Parameters
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
        found = read_description(path)
        return _recording(path, found, zeros_missing)
    except (ValueError, struct.error) as error:
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


def _recording(path: Path, found: Description, zeros_missing: bool) -> Trajectories:
    layout = found.layout
    if not layout.frames or not layout.points:
        raise ValueError(f"it holds no samples: {layout.frames} frames of {layout.points} points")
    points = _points(path, found)
    positions, residuals = points[..., :3], points[..., 3]
    positions = positions * to_millimetres(" ".join(_texts(found.parameters, "UNITS")[:1]))
    positions = mark_missing(positions, residuals < 0, zeros_missing=zeros_missing)
    markers = _markers(_texts(found.parameters, "LABELS"), layout.points)
    return Trajectories(positions=positions, markers=markers, rate=found.rate)


def _points(path: Path, found: Description) -> NDArray[np.float64]:
    """Return x, y, z and the residual's word of every point, (T, M, 4), in the file's unit."""
    layout = found.layout
    columns = 4 * layout.points + layout.values
    count = layout.frames * columns
    if layout.width == 2:
        order = found.processor.order
        words = np.fromfile(path, f"{order}i2", count, offset=layout.start).astype(np.float64)
        scale = np.array([found.scale, found.scale, found.scale, 1.0])
    else:
        with path.open("rb") as stream:
            stream.seek(layout.start)
            words = found.processor.floats(stream.read(4 * count))
        scale = np.ones(4)
    frames = words.reshape(layout.frames, columns)[:, : 4 * layout.points]
    return np.asarray(frames.reshape(layout.frames, layout.points, 4) * scale)


def _texts(parameters: Parameters, name: str) -> list[str]:
    """Return the texts of a parameter of the points, continued in NAME2, NAME3 and so on."""
    numbered = itertools.chain([name], (f"{name}{number}" for number in itertools.count(2)))
    entries = itertools.takewhile(
        lambda entry: entry is not None, (parameters.get(("POINT", one)) for one in numbered)
    )
    return [text for entry in entries if entry is not None for text in entry.texts]


def _markers(labels: list[str], count: int) -> tuple[str, ...]:
    """Return one name per point: without the subject's prefix, each given once."""
    spare = [label for label in labels[count:] if label]
    if spare:
        shown = ", ".join(spare[:5])
        warnings.warn(f"{len(spare)} labels have no point and are left out: {shown}", stacklevel=2)
    names = _without_subject([*labels[:count], *[""] * (count - len(labels))])
    made: list[str] = []
    for number, name in enumerate(names):
        wanted = name or f"unnamed{number + 1}"
        repeats = (f"{wanted}_{again}" for again in itertools.count(2))
        taken = {*made, *(one for one in names if one != wanted)}
        made.append(
            next(one for one in (wanted, *itertools.islice(repeats, count)) if one not in taken)
        )
    changed = [new for old, new in zip(names, made, strict=True) if old != new]
    if changed:
        shown = ", ".join(changed[:5])
        warnings.warn(f"{len(changed)} points lack a name or share one; now {shown}", stacklevel=2)
    return tuple(made)


def _without_subject(names: list[str]) -> list[str]:
    subjects = {name.partition(":")[0] if ":" in name else "" for name in names if name}
    if len(subjects) != 1 or "" in subjects:
        return names
    return [name.partition(":")[2] for name in names]


def _check_writable(recording: Trajectories) -> None:
    largest = LARGEST_COUNT
    if not 0 < recording.frames <= largest or not 0 < len(recording.markers) <= 255:
        raise ValueError(
            f"C3D holds 1 to {largest} frames of 1 to 255 markers, not {recording.frames} of "
            f"{len(recording.markers)}"
        )
    long = [name for name in recording.markers if len(name.encode()) > 127]
    if long:
        raise ValueError(f"C3D names have at most 127 bytes; {long[0]!r} is longer")


def _write(recording: Trajectories, path: Path) -> None:
    import ezc3d

    file = ezc3d.c3d()
    points = file["parameters"]["POINT"]
    points["RATE"]["value"] = [recording.rate]
    points["LABELS"]["value"] = list(recording.markers)
    points["UNITS"]["value"] = ["mm"]
    missing = ~recording.present
    data = np.ones((4, len(recording.markers), recording.frames))
    data[:3] = np.nan_to_num(recording.positions, nan=0.0).transpose(2, 1, 0)
    file["data"]["points"] = data
    file["data"]["meta_points"]["residuals"] = np.where(missing, -1.0, 0.0).T[None]
    file.write(str(path))
