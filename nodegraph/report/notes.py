"""What a reader must know about the steps of a run: failures, refusals, gaps in it, warnings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from nodegraph.display import labels_of
from nodegraph.execute import Run
from nodegraph.execute.left_out import left_out_together
from nodegraph.execute.record import repeating
from nodegraph.plan import Step
from nodegraph.report.study import Kind, StepNote

_KINDS: dict[str, Kind] = {"failed": "failed", "refused": "refused", "skipped": "left out"}


def step_notes(run: Run, command: str) -> tuple[StepNote, ...]:
    """Return a note for everything in a run that did not simply go well."""
    return tuple(
        (
            *_settled(run, command),
            *_left_out_by_plan(run),
            *_left_out_by_command(run),
            *_deprecated(run),
            *_warned(run),
        )
    )


def _settled(run: Run, command: str) -> Iterator[StepNote]:
    for step, outcome in run.settled(*_KINDS):
        repeat = repeating(command, step) if outcome.state == "failed" else ""
        yield StepNote(
            _name(step),
            labels_of(step.labels),
            outcome.told,
            _KINDS[outcome.state],
            repeat=repeat,
            trace=outcome.trace,
        )


def _left_out_by_plan(run: Run) -> Iterator[StepNote]:
    for name, cells in run.plan.skipped.items():
        axes = run.plan.graph.nodes[name].axes
        for at, reason in cells.items():
            yield StepNote(name, labels_of(dict(zip(axes, at, strict=True))), reason, "left out")


def _left_out_by_command(run: Run) -> Iterable[StepNote]:
    return (
        StepNote(", ".join(nodes), "", reason, "left out", count=len(nodes))
        for reason, nodes in left_out_together(run.plan.graph).items()
    )


def _deprecated(run: Run) -> Iterable[StepNote]:
    notices = run.plan.graph.notices
    return (
        StepNote(str(one.place), "", f"{one.message}: {one.instead}", "warning") for one in notices
    )


def _warned(run: Run) -> Iterator[StepNote]:
    for step, outcome in run.settled():
        for said in outcome.warnings:
            yield StepNote(_name(step), labels_of(step.labels), said, "warning")


def _name(step: Step) -> str:
    return f"{step.node} ({step.method.node.name})"
