"""Source files and their summaries, some of them remembered from an earlier process."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Mapping
from importlib.machinery import SOURCE_SUFFIXES
from pathlib import Path
from typing import Any

from nodegraph.code.parts import Part, Summary, from_plain, to_plain

SETTLED = 2_000_000_000
"""Nanoseconds after which an edit gets another time, on any file system."""


class Sources:
    """Reads source files.

    Parameters
    ----------
    remembered
        What `remembered` returned in an earlier process. What is not of that form is left out.
    """

    def __init__(self, remembered: Any = None) -> None:
        self._known = dict(remembered) if isinstance(remembered, Mapping) else {}
        self._read: dict[str, Summary] = {}

    def summary(self, file: str) -> Summary:
        """Return a file's summary, read once in the life of this object.

        A file without Python source counts as one statement. If the file cannot be read, the
        summary is empty, and says why.
        """
        if file not in self._read:
            self._read[file] = self._summary(file)
        return self._read[file]

    def remembered(self) -> dict[str, Any]:
        """Return all summaries by file, for a later process."""
        return self._known

    def _summary(self, file: str) -> Summary:
        now = time.time_ns()
        try:
            state = os.stat(file)
            known = _still_true(self._known.get(file), state)
            if known is not None:
                return known
            made = _read(Path(file))
        except OSError as error:
            self._known.pop(file, None)
            return Summary(trouble=f"its file cannot be read: {error.strerror or error}")
        except SyntaxError as error:
            self._known.pop(file, None)
            return Summary(trouble=f"line {error.lineno or 0} is not Python: {error.msg}")
        except (ValueError, RecursionError, MemoryError) as error:
            self._known.pop(file, None)
            return Summary(trouble=f"its file is not Python that can be read: {error}")
        self._known[file] = {
            "size": state.st_size,
            "mtime_ns": state.st_mtime_ns,
            "read_ns": now,
            "summary": to_plain(made),
        }
        return made


def is_source(file: str) -> bool:
    """Whether a file holds Python source."""
    return file.endswith(tuple(SOURCE_SUFFIXES))


def _still_true(entry: Any, state: os.stat_result) -> Summary | None:
    try:
        same = (entry["size"], entry["mtime_ns"]) == (state.st_size, state.st_mtime_ns)
        if same and entry["mtime_ns"] + SETTLED <= entry["read_ns"]:
            return from_plain(entry["summary"])
    except (TypeError, KeyError, ValueError, AttributeError):
        pass  # not of our making: read again
    return None


def _read(path: Path) -> Summary:
    if not is_source(path.name):
        with path.open("rb") as opened:
            digest = hashlib.file_digest(opened, "sha256").hexdigest()
        return Summary(parts=(Part(digest, (), 0, 0),), statements=(0,))
    from nodegraph.code.summary import summarise  # late: most files are remembered

    return summarise(path.read_bytes())
