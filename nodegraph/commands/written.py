"""Files that a command writes where the user says."""

from __future__ import annotations

import os
import tempfile
from contextlib import suppress
from pathlib import Path

from nodegraph.display import size_text
from nodegraph.errors import NodegraphError


def written(path: Path, content: bytes) -> None:
    """Write a file whole or not at all, with the folders that it needs.

    Raises
    ------
    NodegraphError
        If it cannot be written there.
    """
    unfinished = path.with_name(f"{path.name}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished.write_bytes(content)
        unfinished.replace(path)
    except OSError as error:
        raise _unwritable(path, error) from error
    finally:
        with suppress(OSError):
            unfinished.unlink(missing_ok=True)


def written_and_told(path: Path, content: bytes) -> None:
    """Write a file whole or not at all, and print where it is and how large."""
    written(path, content)
    print(f"{path} ({size_text(len(content))})")


def refuse_unwritable(path: Path) -> None:
    """Refuse a place where no file can be written, before long work is done for it.

    Nothing is left there, neither a file nor a folder.

    Raises
    ------
    NodegraphError
        If it cannot be written there.
    """
    try:
        if path.is_dir():
            raise IsADirectoryError
        with tempfile.TemporaryFile(dir=next(one for one in path.parents if one.exists())):
            pass
    except OSError as error:
        raise _unwritable(path, error) from error


def _unwritable(path: Path, error: OSError) -> NodegraphError:
    # paths of which nothing can be asked, such as too long ones, are neither
    in_the_way = [one for one in path.parents if os.path.isfile(one)]
    if in_the_way:
        reason = f"{in_the_way[0]} is a file, and no folder"
    elif os.path.isdir(path):
        reason = "it is a folder; name a file"
    else:
        reason = error.strerror or str(error)
    return NodegraphError(f"{path}: cannot be written: {reason}; name another place with --out")
