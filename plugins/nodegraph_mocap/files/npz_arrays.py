"""The arrays of a NumPy archive, read only once what they say of their size is found to be true."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from nodegraph_mocap.pieces import pieces

if TYPE_CHECKING:
    from zipfile import ZipFile, ZipInfo

    from numpy.typing import NDArray

_LONGEST_TEXTS = 2**26
_DEFLATED = 1032
"""Nothing that deflate packs comes out longer than this many times (zlib, technical details)."""


def npz_arrays(path: Path, kinds: Mapping[str, str], required: Sequence[str]) -> dict[str, Any]:
    """Return arrays of a NumPy archive.

    Parameters
    ----------
    path
        The file.
    kinds
        Which arrays to read, each with the kinds of numbers or text (`numpy.dtype.kind`) that it
        may have. Others are left alone.
    required
        Which of them must be there.

    Raises
    ------
    ValueError
        If it is no such archive, lacks an array, or one is of another kind or size than it says.
    """
    from zipfile import ZipFile

    try:
        with ZipFile(path) as archive:
            found = {one.filename.removesuffix(".npy"): one for one in archive.infolist()}
            _check_names(found, required)
            wanted = [name for name in kinds if name in found]
            return {name: _array(archive, name, found[name], kinds[name]) for name in wanted}
    except Exception as error:
        # zipfile, zlib and NumPy's header parser each have errors of their own for bad bytes.
        raise ValueError(str(error) or type(error).__name__) from None


def _check_names(found: Mapping[str, ZipInfo], required: Sequence[str]) -> None:
    lacking = [name for name in required if name not in found]
    if lacking:
        there = ", ".join(found) or "nothing"
        raise ValueError(f"no array {', '.join(lacking)}; there is {there}")


def _array(archive: ZipFile, name: str, member: ZipInfo, kinds: str) -> NDArray[Any]:
    with archive.open(member) as stream:
        shape, fortran, kind = _described(stream)
        size = stream.tell() + math.prod(shape) * kind.itemsize
        if kind.kind not in kinds:
            raise ValueError(f"array {name!r} is of type {kind}")
        if size != member.file_size or size > _DEFLATED * member.compress_size:
            raise ValueError(f"array {name!r} is not of the size {shape} that it announces")
        if kind.kind == "U" and size > _LONGEST_TEXTS:
            raise ValueError(f"array {name!r} has {size} bytes of text")
        array = _filled(np.empty(shape, kind, order="F" if fortran else "C"), stream)
    if kind.kind == "U":
        _check_text(name, array)
    return array


def _described(stream: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Return shape, whether the first axis is the fastest, and type; the bytes come next."""
    version = np.lib.format.read_magic(stream)
    if version == (1, 0):
        return np.lib.format.read_array_header_1_0(stream)
    return np.lib.format.read_array_header_2_0(stream)


def _filled(array: NDArray[Any], stream: IO[bytes]) -> NDArray[Any]:
    """Fill the array from the file: memory of its own, which nobody needs to copy later."""
    in_order = array if array.flags.c_contiguous else array.T
    memory = in_order.reshape(-1).view(np.uint8)
    for piece in pieces(len(memory), 1):
        size = piece.stop - piece.start
        memory[piece] = np.frombuffer(stream.read(size), np.uint8, count=size)
    return array


def _check_text(name: str, array: NDArray[Any]) -> None:
    """Refuse numbers that stand for no letters: Python would end on them with a system error."""
    try:
        array.astype(array.dtype.newbyteorder("<")).tobytes().decode("utf-32-le")
    except UnicodeDecodeError as error:
        raise ValueError(f"array {name!r} holds what is no text: {error.reason}") from None
