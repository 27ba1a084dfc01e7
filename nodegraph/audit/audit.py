"""Whether each node of a graph gives one answer: again, with more threads, in another process."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal, get_args

import networkx as nx

from nodegraph.audit.repeat import SEVERAL, Case, Drift, Given, Repeats, drift, floor_of
from nodegraph.errors import NodegraphError
from nodegraph.execute import Run
from nodegraph.execute.call import Outcome
from nodegraph.execute.worker.client import WorkerEndedError
from nodegraph.plan import Step
from nodegraph.state import State

Grade = Literal["identical", "close", "skipped", "refused", "failed", "mutates", "differs"]
WORSE: tuple[Grade, ...] = get_args(Grade)
"""From the best to the worst."""

GOOD = frozenset({"identical", "close", "skipped", "refused"})

AGAIN = "a second call"
THREADS = f"{SEVERAL} threads"
PROCESS = "another process"
STORED = "the stored result"


@dataclass(frozen=True)
class Audited:
    """What an audit found of one step.

    Attributes
    ----------
    step : Step
    grade : str
        ``identical`` under every condition; ``close``, up to rounding; ``differs``: it has no one
        answer; ``mutates``: it changes its inputs; or how it ended in the run, if it has no result.
    under : tuple of str
        The conditions under which it was not identical.
    said : tuple of str
        What differs, in words; why there is no result.
    untried : tuple of (condition, str)
        What could not be tried, and why.
    """

    step: Step
    grade: Grade
    under: tuple[str, ...] = ()
    said: tuple[str, ...] = ()
    untried: tuple[tuple[str, str], ...] = ()

    @property
    def is_one_of_several(self) -> bool:
        """Whether runs may get another answer next time; each call of a run has one thread."""
        return self.grade == "differs" and set(self.under) != {THREADS}

    @property
    def text(self) -> str:
        """What was found, in a line."""
        under = ", ".join(self.under)
        said = [f"{under}: {self.said[0]}" if under else self.said[0]] if self.said else []
        return "; ".join([*said, *(f"not in {name}: {why}" for name, why in self.untried)])


def cases(run: Run, *, every: bool = False) -> dict[tuple[str, str], tuple[int, ...]]:
    """Return the steps to audit, by node and method.

    Parameters
    ----------
    run
    every
        Whether to take every combination; else the first of each method that has a result, or the
        first.
    """
    found: dict[tuple[str, str], list[int]] = {}
    for name, node in run.plan.graph.nodes.items():
        for combination, index in run.plan.cells.get(name, {}).items():
            labels = dict(zip(node.axes, combination, strict=True))
            label = str(labels.get(name, "")) if node.has_alternatives else ""
            found.setdefault((name, label), []).append(index)
    if every:
        return {at: tuple(dict.fromkeys(steps)) for at, steps in found.items()}
    return {at: (_first(run, steps),) for at, steps in found.items()}


def audit(run: Run, steps: Iterable[int]) -> Iterator[Audited]:
    """Repeat steps of a finished run, and yield what each was found to be, in their order.

    Each is called twice here with one thread for numerical libraries, once with two, and once in
    another process, always with the same inputs; and its stored result is compared, if what feeds
    it gives one answer. What has several answers is written down in the store: later runs do not
    store its results, and say so.

    Parameters
    ----------
    run
        With a store.
    steps
        Their indices.
    """
    wavering: set[int] = set()
    with Repeats(run) as repeats:
        for index in sorted(set(steps)):
            step = run.plan.steps[index]
            upstream = nx.ancestors(run.plan.network, index)
            found = _audited(run, step, repeats, fed_anew=bool(wavering & upstream))
            if found.grade == "differs":
                wavering.add(index)
            if found.is_one_of_several and run.cache is not None:
                run.cache.distrust(step, ", ".join(found.under))
            yield found


def _first(run: Run, steps: list[int]) -> int:
    return next((index for index in steps if _has_result(run.outcomes[index])), steps[0])


def _has_result(outcome: Outcome) -> bool:
    return outcome.state.has_value


def _audited(run: Run, step: Step, repeats: Repeats, *, fed_anew: bool) -> Audited:
    ended = run.outcomes[step.index]
    if not _has_result(ended):
        state: Grade = ended.state  # type: ignore[assignment]
        return Audited(step, state, said=(ended.reason,))
    try:
        case = repeats.case(step.index)
    except NodegraphError as error:
        return Audited(step, "failed", said=(str(error),))
    try:
        elsewhere = repeats.elsewhere(case)
    except WorkerEndedError as ended:  # here it would end this program
        return Audited(step, "differs", (PROCESS,), (f"the process {ended}",))
    return _Trial(run, step, repeats, case).audited(elsewhere, compare_stored=not fed_anew)


class _Trial:
    """One step, repeated under each condition."""

    def __init__(self, run: Run, step: Step, repeats: Repeats, case: Case) -> None:
        self._run = run
        self._step = step
        self._repeats = repeats
        self._case = case
        self._ports = [port.name for port in step.method.node.outputs]
        self._floor = floor_of(case.call.inputs, run.packer)
        self._drifts: dict[str, Drift] = {}
        self._untried: list[tuple[str, str]] = []
        self._changed = ""
        self._first = self._here()
        # once: a drawing is another each time that its figure is drawn again
        self._gave = repeats.given(self._first)

    def audited(self, elsewhere: Outcome | str, *, compare_stored: bool) -> Audited:
        """Repeat the step here, and return what became of it under each condition."""
        self._compare(AGAIN, self._here())
        self._compare(THREADS, self._here(SEVERAL))
        if isinstance(elsewhere, str):
            self._untried.append((PROCESS, elsewhere))
        else:
            self._compare(PROCESS, elsewhere)
        if self._first.state is not State.DONE:
            said = f"it was done, now it is {_ended(self._first)}"
            self._drifts[STORED] = Drift("differs", (said,))
        elif compare_stored and (stored := self._repeats.stored(self._step.index)) is not None:
            self._drifts[STORED] = self._drift(stored)
        return self._graded()

    def _here(self, threads: int = 1) -> Outcome:
        outcome, changed = self._repeats.here(self._case, threads)
        self._changed = self._changed or changed
        return outcome

    def _compare(self, condition: str, other: Outcome) -> None:
        first = self._first
        if first.state is not State.DONE or other.state is not State.DONE:
            same = (first.state, first.reason) == (other.state, other.reason)
            said = f"{_ended(first)} once, {_ended(other)} then"
            self._drifts[condition] = Drift() if same else Drift("differs", (said,))
        else:
            self._drifts[condition] = self._drift(self._repeats.given(other))

    def _drift(self, other: Given) -> Drift:
        comparisons = self._run.plan.graph.registry.hooks.comparisons
        return drift(self._gave, other, self._ports, comparisons, self._floor)

    def _graded(self) -> Audited:
        grades: set[Grade] = {one.grade for one in self._drifts.values()}
        grade = max(grades, key=WORSE.index)
        drifts = self._drifts.items() if grade != "identical" else ()
        worst = {name: one for name, one in drifts if one.grade == grade}
        said = next((one.said for one in worst.values()), ())
        if self._changed and grade != "differs":
            said, grade, worst = (f"changes its input {self._changed}",), "mutates", {}
        return Audited(self._step, grade, tuple(worst), said, tuple(self._untried))


def _ended(outcome: Outcome) -> str:
    return f"{outcome.state} ({outcome.reason})" if outcome.reason else outcome.state
