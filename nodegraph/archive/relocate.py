"""Texts of a run such that they mean the same elsewhere: no folder of this machine is in them."""

from __future__ import annotations

import gzip
import html
import json
import os
import posixpath
import re
import sys
import tempfile
import zlib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import Any

import markupsafe

from nodegraph.runs.record import Record
from nodegraph.runs.settings import RunSettings

_BEFORE = r"(?:(?<=file://)|(?<![\w+/.\-]))"
"""What stands before a path in a text; inside of base 64 there are none of ours."""
_AFTER = r"(?![\w\-])"
_USERS = ("/home", "/Users")

_FOLDERS = re.compile(
    r"(?<![\w.:/\\<+\-])(?:[A-Za-z]:)?(?:[/\\][^\s:'\"/\\<>,;()]+){2,}(?=[/\\])[/\\]"
)
_PLAIN = re.compile(r"(?:\.\./)*[A-Za-z_][\w./\-]*")


class Elsewhere:
    """Replaces what is of this machine only.

    Parameters
    ----------
    moved
        New texts for old ones, which may stand anywhere.
    folders
        Paths are written as seen from the nearest of these; what is left of them is their name.
    """

    def __init__(self, moved: Mapping[str, str], folders: Iterable[str]) -> None:
        new = {old: one for old, one in moved.items() if old != one}
        for folder in folders:
            new.setdefault(f"{folder}/", "")
            new.setdefault(folder, _last_name(folder))
        self._new = {form: one for old, text in new.items() for form, one in _forms(old, text)}
        longest = sorted(self._new, key=len, reverse=True)
        said = "|".join(re.escape(one) + ("" if one.endswith("/") else _AFTER) for one in longest)
        self._pattern = re.compile(f"{_BEFORE}(?:{said})") if longest else None

    def text(self, text: str) -> str:
        """Return a text with what is meant elsewhere."""
        if self._pattern is None:
            return text
        return self._pattern.sub(lambda found: self._new[found[0]], text)

    def content(self, name: str, content: bytes) -> bytes:
        """Return a file's content; what is no text comes back as it is."""
        try:
            if name.endswith(".gz"):
                inner = self.content(name.removesuffix(".gz"), gzip.decompress(content))
                return gzip.compress(inner, compresslevel=6, mtime=0)
            text = content.decode()
        except (UnicodeDecodeError, OSError, EOFError, zlib.error):
            return content
        return content if "\0" in text else self.text(text).encode()

    def still_in(self, content: bytes) -> bool:
        """Return whether a content that is no text has a path of this machine in it."""
        return self._pattern is not None and bool(self._pattern.search(content.decode("latin-1")))


def _last_name(folder: str) -> str:
    """Return what a folder is called where nothing below it is named; never after a person."""
    above, _, name = folder.rpartition("/")
    return "~" if above in _USERS or folder == str(Path.home()) else name


def _forms(old: str, new: str) -> Iterator[tuple[str, str]]:
    """Yield a replacement as it is written in plain text, in JSON and in HTML."""
    yield old, new
    yield json.dumps(old)[1:-1], json.dumps(new)[1:-1]
    yield html.escape(old), html.escape(new)
    yield html.escape(old, quote=False), html.escape(new, quote=False)
    yield str(markupsafe.escape(old)), str(markupsafe.escape(new))


def folders_here(record: Record, texts: Iterable[str], others: Iterable[Path]) -> set[str]:
    """Return the folders whose names say on which machine, and where on it, something lies.

    Parameters
    ----------
    record
        Folders that it names may be of another machine.
    texts
        Of graphs, which may name some too.
    others
        Further ones, such as that of the run.
    """
    known = [Path.home(), Path.cwd(), Path(tempfile.gettempdir()), Path(sys.prefix)]
    known += [Path(sys.base_prefix), *map(Path, sys.path), *others]
    both = (form for one in known for form in (os.path.abspath(one), os.path.realpath(one)))
    here = {one for one in both if len(PurePosixPath(one).parts) > 1}
    named = [*_named(record), *(found for text in texts for found in _FOLDERS.findall(text))]
    return here | {one.rstrip("/\\") for one in named}


def _named(record: Record) -> Iterator[str]:
    """Yield the folders of absolute paths in what a run says of its inputs and failures."""
    pending: list[Any] = [record.command, record.inputs]
    pending += [left_out.reason for left_out in record.left_out]
    for step in record.steps:
        pending += [step.settings, step.reason, step.trace, step.warnings, step.labels]
    for result in record.not_shown:
        pending += [result.labels, result.reason, result.trace]
    for file in record.not_written:
        pending += [file.reason, file.trace]
    while pending:
        one = pending.pop()
        if isinstance(one, Mapping):
            pending.extend(one.values())
        elif isinstance(one, list):
            pending.extend(one)
        elif isinstance(one, str):
            yield from _FOLDERS.findall(one)


def graph_elsewhere(text: str, was: Path, name: str, moved: Mapping[str, str]) -> str:
    """Return the text of a graph file whose paths lead to where files lie in an archive.

    Parameters
    ----------
    text
    was
        The folder in which it was.
    name
        In the archive.
    moved
        Names in the archive, by absolute paths as they were.
    """
    import yaml

    here = posixpath.dirname(name) or "."
    parts: list[str] = []
    end = 0
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        if not isinstance(event, yaml.ScalarEvent) or event.style in ("|", ">"):
            continue
        there = moved.get(os.path.normpath(was / event.value)) if event.value else None
        new = posixpath.relpath(there, here) if there is not None else event.value
        if new != posixpath.normpath(event.value) and there is not None:
            parts += [text[end : _place(event.start_mark)], _scalar(new)]
            end = _place(event.end_mark)
    return "".join([*parts, text[end:]])


def _place(mark: Any) -> int:
    return int(mark.index)


def _scalar(text: str) -> str:
    return text if _PLAIN.fullmatch(text) else json.dumps(text, ensure_ascii=False)


def settings_elsewhere(settings: RunSettings, graph: str, moved: Mapping[str, str]) -> RunSettings:
    """Return the settings that run the graph again in the unpacked archive.

    Parameters
    ----------
    settings
        Those of the run.
    graph
        The graph's name in the archive.
    moved
        Names in the archive by the paths that the settings have.
    """
    return RunSettings(
        graph,
        set=_in_archive(settings.set, moved),
        axis=_in_archive(settings.axis, moved),
        only=_in_archive(settings.only, moved),
        until=settings.until,
        plugins=_in_archive(settings.plugins, moved),
    )


def _in_archive(value: Any, moved: Mapping[str, str]) -> Any:
    if isinstance(value, Mapping):
        return {name: _in_archive(item, moved) for name, item in value.items()}
    if isinstance(value, list):
        return [_in_archive(item, moved) for item in value]
    return moved.get(value, value) if isinstance(value, str) else value
