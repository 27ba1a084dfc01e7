"""Runs of the shipped graphs in this process, which share a store: equal steps run once."""

from __future__ import annotations

import csv
import io
import json
import re
import shutil
import time
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import pytest

from nodegraph.cli.main import main
from nodegraph.errors import NodegraphError
from nodegraph.lock.lockfile import read_lock
from nodegraph.remote import remote_file
from tests.memory import give_back

ROOT = Path(__file__).parents[1]
DATA = ROOT.parent / "shared" / "data"
GRAPHS = sorted((ROOT / "graphs").glob("*.yaml"))
ONE = (
    *(
        "--only",
        "recording=face_1",
        "--only",
        "condition=own_noise",
        "--only",
        "terms=ends_met",
    ),
    *("--axis", "length=45"),
)
"""One combination of the graph of fills for each method."""
FILL, _, _ = (ROOT / "graphs" / "fill.yaml").read_text().partition("  ranks:\n")
FILL = re.sub(" +movement: .*\n", "", FILL)
"""The graph of fills up to its table, which no other node takes part in."""
OF_SAMPLES = {
    "fill_real": (
        *("--axis", "recording=sample:face_1,sample:face_2", "--only", "length=45"),
        *("--only", "trial=0", "--only", "fill=muscle,lin_ouhyoung,guenter,linear"),
    ),
}
"""A few combinations of graphs that name recordings at addresses."""

needs_recordings = pytest.mark.skipif(not DATA.is_dir(), reason="the recordings are not here")


def needs_fetched(name: str) -> pytest.MarkDecorator:
    """Return the mark of tests that read what a shipped graph names by addresses."""
    text = (ROOT / "graphs" / f"{name}.yaml").read_text()
    addresses = re.findall(r"https://\S+#sha256=\w+", text)
    return pytest.mark.skipif(
        not all(map(_is_here, addresses)), reason=f"needs `nodegraph fetch graphs/{name}.yaml`"
    )


def _is_here(address: str) -> bool:
    try:
        remote_file(address)
    except NodegraphError:
        return False
    return True


STUDIES = [
    pytest.param(path.stem, marks=[] if path.stem in OF_SAMPLES else needs_fetched(path.stem))
    for path in GRAPHS
]
"""The names of the shipped graphs; those that need files at addresses are skipped without these."""


@dataclass(frozen=True)
class Ended:
    """The exit status of a command, and what it printed."""

    status: int
    out: str
    err: str


def command(*words: str, folder: Path) -> Ended:
    """Give a command in a folder."""
    out, err = io.StringIO(), io.StringIO()
    with chdir(folder), redirect_stdout(out), redirect_stderr(err):
        try:
            status = main(list(words))
        except SystemExit as stop:
            status = int(stop.code or 0)
    assert "internal error" not in err.getvalue()
    return Ended(status, out.getvalue(), err.getvalue())


def few(name: str) -> tuple[str, ...]:
    """Return the options of a run of a few combinations of a shipped graph: those of its lock."""
    if name in OF_SAMPLES:
        return OF_SAMPLES[name]
    chosen = read_lock(ROOT / "graphs" / f"{name}.lock").record.settings
    words: list[str] = []
    for option, axes in (("--axis", chosen.axis), ("--only", chosen.only)):
        for axis, labels in axes.items():
            words += (option, f"{axis}={json.dumps(labels)}")
    return tuple(words)


class Studies:
    """Runs graphs with one store.

    Parameters
    ----------
    tmp_path_factory
    store
    """

    def __init__(self, tmp_path_factory: pytest.TempPathFactory, store: Path) -> None:
        self._tmp_path_factory = tmp_path_factory
        self.store = store

    def command(self, *words: str, folder: Path) -> Ended:
        """Give a command that has a store."""
        return command(*words, "--store", str(self.store), folder=folder)

    def run(self, graph: Path | str, *words: str, folder: Path | None = None) -> Path:
        """Run a graph, or a shipped one by its name; return the folder of the run.

        The folder has what was printed in ``printed.txt``.
        """
        path = graph if isinstance(graph, Path) else ROOT / "graphs" / f"{graph}.yaml"
        folder = folder or self._tmp_path_factory.mktemp(path.stem)
        ended = self.command("run", str(path), *words, "--out", "made", folder=folder)
        give_back()
        assert ended.status == 0, ended.err
        (folder / "made" / "printed.txt").write_text(ended.out)
        return folder / "made"

    def few(self, name: str) -> Path:
        """Return the folder of a run of a few combinations of a shipped graph; do not change it.

        It runs once for all workers of pytest-xdist.
        """
        folder = self.store.parent / "few" / name
        while not (folder / "ended").exists():
            try:
                folder.mkdir(parents=True)
            except FileExistsError:  # another worker runs it
                time.sleep(0.05)
                continue
            try:
                self.run(name, *few(name), folder=folder)
            except BaseException:
                shutil.rmtree(folder)  # no worker waits for it
                raise
            (folder / "ended").touch()
        return folder / "made"


def table(path: Path) -> list[dict[str, str]]:
    """Return the rows of a file of comma-separated values."""
    with path.open() as file:
        return list(csv.DictReader(file))
