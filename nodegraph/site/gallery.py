"""A static gallery of runs: a card for each, with its answer, a figure and its report.

The page filters and sorts the cards, and keeps that in its address. Several runs of one study have
a page that shows their numbers beside each other.
"""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from itertools import pairwise
from pathlib import Path, PurePath
from typing import Any, NamedTuple

from nodegraph.errors import NodegraphError, listed
from nodegraph.execute.resume import open_store
from nodegraph.filenames import fold, portable_name
from nodegraph.formatting import number_of, options_of
from nodegraph.plugin.registry import Registry
from nodegraph.report.notes import note_kinds
from nodegraph.report.page import filled, source
from nodegraph.report.study import NoteSubject, Study, read_study
from nodegraph.runs.folder import REPORT, STUDY, is_run, moved_for, runs_in
from nodegraph.site.history import changes_between, data_of, tables

INDEX = "index.html"
_PACKAGE = "nodegraph.site"
_MARK = b'<meta name="generator" content="nodegraph site">'


class GalleryFiles(NamedTuple):
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
    folder : Path
    replaced_by : str
        Name of the folder of the later run of the same graph, if that did not fail; or empty.
    history : str
        Path of the page of all runs of the study; empty if this is the only one.
    """

    name: str
    study: Study
    files: Mapping[str, Path]
    folder: Path
    replaced_by: str = ""
    history: str = ""

    @property
    def question(self) -> tuple[str, str]:
        """The graph file and the title: equal in all runs of one study."""
        return self.study.graph_file, self.study.title

    @property
    def options(self) -> str:
        """The options of the command that repeats it."""
        return options_of(self.study.command)

    @property
    def created(self) -> datetime | None:
        """When it was run, or the first of several merged; None if that is not known."""
        try:
            when = datetime.fromisoformat(self.study.created.partition(" | ")[0])
        except ValueError:
            return None
        return when if when.tzinfo else when.replace(tzinfo=UTC)

    @property
    def failed(self) -> str:
        """How many combinations failed, as a report says it; empty if none did."""
        kinds = (kind for kind in note_kinds(self.study) if kind.kind is NoteSubject.FAILED)
        return next(map(str, kinds), "")

    @property
    def methods(self) -> Sequence[str]:
        """The full names of its methods."""
        return sorted({method.use for method in self.study.methods})

    @property
    def figure(self) -> str:
        """The path of the first figure, one of the section that answers if it has any; or empty."""
        leads = {each.node for each in self.study.sections if each.rendered.lead}
        sections = sorted(self.study.sections, key=lambda section: section.node not in leads)
        paths = (link.path for section in sections for link in section.files)
        return next((path for path in paths if path.endswith(".svg")), "")

    @property
    def answer(self) -> tuple[str, ...]:
        """The sentences of the answer, first the one that answers at a glance."""
        return tuple(dict.fromkeys([*self.study.short_answer(1), *self.study.answer]))


def is_gallery(folder: Path) -> bool:
    """Return whether a folder holds a gallery."""
    page = folder / INDEX
    return page.is_file() and _MARK in page.read_bytes()


def gallery(folders: Iterable[Path]) -> GalleryFiles:
    """Return the files of a gallery of runs, from their folders or from folders that hold them.

    A warning counts the runs in a folder that are not finished, and are left out. The links are
    relative; the page loads nothing from elsewhere, and forbids that to itself.

    Raises
    ------
    NodegraphError
        If a folder holds no run that can be read, or a file is missing that its report links to.
    """
    runs = _read_runs(folders)
    generated = dict(_histories(runs))
    generated[INDEX] = _page(
        "gallery",
        ("modules", "theme"),
        title="Studies",
        runs=runs,
        methods=sorted({method for run in runs for method in run.methods}),
        report=REPORT,
        mark=_MARK.decode(),
    )
    copied = {f"{run.name}/{path}": file for run in runs for path, file in run.files.items()}
    return GalleryFiles(len(runs), generated, copied)


def _histories(runs: Sequence[_RunReport]) -> Iterator[tuple[str, bytes]]:
    """Yield the path and the page of each study that has several runs."""
    studies: dict[str, list[_RunReport]] = {}
    for run in reversed(runs):  # the earliest first
        if run.history:
            studies.setdefault(run.history, []).append(run)
    if not studies:
        return
    store = open_store(Registry.installed(), None, partial(warnings.warn, stacklevel=2))
    for path, of_study in studies.items():
        data = [data_of(run.folder, store) for run in of_study]
        yield (
            path,
            _page(
                "history",
                ("modules", "helpers", "theme", "selection", "tables"),
                title=of_study[-1].study.title,
                runs=of_study,
                changes=[
                    changes_between(was.folder, now.folder, store)
                    for was, now in pairwise(of_study)
                ],
                data=[data.index(each) for each in data],
                tables=tables([run.study for run in of_study]),
                report=REPORT,
                index=INDEX,
            ),
        )


def _page(name: str, of_report: Iterable[str], **context: Any) -> bytes:
    """Return a page from its template, with its own script and style and scripts of the report."""
    html = filled(
        _PACKAGE,
        f"{name}.html",
        scripts=[*(source(f"{each}.js") for each in of_report), source(f"{name}.js", _PACKAGE)],
        styles=[source("gallery.css", _PACKAGE)],
        rules={"img-src": "data: 'self'"},
        **context,
    )
    # an answer that names a file may hold what is not valid text
    return html.encode(errors="backslashreplace")


def _read_runs(folders: Iterable[Path]) -> list[_RunReport]:
    """Return the runs, the latest first; those whose date is not known come last."""
    runs: dict[Path, _RunReport] = {}
    taken: list[str] = []
    named = (run for folder in folders for run in _finished(folder))
    for folder in dict.fromkeys(path.resolve() for path in named):
        study = read_study(folder)
        links = [link for section in study.sections for link in section.files]
        paths = [REPORT, *(link.path for link in (*links, *study.files))]
        copied = {path: folder / path for path in dict.fromkeys(paths)}
        for path, file in copied.items():
            if not file.is_file() or not file.resolve().is_relative_to(folder):
                raise NodegraphError(
                    f"{folder}: there is no file {path}, to which the report links; run the graph "
                    "again"
                )
        taken.append(_free(folder.name, taken))
        runs[folder] = _RunReport(taken[-1], study, copied, folder)
    histories = dict.fromkeys((run.question for run in runs.values()), "")
    for question, count in Counter(run.question for run in runs.values()).items():
        if count > 1:
            taken.append(_free(f"{PurePath(question[0]).stem or 'runs'}.html", taken))
            histories[question] = taken[-1]
    for folder, run in runs.items():
        later = runs.get(moved_for(folder) or Path())
        replaced_by = later.name if later is not None and later.study.ok else ""
        runs[folder] = replace(run, replaced_by=replaced_by, history=histories[run.question])
    return sorted(runs.values(), key=_when, reverse=True)


def _when(run: _RunReport) -> tuple[datetime, int]:
    """Return when a run was made: its date has minutes only, so the time of its file decides."""
    unknown = datetime.min.replace(tzinfo=UTC)
    return run.created or unknown, (run.folder / STUDY).stat().st_mtime_ns


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


def _free(name: str, others: Collection[str]) -> str:
    """Return a portable name that is none of others, with a number if need be."""
    taken = {fold(INDEX), *map(fold, others)}
    plain = PurePath(portable_name(name))
    names = (plain.with_stem(f"{plain.stem}-{number}") for number in range(2, len(taken) + 3))
    return next(str(free) for free in (plain, *names) if fold(str(free)) not in taken)
