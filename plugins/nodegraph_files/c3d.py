"""Recordings in C3D files, read and written here.

ezc3d 1.7, which reads what is written here, is not used for either. Its reader ends the process
on some damaged files, and returns fewer frames from a file that was cut short and shifted numbers
from one whose header and parameters disagree, all without a word. Its writer does not say how
many frames there are where they are more than 65535, so that no program reads the rest. Both take
some ten times the memory of the samples. What both can read is equal bit for bit.
"""

from __future__ import annotations

import struct
import warnings
from collections import Counter
from collections.abc import Iterable, Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from nodegraph import Format, quoted
from nodegraph_files.c3d_header import (
    BLOCK,
    FLOAT,
    INTEGER,
    INTEL,
    LARGEST_COUNT,
    TEXT,
    Description,
    Parameters,
    read_description,
)
from nodegraph_files.marker_names import unique_names
from nodegraph_files.missing import mark_missing
from nodegraph_files.rates import rate_from
from nodegraph_files.units import AUTO, BODY, FACE, extent_of, unit_from
from nodegraph_mocap.frame_ranges import chunks
from nodegraph_mocap.recording import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


MOST_FRAMES = 2**24
"""Up to here a 32-bit floating-point number, `LONG_FRAMES`, counts every frame."""
LONGEST_NAME = 127
_MOST_BLOCKS = 255
_MOST_TEXTS = 255


def c3d_head(markers: Sequence[str], frames: int, rate: float) -> bytes:
    """Return header and parameters, in whole blocks; 32-bit samples are to follow.

    Raises
    ------
    ValueError
        If the names need more room than there is.
    """
    blocks = -(-len(_section(markers, frames, rate, 0, 0)) // BLOCK)
    if blocks > _MOST_BLOCKS:
        raise ValueError(f"C3D cannot hold the names of {len(markers)} markers; write CSV or NPZ")
    start = 2 + blocks
    counted = min(frames, LARGEST_COUNT)
    header = struct.pack(
        "<BBHHHHHfHHf", 2, 0x50, len(markers), 0, 1, counted, 0, -1.0, start, 0, rate
    )
    section = _section(markers, frames, rate, blocks, start)
    return header.ljust(BLOCK, b"\0") + section.ljust(blocks * BLOCK, b"\0")


def _section(markers: Sequence[str], frames: int, rate: float, blocks: int, start: int) -> bytes:
    point = [
        _number("USED", len(markers)),
        _number("SCALE", -1.0),
        _number("RATE", rate),
        _number("DATA_START", start),
        _number("FRAMES", min(frames, LARGEST_COUNT)),
        _texts("UNITS", ["mm"]),
        *_lists("LABELS", markers),
        *_lists("DESCRIPTIONS", [" "] * len(markers)),
    ]
    # Programs expect these groups, though there is nothing to say.
    groups = {
        "POINT": point,
        "ANALOG": [_number("USED", 0), _number("GEN_SCALE", 1.0), _number("RATE", 0.0)],
        "FORCE_PLATFORM": [_number("USED", 0)],
    }
    if frames >= LARGEST_COUNT:
        point.append(_number("LONG_FRAMES", float(frames)))
        groups["TRIAL"] = [_long("ACTUAL_START_FIELD", 1), _long("ACTUAL_END_FIELD", frames)]
    entries = b"".join(
        _group(name, number, parts) for number, (name, parts) in enumerate(groups.items(), 1)
    )
    return struct.pack("<4B", 1, 0x50, blocks, INTEL) + entries + b"\0\0"


_Part = tuple[str, bytes]
"""A parameter's name, and what follows it: kind, shape and data."""


def _group(name: str, number: int, parts: Iterable[_Part]) -> bytes:
    return _entry(name, -number, b"") + b"".join(_entry(key, number, body) for key, body in parts)


def _entry(name: str, number: int, body: bytes) -> bytes:
    """Return an entry: its name, how far the next one is, its body and no description."""
    text = name.encode()
    step = struct.pack("<H", len(body) + 3)
    return struct.pack("<bb", len(text), number) + text + step + body + b"\0"


def _number(name: str, value: float) -> _Part:
    kind, code = (FLOAT, "f") if isinstance(value, float) else (INTEGER, "H")
    return name, struct.pack(f"<bB{code}", kind, 0, value)


def _long(name: str, value: int) -> _Part:
    """Return a count as two 16-bit words, the lower first."""
    return name, struct.pack("<bBBI", INTEGER, 1, 2, value)


def _texts(name: str, texts: Sequence[str]) -> _Part:
    raw = [text.encode() for text in texts]
    width = max(map(len, raw))
    data = b"".join(text.ljust(width) for text in raw)
    return name, struct.pack("<bBBB", TEXT, 2, width, len(raw)) + data


def _lists(name: str, texts: Sequence[str]) -> Iterable[_Part]:
    """Yield the texts as NAME, NAME2, ..., because an entry counts up to 255."""
    for number, first in enumerate(range(0, len(texts), _MOST_TEXTS), 1):
        part = texts[first : first + _MOST_TEXTS]
        yield _texts(name if number == 1 else f"{name}{number}", part)


_LARGEST = float(np.finfo(np.float32).max)


_MODEL_OUTPUTS = (
    "ANGLES", "FORCES", "MOMENTS", "POWERS", "SCALARS", "REACTIONS", "MODELED_MARKERS"
)  # fmt: skip
"""Parameters that list points which a model computed; TYPE_GROUPS may name others."""


def read_c3d(
    path: Path, *, zeros_missing: bool = True, unit: str = AUTO, rate: float | None = None
) -> Trajectories:
    """Read the markers of a C3D file; analog channels and events are left out.

    Points that a model computed, such as the angles, forces, moments and powers of joints, are
    left out too, with a warning that counts them: those that the parameters POINT:ANGLES,
    POINT:FORCES and their like list, or others that POINT:TYPE_GROUPS names.

    Warnings also say how many samples were partly missing or infinite, which markers lacked a name
    or shared one, that the unit of length is unknown, where header and parameters contradict each
    other, and how many frames there are where the file was cut short. Of two scales of integers,
    that of the parameters counts, unless only the other makes the markers as large as a face or a
    body.

    Parameters
    ----------
    path
        The file.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing.
    unit
        Unit of length, such as ``cm``; by default what the parameter POINT:UNITS states.
    rate
        Hz; by default what the parameter POINT:RATE states, or else the header.

    Returns
    -------
    Trajectories
        In millimetres; a sample whose residual is negative is missing. A subject's prefix
        (``subject:marker``) that all markers share is taken off their names.

    Raises
    ------
    ValueError
        If it is not a C3D file, is damaged or cut short within the first frame, has no rate, or
        holds no frames or no markers.
    """
    try:
        description = read_description(path)
        labels, points = _markers(description)
        positions, lost = _samples(path, description, points)
        used_rate = rate_from(rate, description.rate)
        if used_rate is None:
            raise ValueError("no positive number is its rate; set `rate` in Hz")
    except ValueError as error:
        raise ValueError(f"{path}: not a readable C3D recording: {error}") from None
    markers = unique_names(labels, positions.shape[1])
    positions = mark_missing(positions, lost, markers, zeros_missing=zeros_missing)
    length_unit = unit_from(unit, "".join(_texts_of(description.parameters, "UNITS")[:1]))
    if description.scales:
        positions *= _scale(description.scales, extent_of(positions), length_unit.name)
    length_unit.convert(positions)
    return Trajectories(
        positions=positions,
        markers=markers,
        rate=used_rate,
    )


def write_c3d(recording: Trajectories, path: Path) -> None:
    """Write a recording as a C3D file; see `c3d_bytes`."""
    head = _head(recording)
    with path.open("wb") as stream:
        _write(recording, head, stream)


def c3d_bytes(recording: Trajectories) -> bytes:
    """Return a recording as C3D: millimetres in 32 bits, missing samples with residual -1.

    Raises
    ------
    ValueError
        If it has more frames, or more or longer names, than the format can hold, or a rate or a
        position that 32 bits cannot.
    """
    stream = BytesIO()
    _write(recording, _head(recording), stream)
    return stream.getvalue()


def _markers(description: Description) -> tuple[list[str], list[int]]:
    """Return the labels, and which points are markers and no results of a model.

    Raises
    ------
    ValueError
        If there are no frames, or none is a marker.
    """
    layout, parameters = description.layout, description.parameters
    held = f"it holds {layout.frames} frames of {layout.points} points"
    if not layout.frames or not layout.points:
        raise ValueError(held)
    types = (*_MODEL_OUTPUTS, *_texts_of(parameters, "TYPE_GROUPS")[::2])
    type_of = {label: each for each in types for label in _texts_of(parameters, each) if label}
    labels = _texts_of(parameters, "LABELS")
    points = range(layout.points)
    computed = {
        place: type_of[label]
        for place, label in zip(points, labels, strict=False)
        if label in type_of
    }
    markers = [place for place in points if place not in computed]
    counts = Counter(computed.values())
    left_out = ", ".join(f"{count} {each}" for each, count in counts.items())
    if not markers:
        raise ValueError(f"{held}, none of them a marker: {left_out}")
    if left_out:
        warnings.warn(
            f"{counts.total()} of {layout.points} points are results of a model, not markers, and "
            f"were left out: {left_out}",
            stacklevel=3,
        )
    there = [labels[place] for place in markers if place < len(labels)]
    return [*there, *labels[layout.points :]], markers


def _samples(
    path: Path, description: Description, points: Sequence[int]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return (T, M, 3) positions as they are stored, and (T, M) whether they are missing."""
    layout = description.layout
    positions = np.empty((layout.frames, len(points), 3))
    lost = np.empty((layout.frames, len(points)), dtype=np.bool_)
    # A NaN of the kind that is to give an alarm gives one; it is counted as a missing coordinate.
    with path.open("rb") as stream, np.errstate(invalid="ignore"):
        stream.seek(layout.start)
        for piece in chunks(layout.frames, layout.frame_bytes):
            content = stream.read((piece.stop - piece.start) * layout.frame_bytes)
            numbers = _numbers(content, description)
            if len(points) < layout.points:
                numbers = numbers[:, points]  # a copy
            for axis in range(3):
                positions[piece, :, axis] = numbers[..., axis]
            np.less(numbers[..., 3], 0, out=lost[piece])
    return positions, lost


def _scale(scales: tuple[float, ...], extent: float, unit: str) -> float:
    """Return the first scale, or the first that makes the markers as large as a face or a body.

    Parameters
    ----------
    scales
        The scale of the parameters, then that of the header.
    extent
        Extent of the markers, in integers.
    unit
        Unit of length, once they are scaled.
    """
    plausible = (
        scale
        for scale in scales
        if any(size.includes(extent * scale, unit) for size in (FACE, BODY))
    )
    chosen = next(plausible, scales[0])
    if len(scales) > 1:
        size = f": markers span {extent * chosen:.4g} {unit}" if np.isfinite(extent) else ""
        warnings.warn(
            f"the file's parameters give a scale of {scales[0]:g}, its header {scales[1]:g}; "
            f"{chosen:g} is taken{size}",
            stacklevel=3,
        )
    return chosen


def _numbers(content: bytes, description: Description) -> NDArray[np.generic]:
    """Return (frames, M, 4): x, y, z as they are stored, and what is negative when missing."""
    layout, processor = description.layout, description.processor
    frames = np.frombuffer(content, np.uint8).reshape(-1, layout.frame_bytes)
    points = np.ascontiguousarray(frames[:, : 4 * layout.points * layout.width]).data
    numbers = processor.floats(points) if layout.width == 4 else processor.integers(points)
    return numbers.reshape(len(frames), layout.points, 4)


def _texts_of(parameters: Parameters, name: str) -> list[str]:
    """Return POINT:NAME, NAME2, ... as one list."""
    texts: list[str] = []
    each, number = name, 2
    while parameter := parameters.get(("POINT", each)):
        texts += parameter.texts
        each, number = f"{name}{number}", number + 1
    return texts


def _head(recording: Trajectories) -> bytes:
    """Return the header and parameters, for a recording that the format can hold."""
    if not 0 < recording.frames <= MOST_FRAMES or not recording.markers:
        raise ValueError(
            f"C3D holds 1 to {MOST_FRAMES} frames of at least one marker, not "
            f"{recording.frames} of {len(recording.markers)}; write CSV or NPZ"
        )
    for name in recording.markers:
        fits = name.isprintable() and 0 < len(name.encode()) <= LONGEST_NAME
        if not fits or name != name.strip():
            raise ValueError(
                f"C3D cannot keep the marker name {quoted(name)}: 1 to {LONGEST_NAME} bytes that "
                "are printed, no spaces around it"
            )
    # fmax and fmin pass over NaN, and need no array of their own
    ends = np.fmax.reduce(recording.positions, None), np.fmin.reduce(recording.positions, None)
    if max(map(abs, ends)) > _LARGEST:
        raise ValueError("a position is beyond the 32-bit numbers of C3D")
    return c3d_head(recording.markers, recording.frames, recording.rate)


def _write(recording: Trajectories, head: bytes, stream: BinaryIO) -> None:
    stream.write(head)
    written = 0
    for piece in chunks(recording.frames, 16 * len(recording.markers)):
        missing = recording.origin[piece] == Origin.MISSING
        samples = np.zeros((*missing.shape, 4), dtype="<f4")
        samples[..., :3] = recording.positions[piece]
        # Zeros, because many programs do not expect NaN in a file.
        samples[missing] = 0, 0, 0, -1
        written += stream.write(samples.data)
    # In a longer take ezc3d counts the frames by the file's size; filling up the last block would
    # give it some that are not there.
    if recording.frames < LARGEST_COUNT:
        stream.write(bytes(-written % BLOCK))


def _is_c3d(start: bytes) -> bool:
    # a small number comes first, which text with a P in second place does not begin with
    return start[1:2] == b"\x50" and start[0] < 0x20


FORMAT = Format("C3D", Trajectories, (".c3d",), read_c3d, _is_c3d)
