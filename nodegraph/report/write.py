"""A finished run -> its folder: report, tables, figures, record."""

from __future__ import annotations

from typing import Any

from nodegraph.execute import Run
from nodegraph.execute.record import record
from nodegraph.report.compose import compose
from nodegraph.report.page import page
from nodegraph.report.study import Study


def report_files(run: Run, *, command: str) -> tuple[dict[str, bytes], dict[str, Any], Study]:
    """Return the files of a run by name, its record, and what its report says."""
    study = compose(run, command=command)
    files = {name: one for section in study.sections for name, one in section.files.items()}
    files["report.html"] = page(study).encode()
    return files, record(run), study


def summary(study: Study) -> str:
    """Return what a terminal shows of a study: its tables, its answer, what went wrong."""
    parts = [f"{one.title}\n{one.rendered.text}" for one in study.sections if one.rendered.text]
    parts += ["\n".join(study.answer)] if study.answer else []
    lost = {state: count for state, count in study.counts.items() if state != "done" and count}
    if lost:
        said = ", ".join(f"{count} {state}" for state, count in lost.items())
        parts.append(f"{said}; the report says which and why")
    return "\n\n".join(parts)
