"""What stands before the samples of a C3D file that is written: its header and parameters.

Numbers are written as an Intel processor has them. Layout after the C3D file format user guide
(https://www.c3d.org). A take of 65535 frames or more says how many it has in the two ways that
programs look for: ``POINT:LONG_FRAMES`` (C-Motion) and ``TRIAL:ACTUAL_END_FIELD`` (Vicon).
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence

from nodegraph_mocap.files.c3d_layout import LARGEST_COUNT
from nodegraph_mocap.files.c3d_parameters import BLOCK, FLOAT, INTEGER, INTEL, TEXT

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
