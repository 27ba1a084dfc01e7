"""Replace the paths of this machine in the texts of a run by those in its archive."""

from __future__ import annotations

import gzip
import html
import io
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

from nodegraph.execute.settings import RunSettings
from nodegraph.graphfile.spec import with_names
from nodegraph.lock.portable import texts_in
from nodegraph.runs.record import Record

_BEFORE = r"(?:(?<=file://)|(?<![\w+/.\-]))"
"""Characters before a path in a text, so that none is matched inside of base 64."""
_AFTER = r"(?![\w\-])"
_USERS = ("/home", "/Users")
_MOST_BYTES = 512_000_000
"""Most bytes of a text: a few kilobytes, compressed, may hold more than the memory does."""

_FOLDERS = re.compile(
    r"(?<![\w.:/\\<+\-])(?:[A-Za-z]:)?(?:[/\\][^\s:'\"/\\<>,;()]+){2,}(?=[/\\])[/\\]"
)
_PLAIN = re.compile(r"(?:\.\./)*[A-Za-z_][\w./\-]*")


class Relocation:
    """Replaces paths of this machine in texts.

    Parameters
    ----------
    replacements
        New texts by old ones.
    folders
        Folders that are removed from paths; by themselves they are replaced by their names.
    """

    def __init__(self, replacements: Mapping[str, str], folders: Iterable[str]) -> None:
        by_old = {old: new for old, new in replacements.items() if old != new}
        for folder in folders:
            by_old.setdefault(f"{folder}/", "")
            by_old.setdefault(folder, _last_name(folder))
        self._new = dict(form for old, new in by_old.items() for form in _forms(old, new))
        longest = sorted(self._new, key=len, reverse=True)
        texts = (re.escape(old) + ("" if old.endswith("/") else _AFTER) for old in longest)
        self._pattern = re.compile(f"{_BEFORE}(?:{'|'.join(texts)})") if longest else None

    def text(self, text: str) -> str:
        """Return a text with the paths of the archive."""
        if self._pattern is None:
            return text
        return self._pattern.sub(lambda match: self._new[match[0]], text)

    def encoded(self, text: str) -> bytes:
        """Return a text with the paths of the archive as UTF-8."""
        return self.text(text).encode(errors="backslashreplace")

    def content(self, name: str, content: bytes) -> bytes:
        """Return the content of a file; the same object if it is not text, or one beyond 512 MB."""
        try:
            if name.endswith(".gz"):
                with gzip.GzipFile(fileobj=io.BytesIO(content)) as packed:
                    plain = packed.read(_MOST_BYTES + 1)
                if len(plain) > _MOST_BYTES:
                    return content
                inner = self.content(name.removesuffix(".gz"), plain)
                return gzip.compress(inner, compresslevel=6, mtime=0)
            text = content.decode()
        except (UnicodeDecodeError, OSError, EOFError, zlib.error):
            return content
        return content if "\0" in text else self.text(text).encode()

    def matches(self, content: bytes) -> bool:
        """Return whether a binary content contains a path of this machine."""
        return self._pattern is not None and bool(self._pattern.search(content.decode("latin-1")))


def _last_name(folder: str) -> str:
    """Return the name of a folder, or ``~`` for the home of a user."""
    above, _, name = folder.rpartition("/")
    return "~" if above in _USERS or folder == str(Path.home()) else name


def _forms(old: str, new: str) -> Iterator[tuple[str, str]]:
    """Yield a replacement in plain text, in JSON and in HTML."""
    yield old, new
    yield json.dumps(old)[1:-1], json.dumps(new)[1:-1]
    yield html.escape(old), html.escape(new)
    yield html.escape(old, quote=False), html.escape(new, quote=False)
    yield str(markupsafe.escape(old)), str(markupsafe.escape(new))


def local_folders(record: Record, texts: Iterable[str], folders: Iterable[Path]) -> set[str]:
    """Return the folders whose names depend on the machine.

    Parameters
    ----------
    record
        A record, whose folders may be of another machine.
    texts
        Graphs, which may contain folders.
    folders
        Further ones, such as that of the run.
    """
    known = [Path.home(), Path.cwd(), Path(tempfile.gettempdir()), Path(sys.prefix)]
    known += [Path(sys.base_prefix), *map(Path, sys.path), *folders]
    paths = {form(path) for path in known for form in (os.path.abspath, os.path.realpath)}
    local = {path for path in paths if len(PurePosixPath(path).parts) > 1}
    recorded = [*_recorded_folders(record), *(f for text in texts for f in _FOLDERS.findall(text))]
    return local | {folder.rstrip("/\\") for folder in recorded}


def _recorded_folders(record: Record) -> Iterator[str]:
    """Yield the folders of absolute paths in the inputs, settings and messages of a run."""
    said: list[object] = [record.command, record.inputs]
    said += [left_out.reason for left_out in record.left_out]
    for step in record.steps:
        said += [step.settings, step.reason, step.trace, step.warnings, step.labels]
    for result in record.not_shown:
        said += [result.labels, result.reason, result.trace]
    for file in record.not_written:
        said += [file.reason, file.trace]
    for text in texts_in(said):
        yield from _FOLDERS.findall(text)


def relocate_graph(text: str, folder: Path, name: str, names: Mapping[str, str]) -> str:
    """Return the text of a graph file with the paths of files in an archive.

    Parameters
    ----------
    text
    folder
        The folder in which it was.
    name
        Its name in the archive.
    names
        Names in the archive by absolute paths.
    """
    import yaml

    here = posixpath.dirname(name) or "."
    parts: list[str] = []
    end = 0
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        if not isinstance(event, yaml.ScalarEvent) or event.style in ("|", ">"):
            continue
        target = names.get(os.path.normpath(folder / event.value)) if event.value else None
        if target is None:
            continue
        new = posixpath.relpath(target, here)
        if new != posixpath.normpath(event.value):
            scalar = new if _PLAIN.fullmatch(new) else json.dumps(new, ensure_ascii=False)
            parts += [text[end : _index(event.start_mark)], scalar]
            end = _index(event.end_mark)
    return "".join([*parts, text[end:]])


def _index(mark: Any) -> int:
    return int(mark.index)


def relocate_settings(settings: RunSettings, graph: str, names: Mapping[str, str]) -> RunSettings:
    """Return the settings that run the graph again in the unpacked archive.

    Parameters
    ----------
    settings
        The settings of the run.
    graph
        The name of the graph in the archive.
    names
        Names in the archive by paths in the settings.
    """
    return RunSettings(
        graph,
        set=with_names(settings.set, names),
        axis=with_names(settings.axis, names),
        only=with_names(settings.only, names),
        until=settings.until,
        plugins=with_names(settings.plugins, names),
    )
