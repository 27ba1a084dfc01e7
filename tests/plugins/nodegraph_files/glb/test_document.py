from __future__ import annotations

import json
from typing import Any

import pytest

from nodegraph_files.glb.document import entry_at, read_document


def read(**parts: object) -> Any:
    return read_document(json.dumps({"asset": {"version": "2.0"}, **parts}).encode())


def test_what_is_not_needed_is_passed_over() -> None:
    document = read(materials=[{}], nodes=[{"mesh": 0, "extras": {"a": [1]}}], cameras=5)
    assert document.nodes[0].mesh == 0
    assert (document.scene, document.meshes) == (0, [])


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"meshes": 5}, "meshes: Input should be a valid array"),
        ({"meshes": [{"primitives": []}]}, r"meshes\.0\.primitives: List should have at least 1"),
        ({"meshes": [{}]}, r"meshes\.0\.primitives: Field required"),
        ({"nodes": [{"mesh": -1}]}, r"nodes\.0\.mesh: Input should be greater than or equal to 0"),
        ({"nodes": [{"scale": [1, 1]}]}, r"nodes\.0\.scale"),
        ({"nodes": [{"matrix": [1.0]}]}, r"nodes\.0\.matrix: List should have at least 16"),
        (
            {"accessors": [{"componentType": 5126, "type": "VEC3", "count": "many"}]},
            r"accessors\.0\.count: Input should be a valid integer",
        ),
        (
            {"accessors": [{"componentType": 5130, "type": "VEC3", "count": 1}]},
            r"accessors\.0\.componentType: Input should be 5120, 5121",
        ),
        ({"buffers": [{"byteLength": 0}]}, r"buffers\.0\.byteLength"),
        ({"asset": None}, "asset: Input should be an object"),
        ({"nodes": [1, 2, 3, 4, 5]}, "and 2 more"),
    ],
)
def test_what_is_wrong_is_reported_with_its_place(parts: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=rf"its JSON is wrong: .*{message}"):
        read(**parts)


@pytest.mark.parametrize(
    "text", [b"", b"[1]", b"{", b"\xff\xfe", b"null", b"[" * 100_000, b'{"asset":{"version":"2.0"'],
)  # fmt: skip
def test_what_is_no_json_is_refused(text: bytes) -> None:
    with pytest.raises(ValueError, match="its JSON is wrong"):
        read_document(text)


def test_a_number_that_is_none_is_refused() -> None:
    text = b'{"asset":{"version":"2.0"},"nodes":[{"translation":[0,NaN,0]}]}'
    with pytest.raises(ValueError, match=r"nodes\.0\.translation\.1: Input should be a finite"):
        read_document(text)


@pytest.mark.parametrize("where", ["extensionsUsed", "extensionsRequired"])
@pytest.mark.parametrize("name", ["KHR_draco_mesh_compression", "EXT_meshopt_compression"])
def test_compressed_meshes_are_refused(where: str, name: str) -> None:
    with pytest.raises(ValueError, match=rf"compressed \({name}\); export it without compression"):
        read(**{where: ["KHR_materials_unlit", name]})


def test_an_unknown_extension_is_refused_only_if_the_file_needs_it() -> None:
    assert read(extensionsUsed=["X_new"])
    assert read(extensionsRequired=["KHR_materials_unlit", "KHR_mesh_quantization"])
    with pytest.raises(ValueError, match="needs the extension EXT_mesh_gpu_instancing"):
        read(extensionsRequired=["EXT_mesh_gpu_instancing"])


def test_what_is_named_but_not_there_is_reported() -> None:
    assert entry_at(["a"], 0, "mesh", "node 3") == "a"
    with pytest.raises(ValueError, match="node 3: there is no mesh 1; the file has 1"):
        entry_at(["a"], 1, "mesh", "node 3")
