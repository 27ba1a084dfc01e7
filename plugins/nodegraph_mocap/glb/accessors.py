"""Numbers of a glTF file, out of its binary data.

Source: glTF 2.0 Specification, section 3.6 (Binary Data Storage), The Khronos Group.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph_mocap.glb.document import Accessor, Document, Sparse, found

if TYPE_CHECKING:
    from numpy.typing import NDArray

_COMPONENTS = {
    code: np.dtype(kind)
    for code, kind in {
        5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4",
    }.items()
}  # fmt: skip
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Accessors:
    """Reads the accessors of a document.

    Nothing is taken from memory for more than what the file's own bytes hold, except where the
    caller says how many values there must be.

    Parameters
    ----------
    document
    binary
        The bytes that belong to its first buffer.
    """

    def __init__(self, document: Document, binary: bytes) -> None:
        self._document = document
        self._binary = binary

    def numbers(
        self, index: int, where: str, *, kind: str, count: int | None = None
    ) -> NDArray[np.float64]:
        """Return (count, width) numbers, normalized ones as their fraction.

        Parameters
        ----------
        index
            Of the accessor.
        where
            What asks for it, for messages.
        kind
            ``VEC3`` or the like; another one is an error.
        count
            How many there must be, or None where anything will do that the file holds.

        Raises
        ------
        ValueError
            If there are others, they lie outside the file, or one is no finite number.
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
        """Return (count, width) whole numbers; the parameters are those of `numbers`."""
        accessor, at = self._accessor(index, where, kind, count)
        stored = self._stored(accessor, at, known=count is not None)
        if stored.dtype.kind == "f":
            raise ValueError(f"{at}: must be whole numbers")
        return stored.astype(np.int64)

    def count(self, index: int, where: str) -> int:
        """Return how many values an accessor says it has."""
        return found(self._document.accessors, index, "accessor", where).count

    def _accessor(
        self, index: int, where: str, kind: str, count: int | None
    ) -> tuple[Accessor, str]:
        accessor = found(self._document.accessors, index, "accessor", where)
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
            stored = np.zeros(shape, component)
        else:
            raise ValueError(f"{at}: has no data")
        return stored if accessor.sparse is None else self._filled(stored, accessor.sparse, at)

    def _filled(self, stored: NDArray[Any], sparse: Sparse, at: str) -> NDArray[Any]:
        """Return the array with the values that a sparse accessor puts into it."""
        count, where = sparse.count, sparse.indices
        component = _COMPONENTS[where.component_type]
        places = self._view(where.buffer_view, where.byte_offset, component, (count, 1), at)
        if places.max() >= len(stored):
            raise ValueError(f"{at}: puts a value at {places.max()} of {len(stored)}")
        values = sparse.values
        shape = (count, stored.shape[1])
        filled = stored.copy()
        filled[places[:, 0]] = self._view(
            values.buffer_view, values.byte_offset, stored.dtype, shape, at
        )
        return filled

    def _view(
        self, index: int, offset: int, component: np.dtype[Any], shape: tuple[int, int], at: str
    ) -> NDArray[Any]:
        """Return values of a buffer view, without a copy."""
        view = found(self._document.buffer_views, index, "buffer view", at)
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
        if found(self._document.buffers, buffer, "buffer", at).uri is not None or buffer:
            raise ValueError(f"{at}: buffer {buffer} lies outside the file; export one GLB file")
        if stop > len(self._binary):
            raise ValueError(f"{at}: ends at byte {stop} of data that has {len(self._binary)}")
