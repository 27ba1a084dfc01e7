"""The header and the parameters of a C3D file: where its samples lie, and their form.

A C3D file says most things twice, in its header and in its parameters, and writers do not
always keep the two equal. The size of the file settles which is right; where it does not, the
file is refused, because a wrong guess would shift every number. Where the two agree on more frames
than the file holds, those that it holds are read, with a warning. Of two rates, that of the
parameters counts, if it is one, with a warning; of two scales, see `nodegraph_files.c3d.read_c3d`.
"""

from __future__ import annotations

import itertools
import math
import struct
import warnings
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import quoted
from nodegraph_files.text.text_file import other_format

if TYPE_CHECKING:
    from numpy.typing import NDArray


BLOCK = 512
INTEL, DEC, MIPS = 84, 85, 86
TEXT, BYTE, INTEGER, FLOAT = -1, 1, 2, 4


@dataclass(frozen=True)
class Processor:
    """The number format of the machine that wrote a file."""

    code: int

    def __post_init__(self) -> None:
        if self.code not in (INTEL, DEC, MIPS):
            raise ValueError(f"it was written by a processor of unknown kind {self.code}")

    @property
    def order(self) -> str:
        """Byte order, as `struct` and NumPy write it."""
        return ">" if self.code == MIPS else "<"

    def integer(self, data: bytes) -> int:
        """Return an unsigned integer."""
        return int.from_bytes(data, "big" if self.code == MIPS else "little")

    def integers(self, data: bytes | memoryview) -> NDArray[np.int16]:
        """Return 16-bit signed integers."""
        return np.frombuffer(data, f"{self.order}i2")

    def floats(self, data: bytes | memoryview) -> NDArray[np.floating]:
        """Return 32-bit floating-point numbers.

        DEC stores the two halves of a number the other way round, and an exponent that is
        larger by two.
        """
        if self.code == DEC:
            halves = np.frombuffer(data, "<u2").reshape(-1, 2)[:, ::-1]
            with np.errstate(invalid="ignore"):  # of bits that are not numbers
                return halves.copy().view("<f4").ravel().astype(np.float64) / 4
        return np.frombuffer(data, f"{self.order}f4")


@dataclass(frozen=True)
class Parameter:
    """One entry: its kind (`TEXT`, `BYTE`, `INTEGER`, `FLOAT`), its shape and its bytes."""

    kind: int
    shape: tuple[int, ...]
    data: bytes
    processor: Processor

    @property
    def numbers(self) -> tuple[float, ...]:
        """Its values; integers count from 0 to 65535, texts have none."""
        if self.kind == FLOAT:
            return tuple(self.processor.floats(self.data).tolist())
        if self.kind == TEXT:
            return ()
        pieces = range(0, len(self.data), self.kind)
        return tuple(float(self.processor.integer(self.data[at : at + self.kind])) for at in pieces)

    @property
    def texts(self) -> tuple[str, ...]:
        """Its texts, without the spaces that pad them; numbers have none."""
        if self.kind != TEXT or not self.data:
            return ()
        width = self.shape[0] if self.shape else 1
        pieces = range(0, len(self.data), width)
        return tuple(_text(self.data[at : at + width]) for at in pieces)


Parameters = Mapping[tuple[str, str], Parameter]
"""Entries by group and name, both in capitals."""


def read_parameters(content: bytes, start: int, samples: int = 0) -> Parameters:
    """Read the section that starts at that byte.

    It ends with an entry that says that it is the last, or else where it says itself or where the
    samples start, whichever is later: writers get each of these wrong.

    Parameters
    ----------
    content
        The content of the file, from its first byte.
    start
        Byte at which the section starts.
    samples
        Byte at which, by the header, the samples start; 0 if it does not say.

    Raises
    ------
    ValueError
        If it is damaged.
    """
    processor = Processor(content[start + 3])
    groups: dict[int, str] = {}
    parameters: dict[tuple[int, str], Parameter] = {}
    end = max(start + content[start + 2] * BLOCK, samples)
    for place, number, name, body in _entries(content, start + 4, end, processor):
        if number < 0:
            groups[-number] = name
        else:
            parameters[number, name] = _parameter(body, place, processor)
    return {
        (groups[number], name): value
        for (number, name), value in parameters.items()
        if number in groups
    }


def _entries(
    content: bytes, place: int, last: int, processor: Processor
) -> Iterator[tuple[int, int, str, bytes]]:
    """Yield place, number, name and body of the entries up to the byte `last`."""
    is_cut = len(content) < last
    content = content[:last]
    while place + 2 <= len(content):
        length, number = struct.unpack("<bb", content[place : place + 2])
        if length == 0:
            return
        step_at = place + 2 + abs(length)
        step = processor.integer(content[step_at : step_at + 2])
        end = step_at + step if step else len(content)
        # of the last entry, some writers give a distance beyond the section
        if end > len(content) and not is_cut:
            end = len(content)
        if number == 0 or step_at + 2 >= len(content) or end > len(content) or 0 < step < 3:
            raise ValueError(f"its parameter section is damaged at byte {place}")
        name = _text(content[place + 2 : step_at]).upper()
        yield place, number, name, content[step_at + 2 : end]
        if step == 0:
            return
        place = end
    if is_cut:
        raise ValueError("its parameter section has no end")


def _parameter(body: bytes, place: int, processor: Processor) -> Parameter:
    kind = struct.unpack("<b", body[:1])[0]
    rank = body[1] if len(body) > 1 else 0
    shape = tuple(body[2 : 2 + rank])
    length = math.prod(shape) * abs(kind)
    data = body[2 + rank : 2 + rank + length]
    if kind not in (TEXT, BYTE, INTEGER, FLOAT) or len(shape) < rank or len(data) < length:
        raise ValueError(f"the parameter at byte {place} is damaged")
    return Parameter(kind, shape, data, processor)


def _text(data: bytes) -> str:
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return text.strip(" \0\t\r\n")


LARGEST_COUNT = 0xFFFF
LARGEST_SECTION = 256 * BLOCK


@dataclass(frozen=True)
class ByteLayout:
    """One account of how many samples a file holds and where they lie.

    Attributes
    ----------
    frames, points : int
    values : int
        Analog values per frame.
    start : int
        Byte at which the samples start.
    width : int
        Bytes per number: 2, integers to be scaled, or 4.
    """

    frames: int
    points: int
    values: int
    start: int
    width: int

    @property
    def frame_bytes(self) -> int:
        """Bytes of one frame."""
        return (4 * self.points + self.values) * self.width

    @property
    def end(self) -> int:
        """Byte after the last sample."""
        return self.start + self.frames * self.frame_bytes

    def __str__(self) -> str:
        return (
            f"{self.frames} frames x ({self.points} points, {self.values} analog values) of "
            f"{self.width} bytes from byte {self.start}"
        )


@dataclass(frozen=True)
class Description:
    """The description of a C3D file's samples by its header and parameters.

    Attributes
    ----------
    layout : ByteLayout
    parameters : mapping of group and name to Parameter
    processor : Processor
    rate : float or None
        Hz, if the file gives a positive number.
    scales : tuple of float
        Factors of integers: that of the parameters first, and that of the header if
        it is another. None where samples are not integers.
    """

    layout: ByteLayout
    parameters: Parameters
    processor: Processor
    rate: float | None
    scales: tuple[float, ...]


@dataclass(frozen=True)
class _Header:
    points: int
    values: int
    frames: int
    scale: float
    start_block: int
    rate: float


def read_description(path: Path) -> Description:
    """Read header and parameters, and decide where they disagree.

    Raises
    ------
    ValueError
        If the file is not a C3D file, is damaged, or is shorter than it says.
    """
    size = path.stat().st_size
    with path.open("rb") as stream:
        content = stream.read(LARGEST_SECTION)
    if content[1:2] != b"\x50":
        raise ValueError(f"{_what_it_is(content)}; the second byte of C3D is 0x50")
    if len(content) < BLOCK:
        raise ValueError("it ends before its header does")
    section = (content[0] - 1) * BLOCK
    if section < BLOCK or section + 4 > len(content):
        raise ValueError("it ends before its parameters, or they are not where it says")
    processor = Processor(content[section + 3])
    header = _header(content, processor)
    parameters = read_parameters(content, section, (header.start_block - 1) * BLOCK)
    layout = _settle(list(_accounts(header, parameters)), size)
    return Description(
        layout=layout,
        parameters=parameters,
        processor=processor,
        rate=_rate(header, parameters),
        scales=_scales(header, parameters, layout.width),
    )


def _what_it_is(content: bytes) -> str:
    """Return what a file is that does not begin as C3D does, as far as its first bytes tell."""
    if other := other_format(content):
        return f"it is {other}"
    first = content[:BLOCK].split(b"\n", maxsplit=1)[0]
    if first and all(0x20 <= byte < 0x7F or byte in b"\t\r" for byte in first):
        return f"it is text, and begins with {quoted(first.decode().strip())}"
    return f"it begins with the bytes {content[:4].hex(' ')}"


def _header(content: bytes, processor: Processor) -> _Header:
    order = processor.order
    points, values, first, last = struct.unpack(f"{order}4H", content[2:10])
    scale, rate = processor.floats(content[12:16] + content[20:24])
    start = processor.integer(content[16:18])
    return _Header(points, values, last - first + 1, float(scale), start, float(rate))


def _accounts(header: _Header, parameters: Parameters) -> Iterable[ByteLayout]:
    """Yield every combination of what header and parameters say, the parameters' first."""

    def claimed(group: str, name: str, also: float) -> list[float]:
        return _unlike(_number(parameters, group, name), also)

    claims = itertools.product(
        _frames(header, parameters),
        claimed("POINT", "USED", header.points),
        _unlike(_analog_values(parameters), header.values),
        claimed("POINT", "DATA_START", header.start_block),
        _unlike(*(_width(scale) for scale in claimed("POINT", "SCALE", header.scale))),
    )
    for frames, points, values, block, width in claims:
        start = (int(block) - 1) * BLOCK
        if start >= 2 * BLOCK and points >= 0 and values >= 0:
            yield ByteLayout(int(frames), int(points), int(values), start, int(width))


def _frames(header: _Header, parameters: Parameters) -> list[float]:
    first = _whole(parameters, "TRIAL", "ACTUAL_START_FIELD")
    last = _whole(parameters, "TRIAL", "ACTUAL_END_FIELD")
    trial = last - first + 1 if first is not None and last is not None else None
    longer = _number(parameters, "POINT", "LONG_FRAMES")
    counted = _number(parameters, "POINT", "FRAMES")
    counts = _unlike(longer, trial, counted, header.frames)
    if max(counts) > LARGEST_COUNT:
        # The old counters cannot hold as many; that they are full is not a disagreement.
        counts = [count for count in counts if count != LARGEST_COUNT]
    return [count for count in counts if 0 <= count < 2**31] or [0]


def _analog_values(parameters: Parameters) -> float:
    """Return the analog values per frame: channels times samples per frame."""
    used = _number(parameters, "ANALOG", "USED") or 0
    rate = _number(parameters, "POINT", "RATE") or 0
    analog_rate = _number(parameters, "ANALOG", "RATE") or 0
    return used * round(analog_rate / rate) if rate > 0 else 0


def _settle(accounts: list[ByteLayout], size: int) -> ByteLayout:
    if not accounts:
        raise ValueError("it does not say where its samples start")
    if len(accounts) == 1:
        return _checked(accounts[0], size)
    fitting = [account for account in accounts if 0 <= size - account.end < BLOCK]
    exact = [account for account in fitting if account.end == size] or fitting
    if not exact:
        claims = "; ".join(str(account) for account in (accounts[0], accounts[-1]))
        raise ValueError(
            f"its header and its parameters disagree ({claims}), and its {size} bytes do not "
            "show which is right: it was cut short, or is damaged"
        )
    warnings.warn(
        f"the file's header and parameters disagree; by its size it holds {exact[0]}", stacklevel=2
    )
    return exact[0]


def _checked(layout: ByteLayout, size: int) -> ByteLayout:
    if layout.end > size:
        whole = max(size - layout.start, 0) // max(layout.frame_bytes, 1)
        ends = f"which end at byte {layout.end}, but the file ends at byte {size}"
        if not whole:
            raise ValueError(f"it announces {layout}, {ends}: it was cut short, or is damaged")
        warnings.warn(
            f"the file was cut short: it announces {layout}, {ends}; its first {whole} frames are "
            "read. If it lacks bytes before its end, samples after that place are wrong",
            stacklevel=2,
        )
        return replace(layout, frames=whole)
    if layout.frames == LARGEST_COUNT and size - layout.end >= BLOCK:
        raise ValueError(
            f"it counts {LARGEST_COUNT} frames, the most that its counter can hold, and continues "
            "after them; cut it into shorter takes"
        )
    return layout


def _rate(header: _Header, parameters: Parameters) -> float | None:
    """Return the rate as the shortest decimal number that the file's 32 bits stand for."""
    stated = _number(parameters, "POINT", "RATE") or 0.0
    rate = stated if stated > 0 else header.rate
    if not (np.isfinite(rate) and rate > 0):
        return None
    if header.rate > 0 and _differ(stated, header.rate):
        counts = "the parameters count" if stated > 0 else "the header counts"
        _warn_two("rate", stated, header.rate, counts)
    return float(str(np.float32(rate)))


def _scales(header: _Header, parameters: Parameters, width: int) -> tuple[float, ...]:
    stated = _number(parameters, "POINT", "SCALE") or 0.0
    if width == 4:
        if stated < 0 and header.scale < 0 and _differ(stated, header.scale):
            _warn_two("scale", stated, header.scale, "the samples need neither, as they are stored")
        return ()
    # a negative number stands for no integers
    scales = [scale for scale in (stated, header.scale) if np.isfinite(scale) and scale > 0]
    if not scales:
        raise ValueError(f"its samples are integers, and their scale is {header.scale}")
    if not stated > 0:
        _warn_two("scale", stated, header.scale, "the header counts")
    return tuple(scales) if _differ(scales[0], scales[-1]) else tuple(scales[:1])


def _warn_two(what: str, stated: float, header: float, taken: str) -> None:
    parameters = f"a {what} of {stated:g}" if stated else f"no {what}"
    warnings.warn(
        f"the file's parameters give {parameters}, its header {header:g}; {taken}", stacklevel=5
    )


def _differ(first: float, second: float) -> bool:
    return not math.isclose(first, second, rel_tol=1e-6)


def _number(parameters: Parameters, group: str, name: str) -> float | None:
    parameter = parameters.get((group, name))
    numbers = parameter.numbers if parameter else ()
    return numbers[0] if numbers and np.isfinite(numbers[0]) else None


def _whole(parameters: Parameters, group: str, name: str) -> float | None:
    """Return a count that is stored as two 16-bit words, the lower first."""
    parameter = parameters.get((group, name))
    numbers = parameter.numbers if parameter else ()
    return numbers[0] + 65536 * numbers[1] if len(numbers) == 2 else None


def _width(scale: float) -> float:
    return 4 if scale < 0 else 2


def _unlike(*claims: float | None) -> list[float]:
    return list(dict.fromkeys(claim for claim in claims if claim is not None))
