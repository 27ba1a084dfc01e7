"""The file of an archive."""

from __future__ import annotations

import io
import zipfile

from nodegraph.archive.contents import METADATA, packed

FILES = {"run/b.bin": bytes(range(256)), "a/ü.txt": b"text" * 1000, "README.md": b""}


def test_files_read_back_and_the_metadata_is_first() -> None:
    with zipfile.ZipFile(io.BytesIO(packed(FILES, b"{}"))) as file:
        assert file.testzip() is None
        assert file.namelist() == [METADATA, "README.md", "a/ü.txt", "run/b.bin"]
        assert {name: file.read(name) for name in FILES} == FILES
        assert file.read(METADATA) == b"{}"


def test_files_are_readable_for_everyone() -> None:
    with zipfile.ZipFile(io.BytesIO(packed(FILES, b"{}"))) as file:
        assert {entry.external_attr >> 16 for entry in file.infolist()} == {0o100644}


def test_the_bytes_depend_only_on_the_files() -> None:
    backwards = dict(reversed(list(FILES.items())))
    assert packed(FILES, b"{}") == packed(backwards, b"{}")
    assert packed(FILES, b"{}") != packed({**FILES, "README.md": b"x"}, b"{}")
