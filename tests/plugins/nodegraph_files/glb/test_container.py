from __future__ import annotations

import json
import struct

import pytest

from nodegraph_files.glb.buffers import joined_glb, split_glb


def chunk(kind: bytes, content: bytes, *, length: int | None = None) -> bytes:
    return struct.pack("<I4s", len(content) if length is None else length, kind) + content


def container(*chunks: bytes, version: int = 2, length: int | None = None) -> bytes:
    body = b"".join(chunks)
    return struct.pack("<4sII", b"glTF", version, length or 12 + len(body)) + body


@pytest.mark.parametrize("binary", [b"", b"\1", b"\1\2\3\4", bytes(range(10))])
def test_what_is_joined_splits_again(binary: bytes) -> None:
    written = joined_glb({"name": "é"}, binary)
    text, data = split_glb(written)
    assert json.loads(text) == {"name": "é"}
    assert data == binary + b"\0" * (-len(binary) % 4)
    assert len(written) % 4 == len(text) % 4 == 0


def test_the_binary_chunk_may_be_absent_and_others_follow() -> None:
    assert split_glb(container(chunk(b"JSON", b"{} "))) == (b"{} ", b"")
    assert split_glb(container(chunk(b"JSON", b"{}"), chunk(b"MINE", b"1234"))) == (b"{}", b"")
    whole = container(chunk(b"JSON", b"{}"), chunk(b"BIN\0", b"1234"), chunk(b"MINE", b"5"))
    assert split_glb(whole + b"what follows the file") == (b"{}", b"1234")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "does not start as a GLB file"),
        (b"glTF\2\0", "does not start as a GLB file"),
        (b"solid head of an STL file", "does not start as a GLB file"),
        (container(chunk(b"JSON", b"{}"), version=1), "of version 1 of glTF, not 2"),
        (container(chunk(b"JSON", b"{}"), length=500), "cut short: it has 22 bytes of 500"),
        (container(), "ends within the head of a chunk, at byte 12"),
        (container(chunk(b"BIN\0", b"1234")), r"the first chunk is b'BIN\\x00', not JSON"),
        (container(chunk(b"JSON", b"{}", length=2**32 - 1)), "it has 4294967295 bytes, but 2 fol"),
        (container(chunk(b"JSON", b"{}"), b"1234"), "ends within the head of a chunk, at byte 22"),
        (container(chunk(b"JSON", b"{}"), chunk(b"BIN\0", b"", length=1)), "chunk at byte 22 says"),
    ],
)
def test_what_is_no_glb_file_is_refused(data: bytes, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        split_glb(data)
