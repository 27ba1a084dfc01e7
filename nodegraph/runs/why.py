"""Why a step is not cached: which part of its key changed since an earlier run."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import networkx as nx

from nodegraph.execute.results import Run
from nodegraph.execute.resume import StoredSteps
from nodegraph.formatting import first_and_more
from nodegraph.plan import Plan, Step
from nodegraph.runs.compare import changes
from nodegraph.runs.record import Cell, Record, RecordedStep, expected
from nodegraph.state import State

_AT_LABELS = re.compile(r"(([\w.]+)\(.*?\)): (.*)", re.DOTALL)


@dataclass(frozen=True)
class Explanation:
    """Why a step is cached or not.

    Attributes
    ----------
    step : Step
    stored : bool
        Whether its result is in the store now.
    changes : tuple of str
        Changes since the earlier run, root causes upstream included; if nothing did, why
        there is no result all the same.
    """

    step: Step
    stored: bool
    changes: tuple[str, ...]


def changes_since(run: Run, record: Record, indices: Iterable[int]) -> tuple[str, ...]:
    """Return the changes since a run in everything that some of its steps depend on.

    If anything has changed, or may have, they cannot be computed as they were then.

    Parameters
    ----------
    run
        Opened from its folder.
    record
        The record of the run.
    indices
        Steps of its plan.
    """
    if not record.settings.cache or run.cache is None:
        return ("the run stored nothing (--no-cache), so what has changed is not known",)
    needed = set(indices)
    needed |= {above for index in needed for above in nx.ancestors(run.plan.network, index)}
    changed = (
        index
        for index in sorted(needed)
        if run.outcomes[index].state.has_value
        and run.cache.key(run.plan.steps[index], run.outcomes) != run.outcomes[index].key
    )
    why = Why(run.plan, run.cache, record)
    return tuple(
        dict.fromkeys(text for index in changed for text in why.explain_step(index).changes)
    )


def together(explanations: Iterable[Explanation]) -> list[str]:
    """Return the changes of several steps, each once, however many combinations have it."""
    places: dict[tuple[str, str], dict[str, None]] = defaultdict(dict)
    for explanation in explanations:
        for line in explanation.changes:
            node, name, text = node_and_text(line)
            places[node, text][name] = None
    return [
        f"{first_and_more(next(iter(names)), len(names), node)}: {text}" if node else text
        for (node, text), names in places.items()
    ]


def node_and_text(line: str) -> tuple[str, str, str]:
    """Return node, name with labels, and the rest of a line such as ``gaps(length=5): ...``."""
    match = _AT_LABELS.fullmatch(line)
    return (match[2], match[1], match[3]) if match else ("", "", line)


class Why:
    """Compares a plan with the record of an earlier run.

    Parameters
    ----------
    plan
    cache
        The stored steps of the plan.
    record
        The record of the earlier run.
    """

    def __init__(self, plan: Plan, cache: StoredSteps, record: Record) -> None:
        self._plan = plan
        self._cache = cache
        self._was = record
        self._by_cell = {Cell(step.node, step.labels).key: step for step in record.steps}
        self._by_key = {step.key: step for step in record.steps if step.key}
        self._changes: dict[int, tuple[str, ...]] = {}

    def explain(self, node: str) -> Iterator[Explanation]:
        """Yield an explanation for each step of a node."""
        yield from map(self.explain_step, dict.fromkeys(self._plan.cells[node].values()))

    def explain_step(self, index: int) -> Explanation:
        """Return the explanation for a step."""
        stored = index in self._cache
        texts = self._all_changes(index)
        if not stored and not texts:
            texts = (self._reason(index),)
        return Explanation(self._plan.steps[index], stored, texts)

    @cached_property
    def _now(self) -> Record:
        return expected(self._plan, self._cache)

    def _reason(self, index: int) -> str:
        """Return why a step without changes has no result."""
        outcome, earlier = self._cache.known.get(index), self._earlier(index)
        if outcome is not None:
            return f"{outcome.state}, as before: {outcome.reason}"
        if earlier is not None and earlier.state is State.DONE and not earlier.digests:
            return "its key is unchanged; the earlier run could not store its result"
        return "its key is unchanged; the result is not in the store"

    def _earlier(self, index: int) -> RecordedStep | None:
        """Return the recorded step of the same key, else of the same combination."""
        now = self._now.by_index[index]
        same_key = self._by_key.get(now.key)
        return same_key or self._by_cell.get(Cell(now.node, now.labels).key)

    def _all_changes(self, index: int) -> tuple[str, ...]:
        """Return the changes of a step and of everything upstream, each once."""
        indices = {index} | nx.ancestors(self._plan.network, index)
        texts = (text for index in sorted(indices) for text in self._own_changes(index))
        return tuple(dict.fromkeys(texts))

    def _own_changes(self, index: int) -> tuple[str, ...]:
        if index not in self._changes:
            earlier = self._earlier(index)
            self._changes[index] = tuple(self._compare(index, earlier))
        return self._changes[index]

    def _compare(self, index: int, earlier: RecordedStep | None) -> Iterator[str]:
        step, now = self._plan.steps[index], self._now.by_index[index]
        if earlier is None:
            # else that follows from a new step that feeds it
            if all(self._earlier(source) for source in step.needed):
                yield f"{step.name}: was not in the earlier run"
            return
        if earlier.state is State.FAILED:
            tried = "has a result now" if index in self._cache else "will be tried again"
            yield f"{step.name}: failed in the earlier run and {tried}: {earlier.reason}"
            return
        if earlier.key and earlier.key == now.key:
            return
        if reason := self._cache.digest_of(step).reason:
            yield f"{now.use}: its results cannot be stored: {reason}"
        if earlier.use == now.use and self._now.method(now).full_name not in self._was.code:
            nothing = "" if self._was.code else ", which stored nothing"
            yield f"{now.use}: its code was not recorded in the earlier run{nothing}"
        change = changes(self._was, self._now, earlier, now)
        # code is the same at all combinations of a method
        yield from (
            f"{now.use if text.startswith('code: ') else step.name}: {text}" for text in change.own
        )
        yield from (f"{now.use}: {text}" for text in change.around)
        if not change.own and not change.around and not any(map(self._all_changes, step.needed)):
            # the record has no output positions, nor the labels that are absent from a gathering
            yield f"{step.name}: takes other outputs, or labels, of what feeds it"
