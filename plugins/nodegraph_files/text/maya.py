"""Recordings as Maya ASCII scenes (.ma): the animation curves of what each marker is moved by.

A scene is a list of commands. `createNode animCurveTL` makes a curve of a length over time, the
`setAttr` after it gives its keys (``.ktv``: time and value in turn), and `connectAttr` says what
it moves: ``"chin_translateX.o" "chin.tx"``. Times are in frames of the unit of time that
`currentUnit` names. Source: Autodesk, Maya Help, "Maya ASCII file format".
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph import Format, quoted
from nodegraph_files.rates import rate_from
from nodegraph_files.text.table_recording import recording_of
from nodegraph_files.text.text_file import start_in_utf8
from nodegraph_files.units import AUTO, unit_from
from nodegraph_mocap.recording import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_FIRST_WORDS = b"//Maya ASCII"
_STATEMENT = re.compile(
    r"""(?P<skipped>\s++|//[^\n]*+)|(?P<text>(?:[^;"]++|"(?:[^"\\]++|\\.)*+")++);""", re.DOTALL
)
_QUOTED = re.compile(r'"((?:[^"\\]|\\.)*)"')
_KEYS = re.compile(r'"\.(?:ktv|keyTimeValue)\[(\d+)(?::(\d+))?\]"(.*)', re.DOTALL)
_NAMED = re.compile(r'\s-n(?:ame)?\s+"([^"]*)"')
_PARENT = re.compile(r'\s-p(?:arent)?\s+"([^"]*)"')
_OF_TIME = re.compile(r"\s-t(?:ime)?\s+(\S+)")
_OF_LENGTH = re.compile(r"\s-l(?:inear)?\s+(\S+)")
_MOVED = re.compile(r'"\.(?:t|r|s|translate|rotate|scale)[xyzXYZ]?"')
_PLUGS = {f"{name}{axis}": "xyz".index(axis.lower()) for name, axes in
          (("t", "xyz"), ("translate", "XYZ")) for axis in axes}  # fmt: skip
_PER_SECOND = {
    "game": 15.0, "film": 24.0, "pal": 25.0, "ntsc": 30.0, "show": 48.0, "palf": 50.0,
    "ntscf": 60.0, "millisec": 1000.0, "sec": 1.0, "min": 1.0 / 60.0, "hour": 1.0 / 3600.0,
}  # fmt: skip
_RATE = re.compile(r"(\d+(?:\.\d+)?)fps")
_OFF = 0.01
"""How far from an even grid a key may lie, as a share of the grid's step."""
_SPARSE = 10
"""Frames per key of the curve with the most, above which a scene is no recording."""


class _Statement(NamedTuple):
    line: int
    text: str


@dataclass
class _Curve:
    line: int
    keys: list[NDArray[np.float64]] = field(default_factory=list)


@dataclass
class _Scene:
    """What of a scene may make up a recording."""

    time: str = "film"
    length: str = "cm"
    curves: dict[str, _Curve] = field(default_factory=dict)
    others: list[int] = field(default_factory=list)
    """Lines of curves of angles, times and numbers."""
    moves: list[tuple[str, str]] = field(default_factory=list)
    """Curve and what it is connected to."""
    parents: dict[str, str] = field(default_factory=dict)
    moved: set[str] = field(default_factory=set)
    references: list[int] = field(default_factory=list)
    """Lines that name other files."""


def read_maya(
    path: Path, *, zeros_missing: bool = True, unit: str = AUTO, rate: float | None = None
) -> Trajectories:
    """Read a recording from a Maya ASCII scene: a marker per node that curves translate.

    The keys are the samples, on a grid whose step is the shortest between two keys of a curve. No
    tangent matters, as nothing between keys is computed: where a curve has no key, the sample is
    missing. A curve of one key has that value all the time. Warnings count other curves, markers
    whose group is moved itself, samples with keys in some axes only, and references to files.

    Parameters
    ----------
    path
        The file.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing.
    unit
        Unit of length; by default the scene's.
    rate
        Hz; by default that of the keys.

    Returns
    -------
    Trajectories
        In millimetres, positions in the axes of each marker's group.

    Raises
    ------
    ValueError
        With the line, if a statement does not end, keys are no numbers or lie on no even grid, the
        unit of time is unknown, or no curve translates a node in x, y and z.
    """
    text = path.read_bytes().decode("utf-8", errors="replace").replace("\r\n", "\n")
    scene = _scene(text)
    markers = _markers(scene)
    grid, step = _grid(markers)
    positions = np.full((len(grid), len(markers), 3), np.nan)
    for column, curves in enumerate(markers.values()):
        for axis, (times, values) in enumerate(map(_keys, curves)):
            frame = np.rint((times - grid[0]) / step).astype(np.intp) if len(times) > 1 else ...
            positions[frame, column, axis] = values
    _warn(scene, markers)
    return recording_of(
        positions.reshape(len(grid), -1),
        list(markers),
        rate=rate_from(rate, round(_per_second(scene.time) / step, 9)),
        unit=unit_from(unit, scene.length),
        zeros_missing=zeros_missing,
    )


def _statements(text: str) -> Iterator[_Statement]:
    place, line = 0, 1
    while place < len(text):
        match = _STATEMENT.match(text, place)
        if match is None:
            raise ValueError(f"line {line}: a statement begins here and does not end")
        if match["text"]:
            yield _Statement(line, match["text"])
        line += match[0].count("\n")
        place = match.end()


def _scene(text: str) -> _Scene:
    scene, curve, node = _Scene(), None, ""
    for line, statement in _statements(text):
        word = statement.split(None, 1)[0] if statement.strip() else ""
        if word == "createNode":
            node = _found(_NAMED, statement)
            curve = _created(scene, line, statement, node)
        elif word == "setAttr" and curve is not None:
            curve.keys += _keys_of(line, statement)
        elif word == "setAttr" and node in scene.parents and _MOVED.search(statement):
            scene.moved.add(node)
        elif word == "connectAttr":
            scene.moves += [tuple(_QUOTED.findall(statement)[:2])]
        elif word == "currentUnit":
            scene.time = _found(_OF_TIME, statement) or scene.time
            scene.length = _found(_OF_LENGTH, statement) or scene.length
        elif word == "file":
            scene.references.append(line)
    return scene


def _created(scene: _Scene, line: int, statement: str, node: str) -> _Curve | None:
    """Note a node; return its curve if it is one of a length."""
    kind = [*statement.split(None, 2), ""][1]
    if kind == "animCurveTL":
        scene.curves[node] = _Curve(line)
    elif kind.startswith("animCurve"):
        scene.others.append(line)
    elif kind == "transform":
        scene.parents[node] = _found(_PARENT, statement)
    return scene.curves[node] if kind == "animCurveTL" else None


def _found(pattern: re.Pattern[str], statement: str) -> str:
    match = pattern.search(statement)
    return match[1] if match else ""


def _keys_of(line: int, statement: str) -> list[NDArray[np.float64]]:
    """Return the keys that a statement gives a curve, rows of time and value."""
    match = _KEYS.search(statement)
    if match is None:
        return []
    words = match[3].split()
    count = int(match[2] or match[1]) - int(match[1]) + 1
    try:
        numbers = np.array(words, dtype=np.float64)
    except ValueError:
        raise ValueError(f"line {line}: a key that is no number") from None
    if len(numbers) != 2 * count or not np.isfinite(numbers).all():
        raise ValueError(
            f"line {line}: {len(numbers)} numbers for a time and value of {count} keys"
        )
    return [numbers.reshape(-1, 2)]


def _keys(curve: _Curve) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    times, values = np.concatenate(curve.keys).T
    return times, values


def _markers(scene: _Scene) -> dict[str, list[_Curve]]:
    """Return the curves in x, y and z of each node that has all three, as they are connected."""
    found: dict[str, dict[int, _Curve]] = {}
    for output, plug in (pair for pair in scene.moves if len(pair) == 2):
        node, _, attribute = plug.rpartition(".")
        curve = scene.curves.get(output.rpartition(".")[0])
        if curve is not None and curve.keys and attribute in _PLUGS:
            found.setdefault(node, {})[_PLUGS[attribute]] = curve
    markers = {
        node: [curves[axis] for axis in range(3)]
        for node, curves in found.items()
        if len(curves) == 3
    }
    if not markers:
        there = {
            "curves of lengths (animCurveTL)": [each.line for each in scene.curves.values()],
            "other curves": scene.others,
            "references to other files": scene.references,
        }
        counts = (
            f"{len(lines)} {what}{f', from line {lines[0]} on' if lines else ''}"
            for what, lines in there.items()
        )
        raise ValueError(
            "no node that animation curves translate in x, y and z: a scene without a recording? "
            f"It has {'; '.join(counts)}"
        )
    return markers


def _grid(markers: dict[str, list[_Curve]]) -> tuple[NDArray[np.float64], float]:
    """Return the times of all frames, and the step between them, in the scene's unit."""
    curves = [curve for three in markers.values() for curve in three]
    for curve in curves:
        if np.any(np.diff(_keys(curve)[0]) <= 0.0):
            raise ValueError(f"line {curve.line}: the times of the curve's keys do not increase")
    several = [_keys(curve)[0] for curve in curves if len(_keys(curve)[0]) > 1]
    if not several:
        return np.zeros(1), 1.0
    first = min(times[0] for times in several)
    shortest = min(float(np.diff(times).min()) for times in several)
    # rounded times would add up over a take
    last = max(times[-1] for times in several)
    step = (last - first) / max(np.rint((last - first) / shortest), 1.0)
    frames, most = 1 + round((last - first) / step), max(map(len, several))
    if frames > _SPARSE * most:
        raise ValueError(
            f"keys at steps of {step:.4g} are {frames} frames, of which no curve has more than "
            f"{most}: an animation by hand, no recording"
        )
    for curve in curves:
        times = _keys(curve)[0]
        place = (times - first) / step
        off = np.abs(place - np.rint(place)) > _OFF
        if len(times) > 1 and off.any():
            raise ValueError(
                f"line {curve.line}: a key at {times[off.argmax()]:g} lies between the frames, "
                f"which begin at {first:g} and are {step:.4g} apart"
            )
    return first + step * np.arange(frames), step


def _per_second(time: str) -> float:
    match = _RATE.fullmatch(time)
    rate = float(match[1]) if match else _PER_SECOND.get(time, 0.0)
    if not rate:
        raise ValueError(f"unit of time {quoted(time)} is unknown")
    return rate


def _warn(scene: _Scene, markers: dict[str, list[_Curve]]) -> None:
    used = {id(curve) for three in markers.values() for curve in three}
    left = len(scene.others) + sum(id(curve) not in used for curve in scene.curves.values())
    moves = scene.moved | {plug.rpartition(".")[0] for _, plug in scene.moves}
    under = sum(not moves.isdisjoint(_ancestors(scene, marker)) for marker in markers)
    counts = {
        "curves translate no marker and are left out": left,
        "markers are in a group that is moved itself: positions are in its axes": under,
        "references to other files are not followed": len(scene.references),
    }
    for what, count in counts.items():
        if count:
            warnings.warn(f"{count} {what}", stacklevel=4)


def _ancestors(scene: _Scene, node: str) -> set[str]:
    above: set[str] = set()
    while (node := scene.parents.get(node, "").rpartition("|")[2]) and node not in above:
        above.add(node)
    return above


def _is_maya(start: bytes) -> bool:
    return start_in_utf8(start).startswith(_FIRST_WORDS)


FORMAT = Format("Maya ASCII", Trajectories, (".ma",), read_maya, _is_maya)
