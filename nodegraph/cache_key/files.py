"""The content of files; a file that has not changed is not read again."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

_SETTLED = 2_000_000_000
"""Nanoseconds after which an edit gets another time, on any file system."""


_READ: dict[tuple[str, Callable[[str], Any]], tuple[list[int], Any]] = {}
"""What this process has read, with the size, time and number of the file."""


class FileMemo:
    """Data found in files, each kept until the file changes, by this process for every memo.

    Parameters
    ----------
    remembered
        The attribute `remembered` of an earlier process.

    Attributes
    ----------
    remembered : dict
        Plain data for JSON, which saves a later process from reading the same files again.
    """

    def __init__(self, remembered: Mapping[str, object] | None = None) -> None:
        self.remembered = dict(remembered or {})

    def get(self, path: str, read: Callable[[str], Any]) -> Any:
        """Return what a function reads in a file.

        Raises
        ------
        OSError
            If the file cannot be read.
        """
        status = os.stat(path)
        # a program can put back the time of an edit, but not that of a change of the status
        mark = [status.st_size, status.st_mtime_ns, status.st_ctime_ns, status.st_ino]
        match self.remembered.get(path):
            case [known, data] if known == mark:
                return data
        known, data = _READ.get((path, read), (None, None))
        if known != mark:
            data = read(path)
        # a file that was written just now may be written again within one tick of its clock
        if time.time_ns() - status.st_mtime_ns > _SETTLED:
            self.remembered[path] = [mark, data]
            _READ[path, read] = mark, data
        return data


class FileDigests(FileMemo):
    """Digests of the content of files."""

    def digest(self, path: Path) -> str:
        """Return the digest of a file with its suffix, or of all files in a folder.

        Raises
        ------
        OSError
            If it cannot be read.
        """
        if not path.is_dir():
            return self._content(str(path)) + path.suffix.lower()
        files = sorted(file for file in path.rglob("*") if file.is_file())
        texts = (
            f"{file.relative_to(path).as_posix()} {self._content(str(file))}" for file in files
        )
        return hashlib.sha256("\n".join(texts).encode()).hexdigest()

    def _content(self, path: str) -> str:
        return str(self.get(path, _sha256))


def _sha256(path: str) -> str:
    with open(path, "rb") as opened:
        return hashlib.file_digest(opened, "sha256").hexdigest()
