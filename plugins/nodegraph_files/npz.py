"""Recordings and blendshape models as NumPy archives, which read back bit for bit."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from nodegraph import Format, listed, quoted
from nodegraph_files.marker_set import marker_set_of, plain_marker_set
from nodegraph_files.missing import mark_missing
from nodegraph_files.rates import rate_from
from nodegraph_files.units import AUTO, LengthUnit, unit_from
from nodegraph_mocap.face_model import BlendshapeModel
from nodegraph_mocap.frame_ranges import chunks
from nodegraph_mocap.recording import Trajectories

if TYPE_CHECKING:
    from zipfile import ZipFile, ZipInfo

    from numpy.typing import NDArray


_LONGEST_TEXTS = 2**26
_MOST_INFLATION = 1032
"""Nothing that deflate packs comes out longer than this many times (zlib, technical details)."""


def is_model(path: Path) -> bool:
    """Return whether a ZIP archive holds the arrays of a blendshape model."""
    from zipfile import ZipFile

    try:
        with ZipFile(path) as archive:
            return {"neutral.npy", "shapes.npy"} <= set(archive.namelist())
    except Exception:  # zipfile has several errors for bad bytes; the reader says what is wrong
        return False


_LONGEST = 300  # characters of a reason


def is_archive(start: bytes) -> bool:
    """Return whether a file that begins with these bytes is a ZIP archive, as NPZ is."""
    return start.startswith(b"PK\x03\x04")


def npz_arrays(path: Path, kinds: Mapping[str, str], required: Sequence[str]) -> dict[str, Any]:
    """Return arrays of a NumPy archive.

    Parameters
    ----------
    path
        The file.
    kinds
        The arrays to read, each with the kinds of numbers or text (`numpy.dtype.kind`) that it
        may have. Others are left alone.
    required
        Those of them that must be there.

    Raises
    ------
    ValueError
        If it is not such an archive, lacks an array, or one is of another kind or size than
        stated.
    """
    from zipfile import ZipFile

    try:
        with ZipFile(path) as archive:
            members = {
                member.filename.removesuffix(".npy"): member for member in archive.infolist()
            }
            _check_names(members, required)
            wanted = [name for name in kinds if name in members]
            return {name: _array(archive, name, members[name], kinds[name]) for name in wanted}
    except Exception as error:
        # zipfile, zlib and NumPy's header parser each have errors of their own for bad bytes.
        reason = str(error) or "an array ends too early"
        more = " …" if len(reason) > _LONGEST else ""  # zipfile quotes any number of bytes
        raise ValueError(f"{reason[:_LONGEST]}{more}") from None


def _check_names(members: Mapping[str, ZipInfo], required: Sequence[str]) -> None:
    lacking = [name for name in required if name not in members]
    if lacking:
        raise ValueError(f"no array {', '.join(lacking)}; there is {listed(members)}")


def _array(archive: ZipFile, name: str, member: ZipInfo, kinds: str) -> NDArray[np.generic]:
    with archive.open(member) as stream:
        shape, fortran, kind = _described(stream)
        size = stream.tell() + math.prod(shape) * kind.itemsize
        if kind.kind not in kinds:
            raise ValueError(f"array {quoted(name)} is of type {kind}")
        if size != member.file_size or size > _MOST_INFLATION * member.compress_size:
            raise ValueError(f"array {quoted(name)} is not of the size {shape} that it announces")
        if kind.kind == "U" and size > _LONGEST_TEXTS:
            raise ValueError(f"array {quoted(name)} has {size} bytes of text")
        array = _filled(np.empty(shape, kind, order="F" if fortran else "C"), stream)
    if kind.kind == "U":
        _check_text(name, array)
    return array


def _described(stream: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[np.generic]]:
    """Return shape, whether the first axis is the fastest, and type; the bytes come next."""
    version = np.lib.format.read_magic(stream)
    if version == (1, 0):
        return np.lib.format.read_array_header_1_0(stream)
    return np.lib.format.read_array_header_2_0(stream)


def _filled(array: NDArray[np.generic], stream: IO[bytes]) -> NDArray[np.generic]:
    """Fill the array from the file: memory of its own, which nobody needs to copy later."""
    in_order = array if array.flags.c_contiguous else array.T
    memory = in_order.reshape(-1).view(np.uint8)
    for piece in chunks(len(memory), 1):
        size = piece.stop - piece.start
        memory[piece] = np.frombuffer(stream.read(size), np.uint8, count=size)
    return array


def _check_text(name: str, array: NDArray[np.generic]) -> None:
    """Refuse numbers that stand for no letters: Python would end on them with a system error."""
    try:
        array.astype(array.dtype.newbyteorder("<")).tobytes().decode("utf-32-le")
    except UnicodeDecodeError as error:
        raise ValueError(f"array {quoted(name)} holds what is not text: {error.reason}") from None


_KINDS = {
    "positions": "fiu",
    "markers": "U",
    "rate": "fiu",
    "origin": "iu",
    "sigma": "fiu",
    "marker_set": "U",
}
_REQUIRED = ("positions", "markers")


def read_npz(
    path: Path, *, zeros_missing: bool = True, unit: str = AUTO, rate: float | None = None
) -> Trajectories:
    """Read a recording from a NumPy archive.

    The archive holds ``positions`` (T, M, 3) in mm, ``markers`` (M,) and ``rate``, and may hold
    ``origin``, ``sigma`` (T, M) and ``marker_set`` (JSON text). Other arrays are not read.

    Parameters
    ----------
    path
        The file.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing if the archive has no
        ``origin``.
    unit
        Unit of length, such as ``cm``; by default mm, as this package writes.
    rate
        Hz; by default the archive's.

    Raises
    ------
    ValueError
        If it is not such an archive, or lacks an array; the message lists those that are there.
    """
    try:
        arrays = npz_arrays(path, _KINDS, _REQUIRED)
        return _recording(arrays, zeros_missing, unit_from(unit, "mm"), rate)
    except (ValueError, TypeError, RecursionError) as error:
        raise ValueError(f"{path}: not a readable NPZ recording: {error}") from None


def write_npz(recording: Trajectories, path: Path) -> None:
    """Write a recording as a NumPy archive; see `npz_bytes`."""
    with path.open("wb") as stream:
        _write(recording, stream)


def npz_bytes(recording: Trajectories) -> bytes:
    """Return a recording as the bytes of a NumPy archive."""
    target = BytesIO()
    _write(recording, target)
    return target.getvalue()


def _write(recording: Trajectories, target: IO[bytes]) -> None:
    arrays: dict[str, Any] = {
        "positions": recording.positions,
        "markers": np.array(recording.markers, dtype=np.str_),
        "rate": np.float64(recording.rate),
        "origin": recording.origin,
    }
    if recording.sigma is not None:
        arrays["sigma"] = recording.sigma
    if recording.marker_set is not None:
        arrays["marker_set"] = np.str_(json.dumps(plain_marker_set(recording.marker_set)))
    np.savez_compressed(target, **arrays)


def _recording(
    arrays: dict[str, Any], zeros_missing: bool, unit: LengthUnit, rate: float | None
) -> Trajectories:
    positions = np.asarray(arrays["positions"], dtype=np.float64)
    if positions.ndim != 3 or positions.shape[2] != 3:
        raise ValueError(f"positions must be (frames, markers, 3), got {positions.shape}")
    markers = tuple(str(name) for name in np.atleast_1d(arrays["markers"]))
    if "origin" not in arrays:
        nothing = np.zeros(positions.shape[:2], dtype=np.bool_)
        positions = mark_missing(positions, nothing, markers, zeros_missing=zeros_missing)
    unit.convert(positions)
    sigma = None if "sigma" not in arrays else np.asarray(arrays["sigma"], dtype=np.float64)
    if sigma is not None:
        unit.convert(sigma)
    described = arrays.get("marker_set")
    used_rate = rate_from(rate, float(arrays["rate"]) if "rate" in arrays else None)
    if used_rate is None:
        raise ValueError("no array rate; set `rate` in Hz")
    return Trajectories(
        positions=positions,
        markers=markers,
        rate=used_rate,
        marker_set=None if described is None else marker_set_of(json.loads(str(described))),
        origin=arrays.get("origin"),  # type: ignore[arg-type]
        sigma=sigma,
    )


_MODEL_KINDS = {"neutral": "fiu", "shapes": "fiu", "shape_names": "U", "markers": "U"}


def read_model_npz(path: Path) -> BlendshapeModel:
    """Read a blendshape model.

    The archive holds ``neutral`` (M, 3) and ``shapes`` (K, M, 3) offsets at weight 1, in mm, and
    ``shape_names`` (K,) and ``markers`` (M,). Other arrays are not read.

    Raises
    ------
    ValueError
        If it is not such an archive, lacks an array, or a number is missing or infinite.
    """
    try:
        arrays = npz_arrays(path, _MODEL_KINDS, tuple(_MODEL_KINDS))
        return BlendshapeModel(
            neutral=arrays["neutral"],
            shapes=arrays["shapes"],
            names=_names(arrays["shape_names"]),
            markers=_names(arrays["markers"]),
        )
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path}: not a readable NPZ model: {error}") from None


def model_bytes(model: BlendshapeModel) -> bytes:
    """Return a blendshape model as the bytes of a NumPy archive, which reads back equal."""
    target = BytesIO()
    np.savez(
        target,
        neutral=model.neutral,
        shapes=model.shapes,
        shape_names=np.array(model.names, dtype=np.str_),
        markers=np.array(model.markers, dtype=np.str_),
    )
    return target.getvalue()


def _names(array: NDArray[np.str_]) -> tuple[str, ...]:
    return tuple(str(name) for name in array.ravel())


FORMAT = Format("NPZ", Trajectories, (".npz",), read_npz, is_archive)
MODEL_FORMAT = Format("NPZ", BlendshapeModel, (".npz",), read_model_npz, is_archive)
