from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_files.glb.buffers import Accessors
from nodegraph_files.glb.document import Document

CODES = {"<i1": 5120, "<u1": 5121, "<i2": 5122, "<u2": 5123, "<u4": 5125, "<f4": 5126}
WHERE = "mesh 0"


def accessors(
    binary: bytes, accessor: dict[str, Any], *views: dict[str, Any], **parts: Any
) -> Accessors:
    default = {"componentType": 5126, "type": "VEC3", "count": 1}
    document = {
        "asset": {"version": "2.0"},
        "accessors": [default | accessor],
        "bufferViews": [{"buffer": 0, "byteLength": max(len(binary), 1)} | view for view in views],
        "buffers": [{"byteLength": max(len(binary), 1)}],
    }
    return Accessors(Document.model_validate(document | parts), binary)


def of_array(array: NDArray[np.generic], **accessor: object) -> Accessors:
    code = CODES[f"<{array.dtype.kind}{array.dtype.itemsize}"]
    given = {"bufferView": 0, "componentType": code, "count": len(array)}
    return accessors(array.tobytes(), given | accessor, {})


@pytest.mark.parametrize("kind", sorted(CODES))
def test_numbers_of_every_kind_are_read(kind: str) -> None:
    array = np.arange(12).reshape(4, 3).astype(kind)
    read = of_array(array).numbers(0, WHERE, kind="VEC3")
    np.testing.assert_array_equal(read, array)
    assert read.dtype == np.float64


@pytest.mark.parametrize(
    ("kind", "stored", "meant"),
    [
        ("<i1", [-128, -127, 127], [-1, -1, 1]),
        ("<u1", [0, 51, 255], [0, 0.2, 1]),
        ("<i2", [-32768, 0, 32767], [-1, 0, 1]),
        ("<u2", [0, 13107, 65535], [0, 0.2, 1]),
    ],
)
def test_normalized_integers_are_fractions(
    kind: str, stored: list[int], meant: list[float]
) -> None:
    read = of_array(np.array([stored], kind), normalized=True).numbers(0, WHERE, kind="VEC3")
    np.testing.assert_allclose(read, [meant], rtol=1e-15)


def test_values_may_lie_between_others() -> None:
    rows = np.arange(24, dtype="<f4").reshape(4, 6)
    given = {"bufferView": 0, "count": 3, "byteOffset": 8}
    view = {"byteOffset": 24, "byteLength": 72, "byteStride": 24}
    read = accessors(rows.tobytes(), given, view).numbers(0, WHERE, kind="VEC3")
    np.testing.assert_array_equal(read, rows[1:, 2:5])


@pytest.mark.parametrize("over_zeros", [True, False])
def test_sparse_values_stand_over_the_others(over_zeros: bool) -> None:
    base = np.arange(12, dtype="<f4").reshape(4, 3)
    places, values = np.array([1, 3], "<u2"), np.full((2, 3), 7, "<f4")
    binary = base.tobytes() + places.tobytes() + values.tobytes()
    sparse = {
        "count": 2,
        "indices": {"bufferView": 1, "componentType": 5123},
        "values": {"bufferView": 2},
    }
    given = {"count": 4, "sparse": sparse} | ({} if over_zeros else {"bufferView": 0})
    read = accessors(
        binary, given, {"byteLength": 48}, {"byteOffset": 48, "byteLength": 4},
        {"byteOffset": 52, "byteLength": 24},
    ).numbers(0, WHERE, kind="VEC3", count=4)  # fmt: skip
    expected = np.zeros((4, 3)) if over_zeros else base.copy()
    expected[[1, 3]] = 7
    np.testing.assert_array_equal(read, expected)


def test_a_sparse_value_beyond_the_others_is_refused() -> None:
    binary = np.array([4], "<u4").tobytes() + np.zeros(3, "<f4").tobytes()
    sparse = {"count": 1, "indices": {"bufferView": 0, "componentType": 5125},
              "values": {"bufferView": 0, "byteOffset": 4}}  # fmt: skip
    with pytest.raises(ValueError, match="mesh 0: accessor 0: puts a value at 4 of 4"):
        accessors(binary, {"count": 4, "sparse": sparse}, {}).numbers(
            0, WHERE, kind="VEC3", count=4
        )


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_number_that_is_not_finite_is_refused(bad: float) -> None:
    array = np.zeros((3, 3), "<f4")
    array[1, 2] = bad
    with pytest.raises(ValueError, match=r"mesh 0: accessor 0: number 1 is .*, not finite"):
        of_array(array).numbers(0, WHERE, kind="VEC3")


@pytest.mark.parametrize(
    ("accessor", "view", "message"),
    [
        ({"count": 3}, {}, "3 values need 36 bytes, but buffer view 0 has 24"),
        ({"count": 10**12}, {}, "1000000000000 values need 12000000000000 bytes"),
        ({"count": 10**40}, {}, "but buffer view 0 has 24"),
        ({"count": 2, "byteOffset": 4}, {}, "2 values need 28 bytes"),
        ({"count": 2}, {"byteStride": 16}, "2 values need 28 bytes"),
        ({"count": 2}, {"byteOffset": 8}, "buffer view 0: ends at byte 32 of data that has 24"),
        ({"count": 2}, {"byteLength": 10**12}, "ends at byte 1000000000000 of data that has 24"),
        ({"count": 2}, {"buffer": 1}, "buffer view 0: there is no buffer 1; the file has 1"),
        ({"bufferView": 4}, {}, "there is no buffer view 4; the file has 1"),
        ({"bufferView": None, "count": 10**12}, {}, "mesh 0: accessor 0: has no data"),
    ],
)
def test_what_the_file_does_not_hold_is_refused(
    accessor: dict[str, object], view: dict[str, object], message: str
) -> None:
    read = accessors(bytes(24), {"bufferView": 0} | accessor, view)
    with pytest.raises(ValueError, match=message):
        read.numbers(0, WHERE, kind="VEC3")


def test_data_in_another_file_are_refused() -> None:
    buffers = [{"byteLength": 12, "uri": "head.bin"}]
    read = accessors(bytes(12), {"bufferView": 0}, {}, buffers=buffers)
    with pytest.raises(ValueError, match="buffer 0 lies outside the file; export one GLB file"):
        read.numbers(0, WHERE, kind="VEC3")


def test_another_type_or_number_is_refused() -> None:
    read = of_array(np.zeros((4, 3), "<f4"))
    with pytest.raises(ValueError, match="accessor 0: must be VEC4, not VEC3"):
        read.numbers(0, WHERE, kind="VEC4")
    with pytest.raises(ValueError, match="accessor 0: has 4 values where 5 are needed"):
        read.numbers(0, WHERE, kind="VEC3", count=5)
    with pytest.raises(ValueError, match="there is no accessor 1; the file has 1"):
        read.numbers(1, WHERE, kind="VEC3")
    with pytest.raises(ValueError, match="accessor 0: must be whole numbers"):
        read.integers(0, WHERE, kind="VEC3")
