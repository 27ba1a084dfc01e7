"""Where a run was made: its files are looked for there, and from where the command is given."""

from __future__ import annotations

import hashlib
import shlex
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nodegraph.paper.archived.texts import options_of

PLUGINS = "plugins"


@dataclass(frozen=True)
class PluginFile:
    """A plugin file that the command of a run named.

    Attributes
    ----------
    written : str
        As the command has it.
    name : str
        In the archive.
    path : Path
        Where it lay.
    content : bytes or None
        What the run imported, if it is still found.
    """

    written: str
    name: str
    path: Path
    content: bytes | None


class Origin:
    """Where a run was made.

    Parameters
    ----------
    record
        As ``run.json`` holds it.

    Attributes
    ----------
    folder : Path
        From which the command was given.
    graph : Path
        As the command names it.
    home : Path
        The folder of the graph file.
    """

    def __init__(self, record: Mapping[str, Any]) -> None:
        self._record = record
        self.folder = Path(record["folder"])
        self.graph = Path(shlex.split(record["command"])[2])
        self._starts = list(dict.fromkeys((self.folder, Path.cwd())))
        with_graph = (one for one in self._starts if (one / self.graph).is_file())
        self.home = (next(with_graph, self.folder) / self.graph).parent

    def folders(self) -> list[Path]:
        """Return from where relative paths may be meant, the folder of the graph first."""
        homes = [self.home, *((one / self.graph).parent for one in self._starts)]
        used = [home / Path(name).parent for home in homes for name in self._record["included"]]
        return list(dict.fromkeys([*homes, *used, *self._starts]))

    def plugins(self) -> Iterator[PluginFile]:
        """Yield each plugin file that the command named."""
        imported = {Path(one["path"]).name: one for one in self._record["plugins"]}
        for option, written in options_of(self._record["command"]):
            if option == "--plugin":
                name = Path(written).name
                one = imported.get(name, {"path": written, "sha256": ""})
                paths = [Path(one["path"]), *(start / written for start in self._starts)]
                content = self._found(paths, one["sha256"])
                yield PluginFile(written, f"{PLUGINS}/{name}", paths[0], content)

    def lacks(self, path: str) -> str:
        """Return that a file is not found as it was, and where it would be."""
        if Path(path).is_absolute():
            return f"{path} is gone, or is no longer as the run used it"
        if self.folder.is_dir():
            return f"it is gone from {self.folder}, or is no longer as the run used it"
        return f"it is not here; archive the run where it was made, in {self.folder}"

    @staticmethod
    def _found(paths: list[Path], digest: str) -> bytes | None:
        for path in paths:
            try:
                content = path.read_bytes()
            except (OSError, ValueError):  # a record may say what is no path at all
                continue
            if hashlib.sha256(content).hexdigest() == digest:
                return content
        return None
