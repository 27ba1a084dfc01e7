"""Which registered format a file has: by its content, or else by its suffix."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from pathlib import Path

from nodegraph import Format

_START = 1024  # bytes


def format_of(file: Path, formats: Sequence[Format]) -> Format:
    """Return the first format that recognizes a file's content, or else has its suffix.

    Raises
    ------
    ValueError
        If there is none; the message lists the formats.
    """
    with file.open("rb") as stream:
        start = stream.read(_START)
    by_content = (each for each in formats if each.recognizes(start))
    by_suffix = (each for each in formats if file.suffix.lower() in each.suffixes)
    match = next(chain(by_content, by_suffix), None)
    if match is None:
        known = ", ".join(f"{each.name} ({', '.join(each.suffixes)})" for each in formats)
        raise ValueError(f"{file}: unknown format; there is {known or 'none'}")
    return match


def file_names(stem: str, formats: Sequence[Format]) -> tuple[str, ...]:
    """Return the names of the files that a reader takes from a folder, one per format."""
    return tuple(stem + each.suffixes[0] for each in formats)
