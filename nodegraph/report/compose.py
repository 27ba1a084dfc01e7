"""A run -> the study that its report shows."""

from __future__ import annotations

import traceback
import warnings
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from datetime import datetime
from typing import Any

from nodegraph.describe import shown
from nodegraph.display import labels_of, size_text
from nodegraph.draw.from_graph import drawing_for_page
from nodegraph.execute import Run
from nodegraph.execute.record import versions
from nodegraph.hooks import Rendered, Renderer
from nodegraph.plugins import said_by
from nodegraph.report.methods import Methods
from nodegraph.report.notes import step_notes
from nodegraph.report.study import (
    AxisRow,
    Link,
    Section,
    SettingRow,
    StepNote,
    Study,
    TimingRow,
)
from nodegraph.values import Files

_FILES = (Link("what ran", "run.json"), Link("events", "events.jsonl"))


def compose(run: Run, *, command: str) -> tuple[Study, dict[str, bytes]]:
    """Return what the report of a run says, and the files of its tables and figures.

    Parameters
    ----------
    run
    command
        How the run was started, so that a reader can start it again.
    """
    graph = run.plan.graph
    found = list(_reported(run))
    sections, files, unshown = _sections(found, graph.registry.renderers)
    there, methods = versions(graph), Methods(run)
    study = Study(
        title=graph.title,
        answer=_answer((labels, value) for _, labels, _, value in found),
        notes_markdown=graph.spec.notes,
        sections=sections,
        graph_svg=drawing_for_page(graph),
        axes=tuple(AxisRow(one.name, tuple(map(str, one.labels))) for one in graph.axes.values()),
        inputs=tuple(SettingRow(name, shown(value)) for name, value in graph.inputs.items()),
        known=tuple(str(one) for one in graph.spec.known),
        methods=methods.rows(),
        without_result=methods.without_result(),
        bibtex=methods.bibtex(),
        notes=(*unshown, *step_notes(run, command)),
        timings=_timings(run),
        seconds=run.seconds,
        versions=tuple(there.items()),
        seeds=methods.seeds(),
        command=command,
        graph_file=graph.spec.file,
        graph_text=graph.spec.text,
        files=_FILES,
        created=datetime.now().astimezone().isoformat(timespec="minutes"),
        machine=there["platform"],
    )
    return study, files


def _reported(run: Run) -> Iterator[tuple[str, str, str, Any]]:
    """Yield (title, labels, file name, value) of everything that the report shows."""
    for node, port in run.plan.graph.reported:
        first = run.plan.graph.nodes[node].first.node.outputs[0].name
        others = [name for name in run.plan.graph.nodes[node].outputs if name != first]
        for output in [port] if port else ["", *others]:
            name = output or (first if others else "")
            plain = name in ("", node)
            for labels, value in run[f"{node}.{output}" if output else node].shown():
                at = labels_of(labels)
                words = [node] if plain else [node, name]
                named = [f"{axis}-{label}" for axis, label in labels.items()]
                yield " ".join(words), at, _file_name([*words, *named]), value


def _file_name(words: Iterable[str]) -> str:
    return "_".join("".join(c if c.isalnum() or c in ".-" else "-" for c in one) for one in words)


def _sections(
    found: Iterable[tuple[str, str, str, Any]], renderers: Iterable[Renderer]
) -> tuple[tuple[Section, ...], dict[str, bytes], tuple[StepNote, ...]]:
    sections: list[Section] = []
    unshown: list[StepNote] = []
    files: dict[str, bytes] = {}
    for title, labels, name, value in found:
        if isinstance(value, Files):
            made = {f"{name}/{file}": content for file, content in value.content.items()}
            sections.append(_files_section(title, labels, made))
            files |= made
            continue
        try:
            rendered = _rendered(value, f"{title} {labels}".strip(), renderers)
        except Exception as error:  # a picture that cannot be drawn must not cost the other results
            unshown.append(_unshown(title, labels, error))
            rendered = Rendered("", unshown[-1].reason)
        if rendered is None:
            continue
        beside = {f"{name}{suffix}": content for suffix, content in rendered.files.items()}
        files |= beside
        links = tuple(Link(one.rpartition(".")[2].upper(), one) for one in beside)
        sections.append(Section(title, rendered, labels, links))
    return tuple(sections), files, tuple(unshown)


def _files_section(title: str, labels: str, made: Mapping[str, bytes]) -> Section:
    said = [f"{path} ({size_text(len(content))})" for path, content in made.items()]
    links = tuple(Link(path.rpartition("/")[2], path) for path in made)
    return Section(title, Rendered("", "\n".join(said) or "no files"), labels, links)


def _rendered(value: Any, title: str, renderers: Iterable[Renderer]) -> Rendered | None:
    for renderer in renderers:
        if isinstance(value, renderer.type):
            return renderer.render(value, title)
    return Rendered("", str(value)) if isinstance(value, (str, int, float)) else None


def _unshown(title: str, labels: str, error: Exception) -> StepNote:
    """Return what is said of a result that is there, and for which its renderer failed."""
    # matplotlib begins some of its messages with an empty line
    said = f"cannot be shown: {' '.join(said_by(error).split())}"
    warnings.warn(f"{title} {labels}".strip() + f": {said}", stacklevel=3)
    trace = "".join(traceback.format_exception(error))
    return StepNote(title, labels, said, "failed", trace=trace)


def _answer(values: Iterable[tuple[str, Any]]) -> tuple[str, ...]:
    """Return the sentences that values carry with them, as tables do in ``attrs``."""
    said: list[str] = []
    for labels, value in values:
        place = labels.replace("=", " ")
        said += [f"{place}: {one}" if place else one for one in _sentences(value)]
    return tuple(dict.fromkeys(said))


def _sentences(value: Any) -> list[str]:
    attributes = getattr(value, "attrs", None)
    given = attributes.get("answer", []) if isinstance(attributes, Mapping) else []
    if isinstance(given, str):
        return [given]
    if isinstance(given, list | tuple) and all(isinstance(one, str) for one in given):
        return list(given)
    kind = type(value).__name__
    warnings.warn(f"the answer of a {kind} is no list of sentences: left out", stacklevel=4)
    return []


def _timings(run: Run) -> tuple[TimingRow, ...]:
    took: dict[str, list[float]] = defaultdict(list)
    stored: Counter[str] = Counter()
    for step, outcome in run.settled("done"):
        took[step.node].append(outcome.seconds)
        stored[step.node] += outcome.stored
    return tuple(
        TimingRow(node, len(one), sum(one), max(one), stored[node]) for node, one in took.items()
    )
