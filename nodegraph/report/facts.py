"""One-line summaries of a study: in the head of its page, and next to folded parts."""

from __future__ import annotations

import re
from datetime import datetime
from pathlib import PurePath

from nodegraph.formatting import duration, number_of
from nodegraph.report.notes import note_kinds
from nodegraph.report.study import Study

_LONGEST = 110

_SENTENCE = re.compile(r".*?[.?!](?=\s|$)", re.DOTALL)
_MARKS = re.compile(r"[*_`#>|]+|\[([^\]]*)\]\([^)]*\)")


def head_facts(study: Study) -> list[str]:
    """Return the study's name and its date."""
    name = PurePath(study.graph_file).stem
    dates = ", ".join(dict.fromkeys(map(_day, study.created.split(" | "))))  # of several runs
    return [text for text in (name, dates) if text]


def fold_facts(study: Study) -> dict[str, str]:
    """Return a line for each part that is folded, by its name."""
    uses = len({row.use for row in study.methods})
    steps, stored = (
        sum(getattr(row, name) for row in study.timings) for name in ("steps", "stored")
    )
    nodes = number_of(len({row.node for row in study.methods}), "node")
    took = f" in {duration(study.seconds)}" if study.seconds else ""
    source = f", {'all' if stored == steps else f'{stored:,}'} of them from stored results"
    inputs = ", ".join(f"{row.name} {row.value}" for row in study.inputs)
    axes = number_of(len(study.axes), "axis").replace("axiss", "axes") if study.axes else ""
    settings = [inputs, axes, number_of(len(study.versions), "package")]
    return {
        "measured": _first_sentence(study.notes_markdown),
        "methods": f"what each of {uses} does, its settings and sources"
        if uses
        else "none gave a result",
        "notes": _notes(study),
        "graph": f"{nodes}, {number_of(steps, 'step')}",
        "settings": "; ".join(_shortened(text) for text in settings if text),
        "reproduce": f"{number_of(steps, 'step')} done{took}{source if stored else ''}",
        "download": ", ".join(study.kinds_of_files) or "what ran",
    }


def _day(created: str) -> str:
    """Return the day on which a run ended."""
    try:
        when = datetime.fromisoformat(created)
    except ValueError:
        return created
    return f"{when.day} {when:%B %Y}"


def _notes(study: Study) -> str:
    kinds = note_kinds(study)
    if not kinds:
        return "nothing failed, and nothing warned"
    touching = sum(bool(group.matters) for kind in kinds for group in kind.groups)
    text = f"; {touching} touch{'es' if touching == 1 else ''} the numbers" if touching else ""
    return f"{', '.join(map(str, kinds))}{text}"


def _first_sentence(markdown: str) -> str:
    text = " ".join(_MARKS.sub(r"\1", markdown).split())
    match = _SENTENCE.match(text)
    return _shortened(match[0] if match else text)


def _shortened(text: str) -> str:
    if len(text) <= _LONGEST:
        return text
    return f"{text[:_LONGEST].rpartition(' ')[0]} …"
