"""A static gallery of runs: a card for each, with its answer, a figure and its report."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

from nodegraph.errors import NodegraphError, listed
from nodegraph.filenames import fold, portable_name
from nodegraph.formatting import number_of
from nodegraph.report.page import templates_of
from nodegraph.report.study import Study, read_study
from nodegraph.runs.folder import REPORT, STUDY, is_run, runs_in

INDEX, STYLE = "index.html", "gallery.css"


class Contents(NamedTuple):
    """The number of runs, and the files by their paths: those to write, and those to copy."""

    runs: int
    generated: dict[str, bytes]
    copied: dict[str, Path]


@dataclass(frozen=True)
class _RunReport:
    """A run as the gallery shows it.

    Attributes
    ----------
    name : str
        Name of its folder in the gallery.
    study : Study
    files : mapping of str to Path
        Files that are copied, by their paths in the run's folder.
    """

    name: str
    study: Study
    files: Mapping[str, Path]

    @property
    def figure(self) -> str:
        """The path of the first figure, one of the section that answers if it has any; or empty."""
        leads = {each.node for each in self.study.sections if each.rendered.lead}
        sections = sorted(self.study.sections, key=lambda section: section.node not in leads)
        paths = (link.path for section in sections for link in section.files)
        return next((path for path in paths if path.endswith(".svg")), "")

    @property
    def answer(self) -> str:
        """The first sentence of the answer; empty without one."""
        return self.study.short_answer(1)[0] if self.study.answer else ""


def gallery(folders: Iterable[Path]) -> Contents:
    """Return the files of a gallery of runs, from their folders or from folders that hold them.

    A warning counts the runs in a folder that are not finished, and are left out. The links are
    relative; the page loads nothing from elsewhere, and forbids that to itself.

    Raises
    ------
    NodegraphError
        If a folder holds no run that can be read, or a file is missing that its report links to.
    """
    runs = _read_runs(folders)
    html = (
        templates_of("nodegraph.site")
        .get_template("gallery.html")
        .render(runs=runs, report=REPORT, style=STYLE)
    )
    style = files("nodegraph.site").joinpath("templates", STYLE).read_bytes()
    # an answer that names a file may hold what is not valid text
    generated = {INDEX: html.encode(errors="backslashreplace"), STYLE: style}
    copied = {f"{run.name}/{path}": file for run in runs for path, file in run.files.items()}
    return Contents(len(runs), generated, copied)


def _read_runs(folders: Iterable[Path]) -> list[_RunReport]:
    runs: list[_RunReport] = []
    named = (run for folder in folders for run in _finished(folder))
    for folder in dict.fromkeys(path.resolve() for path in named):
        study = read_study(folder)
        links = [link for section in study.sections for link in section.files]
        paths = [REPORT, *(link.path for link in (*links, *study.files))]
        files = {path: folder / path for path in dict.fromkeys(paths)}
        for path, file in files.items():
            if not file.is_file() or not file.resolve().is_relative_to(folder):
                raise NodegraphError(
                    f"{folder}: there is no file {path}, to which the report links; run the graph "
                    "again"
                )
        runs.append(_RunReport(_free(folder.name, runs), study, files))
    return runs


def _finished(folder: Path) -> list[Path]:
    """Return a folder, or the runs in it that have ended with a report, by their names."""
    there = [] if is_run(folder) else sorted(runs_in(folder))
    finished = [run for run in there if (run / STUDY).is_file()]
    if len(finished) < len(there):
        others = [run.name for run in there if run not in finished]
        warnings.warn(
            f"{folder}: {number_of(len(others), 'run')} without a report left out: "
            f"{listed(others)}",
            stacklevel=2,
        )
    return finished if finished else [folder]


def _free(name: str, runs: Sequence[_RunReport]) -> str:
    taken = {fold(STYLE), fold(INDEX), *(fold(run.name) for run in runs)}
    plain = portable_name(name)
    names = [plain, *(f"{plain}-{number}" for number in range(2, len(runs) + 4))]
    return next(free for free in names if fold(free) not in taken)
