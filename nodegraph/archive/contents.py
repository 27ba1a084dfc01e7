"""The contents of an archive, the file that they make, and its README."""

from __future__ import annotations

import io
import shlex
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from nodegraph.archive.inputs import PLUGINS, ArchivedInput
from nodegraph.archive.relocate import Relocation
from nodegraph.remote import is_remote
from nodegraph.report.study import Study
from nodegraph.runs.record import Record

METADATA = "ro-crate-metadata.json"
README = "README.md"
RUN, CITATION = "run", "citation"
"""Folders of an archive."""

_EARLIEST = (1980, 1, 1, 0, 0, 0)
_READABLE = 0o100644 << 16
_UNIX = 3


@dataclass
class Contents:
    """The contents of an archive.

    Attributes
    ----------
    graph : str
        The name of the graph.
    study : Study
    record : Record
    files : dict of name to bytes
    inputs : tuple of ArchivedInput
    command : str
        Runs the graph again in the unpacked archive.
    missing : list of str
        Files that are not in the archive, and why.
    relocation : Relocation
        Removes paths of this machine.
    """

    graph: str
    study: Study
    record: Record
    command: str = ""
    files: dict[str, bytes] = field(default_factory=dict)
    inputs: tuple[ArchivedInput, ...] = ()
    missing: list[str] = field(default_factory=list)
    relocation: Relocation = field(default_factory=lambda: Relocation({}, ()))

    @property
    def results(self) -> list[str]:
        """The names of the results of the run."""
        return sorted(name for name in self.files if name.startswith(f"{RUN}/"))


def packed(files: Mapping[str, bytes], metadata: bytes) -> bytes:
    """Return the bytes of an archive, which depend only on its files."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as file:
        for name, content in {METADATA: metadata, **dict(sorted(files.items()))}.items():
            entry = zipfile.ZipInfo(name, _EARLIEST)
            entry.compress_type, entry.create_system = zipfile.ZIP_DEFLATED, _UNIX
            entry.external_attr = _READABLE
            file.writestr(entry, content)
    return buffer.getvalue()


def readme(contents: Contents) -> str:
    """Return the text of the README in Markdown."""
    study = contents.study
    version = dict(study.versions).get("nodegraph", "")
    missing = ", and with what is not in this archive" if contents.missing else ""
    lines = [
        f"# {study.title}",
        "",
        f"A run of `{contents.graph}` by nodegraph {version}, made {study.created}. "
        "Its report is `run/report.html`; what to cite is in `citation/`; "
        "`ro-crate-metadata.json` describes every file (Workflow Run RO-Crate 0.5).",
        "",
        *study.answer,
        "",
        f"Run it again here, with the same versions of the packages below{missing}:",
        "",
        *_fetch(contents),
        f"    {contents.command}",
        "",
        *_verify(contents),
        *_inputs(contents),
        *_missing(contents),
        "Paths are those in this archive; folders of the machine that ran it are left out.",
        "",
        ", ".join(f"{name} {version}" for name, version in study.versions),
        "",
    ]
    return "\n".join(lines)


def _fetch(contents: Contents) -> Iterator[str]:
    if any(is_remote(file.written) for file in contents.inputs):
        yield f"    nodegraph fetch {contents.command.removeprefix('nodegraph run ')}"


def _verify(contents: Contents) -> Iterator[str]:
    lock = next((name for name in contents.files if name.endswith(".lock")), "")
    if lock and "/" not in lock:
        plugins = [name for name in contents.files if name.startswith(f"{PLUGINS}/")]
        options = [word for name in sorted(plugins) for word in ("--plugin", name)]
        command = shlex.join(["nodegraph", "verify", lock, *options])
        yield f"Verify that it still has the same results: `{command}`"
        yield ""


def _inputs(contents: Contents) -> Iterator[str]:
    if contents.inputs:
        yield "Input files, with the SHA-256 of their content and their suffix:"
        yield ""
        for file in contents.inputs:
            yield f"- `{file.name}`{_whence(file)}: {file.digest}"
        yield ""


def _whence(file: ArchivedInput) -> str:
    if is_remote(file.written):
        return ", to be fetched from there"
    return ", part of its package" if file.is_shipped else ""


def _missing(contents: Contents) -> Iterator[str]:
    if contents.missing:
        yield "Not in this archive:"
        yield ""
        yield from (f"- {text}" for text in contents.missing)
        yield ""
