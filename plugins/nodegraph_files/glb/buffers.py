"""The bytes of a GLB file: its two chunks, and arrays in and out of the binary one.

Source: glTF 2.0 Specification, sections 3.6 (Binary Data Storage) and 4 (GLB File Format
Specification), The Khronos Group.
"""

from __future__ import annotations

import json
import math
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import quoted
from nodegraph_files.glb.document import Accessor, Document, Sparse, entry_at, read_document

if TYPE_CHECKING:
    from numpy.typing import NDArray

MAGIC = b"glTF"
_HEADER, _CHUNK = struct.Struct("<4sII"), struct.Struct("<I4s")
_VERSION = 2
_JSON, _BINARY = b"JSON", b"BIN\0"

TARGET_NAMES = "targetNames"
"""In the extras of a mesh: the names of its morph targets, as most programs write them."""

MARKER_VERTICES = "markerVertices"
"""In the extras of a mesh, our own: the vertex of each marker."""

UNIT = "m"
"""That of glTF. Ours have it in the extras of the asset, as ``unit``: not all files keep to it."""

_FLOAT, _UNSIGNED = 5126, 5125
_KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
_VERTICES, _CORNERS = 34962, 34963
_COMPONENTS = {
    code: np.dtype(kind)
    for code, kind in {
        5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4",
    }.items()
}  # fmt: skip
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


_FEW, _FOR_EACH_BYTE, _FOR_EACH_ARRAY = 30_000_000, 30, 1000
"""Numbers for which there is room in any case; that a byte may stand for; as an array costs."""


class Accessors:
    """Reads the accessors of a document, and limits what is made of them by the file's bytes.

    A short file can name its numbers over and over, and arrays of nothing but zeros.

    Parameters
    ----------
    document
    binary
        The bytes that belong to its first buffer.
    """

    def __init__(self, document: Document, binary: bytes) -> None:
        self._document = document
        self._binary = binary
        self._most = self._left = max(_FEW, _FOR_EACH_BYTE * len(binary))

    def charge(self, numbers: int, arrays: int = 1) -> None:
        """Count numbers that are going to be made, in so many arrays.

        Raises
        ------
        ValueError
            If with those before they are too many for the size of the file.
        """
        self._left -= numbers + _FOR_EACH_ARRAY * arrays
        if self._left < 0:
            raise ValueError(
                f"its meshes and morph targets have more than {self._most} numbers, too many for "
                f"{len(self._binary)} bytes of data"
            )

    def numbers(
        self, index: int, where: str, *, kind: str, count: int | None = None
    ) -> NDArray[np.float64]:
        """Return (count, width) numbers, normalized ones as their fraction.

        Parameters
        ----------
        index
            The index of the accessor.
        where
            The place that refers to it, for messages.
        kind
            ``VEC3`` or the like; another one is an error.
        count
            How many there must be, or None where anything will do that the file holds.

        Raises
        ------
        ValueError
            If there are others, they lie outside the file, or one is not a finite number.
        """
        accessor, at = self._accessor(index, where, kind, count)
        stored = self._stored(accessor, at, known=count is not None)
        if not np.isfinite(stored).all():
            place = int(np.argwhere(~np.isfinite(stored))[0][0])
            raise ValueError(f"{at}: number {place} is {stored[place]}, not finite")
        numbers = stored.astype(np.float64)
        if accessor.normalized and stored.dtype.kind in "iu":
            # the lowest integer would lie a little below -1
            numbers = np.maximum(numbers / np.iinfo(stored.dtype).max, -1.0)
        return numbers

    def integers(
        self, index: int, where: str, *, kind: str = "SCALAR", count: int | None = None
    ) -> NDArray[np.int64]:
        """Return (count, width) whole numbers; parameters and errors are those of `numbers`.

        Fractions are a ValueError too.
        """
        accessor, at = self._accessor(index, where, kind, count)
        stored = self._stored(accessor, at, known=count is not None)
        if stored.dtype.kind == "f":
            raise ValueError(f"{at}: must be whole numbers")
        return stored.astype(np.int64)

    def _accessor(
        self, index: int, where: str, kind: str, count: int | None
    ) -> tuple[Accessor, str]:
        accessor = entry_at(self._document.accessors, index, "accessor", where)
        at = f"{where}: accessor {index}"
        if accessor.type != kind:
            raise ValueError(f"{at}: must be {kind}, not {accessor.type}")
        if count is not None and accessor.count != count:
            raise ValueError(f"{at}: has {accessor.count} values where {count} are needed")
        return accessor, at

    def _stored(self, accessor: Accessor, at: str, *, known: bool) -> NDArray[Any]:
        component = _COMPONENTS[accessor.component_type]
        shape = (accessor.count, _WIDTHS[accessor.type])
        if accessor.buffer_view is not None:
            stored = self._view(accessor.buffer_view, accessor.byte_offset, component, shape, at)
        elif known:
            stored = np.broadcast_to(component.type(0), shape)
        else:
            raise ValueError(f"{at}: has no data")
        self.charge(math.prod(shape))
        return stored if accessor.sparse is None else self._filled(stored, accessor.sparse, at)

    def _filled(self, stored: NDArray[np.generic], sparse: Sparse, at: str) -> NDArray[np.generic]:
        """Return the array with the values that a sparse accessor puts into it."""
        count, where = sparse.count, sparse.indices
        component = _COMPONENTS[where.component_type]
        places = self._view(where.buffer_view, where.byte_offset, component, (count, 1), at)
        if places.max() >= len(stored):
            raise ValueError(f"{at}: puts a value at {places.max()} of {len(stored)}")
        values = sparse.values
        shape = (count, stored.shape[1])
        self.charge(math.prod(shape))
        filled = stored.copy()
        filled[places[:, 0]] = self._view(
            values.buffer_view, values.byte_offset, stored.dtype, shape, at
        )
        return filled

    def _view(
        self,
        index: int,
        offset: int,
        component: np.dtype[np.generic],
        shape: tuple[int, int],
        at: str,
    ) -> NDArray[np.generic]:
        """Return values of a buffer view, without a copy."""
        view = entry_at(self._document.buffer_views, index, "buffer view", at)
        count, width = shape
        size = width * component.itemsize
        stride = view.byte_stride or size
        needed = offset + stride * (count - 1) + size
        if needed > view.byte_length:
            raise ValueError(
                f"{at}: {count} values need {needed} bytes, but buffer view {index} has "
                f"{view.byte_length}"
            )
        start = view.byte_offset + offset
        self._check_buffer(view.buffer, view.byte_offset + view.byte_length, index)
        strides = (stride, component.itemsize)
        return np.ndarray(shape, component, self._binary, start, strides)

    def _check_buffer(self, buffer: int, stop: int, view: int) -> None:
        at = f"buffer view {view}"
        if entry_at(self._document.buffers, buffer, "buffer", at).uri is not None or buffer:
            raise ValueError(f"{at}: buffer {buffer} lies outside the file; export one GLB file")
        if stop > len(self._binary):
            raise ValueError(f"{at}: ends at byte {stop} of data that has {len(self._binary)}")


def opened_glb(path: Path) -> tuple[Document, Accessors]:
    """Return what a GLB file describes, and what reads its numbers.

    Raises
    ------
    ValueError
        As `split_glb` and `read_document` do.
    """
    text, binary = split_glb(path.read_bytes())
    document = read_document(text)
    return document, Accessors(document, binary)


class GlbBuffer:
    """Gathers arrays, each in a buffer view and an accessor of its own."""

    def __init__(self) -> None:
        self.accessors: list[dict[str, object]] = []
        self.views: list[dict[str, Any]] = []
        self._content = bytearray()

    @property
    def content(self) -> bytes:
        """The bytes so far."""
        return bytes(self._content)

    def vertices(self, positions: NDArray[np.float64], what: str) -> int:
        """Add (V, 3) positions or offsets of vertices; return the accessor's number."""
        return self._floats(positions, what, bounds=True, target=_VERTICES)

    def directions(self, vectors: NDArray[np.float64], what: str) -> int:
        """Add (V, 3) normals of vertices, or offsets of them; return the accessor's number."""
        return self._floats(vectors, what, bounds=False, target=_VERTICES)

    def corners(self, faces: NDArray[np.int64]) -> int:
        """Add (F, 3) triangles; return the accessor's number."""
        return self._add(faces.astype("<u4").reshape(-1, 1), _UNSIGNED, target=_CORNERS)

    def keys(self, values: NDArray[np.float64], what: str, *, bounds: bool = False) -> int:
        """Add (N, width) numbers of an animation; return the accessor's number."""
        return self._floats(values, what, bounds=bounds)

    def _floats(
        self, values: NDArray[np.float64], what: str, *, bounds: bool, target: int | None = None
    ) -> int:
        with np.errstate(over="ignore"):
            stored = values.astype("<f4")
        if not np.isfinite(stored).all():
            raise ValueError(f"{what}: {np.abs(values).max():.3g} is too large for a GLB file")
        return self._add(stored, _FLOAT, target=target, bounds=bounds)

    def _add(
        self,
        stored: NDArray[np.generic],
        component: int,
        *,
        target: int | None,
        bounds: bool = False,
    ) -> int:
        view = {"buffer": 0, "byteOffset": len(self._content), "byteLength": stored.nbytes}
        self.views.append(view if target is None else {**view, "target": target})
        self._content += stored.tobytes()
        accessor = {
            "bufferView": len(self.views) - 1,
            "componentType": component,
            "count": len(stored),
            "type": _KINDS[stored.shape[1]],
        }
        if bounds:
            accessor |= {
                "min": stored.min(axis=0).tolist(),
                "max": stored.max(axis=0).tolist(),
            }
        self.accessors.append(accessor)
        return len(self.accessors) - 1


def split_glb(data: bytes) -> tuple[bytes, bytes]:
    """Return the JSON and the binary data of a GLB file, the latter perhaps empty.

    Raises
    ------
    ValueError
        If the bytes are not such a file, or less than the file says.
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


def joined_glb(document: object, binary: bytes) -> bytes:
    """Return the bytes of a GLB file with that JSON and that binary data."""
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    chunks = _written(_JSON, text.encode(), b" ") + _written(_BINARY, binary, b"\0")
    return _HEADER.pack(MAGIC, _VERSION, _HEADER.size + len(chunks)) + chunks


def _chunk(data: bytes, place: int, stop: int, kind: bytes) -> tuple[bytes, int]:
    """Return a chunk's content and the place after it; a chunk of another kind is empty."""
    start = place + _CHUNK.size
    if start > stop:
        raise ValueError(f"it is cut short: it ends within the head of a chunk, at byte {place}")
    length, name = _CHUNK.unpack_from(data, place)
    if start + length > stop:
        raise ValueError(
            f"the chunk at byte {place} says that it has {length} bytes, but {stop - start} follow"
        )
    if name == kind:
        return data[start : start + length], start + length
    if kind == _JSON:
        raise ValueError(f"the first chunk is {quoted(name)}, not JSON")
    return b"", start + length


def _written(kind: bytes, content: bytes, padding: bytes) -> bytes:
    padded = content + padding * (-len(content) % 4)
    return _CHUNK.pack(len(padded), kind) + padded
