"""Audit steps of a run: call each again, with more threads, and in another process."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import networkx as nx

from nodegraph.audit.drift import AuditGrade, Drift, drift, floor_of
from nodegraph.audit.repeat import Case, Repeats
from nodegraph.errors import NodegraphError
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.processes import WorkerEndedError
from nodegraph.execute.results import Run
from nodegraph.plan import Step
from nodegraph.state import State

_THREADS = 2
AGAIN = "a second call"
THREADS = f"{_THREADS} threads"
PROCESS = "another process"
STORED = "the stored result"


@dataclass(frozen=True)
class Audited:
    """The outcome of the audit of one step.

    Attributes
    ----------
    step : Step
    grade : AuditGrade
    conditions : tuple of str
        The conditions under which the grade is this one, unless it is identical.
    details : tuple of str
        A sentence per difference, or why the step has no result.
    untried : tuple of (condition, str)
        The conditions that were not possible, and why.
    """

    step: Step
    grade: AuditGrade
    conditions: tuple[str, ...] = ()
    details: tuple[str, ...] = ()
    untried: tuple[tuple[str, str], ...] = ()

    @property
    def varies(self) -> bool:
        """Whether another run may have another result; each call of a run has one thread."""
        return self.grade is AuditGrade.DIFFERS and set(self.conditions) != {THREADS}

    @property
    def text(self) -> str:
        """The outcome in one line."""
        conditions = ", ".join(self.conditions)
        details = [f"{conditions}: {text}" if conditions else text for text in self.details[:1]]
        return "; ".join([*details, *(f"not in {name}: {why}" for name, why in self.untried)])


def cases(run: Run, *, every: bool = False) -> dict[tuple[str, str], tuple[int, ...]]:
    """Return the steps to audit, by node and method.

    Parameters
    ----------
    run
    every
        Whether to take every combination; else the first of each method that has a result, or the
        first.
    """
    by_method: dict[tuple[str, str], list[int]] = {}
    for name, node in run.plan.graph.nodes.items():
        for combination, index in run.plan.cells.get(name, {}).items():
            labels = dict(zip(node.axes, combination, strict=True))
            label = str(labels.get(name, "")) if node.has_alternatives else ""
            by_method.setdefault((name, label), []).append(index)
    if every:
        return {method: tuple(dict.fromkeys(steps)) for method, steps in by_method.items()}
    return {
        method: (next((i for i in steps if run.outcomes[i].state.has_value), steps[0]),)
        for method, steps in by_method.items()
    }


def audit(run: Run, steps: Iterable[int]) -> Iterator[Audited]:
    """Repeat steps of a finished run, and yield the outcome for each, in the order of the plan.

    Each is called twice in this process with one thread for numerical libraries, once with two,
    and once in another process, always with the same inputs. Its stored result is compared as
    well, unless it depends on a step whose result varies. The store records the steps whose
    results vary: later runs do not store those results, and warn of them.

    Parameters
    ----------
    run
        With a store.
    steps
        Their indices.
    """
    differing: set[int] = set()
    with Repeats(run) as repeats:
        for index in sorted(set(steps)):
            step = run.plan.steps[index]
            upstream = nx.ancestors(run.plan.network, index)
            audited = _audit(run, step, repeats, compare_stored=differing.isdisjoint(upstream))
            if audited.grade is AuditGrade.DIFFERS:
                differing.add(index)
            if audited.varies and run.cache is not None:
                run.cache.distrust(step, ", ".join(audited.conditions))
            yield audited


def _audit(run: Run, step: Step, repeats: Repeats, *, compare_stored: bool) -> Audited:
    outcome = run.outcomes[step.index]
    if not outcome.state.has_value:
        return Audited(step, AuditGrade(outcome.state), details=(outcome.reason,))
    try:
        case = repeats.case(step.index)
    except NodegraphError as error:
        return Audited(step, AuditGrade.FAILED, details=(str(error),))
    try:
        # first, because a call that ends its process would end this one
        in_process = repeats.call_in_process(case)
    except WorkerEndedError as ended:
        return Audited(step, AuditGrade.DIFFERS, (PROCESS,), (f"the process {ended}",))
    return _graded(run, step, repeats, case, in_process, compare_stored=compare_stored)


def _graded(
    run: Run,
    step: Step,
    repeats: Repeats,
    case: Case,
    in_process: Outcome | str,
    *,
    compare_stored: bool,
) -> Audited:
    """Repeat a step in this process, and grade its results under all conditions."""
    floor = floor_of(case.call.inputs, run.packer)
    hooks = run.plan.graph.registry.hooks
    ports = [port.name for port in step.method.node.outputs]
    first, modified = repeats.call_here(case)
    # packed only once, because a figure differs each time that it is drawn
    result = repeats.result(first)

    def apart(outcome: Outcome) -> Drift:
        if first.state is State.DONE and outcome.state is State.DONE:
            return drift(result, repeats.result(outcome), ports, hooks, floor)
        if (first.state, first.reason) == (outcome.state, outcome.reason):
            return Drift()
        text = f"{_ending(first)} at first, then {_ending(outcome)}"
        return Drift(AuditGrade.DIFFERS, (text,))

    drifts: dict[str, Drift] = {}
    for condition, threads in ((AGAIN, 1), (THREADS, _THREADS)):
        outcome, also_modified = repeats.call_here(case, threads)
        modified = modified or also_modified
        drifts[condition] = apart(outcome)
    untried: tuple[tuple[str, str], ...] = ()
    if isinstance(in_process, str):
        untried = ((PROCESS, in_process),)
    else:
        drifts[PROCESS] = apart(in_process)
    stored = repeats.stored_result(step.index) if compare_stored else None
    if first.state is not State.DONE:
        text = f"it was done, now it is {_ending(first)}"
        drifts[STORED] = Drift(AuditGrade.DIFFERS, (text,))
    elif stored is not None:
        drifts[STORED] = drift(result, stored, ports, hooks, floor)
    grade = max((drift.grade for drift in drifts.values()), key=lambda grade: grade.rank)
    if modified and grade is not AuditGrade.DIFFERS:
        return Audited(step, AuditGrade.MUTATES, (), (f"modifies its input {modified}",), untried)
    if grade is AuditGrade.IDENTICAL:
        return Audited(step, grade, untried=untried)
    worst = {name: drift for name, drift in drifts.items() if drift.grade is grade}
    details = next(iter(worst.values())).differences
    return Audited(step, grade, tuple(worst), details, untried)


def _ending(outcome: Outcome) -> str:
    return f"{outcome.state} ({outcome.reason})" if outcome.reason else outcome.state
