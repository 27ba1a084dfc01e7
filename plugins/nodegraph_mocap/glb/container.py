"""GLB files: a chunk of JSON, and one of binary data that it speaks of.

Source: glTF 2.0 Specification, section 4 (GLB File Format), The Khronos Group.
"""

from __future__ import annotations

import json
import struct
from typing import Any

MAGIC = b"glTF"
_HEADER, _CHUNK = struct.Struct("<4sII"), struct.Struct("<I4s")
_VERSION = 2
_JSON, _BINARY = b"JSON", b"BIN\0"


def split_glb(data: bytes) -> tuple[bytes, bytes]:
    """Return the JSON and the binary data of a GLB file, the latter perhaps empty.

    Raises
    ------
    ValueError
        If the bytes are no such file, or less than the file says.
    """
    if not data.startswith(MAGIC) or len(data) < _HEADER.size:
        raise ValueError("it does not start as a GLB file does")
    _, version, length = _HEADER.unpack_from(data)
    if version != _VERSION:
        raise ValueError(f"it is of version {version} of glTF, not {_VERSION}")
    if length > len(data):
        raise ValueError(f"it is cut short: it has {len(data)} bytes of {length}")
    text, place = _chunk(data, _HEADER.size, length, _JSON)
    binary, _ = _chunk(data, place, length, _BINARY) if place < length else (b"", place)
    return text, binary


def joined_glb(document: Any, binary: bytes) -> bytes:
    """Return the bytes of a GLB file with that JSON and that binary data."""
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    chunks = _written(_JSON, text.encode(), b" ") + _written(_BINARY, binary, b"\0")
    return _HEADER.pack(MAGIC, _VERSION, _HEADER.size + len(chunks)) + chunks


def _chunk(data: bytes, place: int, stop: int, kind: bytes) -> tuple[bytes, int]:
    """Return a chunk's content and the place after it; a chunk of another kind is empty."""
    start = place + _CHUNK.size
    if start > stop:
        raise ValueError(f"it is cut short: it ends within the head of a chunk, at byte {place}")
    length, found = _CHUNK.unpack_from(data, place)
    if start + length > stop:
        raise ValueError(
            f"the chunk at byte {place} says that it has {length} bytes, but {stop - start} follow"
        )
    if found == kind:
        return data[start : start + length], start + length
    if kind == _JSON:
        raise ValueError(f"the first chunk is {found!r}, not JSON")
    return b"", start + length


def _written(kind: bytes, content: bytes, padding: bytes) -> bytes:
    padded = content + padding * (-len(content) % 4)
    return _CHUNK.pack(len(padded), kind) + padded
