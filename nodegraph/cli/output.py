"""The output of commands: printed text, and files."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, TYPE_CHECKING

from nodegraph.errors import NodegraphError
from nodegraph.formatting import size_text

if TYPE_CHECKING:
    from rich.console import Console

MOST = 12
"""Number of items of a kind that are printed."""


def say(text: str) -> None:
    """Print to standard error what is not a result."""
    print(text, file=sys.stderr)


def console(stream: IO[str]) -> Console:
    """Return a console that prints to a stream in the width of its terminal.

    It uses colours and bold if the stream is a terminal and ``NO_COLOR`` is not set.
    """
    from rich.console import Console

    # rich itself would still print bold
    plain = bool(os.environ.get("NO_COLOR"))
    return Console(file=stream, color_system=None if plain else "auto", highlight=False)


def columns(rows: Sequence[Sequence[str]]) -> str:
    """Return rows as aligned columns."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = (
        "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    )
    return "\n".join(lines)


def counted(counts: Counter[str]) -> str:
    """Return the number of combinations of each node: ``fill (4), total (1)``."""
    return ", ".join(f"{node} ({count})" for node, count in counts.items() if count)


def few(lines: Sequence[str], kind: str = "") -> Iterator[str]:
    """Yield the first lines, and how many more there are."""
    yield from lines[:MOST]
    if len(lines) > MOST:
        yield f"and {len(lines) - MOST} more{f' {kind}' if kind else ''}"


def write_file(path: Path, content: bytes) -> None:
    """Write a file whole or not at all, with the folders that it needs.

    Raises
    ------
    NodegraphError
        If it cannot be written there.
    """
    from nodegraph.store import files

    try:
        files.write(str(path.parent), path.name, content)
    except OSError as error:
        raise _unwritable(path, error) from error


def write_and_print(path: Path, content: bytes) -> None:
    """Write a file, and print its path and its size."""
    write_file(path, content)
    print(f"{path} ({size_text(len(content))})")


def refuse_existing(path: Path) -> None:
    """Raise an error if a path exists.

    Raises
    ------
    NodegraphError
    """
    if path.exists():
        raise NodegraphError(f"{path} already exists; name another place, or remove it first")


def refuse_unwritable(path: Path) -> None:
    """Raise an error if a file cannot be written, before long work is done for it.

    Nothing is left there, neither a file nor a folder.

    Raises
    ------
    NodegraphError
    """
    from tempfile import TemporaryFile

    try:
        if path.is_dir():
            raise IsADirectoryError
        with TemporaryFile(dir=next(parent for parent in path.parents if parent.exists())):
            pass
    except OSError as error:
        raise _unwritable(path, error) from error


def _unwritable(path: Path, error: OSError) -> NodegraphError:
    # os.path, unlike pathlib, answers for paths that are too long as well
    above = [parent for parent in path.parents if os.path.isfile(parent)]
    if above:
        reason = f"{above[0]} is a file, not a folder"
    elif os.path.isdir(path):
        reason = "it is a folder; name a file"
    else:
        reason = error.strerror or str(error)
    return NodegraphError(f"{path}: cannot be written: {reason}; name another place with --out")
