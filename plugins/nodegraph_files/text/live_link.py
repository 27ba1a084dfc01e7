"""Weights as the app Live Link Face records them: a table of text, a row per frame.

Two columns come first, ``Timecode`` and ``BlendShapeCount``. Source: files of the app by Epic
Games; the 52 weights are those of Apple's ``ARFaceAnchor.BlendShapeLocation``.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Format, quoted
from nodegraph_files.rates import rate_from
from nodegraph_files.text.table import cell_numbers, check_distinct, without_cut_row
from nodegraph_files.text.text_file import Line, TextFile, read_text_file, start_in_utf8
from nodegraph_mocap.face_model import Weights

if TYPE_CHECKING:
    from numpy.typing import NDArray

_HEADER = ["timecode", "blendshapecount"]
_TIMECODE = re.compile(r"(\d{1,2}):(\d{1,2}):(\d{1,2})[:;](\d{1,3}(?:\.\d*)?)")
_ROTATION = re.compile(r"(Head|LeftEye|RightEye)(Yaw|Pitch|Roll)", re.IGNORECASE)
_COUNTS_PER_SECOND = (24, 25, 30, 48, 50, 60, 100, 120, 240)
_USUAL = 60
_DAY = 24 * 3600
_LONGEST_GAPS = 60  # seconds
_FEW = 10_000_000  # weights for which there is room in any case


@dataclass(frozen=True)
class _Times:
    """The times of the frames: whole seconds, and counts of the timecode within them."""

    path: Path
    lines: list[int]
    written: list[str]
    seconds: NDArray[np.float64]
    counts: NDArray[np.float64]


def read_live_link(path: Path, *, rate: float | None = None) -> Weights:
    """Read the weights of a CSV file by Live Link Face.

    The timecode ``hours:minutes:seconds:count`` counts 60 to the second, or what its own step
    from one second to the next says. The usual step between rows is the rate: 60 Hz if it is 1
    count, 30 Hz if it is 2. A step of several frames stands for frames that were dropped: they
    become rows of NaN. Warnings count these, the frames in which no face was found, other missing
    weights, and steps shorter than half a frame, which count as one; and say where
    BlendShapeCount is not the number of columns.

    Parameters
    ----------
    path
        The file.
    rate
        Hz; by default that of the timecode.

    Returns
    -------
    Weights
        With names as written, such as ``EyeBlinkLeft``. The nine columns of head and eye
        rotations (``HeadYaw`` to ``RightEyeRoll``), which are angles in radians and no weights,
        are left out.

    Raises
    ------
    ValueError
        With the file, and where there are any with line and column: if it is not such a file, a
        cell is not a number or infinite, a row has too few or too many cells, a column is there
        twice, a timecode goes back, or more frames are dropped than there are and than a minute
        has.
    """
    names, rows = _rows(path)
    columns = _columns(path, names)
    values = _values(path, len(names), columns, rows)
    times = _times(path, rows)
    stated, places = _places(times, len(columns))
    whole = np.full((places[-1] + 1, len(columns)), np.nan)
    whole[places] = values
    return Weights(values=whole, names=tuple(columns), rate=rate_from(rate, stated))


def _rows(path: Path) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Return the names of the columns, and the frames as cells with their line's number."""
    text = read_text_file(path)
    header, names = next(_cells(text), (Line(1, "", 0, 0), [""]))
    if [name.lower() for name in names[:2]] != _HEADER:
        raise ValueError(
            f"{path}: no Live Link Face file: it begins with {quoted(','.join(names[:2]))}, not "
            "with the columns Timecode, BlendShapeCount"
        )
    width = max(index for index, name in enumerate(names, 1) if name)
    text = without_cut_row(text, header.end, ",", width)
    _, *rows = [(line.number, cells) for line, cells in _cells(text)]
    if not rows:
        raise ValueError(f"{path}: no frames follow the names of the columns")
    return names[:width], rows


def _cells(text: TextFile) -> Iterator[tuple[Line, list[str]]]:
    """Return the lines in which a cell is not empty, with their cells."""
    for line in text.lines():
        cells = [cell.strip() for cell in line.text.split(",")]
        if any(cells):
            yield line, cells


def _columns(path: Path, names: list[str]) -> dict[str, int]:
    """Return the place of each weight's column."""
    check_distinct(names, str(path))
    columns = {
        name: place
        for place, name in enumerate(names)
        if place >= len(_HEADER) and not _ROTATION.fullmatch(name)
    }
    if not columns or "" in columns:
        raise ValueError(
            f"{path}: {'a column has no name' if columns else 'no columns of weights'}"
        )
    return columns


def _values(
    path: Path, width: int, columns: dict[str, int], rows: list[tuple[int, list[str]]]
) -> NDArray[np.float64]:
    """Return (rows, K) weights; a row that counts none, and has none, is NaN."""
    values = np.full((len(rows), len(columns)), np.nan)
    wanted = list(columns.values())
    faceless = []
    for row, (line, cells) in enumerate(rows):
        if cells[1:2] == ["0"] and not any(cells[2:]):
            faceless.append(line)
            continue
        if len(cells) < width or any(cells[width:]):
            raise ValueError(f"{path}:{line}: {len(cells)} cells, but {width} columns have names")
        numbers = cell_numbers(path, line, cells[1:width], columns=range(2, width + 1))
        values[row] = [numbers[place - 1] for place in wanted]
        if np.isinf(values[row]).any():
            name = list(columns)[int(np.argmax(np.isinf(values[row])))]
            raise ValueError(f"{path}:{line}:{columns[name] + 1}: the weight {name} is infinite")
    _warn_count({cells[1] for _, cells in rows if any(cells[2:])}, width - len(_HEADER))
    _warn_missing(values, faceless)
    return values


def _warn_count(counted: set[str], columns: int) -> None:
    wrong = sorted(counted - {str(columns)})
    if wrong:
        warnings.warn(
            f"BlendShapeCount says {', '.join(cell or 'nothing' for cell in wrong[:5])}, but "
            f"{columns} columns follow it; the columns count",
            stacklevel=4,
        )


def _warn_missing(values: NDArray[np.float64], faceless: list[int]) -> None:
    if faceless:
        warnings.warn(
            f"{len(faceless)} frames have no weights, as no face was found; the first is line "
            f"{faceless[0]}",
            stacklevel=4,
        )
    single = int(np.count_nonzero(np.isnan(values))) - len(faceless) * values.shape[1]
    if single:
        warnings.warn(f"{single} single weights are missing", stacklevel=4)


def _times(path: Path, rows: list[tuple[int, list[str]]]) -> _Times:
    parts = []
    for line, cells in rows:
        match = _TIMECODE.fullmatch(cells[0])
        if match is None:
            raise ValueError(
                f"{path}:{line}:1: {quoted(cells[0])} is not a timecode hh:mm:ss:ff.fff"
            )
        hours, minutes, seconds, counts = (float(part) for part in match.groups())
        parts.append((3600 * hours + 60 * minutes + seconds, counts))
    seconds_of, counts_of = np.array(parts).T
    lines = [line for line, _ in rows]
    return _Times(path, lines, [cells[0] for _, cells in rows], seconds_of, counts_of)


def _places(times: _Times, columns: int) -> tuple[float, NDArray[np.int64]]:
    """Return the rate, and which frame each row is."""
    per_second = _counts_per_second(times)
    if len(times.lines) == 1:
        warnings.warn(f"a single frame has no rate; {per_second} Hz is assumed", stacklevel=3)
        return float(per_second), np.zeros(1, dtype=np.int64)
    steps = _steps(times.seconds, _DAY) * per_second + np.diff(times.counts)
    if steps.min() < 0:
        before = int(np.argmax(steps < 0))
        raise ValueError(
            f"{times.path}:{times.lines[before + 1]}:1: the timecode goes back from "
            f"{times.written[before]} to {times.written[before + 1]}"
        )
    # Two digits: clocks drift by some thousandths of a count.
    usual = round(float(np.median(steps)), 2)
    if not usual:
        raise ValueError(f"{times.path}: the timecode stands still and has no rate")
    frames = np.rint(steps / usual).astype(np.int64)
    _warn_steps(times, frames, per_second / usual, columns)
    places = np.concatenate([[0], np.cumsum(np.maximum(frames, 1))])
    return per_second / usual, places


def _steps(seconds: NDArray[np.float64], around: float) -> NDArray[np.float64]:
    steps = np.diff(seconds)
    return np.where(steps < -around / 2, steps + around, steps)


def _counts_per_second(times: _Times) -> int:
    """Return how many counts make a second, by the steps from one second into the next.

    Where these give none of the known numbers, as no second ends within the take or frames were
    dropped there, it is 60, the app's own.
    """
    passing = _steps(times.seconds, _DAY)
    steps = np.diff(times.counts)
    if (passing == 0).any() and (passing == 1).any():
        measured = np.median(steps[passing == 0]) - np.median(steps[passing == 1])
        nearest = min(_COUNTS_PER_SECOND, key=lambda count: abs(count - measured))
        if abs(nearest - measured) < 0.5 and nearest > times.counts.max():
            return nearest
    if times.counts.max() >= _USUAL:
        raise ValueError(
            f"{times.path}: the timecode counts to {times.counts.max():g}, and not how many "
            "counts make a second"
        )
    return _USUAL


def _warn_steps(times: _Times, frames: NDArray[np.int64], rate: float, columns: int) -> None:
    dropped = int(np.maximum(frames - 1, 0).sum())
    if dropped > max(len(times.lines), min(_LONGEST_GAPS * rate, _FEW / columns)):
        before = int(np.argmax(frames))
        raise ValueError(
            f"{times.path}:{times.lines[before + 1]}:1: the timecode skips {dropped} frames, but "
            f"{len(times.lines)} are there; it goes from {times.written[before]} to "
            f"{times.written[before + 1]}"
        )
    if dropped:
        before = int(np.argmax(frames > 1))
        warnings.warn(
            f"the timecode skips {dropped} frames in {np.count_nonzero(frames > 1)} gaps, the "
            f"first after {times.written[before]}; their weights are missing",
            stacklevel=4,
        )
    if (frames < 1).any():
        warnings.warn(
            f"{np.count_nonzero(frames < 1)} frames follow less than half a frame after the one "
            "before; each counts as a frame of its own",
            stacklevel=4,
        )


def _is_live_link(start: bytes) -> bool:
    first = start_in_utf8(start).decode(errors="replace").partition("\n")[0]
    return [cell.strip('" \r').lower() for cell in first.split(",")[:2]] == _HEADER


FORMAT = Format("Live Link Face", Weights, (".csv",), read_live_link, _is_live_link)
