"""Which node reads a file, by its content and name, and in which format it is."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from nodegraph import Format, formats
from nodegraph_files.glb.moving import RawAnimation, is_animated
from nodegraph_files.head import NEUTRAL, RawHead
from nodegraph_files.npz import is_archive, is_model
from nodegraph_files.readers import MARKER_SETS, SELECTIONS, file_names, matching_formats
from nodegraph_files.text.counters import is_counter
from nodegraph_files.text.text_file import other_format, start_in_utf8
from nodegraph_mocap.face_model import BlendshapeModel, Weights
from nodegraph_mocap.marks import Marks
from nodegraph_mocap.recording import Trajectories

_READ_BY = {
    Trajectories: "read.recording",
    Weights: "read.weights",
    RawAnimation: "read.animation",
    RawHead: "read.head",
    BlendshapeModel: "read.model",
    Marks: "read.marks",
}
"""The nodes that read the types of formats; of a folder, the first that finds its file."""

_IN_YAML = {"read.marker_set": MARKER_SETS, "read.selection": SELECTIONS}
_CHOSEN = re.compile(r"^[\"']?chosen[\"']?\s*:", re.MULTILINE)
_SUFFIXES = (".yaml", ".yml")
_START = 4096  # bytes
_AXIS = re.compile(r"(.*[._: ])?[xyz](_?\d+)?", re.IGNORECASE)
_CELL = re.compile(r"[,;\t]")


def readers() -> Mapping[str, Callable[[Path], str | None]]:
    """Return for each node that reads files what recognizes those that it reads."""
    return {name: partial(_format_for, name) for name in (*_READ_BY.values(), *_IN_YAML)}


def _format_for(node: str, path: Path) -> str | None:
    found = _in_folder(path) if path.is_dir() else _of_file(path)
    return found[1] if found is not None and found[0] == node else None


def _in_folder(folder: Path) -> tuple[str, str] | None:
    """Return the node that reads a folder, and the format of the file that it takes."""
    for kind, node in _READ_BY.items():
        known = formats(kind)
        names = [*file_names(node.removeprefix("read."), known), *[NEUTRAL] * (kind is RawHead)]
        for name in names:
            if (folder / name).is_file():
                return node, _matching(folder / name, known)[0].name
    in_yaml = (node for node, names in _IN_YAML.items() if (folder / names[0]).is_file())
    return next(((node, "YAML") for node in in_yaml), None)


def _of_file(file: Path) -> tuple[str, str] | None:
    if file.suffix.lower() in _SUFFIXES:
        is_selection = _CHOSEN.search(_start(file).decode(errors="replace"))
        return "read.selection" if is_selection else "read.marker_set", "YAML"
    known = [each for each in formats(object) if each.type in _READ_BY]
    matches = _matching(file, known)
    if matches:
        return _READ_BY[matches[0].type], matches[0].name
    # the reader says what to do with it
    other = other_format(_start(file))
    return (_READ_BY[Trajectories], other) if other else None


def _matching(file: Path, known: Sequence[Format]) -> list[Format]:
    """Return the formats that a file may be in; the one that it is in comes first."""
    start = _start(file)
    matches = matching_formats(file, known)
    if is_archive(start):
        return _preferring(BlendshapeModel if is_model(file) else Trajectories, matches)
    if any(each.type is RawAnimation for each in matches):
        return _preferring(RawAnimation if is_animated(file) else RawHead, matches)
    # tables of weights and of recordings may begin alike
    return _preferring(Trajectories, matches) if _has_axes(start) else matches


def _preferring(kind: type, matches: Sequence[Format]) -> list[Format]:
    return sorted(matches, key=lambda each: each.type is not kind)


def _has_axes(start: bytes) -> bool:
    """Return whether one of the first rows of a table names axes, as those of recordings do."""
    rows = start_in_utf8(start).decode(errors="replace").splitlines()[:6]
    return any(
        _AXIS.fullmatch(cell.strip(' "')) and not is_counter(cell)
        for row in rows
        if not row.startswith("#")
        for cell in _CELL.split(row)
    )


def _start(file: Path) -> bytes:
    with file.open("rb") as stream:
        return stream.read(_START)
