"""An archive is a zip that every program reads, and the same for the same content."""

from __future__ import annotations

import io
import zipfile

from nodegraph.archive.contents import METADATA, packed

FILES = {"run/b.bin": bytes(range(256)), "a/ü.txt": b"text" * 1000, "README.md": b""}


def test_all_comes_out_as_it_went_in_and_the_description_first() -> None:
    with zipfile.ZipFile(io.BytesIO(packed(FILES, b"{}"))) as file:
        assert file.testzip() is None
        assert file.namelist() == [METADATA, "README.md", "a/ü.txt", "run/b.bin"]
        assert {name: file.read(name) for name in FILES} == FILES
        assert file.read(METADATA) == b"{}"


def test_whoever_unpacks_it_can_read_it() -> None:
    with zipfile.ZipFile(io.BytesIO(packed(FILES, b"{}"))) as file:
        assert {one.external_attr >> 16 for one in file.infolist()} == {0o100644}


def test_neither_order_nor_clock_is_in_it() -> None:
    backwards = dict(reversed(list(FILES.items())))
    assert packed(FILES, b"{}") == packed(backwards, b"{}")
    assert packed(FILES, b"{}") != packed({**FILES, "README.md": b"x"}, b"{}")
