"""The gallery: a card for each study, with its answer, a picture and the reports of its runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path, PurePosixPath
from urllib.parse import quote

from nodegraph.draw import svg
from nodegraph.draw.from_graph import picture_of
from nodegraph.errors import NodegraphError
from nodegraph.filenames import fold, portable_name
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_file
from nodegraph.plugin.registry import Registry
from nodegraph.report.study import Study, read_study
from nodegraph.runs.folder import REPORT
from nodegraph.site.page import Entry, Page
from nodegraph.site.prose import code_html

_FOLDER = "runs"
_PICTURES = "pictures"


@dataclass(frozen=True)
class RunReport:
    """A run whose report the site has.

    Attributes
    ----------
    name : str
        Of its folder in the site.
    study : Study
    files : mapping of str to Path
        What the site takes over, by its path in the run's folder.
    """

    name: str
    study: Study
    files: Mapping[str, Path]

    @property
    def graph(self) -> str:
        """The name of its graph file without the suffix."""
        return PurePosixPath(self.study.graph_file.replace("\\", "/")).stem

    @property
    def figure(self) -> str:
        """The path of the first figure of what answers at a glance, or of any; empty without."""
        leads = {each.node for each in self.study.sections if each.rendered.lead}
        sections = sorted(self.study.sections, key=lambda section: section.node not in leads)
        paths = (link.path for section in sections for link in section.files)
        return next((path for path in paths if path.endswith(".svg")), "")


def read_runs(folders: Iterable[Path]) -> list[RunReport]:
    """Return the runs in folders.

    Raises
    ------
    NodegraphError
        If there is no run that can be read, or a file is missing that its report links to.
    """
    runs: list[RunReport] = []
    for folder in dict.fromkeys(path.resolve() for path in folders):
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
        runs.append(RunReport(_free(folder.name, runs), study, files))
    return runs


def _free(name: str, runs: Sequence[RunReport]) -> str:
    taken = {fold(run.name) for run in runs}
    plain = portable_name(name)
    names = [plain, *(f"{plain}-{number}" for number in range(2, len(runs) + 3))]
    return next(free for free in names if fold(free) not in taken)


def gallery(registry: Registry, runs: Sequence[RunReport]) -> tuple[Page, dict[str, bytes]]:
    """Return the page of all studies, and the files that it needs beside the runs' own."""
    pictures: dict[str, bytes] = {}
    cards, entries = [], []
    shipped = registry.hooks.graphs
    with_runs = {run.graph for run in runs}
    for name, path in sorted(shipped.items(), key=lambda study: study[0] not in with_runs):
        of_study = [run for run in runs if run.graph == name]
        graph = build(read_graph_file(path), registry)
        figure = next((f"{_FOLDER}/{run.name}/{run.figure}" for run in of_study if run.figure), "")
        if not figure:
            figure = f"{_PICTURES}/{portable_name(name)}.svg"
            pictures[figure] = svg(picture_of(graph)).encode()
        cards.append(_card(name, graph.title, figure, of_study))
        entries.append(Entry(graph.title, _answer(of_study), _anchor(name)))
    for run in (run for run in runs if run.graph not in shipped):
        figure = f"{_FOLDER}/{run.name}/{run.figure}" if run.figure else ""
        cards.append(_card(run.name, run.study.title, figure, [run]))
        entries.append(Entry(run.study.title, _answer([run]), _anchor(run.name)))
    body = f'<h1>Gallery</h1>\n<div class="studies">\n{"".join(cards)}</div>'
    return Page("gallery.html", "Gallery", body, tuple(entries)), pictures


def run_files(runs: Iterable[RunReport]) -> dict[str, Path]:
    """Return the files of runs by their paths in the site."""
    return {
        f"{_FOLDER}/{run.name}/{path}": file for run in runs for path, file in run.files.items()
    }


def _answer(runs: Sequence[RunReport]) -> str:
    return next((run.study.short_answer(1)[0] for run in runs if run.study.answer), "")


def _anchor(name: str) -> str:
    return f"study-{portable_name(name)}"


def _card(name: str, title: str, figure: str, runs: Sequence[RunReport]) -> str:
    answer = _answer(runs)
    links = [
        f'<a href="{escape(quote(f"{_FOLDER}/{run.name}/{REPORT}"))}">Report of {escape(run.name)}'
        f'</a> <span class="quiet">{escape(run.study.created.partition("T")[0])}</span>'
        for run in runs
    ]
    commands = f"nodegraph examples {name}\nnodegraph run {name}.yaml"
    below = "" if runs else code_html(commands)
    return "\n".join(
        [
            f'<article id="{escape(_anchor(name))}">',
            f'<div class="picture"><img src="{escape(quote(figure))}" alt="" loading="lazy"></div>'
            if figure
            else "",
            f"<h2>{escape(title)}</h2>",
            f"<p>{escape(answer)}</p>" if answer else "",
            *(f"<p>{link}</p>" for link in links),
            below,
            "</article>\n",
        ]
    )
