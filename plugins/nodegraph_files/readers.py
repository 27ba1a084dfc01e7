"""Nodes that read recordings, weights, heads, models and marker sets."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from nodegraph import Format, InputFile, Truth, formats, node, quoted
from nodegraph_files.glb.moving import RawAnimation
from nodegraph_files.head import NEUTRAL, RawHead, read_marker_vertices, unit_of_mesh
from nodegraph_files.marker_set import read_marker_set_yaml
from nodegraph_files.paths import find_file, is_sample
from nodegraph_files.rates import RateSetting
from nodegraph_files.selection import read_selection_yaml
from nodegraph_files.text.text_file import other_format
from nodegraph_files.units import AUTO, FACE_OR_BODY, MILLIMETRES, UnitSetting, extent_of
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.face_model import BlendshapeModel, ModelAndNeutral, Weights
from nodegraph_mocap.head import Head
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.marks import Marks
from nodegraph_mocap.recording import Trajectories, with_marker_set
from nodegraph_mocap.selection import Selection

MARKER_SETS = ("markers.yaml",)
SELECTIONS = ("selection.yaml",)
_MARKER_VERTICES = ("marker_vertices.csv",)
_SLOW, _FAST = 1.0, 1e5  # Hz, of recordings that are usual
_FARTHEST = 1e9  # mm
_START = 1024  # bytes


@node("read.recording", synthetic=is_sample)
def read_recording(
    *,
    path: InputFile,
    marker_set: InputFile | None = None,
    unit: UnitSetting = AUTO,
    rate: RateSetting = None,
    zeros_missing: bool = True,
) -> Trajectories:
    """Read a recording: C3D, TRC, MOT, CSV, NPZ, MA or a plugin's, by content, then by suffix.

    Of a C3D file or a table that was cut short, the whole frames are read, with a warning.

    Parameters
    ----------
    path
        A file, a folder that holds ``recording.c3d`` (or another format), or ``sample:NAME``.
    marker_set
        A marker-set file (YAML). By default the recording's own, or ``markers.yaml`` of the
        folder, or none.
    unit
        Unit of length in the file. By default the one that the file states; if it states none, mm
        (Motive: m), or cm or m where that alone makes the markers span 40 to 5000 mm, as a face or
        a body does, with a warning.
    rate
        Frames per second. By default the file's own, and without one the file is refused, as a
        table with nothing but frame numbers has none; a warning says both where they differ.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing, as many systems mean it.

    Returns
    -------
    Trajectories
        In millimetres.

    Raises
    ------
    ValueError
        If the file cannot be read, holds no samples, has no rate or one outside 0.001 to 1e6 Hz, a
        position beyond 1e9 mm, or lacks a marker that the set names.
    """
    known = formats(Trajectories)
    file = find_file(path, file_names("recording", known))
    return _read(path, file, known, marker_set, unit=unit, rate=rate, zeros_missing=zeros_missing)


def _read(
    path: Path,
    file: Path,
    known: Sequence[Format],
    marker_set: Path | None,
    *,
    unit: str,
    rate: float | None,
    zeros_missing: bool,
) -> Trajectories:
    settings = {"zeros_missing": zeros_missing, "unit": unit, "rate": rate}
    recording: Trajectories = _value_of(file, known, **settings)
    _check_recording(path, recording)
    return _with_marker_set(recording, Path(path), file, marker_set)


@node("read.truth", synthetic=is_sample)
def read_truth(
    *,
    path: InputFile,
    marker_set: InputFile | None = None,
    unit: UnitSetting = AUTO,
    rate: RateSetting = None,
    zeros_missing: bool = True,
) -> Truth[Trajectories]:
    """Read the noise-free recording beside a recording, or else the recording itself.

    What methods are given is read from the same path by `read.recording`. A recording of which
    the truth is not known is its own: then errors are measured to samples that carry the noise
    and the impulses of the measurement, which a warning says.

    Parameters
    ----------
    path
        A folder that holds ``truth.npz`` (or another format) beside ``recording.npz``,
        ``sample:NAME``, or a recording of which no truth is known.
    marker_set
        As of `read.recording`.
    unit, rate, zeros_missing
        As of `read.recording`.

    Returns
    -------
    Trajectories
        In millimetres.

    Raises
    ------
    ValueError
        If the file cannot be read, holds no samples, or lacks a marker that the set names.
    """
    known = formats(Trajectories)
    recording_names, truth_names = (file_names(stem, known) for stem in ("recording", "truth"))
    file = find_file(path, truth_names + recording_names)
    if file.name not in truth_names or Path(path) == file:
        warnings.warn(
            f"{path}: no noise-free truth, errors are measured to the captured samples, which "
            "may carry noise and impulses of their own",
            stacklevel=2,
        )
    return _read(path, file, known, marker_set, unit=unit, rate=rate, zeros_missing=zeros_missing)


@node("read.weights")
def read_weights(*, path: InputFile, rate: RateSetting = None) -> Weights:
    """Read weights of blendshapes over time: CSV of Live Link Face, other CSV, a plugin's format.

    In Live Link Face's, frames that the timecode skips are rows of NaN, and the columns of head
    and eye rotations, which are no weights, are left out. Another table has a column per shape,
    and a column ``time`` in seconds or a line ``# rate: 60``, as `write.weights_csv` writes it.

    Parameters
    ----------
    path
        A file, or a folder that holds ``weights.csv``.
    rate
        Frames per second. By default the file's own; a warning says both where they differ.

    Returns
    -------
    Weights
        With names as written, such as ``EyeBlinkLeft``.

    Raises
    ------
    ValueError
        If the file cannot be read or holds no frames.
    """
    known = formats(Weights)
    file = find_file(path, file_names("weights", known))
    weights: Weights = _value_of(file, known, rate=rate)
    if np.isnan(weights.values).all():
        warnings.warn(f"{path}: every weight is missing", stacklevel=2)
    return weights


@node("read.head")
def read_head(
    *,
    path: InputFile,
    marker_vertices: InputFile | None = None,
    unit: UnitSetting = AUTO,
) -> Head:
    """Read a head with its morph targets: a GLB file, OBJ files, or a plugin's format.

    Parameters
    ----------
    path
        A GLB file; an OBJ file, a head without morph targets; or a folder that holds ``head.glb``,
        or ``neutral.obj`` and an OBJ file per morph target, named as it is and with the same
        vertices and faces.
    marker_vertices
        A table ``marker,vertex`` (CSV), vertices counted from 0. By default
        ``marker_vertices.csv`` of the folder, or what a GLB file says itself, or no markers.
    unit
        Unit of length in the file. By default metres for GLB, as glTF has it, and millimetres for
        OBJ; but if the head would then be no 100 to 500 mm long, and is so in metres, centimetres
        or millimetres, then these, with a warning. A GLB file by this package is sure to be in
        metres.

    Returns
    -------
    Head
        In millimetres, in the axes of the file.

    Raises
    ------
    ValueError
        If a file cannot be read, or names a vertex that is not there.
    """
    known = formats(RawHead)
    file = find_file(path, _head_names(file_names("head", known)))
    raw: RawHead = _value_of(file, known, is_folder=Path(path) != file)
    table = _beside(Path(path), file, marker_vertices, _MARKER_VERTICES)
    if table is not None:
        raw = replace(raw, marker_vertices=read_marker_vertices(table, len(raw.vertices)))
    try:
        return raw.head(MILLIMETRES[_unit(file, raw, unit)])
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None


@node("read.animation")
def read_animation(
    *, path: InputFile, unit: UnitSetting = AUTO, rate: RateSetting = None
) -> Animation:
    """Read a head that moves: a GLB file with an animation, or a plugin's format.

    Its first animation is taken: the weights of the morph targets, and where the head is. Times
    begin at its first key.

    Parameters
    ----------
    path
        A file, or a folder that holds ``animation.glb``.
    unit
        Unit of length in the file, as of `read.head`.
    rate
        Frames per second, at which the animation is read. By default a frame per key.

    Returns
    -------
    Animation
        In millimetres, in the axes of the file.

    Raises
    ------
    ValueError
        If the file cannot be read, holds no animation that moves the head, or one that mirrors,
        stretches or shears it.
    """
    known = formats(RawAnimation)
    file = find_file(path, file_names("animation", known))
    raw: RawAnimation = _value_of(file, known, rate=rate)
    millimetres = MILLIMETRES[_unit(file, raw.head, unit)]
    motion = raw.motion
    values = np.array(list(raw.weights.values())).reshape(len(raw.weights), raw.frames).T
    return Animation(
        head=raw.head.head(millimetres),
        weights=Weights(values=values, names=tuple(raw.weights), rate=raw.rate),
        head_motion=motion and replace(motion, translations=motion.translations * millimetres),
    )


@node("read.model", synthetic=is_sample)
def read_model(*, path: InputFile, marker_set: InputFile | None = None) -> ModelAndNeutral:
    """Read a blendshape model: NPZ with ``neutral``, ``shapes``, ``shape_names``, ``markers``.

    Parameters
    ----------
    path
        A file, a folder that holds ``model.npz``, or ``sample:NAME``.
    marker_set
        A marker-set file (YAML) for `neutral`. By default ``markers.yaml`` of the folder, or none.

    Returns
    -------
    model : BlendshapeModel
        In millimetres.
    neutral : Trajectories
        The model's face at rest: a recording of one frame, its rate set to 1 Hz, with the marker
        set.

    Raises
    ------
    ValueError
        If the file cannot be read, or lacks a marker that the set names.
    """
    known = formats(BlendshapeModel)
    file = find_file(path, file_names("model", known))
    model, neutral = ModelAndNeutral.of(_value_of(file, known))
    return ModelAndNeutral(model, _with_marker_set(neutral, Path(path), file, marker_set))


@node("read.marker_set", synthetic=is_sample)
def read_marker_set(*, path: InputFile) -> MarkerSet:
    """Read a marker set: which markers are pairs, on the midline, stable, joined when drawn.

    Parameters
    ----------
    path
        A YAML file, a folder that holds ``markers.yaml``, or ``sample:NAME``.

    Returns
    -------
    MarkerSet
        As written; every name in it is one of its markers.

    Raises
    ------
    ValueError
        If the file is not of that form, with the place where it is not.
    """
    return read_marker_set_yaml(find_file(path, MARKER_SETS))


@node("read.marks")
def read_marks(*, path: InputFile) -> Marks:
    """Read what a person has marked in a take, or a mask: which samples are bad, named, swapped.

    Parameters
    ----------
    path
        A table (CSV) with columns ``marker``, ``start`` (the first frame, counted from 0),
        ``frames``, ``mark`` (``bad``, ``named`` or ``swapped``) and ``other`` (the other marker), a
        row per span, as `nodegraph view` keeps it beside a take; or without the last two columns,
        as `write.mask_csv` writes it: then all are bad.

    Returns
    -------
    Marks
        In the order of the rows.

    Raises
    ------
    ValueError
        If the file is not of that form, with the line where it is not.
    """
    known = formats(Marks)
    marks: Marks = _value_of(find_file(path, file_names("marks", known)), known)
    return marks


@node("read.selection")
def read_selection(*, path: InputFile) -> Selection:
    """Read which markers a method has chosen, as `write.selection_yaml` writes it.

    Parameters
    ----------
    path
        A YAML file, or a folder that holds ``selection.yaml``.

    Returns
    -------
    Selection
        As written.

    Raises
    ------
    ValueError
        If the file is not of that form.
    """
    return read_selection_yaml(find_file(path, SELECTIONS))


def _value_of(file: Path, formats: Sequence[Format], **settings: object) -> Any:
    """Return what a file holds; an error names the file."""
    read = format_of(file, formats).read
    try:
        return read(file, **settings)
    except ValueError as error:
        if str(file) in str(error):
            raise
        raise ValueError(f"{file}: {error}") from None


def format_of(file: Path, formats: Sequence[Format]) -> Format:
    """Return the first format that recognizes a file's content, or else has its suffix.

    Raises
    ------
    ValueError
        If there is none; the message lists the formats.
    """
    match = next(iter(matching_formats(file, formats)), None)
    if match is None:
        known = ", ".join(f"{each.name} ({', '.join(each.suffixes)})" for each in formats)
        other = other_format(_start_of(file))
        what = f"it is {other}" if other else "unknown format"
        raise ValueError(f"{file}: {what}; there is {known or 'none'}")
    return match


def matching_formats(file: Path, formats: Sequence[Format]) -> list[Format]:
    """Return the formats that recognize a file's content, then those that have its suffix."""
    start = _start_of(file)
    by_content = [each for each in formats if each.recognizes(start)]
    by_suffix = [each for each in formats if file.suffix.lower() in each.suffixes]
    return list(dict.fromkeys(by_content + by_suffix))


def _start_of(file: Path) -> bytes:
    with file.open("rb") as stream:
        return stream.read(_START)


def file_names(stem: str, formats: Sequence[Format]) -> tuple[str, ...]:
    """Return the names of the files that a reader takes from a folder, one per first suffix."""
    return tuple(dict.fromkeys(stem + each.suffixes[0] for each in formats))


def _beside(path: Path, file: Path, named: Path | None, wanted: tuple[str, ...]) -> Path | None:
    """Return another file that says more of one, or None.

    Parameters
    ----------
    path
        The path that the user named.
    file
        The file that this led to. One beside it counts only if the user named the folder: results
        are stored by the content of what is named, and by nothing else.
    named
        The other file, if the user named it.
    wanted
        Its names.
    """
    if named is not None:
        return find_file(named, wanted)
    beside = file.parent / wanted[0]
    return beside if path != file and beside.is_file() else None


def _with_marker_set(
    recording: Trajectories, path: Path, file: Path, named: Path | None
) -> Trajectories:
    """Return what was read from a file with the marker set that is named or lies beside it."""
    beside = _beside(path, file, named, MARKER_SETS)
    marker_set = read_marker_set_yaml(beside) if beside else None
    try:
        return with_marker_set(recording, marker_set)
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None


def _check_recording(path: Path, recording: Trajectories) -> None:
    if not recording.frames or not recording.markers:
        raise ValueError(f"{path}: the recording holds no samples")
    if not _SLOW <= recording.rate <= _FAST:
        warnings.warn(
            f"{path}: a rate of {recording.rate:g} Hz, at which no motion is captured; set `rate`?",
            stacklevel=3,
        )
    if not recording.present.any():
        warnings.warn(f"{path}: every sample of the recording is missing", stacklevel=3)
        return
    # fmax and fmin pass over NaN, and need no array of their own
    ends = np.fmax.reduce(recording.positions, None), np.fmin.reduce(recording.positions, None)
    farthest = max(map(abs, ends))
    if farthest > _FARTHEST:
        frame, marker, _ = np.argwhere(np.abs(recording.positions) == farthest)[0]
        raise ValueError(
            f"{path}: frame {frame}, marker {quoted(recording.markers[marker])}: a position at "
            f"{farthest:g} mm; up to {_FARTHEST:g} mm is possible"
        )
    extent = extent_of(recording.positions)
    if np.isfinite(extent) and not FACE_OR_BODY.includes(extent, "mm"):
        warnings.warn(
            f"{path}: the markers span {extent:.4g} mm, which no face or body does; set `unit`?",
            stacklevel=3,
        )


def _head_names(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names with that of the head at rest before ``head.obj``, perhaps a target's."""
    at = names.index("head.obj") if "head.obj" in names else len(names)
    return (*names[:at], NEUTRAL, *names[at:])


def _unit(file: Path, raw: RawHead, setting: str) -> str:
    if setting != AUTO:
        return unit_of_mesh(file, raw.extent, assumed=setting, stated=True)
    unit = unit_of_mesh(file, raw.extent, assumed=raw.unit, stated=raw.unit_stated)
    if file.suffix.lower() == ".obj":
        warnings.warn(f"{file}: OBJ states no unit of length; {unit} is taken", stacklevel=3)
    return unit
