"""Recordings in C3D files.

Files are written by ezc3d. They are read here: ezc3d 1.7 ends the process on some damaged
files, returns fewer frames from a file that was cut short and shifted numbers from one whose
header and parameters disagree, all without a word, and reads no more than 65535 frames. What
both can read is equal bit for bit.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.c3d_layout import LARGEST_COUNT, Description, read_description
from nodegraph_mocap.c3d_parameters import Parameters
from nodegraph_mocap.marker_names import unique_names
from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.samples_missing import mark_missing
from nodegraph_mocap.units import to_millimetres

if TYPE_CHECKING:
    from numpy.typing import NDArray

LONGEST_NAME = 127


def read_c3d(path: Path, *, zeros_missing: bool = True) -> Trajectories:
    """Read the points of a C3D file; analog channels and events are left out.

    Warnings tell how many samples were partly missing or infinite, which markers lacked a name
    or shared one, and that the unit of length is unknown.

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
    """
    try:
        description = read_description(path)
        samples = _samples(path, description)
    except ValueError as error:
        raise ValueError(f"{path}: not a readable C3D recording: {error}") from None
    positions = samples[..., :3] * to_millimetres(_unit(description.parameters))
    lost = samples[..., 3] < 0
    return Trajectories(
        positions=mark_missing(positions, lost, zeros_missing=zeros_missing),
        markers=unique_names(_labels(description.parameters), positions.shape[1]),
        rate=description.rate,
    )


def write_c3d(recording: Trajectories, path: Path) -> None:
    """Write a recording as a C3D file; see `c3d_bytes`."""
    path.write_bytes(c3d_bytes(recording))


def c3d_bytes(recording: Trajectories) -> bytes:
    """Return a recording as C3D: millimetres in 32 bits, missing samples with residual -1.

    Raises
    ------
    ValueError
        If it has more frames, or more or longer names, than the format can hold, or a position
        that 32 bits cannot.
    """
    import ezc3d

    _check_writable(recording)
    missing = ~recording.present
    made = ezc3d.c3d()
    point = made["parameters"]["POINT"]
    point["RATE"]["value"] = np.array([recording.rate])
    point["UNITS"]["value"] = ["mm"]
    point["LABELS"]["value"] = list(recording.markers)
    # Zeros, because many programs do not expect NaN in a file.
    positions = np.where(missing[..., None], 0.0, recording.positions)
    made["data"]["points"] = np.ascontiguousarray(positions.transpose(2, 1, 0))
    made["data"]["meta_points"] = {"residuals": -missing.T[None].astype(np.float64)}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "recording.c3d"
        made.write(str(path))
        _check_written(path, recording)
        return path.read_bytes()


def _check_written(path: Path, recording: Trajectories) -> None:
    """Read the names back: where they are too many, the library writes a damaged file."""
    try:
        names = _labels(read_description(path).parameters)
    except ValueError:
        names = []
    if tuple(names) != recording.markers:
        raise ValueError(
            f"C3D cannot hold the names of {len(recording.markers)} markers; write CSV or NPZ"
        )


def _samples(path: Path, description: Description) -> NDArray[np.float64]:
    """Return (T, M, 4): x, y, z in the file's unit, and what is negative when missing."""
    layout, processor = description.layout, description.processor
    if not layout.frames or not layout.points:
        raise ValueError(f"it holds {layout.frames} frames of {layout.points} points")
    with path.open("rb") as stream:
        stream.seek(layout.start)
        content = stream.read(layout.end - layout.start)
    frames = np.frombuffer(content, np.uint8).reshape(layout.frames, -1)
    points = np.ascontiguousarray(frames[:, : 4 * layout.points * layout.width]).data
    shape = (layout.frames, layout.points, 4)
    if layout.width == 4:
        return processor.floats(points).reshape(shape)
    integers = np.frombuffer(points, f"{processor.order}i2").reshape(shape)
    return integers * description.scale


def _unit(parameters: Parameters) -> str:
    units = parameters.get(("POINT", "UNITS"))
    return next(iter(units.texts), "") if units else ""


def _labels(parameters: Parameters) -> list[str]:
    """Return POINT:LABELS, LABELS2, ... as one list."""
    labels: list[str] = []
    name, number = "LABELS", 2
    while found := parameters.get(("POINT", name)):
        labels += found.texts
        name, number = f"LABELS{number}", number + 1
    return labels


def _check_writable(recording: Trajectories) -> None:
    if not 0 < recording.frames < LARGEST_COUNT or not recording.markers:
        raise ValueError(
            f"C3D holds 1 to {LARGEST_COUNT - 1} frames of at least one marker, not "
            f"{recording.frames} of {len(recording.markers)}; write CSV or NPZ"
        )
    for name in recording.markers:
        if not name.strip() or name != name.strip() or len(name.encode()) > LONGEST_NAME:
            raise ValueError(
                f"C3D cannot keep the marker name {name!r}: 1 to {LONGEST_NAME} bytes, no "
                "spaces around it"
            )
    if np.nanmax(np.abs(recording.positions), initial=0.0) > np.finfo(np.float32).max:
        raise ValueError("a position is beyond the 32-bit numbers of C3D")
