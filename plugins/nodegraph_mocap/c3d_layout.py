"""What a C3D file says about itself, checked before the library reads it.

The library trusts a file: one with a broken parameter section ends the whole process, one that
was cut short comes back shorter, and one whose header and parameters disagree comes back with
shifted numbers, all without a word. The layout is that of the C3D file format user guide
(https://www.c3d.org): a header of one block, a parameter section, then the samples.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

BLOCK = 512
INTEL, DEC, MIPS = 84, 85, 86
ENTRY_SIZES = {-1: 1, 1: 1, 2: 2, 4: 4}
COUNT_LIMIT = 0xFFFF
LARGEST_SECTION = 256 * BLOCK
NEEDED = {
    "POINT": ("USED", "SCALE", "RATE", "DATA_START", "FRAMES"),
    "ANALOG": ("USED", "GEN_SCALE", "RATE"),
    "ROTATION": ("USED", "RATIO", "RATE", "DATA_START"),
    "FORCE_PLATFORM": ("USED",),
}


@dataclass(frozen=True)
class Parameter:
    """One entry of the parameter section: its kind (-1 text, 1, 2, 4), shape and raw bytes."""

    kind: int
    shape: tuple[int, ...]
    data: bytes

    def number(self, processor: int) -> float:
        """Return the first number; the parameter holds one."""
        if self.kind == 4:
            return _float(self.data[:4], processor)
        return float(int.from_bytes(self.data[: ENTRY_SIZES[self.kind]], "little"))


@dataclass(frozen=True)
class Layout:
    """How many samples a file announces, and where they lie.

    Attributes
    ----------
    points, frames : int
    values : int
        Analog values per frame.
    data_start : int
        Byte at which the samples start.
    width : int
        Bytes per number, 2 or 4.
    """

    points: int
    frames: int
    values: int
    data_start: int
    width: int

    @property
    def end(self) -> int:
        """Byte after the last sample."""
        per_frame = (4 * self.points + self.values) * self.width
        return self.data_start + self.frames * per_frame


def check_layout(path: Path) -> None:
    """Refuse a C3D file that the library would not read as it was written.

    Raises
    ------
    ValueError
        With the path and the reason.
    """
    size = path.stat().st_size
    with path.open("rb") as stream:
        top = stream.read(BLOCK + LARGEST_SECTION + BLOCK)
    try:
        _check(top, size)
    except ValueError as error:
        raise ValueError(f"{path}: not a readable C3D file: {error}") from None


def _check(top: bytes, size: int) -> None:
    if len(top) < BLOCK or top[1] != 0x50:
        raise ValueError("it does not start with a C3D header")
    start = (top[0] - 1) * BLOCK
    if start < BLOCK or start + BLOCK > len(top):
        raise ValueError("it ends before its parameter section")
    processor = top[start + 3]
    if processor not in (INTEL, DEC):
        kind = "big-endian (MIPS)" if processor == MIPS else f"of unknown kind {processor}"
        raise ValueError(f"its numbers are {kind}; convert it to little-endian (Intel)")
    parameters = _parameters(top, start)
    _check_needed(parameters)
    header = _header_layout(top, processor)
    announced = _announced_layout(parameters, header, processor)
    _check_counts(announced, header, parameters, processor)
    _check_size(announced, header, size)
    _check_rotations(parameters, announced, size, processor)


def _header_layout(top: bytes, processor: int) -> Layout:
    points, values, first, last, _ = struct.unpack("<5H", top[2:12])
    scale = _float(top[12:16], processor)
    block = int.from_bytes(top[16:18], "little")
    frames = max(0, last - first + 1)
    return Layout(points, frames, values, (block - 1) * BLOCK, 4 if scale < 0 else 2)


def _announced_layout(
    parameters: Mapping[tuple[str, str], Parameter], header: Layout, processor: int
) -> Layout:
    def number(group: str, name: str, otherwise: float) -> float:
        found = parameters.get((group, name))
        return otherwise if found is None else found.number(processor)

    rate = number("POINT", "RATE", 0.0)
    analog_rate = number("ANALOG", "RATE", 0.0)
    steps = round(analog_rate / rate) if rate > 0 and 0 <= analog_rate / rate < 1e6 else 0
    scale = number("POINT", "SCALE", -1.0 if header.width == 4 else 1.0)
    return Layout(
        points=int(number("POINT", "USED", header.points)),
        frames=int(number("POINT", "FRAMES", header.frames)),
        values=int(number("ANALOG", "USED", 0)) * steps,
        data_start=header.data_start,
        width=4 if scale < 0 else 2,
    )


def _check_counts(
    announced: Layout,
    header: Layout,
    parameters: Mapping[tuple[str, str], Parameter],
    processor: int,
) -> None:
    if ("POINT", "USED") not in parameters:
        raise ValueError("it has no POINT:USED")
    longer = parameters.get(("POINT", "LONG_FRAMES"))
    frames = longer.number(processor) if longer and longer.data else announced.frames
    if max(frames, header.frames) >= COUNT_LIMIT:
        raise ValueError(
            f"it may hold more frames than the {COUNT_LIMIT - 1} that can be counted; "
            "cut it into shorter takes, or export CSV"
        )
    if header.data_start < BLOCK + BLOCK:
        raise ValueError(f"its samples would start at byte {header.data_start}")
    if header.width != announced.width:
        raise ValueError("its header and POINT:SCALE disagree whether samples are integers")


def _check_size(announced: Layout, header: Layout, size: int) -> None:
    """Compare with the size, which also decides where header and parameters disagree."""
    if announced.end > size:
        raise ValueError(
            f"it announces {announced.frames} frames of {announced.points} points, which end at "
            f"byte {announced.end}, but it has {size} bytes: cut short, or damaged"
        )
    if announced != header and size - announced.end >= BLOCK:
        raise ValueError(
            f"its header tells of {_told(header)}, its parameters of {_told(announced)}, and "
            f"its {size} bytes do not show which is right"
        )


def _told(layout: Layout) -> str:
    return f"{layout.frames} frames x ({layout.points} points, {layout.values} analog values)"


def _check_rotations(
    parameters: Mapping[tuple[str, str], Parameter], layout: Layout, size: int, processor: int
) -> None:
    used = parameters.get(("ROTATION", "USED"))
    ratio = parameters.get(("ROTATION", "RATIO"))
    if used and ratio:
        count = used.number(processor) * ratio.number(processor) * layout.frames
        if count * 17 * layout.width > size:
            raise ValueError("it announces more rotations than it has bytes")


def _check_needed(parameters: Mapping[tuple[str, str], Parameter]) -> None:
    for group, names in NEEDED.items():
        for name in names:
            found = parameters.get((group, name))
            if found is not None and (found.kind == -1 or not found.data):
                raise ValueError(f"{group}:{name} holds no number")


def _parameters(top: bytes, start: int) -> dict[tuple[str, str], Parameter]:
    """Walk the parameter section; every entry must lie inside the file."""
    groups: dict[int, str] = {}
    found: dict[tuple[int, str], Parameter] = {}
    for number, name, body in _entries(top, start + 4):
        if number < 0:
            groups[-number] = name
        else:
            found[number, name] = _parameter(name, body)
    orphans = sorted({name for number, name in found if number not in groups})
    if orphans:
        raise ValueError(f"parameters without a group: {', '.join(orphans)}")
    return {(groups[number], name): value for (number, name), value in found.items()}


def _entries(top: bytes, place: int) -> Iterator[tuple[int, str, bytes]]:
    while True:
        if place + 2 > len(top):
            raise ValueError("its parameter section has no end")
        length, number = struct.unpack("<bb", top[place : place + 2])
        if length == 0:
            return
        after_name = place + 2 + abs(length)
        body = after_name + 2
        step = int.from_bytes(top[after_name:body], "little")
        end = after_name + step if step else len(top)
        if number == 0 or body > len(top) or end > len(top) or 0 < step < 3:
            raise ValueError(f"its parameter section is damaged at byte {place}")
        yield number, top[place + 2 : after_name].decode("latin-1").upper(), top[body:end]
        if step == 0:
            return
        place = end


def _parameter(name: str, body: bytes) -> Parameter:
    kind = struct.unpack("<b", body[:1])[0] if body else 0
    rank = body[1] if len(body) > 1 else 0
    shape = tuple(body[2 : 2 + rank])
    data_start = 2 + rank
    length = math.prod(shape) * ENTRY_SIZES.get(kind, 0)
    if kind not in ENTRY_SIZES or len(shape) < rank or data_start + length > len(body):
        raise ValueError(f"parameter {name} is damaged")
    return Parameter(kind, shape, body[data_start : data_start + length])


def _float(data: bytes, processor: int) -> float:
    if processor == DEC:
        # DEC stores the two halves the other way round, and an exponent that is larger by two.
        return float(_unpacked(data[2:] + data[:2])) / 4
    return float(_unpacked(data))


def _unpacked(data: bytes) -> Any:
    return struct.unpack("<f", data)[0]
