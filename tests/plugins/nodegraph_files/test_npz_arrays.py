from __future__ import annotations

import zipfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph_files.npz import npz_arrays

KINDS = {"numbers": "fiu", "names": "U"}


def member(array: Any, shape: tuple[int, ...] | None = None) -> bytes:
    """Return an array as its file, which may announce another shape."""
    header = {"descr": array.dtype.str, "fortran_order": False, "shape": shape or array.shape}
    target = BytesIO()
    np.lib.format.write_array_header_1_0(target, header)
    content: bytes = target.getvalue() + array.tobytes()
    return content


def archive(folder: Path, **members: bytes) -> Path:
    path = folder / "it.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as target:
        for name, content in members.items():
            target.writestr(f"{name}.npy", content)
    return path


@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_wanted_arrays_are_read_and_others_are_left_alone(
    tmp_path: Path, save: Callable[..., None]
) -> None:
    numbers, names = np.asfortranarray(np.arange(6.0).reshape(2, 3)), np.array(["a", "é"])
    save(tmp_path / "it.npz", numbers=numbers, names=names, other=np.array([None]))
    arrays = npz_arrays(tmp_path / "it.npz", KINDS, ("numbers",))
    assert list(arrays) == ["numbers", "names"]
    np.testing.assert_array_equal(arrays["numbers"], numbers)
    np.testing.assert_array_equal(arrays["names"], names)


def test_an_array_that_must_be_there_is_missed(tmp_path: Path) -> None:
    path = archive(tmp_path, other=member(np.zeros(1)), names=member(np.array(["a"])))
    with pytest.raises(ValueError, match="no array numbers; there is other, names"):
        npz_arrays(path, KINDS, ("numbers", "names"))
    assert list(npz_arrays(path, KINDS, ("names",))) == ["names"]


@pytest.mark.parametrize("shape", [(10**12,), (3,), (10**9, 10**9), (1,)])
def test_an_array_of_another_size_than_it_says_is_refused(
    tmp_path: Path, shape: tuple[int, ...]
) -> None:
    path = archive(tmp_path, numbers=member(np.zeros(2), shape))
    with pytest.raises(ValueError, match=r"array 'numbers' is not of the size .* it announces"):
        npz_arrays(path, KINDS, ())


@pytest.mark.parametrize("array", [np.array(["a"]), np.zeros(2, complex), np.zeros(2, bool)])
def test_an_array_of_another_kind_is_refused(tmp_path: Path, array: Any) -> None:
    path = archive(tmp_path, numbers=member(array))
    with pytest.raises(ValueError, match=f"array 'numbers' is of type {array.dtype}"):
        npz_arrays(path, KINDS, ())


@pytest.mark.parametrize("content", [b"", b"\x93NUMPY", b"\x93NUMPY\1\0\xff\xff", b"x" * 200])
def test_a_member_that_is_no_array_is_refused(tmp_path: Path, content: bytes) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        npz_arrays(archive(tmp_path, numbers=content), KINDS, ())


@pytest.mark.parametrize("code", [0x11_0000, 0xFFFF_FFFF, 0xD800])
def test_numbers_that_stand_for_no_letters_are_refused_as_no_text(
    tmp_path: Path, code: int
) -> None:
    for order in "<>":
        letters = np.array([0x61, code], f"{order}u4").view(f"{order}U1")
        with pytest.raises(ValueError, match="array 'names' holds what is not text"):
            npz_arrays(archive(tmp_path, names=member(letters)), KINDS, ())


def test_a_text_longer_than_any_name_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("nodegraph_files.npz._LONGEST_TEXTS", 2**16)
    path = archive(tmp_path, names=member(np.array("a" * 2**14)))
    with pytest.raises(ValueError, match="array 'names' has 65664 bytes of text"):
        npz_arrays(path, KINDS, ())


@pytest.mark.parametrize("shape", [(), (0, 3), (2, 3), (50, 400, 3)])
@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("kind", ["<f8", ">f8", "<f4", "<i2"])
def test_an_array_has_memory_of_its_own(
    tmp_path: Path, shape: tuple[int, ...], order: Any, kind: str
) -> None:
    numbers = np.zeros(shape, kind, order=order)
    numbers[...] = np.arange(numbers.size).reshape(shape)
    np.savez_compressed(tmp_path / "it.npz", numbers=numbers)
    arrays = npz_arrays(tmp_path / "it.npz", KINDS, ())["numbers"]
    np.testing.assert_array_equal(arrays, numbers)
    assert (arrays.dtype, arrays.strides) == (numbers.dtype, numbers.strides)
    assert arrays.base is None


def test_what_cannot_be_packed_into_so_little_takes_no_memory(
    tmp_path: Path, peak_memory: Callable[[], int]
) -> None:
    content = member(np.zeros(1), (10**10,))
    # the archive's own list says as well that it is so long
    with zipfile.ZipFile(tmp_path / "it.npz", "w", zipfile.ZIP_DEFLATED) as target:
        target.writestr("numbers.npy", content)
        target.infolist()[0].file_size = len(content) - 8 + 8 * 10**10
    with pytest.raises(ValueError, match="not of the size"):
        npz_arrays(tmp_path / "it.npz", KINDS, ())
    assert peak_memory() < 2_000_000
