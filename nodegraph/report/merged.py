"""Several studies as one, their results side by side."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import PurePosixPath
from typing import TypeVar

from nodegraph.report.study import Link, Section, SettingRow, Study

T = TypeVar("T")


def merged(studies: Mapping[str, Study]) -> Study:
    """Return one study of several runs.

    What has one title stands together, a run after the other; each result, note, method and time
    is labelled with the name of its run. A method that ran alike everywhere is told once.

    Parameters
    ----------
    studies
        By the names of the runs, two at least.
    """
    first = next(iter(studies.values()))
    every = studies.items()
    return Study(
        title=" | ".join(dict.fromkeys(one.title for one in studies.values())),
        answer=tuple(f"{name}: {line}" for name, one in every for line in one.answer),
        notes_markdown="\n\n".join(dict.fromkeys(one.notes_markdown for one in studies.values())),
        sections=tuple(_sections(studies)),
        graph_svg=first.graph_svg,
        axes=first.axes if _same(one.axes for one in studies.values()) else (),
        inputs=tuple(_inputs(studies)),
        known=tuple(dict.fromkeys(one for study in studies.values() for one in study.known)),
        methods=tuple(dict.fromkeys(one for study in studies.values() for one in study.methods)),
        without_result=tuple(
            replace(one, reason=f"{one.reason} ({name})")
            for name, study in every
            for one in study.without_result
        ),
        bibtex="\n".join(dict.fromkeys(one.bibtex for one in studies.values() if one.bibtex)),
        notes=tuple(
            replace(note, labels=_and(name, note.labels))
            for name, one in every
            for note in one.notes
        ),
        timings=tuple(
            replace(row, node=f"{row.node} ({name})") for name, one in every for row in one.timings
        ),
        seconds=sum(one.seconds for one in studies.values()),
        versions=tuple(_versions(studies)),
        seeds=tuple((f"{node} ({name})", text) for name, one in every for node, text in one.seeds),
        command="\n".join(one.command for one in studies.values()),
        graph_file=first.graph_file,
        graph_text=first.graph_text,
        files=tuple(
            replace(link, text=f"{name}: {link.text}") for name, one in every for link in one.files
        ),
        created=" | ".join(dict.fromkeys(one.created for one in studies.values())),
        machine=" | ".join(dict.fromkeys(one.machine for one in studies.values())),
        runs=len(studies),
    )


def linked(study: Study, folder: str) -> Study:
    """Return a study whose files lie in a folder, as seen from the page: ``../runs/fill``."""
    sections = (replace(one, files=_moved(one.files, folder)) for one in study.sections)
    return replace(study, sections=tuple(sections), files=_moved(study.files, folder))


def _moved(links: Iterable[Link], folder: str) -> tuple[Link, ...]:
    return tuple(replace(link, path=str(PurePosixPath(folder, link.path))) for link in links)


def _sections(studies: Mapping[str, Study]) -> Iterator[Section]:
    titles = dict.fromkeys(one.title for study in studies.values() for one in study.sections)
    for title in titles:
        for name, study in studies.items():
            for one in study.sections:
                if one.title == title:
                    yield replace(one, labels=_and(name, one.labels))


def _inputs(studies: Mapping[str, Study]) -> Iterator[SettingRow]:
    """Yield the inputs, those that differ once per run."""
    for name in dict.fromkeys(row.name for one in studies.values() for row in one.inputs):
        rows = {run: row for run, one in studies.items() for row in one.inputs if row.name == name}
        if _same(rows.values()) and len(rows) == len(studies):
            yield next(iter(rows.values()))
        else:
            yield from (replace(row, name=f"{name} ({run})") for run, row in rows.items())


def _versions(studies: Mapping[str, Study]) -> Iterator[tuple[str, str]]:
    for name in dict.fromkeys(name for one in studies.values() for name, _ in one.versions):
        found = [dict(one.versions).get(name, "none") for one in studies.values()]
        yield name, " | ".join(dict.fromkeys(found))


def _same(values: Iterable[T]) -> bool:
    found = list(values)
    return all(one == found[0] for one in found)


def _and(name: str, labels: str) -> str:
    return f"{name}, {labels}" if labels else name
