from __future__ import annotations

import gzip
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from dataclasses import replace
from pathlib import Path

import pytest

import nodegraph as ng
from nodegraph_files.text.text_file import TextFile, read_text_file, start_in_utf8

TEXT = "é,b\n# rate: 60\n1,2\n"


@pytest.mark.parametrize(
    ("mark", "encoding"),
    [(b"", "utf-8"), (BOM_UTF8, "utf-8"), (BOM_UTF16_LE, "utf-16-le"), (BOM_UTF16_BE, "utf-16-be")],
)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_encodings_and_line_ends_no_longer_matter(
    tmp_path: Path, mark: bytes, encoding: str, end: str
) -> None:
    path = tmp_path / "take.csv"
    path.write_bytes(mark + TEXT.replace("\n", end).encode(encoding))
    text = read_text_file(path)
    assert text.content.decode() == TEXT
    assert text.plain == (mark == b"" and end == "\n")


def test_a_line_knows_its_number_and_its_bytes() -> None:
    text = TextFile(Path("take.csv"), TEXT.encode())
    lines = list(text.lines())
    assert [(line.number, line.text) for line in lines] == [
        (1, "é,b"),
        (2, "# rate: 60"),
        (3, "1,2"),
    ]
    assert [text.content[line.start : line.end].decode() for line in lines] == TEXT.splitlines(True)
    assert list(text.lines(lines[1].end, 3)) == lines[2:]


def test_comments_count_as_empty_lines_and_say_something() -> None:
    content = b"#Rate=59.94 Hz\na#b.x\n  # unit: m\n# just a note\n1\n#rate: 60"
    text = replace(TextFile(Path("take.csv"), content), commented=True)
    assert [line.text for line in text.lines()] == ["", "a#b.x", "", "", "1", ""]
    assert text.comments() == {"rate": ("60", 6), "unit": ("m", 3)}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"a\nb\0\n", "line 2 holds a zero byte"),
        (b"\x1f\x8b\x08\0\0", "compressed by gzip; unpack"),
        (b"\0\0\0\x06\0\0\0\x24", "Live Link packets"),
        (
            gzip.compress(b"\x06\0\0\1\0\0\1\x22", mtime=0),
            "Live Link packets; .*, compressed by gzip",
        ),
        (gzip.compress(b"a,b\n", mtime=0), "compressed by gzip; unpack"),
        (b"PK\x03\x04", "ZIP archive or a spreadsheet"),
        ("a,b".encode("utf-16-le"), "line 1 holds a zero byte"),
        (BOM_UTF16_LE + b"a\0b", "in UTF-16"),
    ],
)
def test_what_is_no_text_is_refused(tmp_path: Path, content: bytes, message: str) -> None:
    path = tmp_path / "take.csv"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=rf"take\.csv: not a table of text.*{message}"):
        read_text_file(path)


def test_what_is_not_utf_8_is_reported_with_its_line() -> None:
    text = TextFile(Path("take.csv"), "a\nHüfte\n".encode("latin-1"))
    with pytest.raises(ValueError, match=r"take\.csv: .*: line 2 holds byte 0xfc"):
        list(text.lines())


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_the_start_of_a_file_whatever_its_encoding(encoding: str) -> None:
    assert start_in_utf8("PathFileType".encode(encoding)[:20]).startswith(b"PathFil")


def test_a_file_of_a_known_kind_and_an_unknown_suffix_is_named(tmp_path: Path) -> None:
    path = tmp_path / "take.gesichter"
    path.write_bytes(gzip.compress(b"\x06\0\0\1\0\0\1\x22"))
    with pytest.raises(ValueError, match=r"take\.gesichter: it is probably a record of Live Link"):
        ng.get_node("read.recording")(path=path)
