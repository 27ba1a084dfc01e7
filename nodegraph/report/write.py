"""A finished run -> the files of its report, and what a terminal shows of it."""

from __future__ import annotations

from collections.abc import Iterator

from nodegraph.execute import Run
from nodegraph.execute.not_kept import not_kept_lines
from nodegraph.report.compose import compose
from nodegraph.report.page import page
from nodegraph.report.saved import STUDY, study_bytes
from nodegraph.report.study import Study

_MOST_FAILURES = 5
_WORDS = {"done": "computed", "unneeded": "not needed"}


def report_files(run: Run, *, command: str) -> tuple[dict[str, bytes], Study]:
    """Return the report, the tables and the figures of a run by file name, and its study."""
    study, files = compose(run, command=command)
    # what failed may name a file whose name is no text
    text = page(study).encode(errors="backslashreplace")
    return {**files, STUDY: study_bytes(study), "report.html": text}, study


def summary(study: Study, run: Run) -> str:
    """Return what a terminal shows of a run: its tables, its answer, how its steps ended."""
    parts = [
        f"{f'{one.title} {one.labels}'.strip()}\n{one.rendered.text}"
        for one in study.sections
        if one.rendered.text
    ]
    parts += ["\n".join(study.answer)] if study.answer else []
    counts = [
        f"{count} {_WORDS.get(state, state)}" for state, count in run.counts().items() if count
    ]
    parts += [f"{len(run.plan.steps)} steps: {', '.join(counts)}"]
    parts += [*_failures(study), *not_kept_lines(run)]
    return "\n\n".join(parts)


def _failures(study: Study) -> Iterator[str]:
    """Yield what failed first, with the command that repeats it alone."""
    failed = [note for note in study.notes if note.kind == "failed"]
    for note in failed[:_MOST_FAILURES]:
        where = f"{note.node} at {note.labels}" if note.labels else note.node
        repeat = f"\n    repeat it alone: {note.repeat}" if note.repeat else ""
        yield f"failed: {where}: {note.reason}{repeat}"
    if len(failed) > _MOST_FAILURES:
        yield f"{len(failed) - _MOST_FAILURES} more failed; the report says which and why"
