"""Recordings as TRC files (track row column): a row of text per frame, as OpenSim reads them.

Five lines come first: the form of the file, names of facts, the facts, the markers' names over the
first of their columns, and the columns' own names X1, Y1, Z1, X2, ... Source: OpenSim
documentation, "Marker (.trc) Files".
"""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.marker_names import unique_names
from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.samples_missing import mark_missing
from nodegraph_mocap.text_cells import cell_numbers, text_lines
from nodegraph_mocap.units import to_millimetres

if TYPE_CHECKING:
    from numpy.typing import NDArray

FIRST_WORD = "PathFileType"
_COORDINATE = re.compile(r"([XYZ])\d*", re.IGNORECASE)
_HEADER_LINES = 5
_LEADING = 2  # the columns Frame# and Time


@dataclass(frozen=True)
class _Text:
    """A file as it was written: facts of its header by name, and its lines with their numbers."""

    path: Path
    facts: dict[str, str]
    labels: list[str]
    markers: int
    rows: list[tuple[int, list[str]]]


def read_trc(path: Path, *, zeros_missing: bool = True) -> Trajectories:
    """Read a recording from a TRC file, whose cells tabs or commas separate.

    The columns and rows that are there count, not the numbers of the header. Warnings tell where
    the two differ, which markers lacked a name or shared one, how many samples were partly
    missing, infinite or zero, how many rows end early, and whether frame numbers or times
    contradict evenly spaced frames.

    Parameters
    ----------
    path
        The file.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing.

    Returns
    -------
    Trajectories
        In millimetres, at the header's DataRate; a sample whose cells are empty is missing. A
        subject's prefix (``subject:marker``) that all markers share is taken off their names.

    Raises
    ------
    ValueError
        With the file, and where there are any with line and column: if it is no TRC file, a cell
        is no number, a name or column is out of place, or the rate or all frames are lacking.
    """
    text = _text(path)
    rate = _rate(text)
    cells = _cells(text)
    positions = cells[:, _LEADING:].reshape(len(cells), text.markers, 3)
    positions = positions * to_millimetres(text.facts.get("units", ""))
    _tell_counts(text)
    _tell_uneven(cells[:, 0], cells[:, 1], rate)
    nothing = np.zeros(positions.shape[:2], dtype=np.bool_)
    return Trajectories(
        positions=mark_missing(positions, nothing, zeros_missing=zeros_missing),
        markers=unique_names(text.labels, text.markers),
        rate=rate,
    )


def write_trc(recording: Trajectories, path: Path) -> None:
    """Write a recording as a TRC file; see `trc_bytes`."""
    path.write_bytes(trc_bytes(recording))


def trc_bytes(recording: Trajectories) -> bytes:
    """Return a recording as TRC in millimetres; rate and every number read back equal.

    Names do as well, but for a subject's prefix that all of them share, which readers take off.

    Raises
    ------
    ValueError
        If there is no frame or no marker, or a marker's name cannot stand in a cell: it is empty,
        starts or ends with a space, or contains a character that is not printed.
    """
    _check_writable(recording)
    frames, count, rate = recording.frames, len(recording.markers), repr(recording.rate)
    facts = {
        "DataRate": rate, "CameraRate": rate, "NumFrames": frames, "NumMarkers": count,
        "Units": "mm", "OrigDataRate": rate, "OrigDataStartFrame": 1, "OrigNumFrames": frames,
    }  # fmt: skip
    axes = [f"{axis}{marker}" for marker in range(1, count + 1) for axis in "XYZ"]
    lines = [
        f"{FIRST_WORD}\t4\t(X/Y/Z)\trecording.trc",
        "\t".join(facts),
        "\t".join(str(value) for value in facts.values()),
        "\t".join(["Frame#", "Time", *(f"{name}\t\t" for name in recording.markers)]),
        "\t".join(["", "", *axes]),
        "",
    ]
    for frame, row in enumerate(recording.positions.reshape(frames, -1).tolist()):
        numbers = ("" if number != number else repr(number) for number in row)
        lines.append("\t".join([str(frame + 1), repr(frame / recording.rate), *numbers]))
    return ("\n".join(lines) + "\n").encode()


def _check_writable(recording: Trajectories) -> None:
    if not recording.frames or not recording.markers:
        raise ValueError(
            f"TRC holds at least one frame of one marker, not {recording.frames} of "
            f"{len(recording.markers)}"
        )
    for name in recording.markers:
        if not name or not name.isprintable() or name != name.strip():
            raise ValueError(f"TRC cannot keep the marker name {name!r}")


def _text(path: Path) -> _Text:
    lines = text_lines(path)
    if not lines[0].startswith(FIRST_WORD):
        raise ValueError(f"{path}: no TRC file: it begins with {lines[0][:20]!r}, not {FIRST_WORD}")
    separator = max("\t,", key=lines[0].count)
    if separator not in lines[0]:
        raise ValueError(f"{path}:1: neither tabs nor commas separate cells")
    split = (
        (number, [cell.strip() for cell in line.split(separator)])
        for number, line in enumerate(lines, 1)
    )
    rows = [(number, cells) for number, cells in split if any(cells)]
    if len(rows) < _HEADER_LINES:
        raise ValueError(f"{path}: the header ends after {len(rows)} of {_HEADER_LINES} lines")
    (_, keys), (_, values), names, coordinates = rows[1:_HEADER_LINES]
    text = _Text(
        path=path,
        facts={key.lower(): value for key, value in zip(keys, values, strict=False)},
        labels=_labels(path, *names),
        markers=_markers(path, *coordinates),
        rows=rows[_HEADER_LINES:],
    )
    if lines[-1]:
        _drop_cut_number(text)
    return text


def _labels(path: Path, line: int, cells: list[str]) -> list[str]:
    for column, cell in enumerate(cells[_LEADING:], _LEADING + 1):
        if cell and (column - _LEADING) % 3 != 1:
            raise ValueError(
                f"{path}:{line}:{column}: the name {cell!r} is out of place: names stand over X "
                "columns, every third from the third on"
            )
    return cells[_LEADING::3]


def _markers(path: Path, line: int, cells: list[str]) -> int:
    """Return the number of markers, after a look at the names of the columns."""
    last = max(index for index, cell in enumerate(cells, 1) if cell)
    for column, cell in enumerate(cells[:last], 1):
        place = column - 1 - _LEADING
        wanted = f"{'XYZ'[place % 3]}{place // 3 + 1}" if place >= 0 else ""
        found = _COORDINATE.fullmatch(cell)
        if (found[1].upper() if found else cell) != wanted[:1]:
            raise ValueError(
                f"{path}:{line}:{column}: {cell!r} where {wanted or 'an empty cell'} is expected"
            )
    if last <= _LEADING or (last - _LEADING) % 3:
        raise ValueError(
            f"{path}:{line}: {max(last - _LEADING, 0)} columns X1, Y1, Z1, ... make no whole "
            "number of markers"
        )
    return (last - _LEADING) // 3


def _drop_cut_number(text: _Text) -> None:
    """Empty the last cell of a file that ends within a row: its number may lack digits."""
    if text.rows and len(text.rows[-1][1]) < _LEADING + 3 * text.markers:
        text.rows[-1][1][-1] = ""


def _cells(text: _Text) -> NDArray[np.float64]:
    if not text.rows:
        said = text.facts.get("numframes") or "none"
        raise ValueError(f"{text.path}: no frames follow the header, whose NumFrames says {said}")
    width = _LEADING + 3 * text.markers
    cells = np.full((len(text.rows), width), np.nan)
    early = []
    for row, (line, found) in enumerate(text.rows):
        if any(found[width:]):
            raise ValueError(
                f"{text.path}:{line}: {len(found)} cells, but {width} columns: Frame#, Time and "
                f"{text.markers} markers"
            )
        early += [line] if len(found) < width else []
        cells[row, : len(found)] = cell_numbers(text.path, line, found[:width])
    if early:
        warnings.warn(
            f"{len(early)} rows end before the last of {width} columns; what they lack counts as "
            f"missing; the first is line {early[0]}",
            stacklevel=3,
        )
    return cells


def _rate(text: _Text) -> float:
    said = text.facts.get("datarate", "")
    try:
        rate = float(said.replace("_", "?"))
    except ValueError:
        rate = 0.0
    if not 0 < rate < float("inf"):
        raise ValueError(
            f"{text.path}: DataRate must be a positive number of frames per second, the header "
            f"says {said or 'none'}"
        )
    return rate


def _tell_counts(text: _Text) -> None:
    for fact, what, there in (
        ("numframes", "frames", len(text.rows)),
        ("nummarkers", "markers", text.markers),
    ):
        said = text.facts.get(fact, str(there))
        if said not in (str(there), f"{there}.0"):
            warnings.warn(
                f"the header says {said or 'no number of'} {what}, the file holds {there}; what "
                "it holds counts",
                stacklevel=3,
            )


def _tell_uneven(numbers: NDArray[np.float64], times: NDArray[np.float64], rate: float) -> None:
    """Tell of frame numbers and times that contradict evenly spaced frames."""
    steps = len(numbers) - 1
    uneven = int(np.count_nonzero(np.diff(numbers) != 1))
    if uneven:
        warnings.warn(
            f"{uneven} of {steps} steps of Frame# are not 1: frames were dropped or repeated; the "
            "rows count as evenly spaced",
            stacklevel=3,
        )
    lasts = times[-1] - times[0]
    # Times are often rounded to hundredths of a second.
    if abs(lasts - steps / rate) > 0.01 * (steps / rate + 1):
        warnings.warn(
            f"by the column Time the recording lasts {lasts:g} s, by DataRate {steps / rate:g} s; "
            "DataRate counts",
            stacklevel=3,
        )
