"""A saved run with its graph and its values again, as far as code and store are as they were."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import networkx as nx

from nodegraph.errors import NodegraphError
from nodegraph.execute import Run
from nodegraph.execute.call import Outcome, collecting_warnings, skipped
from nodegraph.execute.events import plain
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.numeric_threads import one_thread_each
from nodegraph.execute.resume import StoredSteps
from nodegraph.execute.schedule import Schedule
from nodegraph.execute.threads import serial
from nodegraph.graph import Choices, Graph, build
from nodegraph.graphfile import read_graph_text
from nodegraph.node.ports import Label
from nodegraph.plan import Plan, Step, plan
from nodegraph.plugin.registry import Registry
from nodegraph.runs.folder import content_of, graph_name
from nodegraph.runs.record import Record, RecordedStep
from nodegraph.runs.saved_run import SavedRun
from nodegraph.runs.settings import RunSettings
from nodegraph.runs.why import Why
from nodegraph.state import State
from nodegraph.store import DamagedEntry, Store


class NotStored(NodegraphError):
    """Values of a saved run are not stored.

    Attributes
    ----------
    steps : tuple of int
        Those that have to be computed, by their index in the plan.
    """

    def __init__(self, steps: Iterable[Step]) -> None:
        listed = tuple(steps)
        self.steps = tuple(step.index for step in listed)
        super().__init__(f"not stored: {', '.join(step.name for step in listed)}")


def saved_graph(
    folder: Path,
    settings: RunSettings,
    origin: Path,
    registry: Registry,
    *,
    included: Mapping[str, str] | None = None,
    only: Mapping[str, Iterable[Label]] | None = None,
) -> Graph:
    """Return the graph of a run from the text in its folder.

    Parameters
    ----------
    folder
    settings
        What the run was started with.
    origin
        The working directory then.
    registry
    included
        The texts of graph files that it uses, if they are recorded.
    only
        Labels in place of those of the settings.

    Raises
    ------
    NodegraphError
        If the text is missing, or does not fit what is installed.
    """
    path = folder / graph_name(included or ())
    try:
        text = content_of(path).decode()
    except (OSError, ValueError) as error:
        raise NodegraphError(f"{path} cannot be read: {error}") from error
    spec = read_graph_text(text, settings.graph, (origin / settings.graph).parent, included)
    labels = settings.only if only is None else only
    choices = Choices(
        settings.set, settings.axis, {axis: tuple(kept) for axis, kept in labels.items()}, origin
    )
    graph = build(spec, registry, choices)
    return graph.until(settings.until) if settings.until else graph


class Advance(NamedTuple):
    """Progress of a computation: steps that have ended, steps left, and the last that ended."""

    ended: int
    left: int
    step: str = ""


@dataclass(frozen=True, repr=False)
class ReopenedRun(Run):
    """A saved run, whose values come from the store, and are computed only by `compute`.

    Attributes
    ----------
    record : Record
    in_memory : dict of step index to values
        Of those computed last that the store could not take.
    """

    record: Record
    in_memory: dict[int, tuple[object, ...]]

    def changes(self, indices: Iterable[int]) -> tuple[str, ...]:
        """Return the changes since the run in everything that steps depend on.

        If anything has, or may have, they cannot be computed as they were then.
        """
        if not self.record.settings.cache:
            return ("the run stored nothing (--no-cache), so what has changed is not known",)
        needed = set(indices)
        needed |= {above for index in needed for above in nx.ancestors(self.plan.network, index)}
        changed = sorted(needed & self._changed)
        return tuple(dict.fromkeys(text for index in changed for text in self._explained(index)))

    @cached_property
    def now(self) -> ReopenedRun:
        """The run of the same graph with code and files as they are now."""
        outcomes = {
            index: replace(outcome, key=self.steps.expected_key(index))
            for index, outcome in self.outcomes.items()
        }
        return replace(self, outcomes=outcomes, in_memory={})

    def compute(self, indices: Iterable[int]) -> Iterator[Advance]:
        """Compute and store steps, with those that they need and that are not stored.

        Nothing is computed beyond the step at which the iterator is left.

        Raises
        ------
        NodegraphError
            If one of the steps fails, with its reason.
        """
        wanted = list(indices)
        known = self.steps.stored()
        known |= {at: end for at, end in self.outcomes.items() if not end.state.has_value}
        known = {index: outcome for index, outcome in known.items() if index not in wanted}
        schedule = Schedule(
            self.plan,
            cache=self.cache,
            known=known,
            packer=self.packer,
            keep=wanted,
            wanted=wanted,
        )
        ended = 0
        yield Advance(ended, len(schedule.left))
        with collecting_warnings(), one_thread_each():
            for index, outcome in serial(schedule, HowToRun()):
                schedule.finish(index, outcome)
                ended += 1
                yield Advance(ended, len(schedule.left), self.plan.steps[index].name)
        self.in_memory.clear()
        for index in wanted:
            outcome = schedule.outcomes[index]
            if not outcome.state.has_value:
                step = self.plan.steps[index]
                raise NodegraphError(f"{step.name} was {outcome.state}: {outcome.reason}")
            if not self.steps.gives(index, range(len(schedule.values[index]))):
                self.in_memory[index] = schedule.values[index]

    def has_at_hand(self, index: int) -> bool:
        """Whether a step has values in memory or stored as they were in the run."""
        if not self.outcomes[index].state.has_value:
            return False
        entry = self.steps.entry(self.plan.steps[index], self.outcomes[index].key)
        return index in self.in_memory or (entry is not None and all(entry.faithful))

    @property
    def steps(self) -> StoredSteps:
        """The steps in the store."""
        assert self.cache is not None
        return self.cache

    def _loaded(self, step: Step, *, stand_ins: bool = False) -> tuple[object, ...] | None:
        entry = self.steps.entry(step, self.outcomes[step.index].key)
        if entry is None or all(entry.faithful) == stand_ins:
            return None
        try:
            return self.steps.values(step, entry)
        except DamagedEntry:
            return None

    def _computed(self, step: Step) -> tuple[object, ...]:
        raise NotStored([step])

    @cached_property
    def _changed(self) -> frozenset[int]:
        """The steps whose own part of the key has changed: settings, code or files."""
        return frozenset(
            index
            for index, outcome in self.outcomes.items()
            if outcome.state.has_value
            and self.steps.key(self.plan.steps[index], self.outcomes) != outcome.key
        )

    def _explained(self, index: int) -> Iterator[str]:
        why = Why(self.plan, self.steps, self.record)
        for explanation in why.explain(self.plan.steps[index].node):
            if explanation.step.index == index:
                yield from explanation.changes


def reopen(saved: SavedRun, registry: Registry, store: Store) -> ReopenedRun:
    """Return a saved run with its graph and what is stored of it.

    Parameters
    ----------
    saved
    registry
        Must have the plugins of the run.
    store

    Raises
    ------
    NodegraphError
        If its graph cannot be built from what is installed.
    """
    record = saved.record
    graph = saved_graph(
        saved.folder,
        record.settings,
        Path(record.folder),
        registry,
        included=record.included,
        only=record.axes,  # no methods that were installed later
    )
    planned = plan(graph)
    return ReopenedRun(
        planned,
        _outcomes(planned, record),
        {},
        record.seconds,
        StoredSteps(planned, store),
        store.packer,
        record,
    )


def _outcomes(planned: Plan, record: Record) -> Mapping[int, Outcome]:
    """Return the outcomes of the steps of a plan in a run."""
    recorded = {
        (cell.node, *sorted(cell.labels.items())): step
        for step in record.steps
        for cell in step.cells
    }
    outcomes: dict[int, Outcome] = {}
    for step in planned.steps:
        earlier = recorded.get((step.node, *sorted(plain(step.labels).items())))
        outcomes[step.index] = (
            Outcome(State.SKIPPED, reason="it was not in the run")
            if earlier is None
            else _outcome(earlier, skipped(planned, step, outcomes))
        )
    return outcomes


def _outcome(step: RecordedStep, without_input: Outcome | None) -> Outcome:
    if step.state is State.SKIPPED and without_input is not None:
        return replace(without_input, reason=step.reason)
    return Outcome(
        # a step that nothing needed has a key like the others
        State.DONE if step.state.has_value else step.state,
        reason="" if step.state.has_value else step.reason,
        warnings=tuple(step.warnings),
        seconds=step.seconds,
        stored=step.stored,
        digests=tuple(step.digests),
        key=step.key,
    )
