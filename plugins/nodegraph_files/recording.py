"""Read a recording, whatever its file form."""

from __future__ import annotations

import warnings
from pathlib import Path

from nodegraph import InputFile, node
from nodegraph_files.marker_set import marker_set_for, with_marker_set
from nodegraph_files.npz import read_npz
from nodegraph_files.paths import find_file
from nodegraph_files.text.csv import read_csv
from nodegraph_files.text.text_file import start_in_utf8
from nodegraph_files.text.trc import FIRST_WORD, read_trc
from nodegraph_mocap.recording import Trajectories

_RECORDINGS = ("recording.c3d", "recording.npz", "recording.trc", "recording.csv")
_TABLES = (".csv", ".tsv", ".txt")


@node("read.recording")
def read_recording(
    *, path: InputFile, marker_set: InputFile | None = None, zeros_missing: bool = True
) -> Trajectories:
    """Read a recording: C3D, TRC, CSV, TSV or NPZ, told apart by content, then by suffix.

    Parameters
    ----------
    path
        A file, a folder that holds ``recording.c3d``, or ``sample:NAME``.
    marker_set
        A marker-set file (YAML). By default the recording's own, or ``markers.yaml`` of the
        folder, or none.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing, as many systems mean it.

    Returns
    -------
    Trajectories
        In millimetres.

    Raises
    ------
    ValueError
        If the file cannot be read, holds no samples, or lacks a marker that the set names.
    """
    file = find_file(path, _RECORDINGS)
    recording = _read(file, zeros_missing)
    if not recording.frames or not recording.markers:
        raise ValueError(f"{path}: the recording holds no samples")
    if not recording.present.any():
        warnings.warn(f"{path}: every sample of the recording is missing", stacklevel=2)
    return with_marker_set(recording, marker_set_for(Path(path), file, marker_set), file)


def _read(file: Path, zeros_missing: bool) -> Trajectories:
    with file.open("rb") as opened:
        start = opened.read(2 + 2 * len(FIRST_WORD))
    # A C3D file starts with a small number, a text that has a P in second place does not.
    if (start[1:2] == b"\x50" and start[0] < 0x20) or file.suffix.lower() == ".c3d":
        from nodegraph_files.c3d import read_c3d

        return read_c3d(file, zeros_missing=zeros_missing)
    if start.startswith(b"PK\x03\x04"):
        return read_npz(file, zeros_missing=zeros_missing)
    if start_in_utf8(start).startswith(FIRST_WORD.encode()) or file.suffix.lower() == ".trc":
        return read_trc(file, zeros_missing=zeros_missing)
    if file.suffix.lower() in _TABLES:
        return read_csv(file, zeros_missing=zeros_missing)
    raise ValueError(f"{file}: neither C3D, TRC, NPZ nor a table ({', '.join(_TABLES)})")
