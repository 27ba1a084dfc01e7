"""The contents of an archive, and the file that they make."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field

from nodegraph.archive.inputs import ReadFile
from nodegraph.archive.relocate import Relocation
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
    inputs : tuple of ReadFile
    command : str
        Runs the graph again in the unpacked archive.
    missing : list of str
        What is not in the archive, and why.
    relocation : Relocation
        Removes paths of this machine.
    """

    graph: str
    study: Study
    record: Record
    command: str = ""
    files: dict[str, bytes] = field(default_factory=dict)
    inputs: tuple[ReadFile, ...] = ()
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
