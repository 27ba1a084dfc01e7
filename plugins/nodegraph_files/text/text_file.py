"""Files of text as bytes whose encoding and line ends no longer matter."""

from __future__ import annotations

import re
import zlib
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import NamedTuple

_MARKS = ((BOM_UTF8, "utf-8"), (BOM_UTF16_LE, "utf-16-le"), (BOM_UTF16_BE, "utf-16-be"))
_START = 1 << 16  # bytes
_GZIP = b"\x1f\x8b"
_OTHERS = {
    _GZIP: "compressed by gzip; unpack it first",
    b"PK\x03\x04": "a ZIP archive or a spreadsheet; unpack it, or save the sheet as CSV",
    b"\x89HDF": "an HDF5 file; save the recording as CSV or NPZ",
    b"MATLAB 5": "a MATLAB file; save the recording as CSV or NPZ",
    b"\x00\x00\x00\x06": "probably a record of Live Link packets; use the CSV file of the take",
    b"\x06": "probably a record of Live Link packets; use the CSV file of the take",
    b"version https://git-lfs": "a pointer of Git LFS; fetch the file with git lfs pull",
    b"<!DOCTYPE": "a web page; download the file that it shows",
    b"<html": "a web page; download the file that it shows",
}
"""File formats by their first bytes, with which no table begins."""
_COMMENT = re.compile(r"#\s*(\w+)\s*[:=]\s*(\S+)(?:\s+\w+)?")


class Line(NamedTuple):
    """A line of a file: its number, its text, its first byte and that of the next one."""

    number: int
    text: str
    start: int
    end: int


class Comment(NamedTuple):
    """The name and value of a line ``# name: value``, and its place."""

    value: str
    line: int


@dataclass(frozen=True)
class TextFile:
    """A text as it was written, in UTF-8, its lines ended by line feeds alone.

    Attributes
    ----------
    path : Path
    content : bytes
        The lines are decoded one by one, as only few of a long recording need it.
    plain : bool
        Whether the content is that of the file, byte by byte.
    commented : bool
        Whether lines that begin with ``#`` count as empty.
    """

    path: Path
    content: bytes
    plain: bool = False
    commented: bool = False

    def lines(self, start: int = 0, number: int = 1) -> Iterator[Line]:
        """Return the lines from a byte on, which is in the line of that number.

        Raises
        ------
        ValueError
            With file and line, if one is not text in UTF-8.
        """
        stream = BytesIO(self.content)
        stream.seek(start)
        for place, raw in enumerate(stream, number):
            yield Line(place, self._decoded(place, raw), start, start + len(raw))
            start += len(raw)

    def comments(self) -> dict[str, Comment]:
        """Return what lines ``# name: value`` say, by name in small letters."""
        comments, at, line = {}, 0, 1
        while (hit := self.content.find(b"#", at)) >= 0:
            start = max(self.content.rfind(b"\n", at, hit) + 1, at)
            line += self.content.count(b"\n", at, start)
            end = self.content.find(b"\n", hit)
            at = end if end >= 0 else len(self.content)
            text = self.content[start:at].decode(errors="replace").strip()
            if match := _COMMENT.fullmatch(text):
                comments[match[1].lower()] = Comment(match[2], line)
        return comments

    def _decoded(self, number: int, raw: bytes) -> str:
        try:
            text = raw.decode().removesuffix("\n")
        except UnicodeDecodeError as error:
            byte = error.object[error.start]
            raise ValueError(
                f"{self.path}: not a table of text in UTF-8: line {number} holds byte 0x{byte:02x}"
            ) from None
        return "" if self.commented and text.lstrip().startswith("#") else text


def read_text_file(path: Path) -> TextFile:
    """Read a text in UTF-8, or in UTF-16 if it begins with a byte order mark.

    Raises
    ------
    ValueError
        If the file is not text.
    """
    raw = path.read_bytes()
    other = other_format(raw)
    if other is not None:
        raise ValueError(f"{path}: not a table of text: it is {other}")
    content = _in_utf8(path, raw)
    # The start is enough: what follows is refused where it is read, if it is not text.
    if b"\r" in content[:_START]:
        content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    zero = content.find(b"\0", 0, _START)
    if zero >= 0:
        line = content.count(b"\n", 0, zero) + 1
        raise ValueError(f"{path}: not a table of text: line {line} holds a zero byte")
    return TextFile(path, content, plain=content is raw)


def other_format(content: bytes) -> str | None:
    """Return what a file is that is not text, if that is known."""
    if content.startswith(_GZIP):
        with suppress(zlib.error):
            content = zlib.decompressobj(wbits=31).decompress(content, 8)
            inside = other_format(content)
            return f"{inside}, compressed by gzip" if inside else _OTHERS[_GZIP]
    return next((what for start, what in _OTHERS.items() if content.startswith(start)), None)


def start_in_utf8(start: bytes) -> bytes:
    """Return the first bytes of a file in UTF-8, whatever its byte order mark says they are in."""
    mark, encoding = _mark(start)
    return start.removeprefix(mark).decode(encoding, errors="replace").encode()


def _in_utf8(path: Path, content: bytes) -> bytes:
    mark, encoding = _mark(content)
    if encoding == "utf-8":
        return content.removeprefix(mark)
    try:
        return content.removeprefix(mark).decode(encoding).encode()
    except UnicodeError as error:
        raise ValueError(f"{path}: not a table of text in UTF-16: {error}") from None


def _mark(content: bytes) -> tuple[bytes, str]:
    """Return the byte order mark that the content begins with, and what it is in."""
    return next((mark for mark in _MARKS if content.startswith(mark[0])), (b"", "utf-8"))
