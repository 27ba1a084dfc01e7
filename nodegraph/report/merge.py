"""The study of several runs, their results side by side."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import PurePosixPath

from nodegraph.plugin.hook_types import Rendered
from nodegraph.report.study import Link, Section, SettingRow, Study, numbered

_ANCHOR = re.compile(r'\s(?:id|name)="([^"]+)"')


def merged(studies: Mapping[str, Study]) -> Study:
    """Return one study of several runs.

    Each question stands once, with what answers it in each run. Sections of one title stand
    together, a run after the other; each result, note and time is labelled with the name of its
    run. A method that ran alike everywhere is listed once.

    Parameters
    ----------
    studies
        By the names of the runs, two at least.
    """
    runs = studies.items()
    first = next(iter(studies.values()))
    return Study(
        title=_title(studies),
        answer=tuple(f"{name}: {line}" for name, study in runs for line in study.answer),
        notes_markdown=_joined("\n\n", studies, "notes_markdown"),
        chosen=_joined(" | ", studies, "chosen"),
        sections=numbered(_sections(studies)),
        graph_svg=first.graph_svg,
        graph_unfolded_svg=first.graph_unfolded_svg,
        axes=first.axes if len({study.axes for study in studies.values()}) == 1 else (),
        inputs=tuple(_inputs(studies)),
        known=tuple(dict.fromkeys(port for study in studies.values() for port in study.known)),
        methods=tuple(dict.fromkeys(row for study in studies.values() for row in study.methods)),
        without_result=tuple(
            replace(method, reason=f"{method.reason} ({name})")
            for name, study in runs
            for method in study.without_result
        ),
        bibtex=_joined("\n", studies, "bibtex"),
        notes=tuple(
            replace(note, labels=_with_name(name, note.labels))
            for name, study in runs
            for note in study.notes
        ),
        timings=tuple(
            replace(row, node=f"{row.node} ({name})")
            for name, study in runs
            for row in study.timings
        ),
        seconds=sum(study.seconds for study in studies.values()),
        versions=tuple(_versions(studies)),
        seeds=tuple(
            (f"{node} ({name})", text) for name, study in runs for node, text in study.seeds
        ),
        command="\n".join(study.command for study in studies.values()),
        graph_file=first.graph_file,
        graph_text=first.graph_text,
        files=tuple(
            replace(link, text=f"{name}: {link.text}")
            for name, study in runs
            for link in study.files
        ),
        created=_joined(" | ", studies, "created"),
        machine=_joined(" | ", studies, "machine"),
        runs=len(studies),
    )


def _title(studies: Mapping[str, Study]) -> str:
    """Return the question of the studies, or how many questions there are."""
    titles = list(dict.fromkeys(study.title for study in studies.values()))
    return titles[0] if len(titles) == 1 else f"{len(titles)} studies"


def linked(study: Study, folder: str) -> Study:
    """Return a study with links to files in a folder, relative to the page: ``../runs/fill``."""
    sections = tuple(
        replace(section, files=_moved(section.files, folder)) for section in study.sections
    )
    return replace(study, sections=sections, files=_moved(study.files, folder))


def _moved(links: Iterable[Link], folder: str) -> tuple[Link, ...]:
    return tuple(replace(link, path=str(PurePosixPath(folder, link.path))) for link in links)


def _sections(studies: Mapping[str, Study]) -> Iterator[Section]:
    every = [
        replace(
            section,
            run=name,
            question=study.title,
            rendered=_with_own_ids(section.rendered, number),
        )
        for number, (name, study) in enumerate(studies.items(), 1)
        for section in study.sections
    ]
    for key in dict.fromkeys((section.question, section.title) for section in every):
        yield from (section for section in every if (section.question, section.title) == key)


def _with_own_ids(rendered: Rendered, number: int) -> Rendered:
    """Return a fragment whose ids and groups of buttons are those of no other run."""
    if number == 1:
        return rendered
    names = dict.fromkeys(_ANCHOR.findall(rendered.html + rendered.lead))
    if not names:
        return rendered
    longest_first = sorted(names, key=len, reverse=True)
    used = re.compile(rf"""(?<=["'#])({"|".join(map(re.escape, longest_first))})(?=["')])""")
    own = rf"\1-run-{number}"  # ids often end in a number
    return replace(rendered, html=used.sub(own, rendered.html), lead=used.sub(own, rendered.lead))


def _inputs(studies: Mapping[str, Study]) -> Iterator[SettingRow]:
    """Yield the inputs, those that differ once per run."""
    for name in dict.fromkeys(row.name for study in studies.values() for row in study.inputs):
        rows = {
            run: row for run, study in studies.items() for row in study.inputs if row.name == name
        }
        if len({*rows.values()}) == 1 and len(rows) == len(studies):
            yield next(iter(rows.values()))
        else:
            yield from (replace(row, name=f"{name} ({run})") for run, row in rows.items())


def _versions(studies: Mapping[str, Study]) -> Iterator[tuple[str, str]]:
    versions = [dict(study.versions) for study in studies.values()]
    for name in dict.fromkeys(name for of_run in versions for name in of_run):
        yield name, " | ".join(dict.fromkeys(of_run.get(name, "none") for of_run in versions))


def _joined(separator: str, studies: Mapping[str, Study], field: str) -> str:
    """Return the different texts of a field, joined."""
    texts = dict.fromkeys(getattr(study, field) for study in studies.values())
    return separator.join(text for text in texts if text)


def _with_name(name: str, labels: str) -> str:
    return f"{name}, {labels}" if labels else name
