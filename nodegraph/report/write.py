"""A finished run -> the files of its report, and what a terminal shows of it."""

from __future__ import annotations

from nodegraph.execute import Run
from nodegraph.report.compose import compose
from nodegraph.report.page import page
from nodegraph.report.study import Study


def report_files(run: Run, *, command: str) -> tuple[dict[str, bytes], Study]:
    """Return the report, the tables and the figures of a run by file name, and its study."""
    study, files = compose(run, command=command)
    return {**files, "report.html": page(study).encode()}, study


def summary(study: Study, counts: dict[str, int]) -> str:
    """Return what a terminal shows of a study: its tables, its answer, what went wrong."""
    parts = [
        f"{f'{one.title} {one.labels}'.strip()}\n{one.rendered.text}"
        for one in study.sections
        if one.rendered.text
    ]
    parts += ["\n".join(study.answer)] if study.answer else []
    lost = [f"{count} {state}" for state, count in counts.items() if state != "done" and count]
    parts += [f"{', '.join(lost)}; the report says which and why"] if lost else []
    return "\n\n".join(parts)
