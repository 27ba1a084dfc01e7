"""A run from its folder, with its values as far as code and store are as they were."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from nodegraph.errors import NodegraphError
from nodegraph.execute.events import plain
from nodegraph.execute.outcome import Outcome, skipped
from nodegraph.execute.results import Run
from nodegraph.execute.resume import StoredSteps
from nodegraph.execute.settings import RunSettings
from nodegraph.graph import Choices, Graph, build
from nodegraph.graphfile import read_graph_text
from nodegraph.node.ports import Label
from nodegraph.plan import Plan, Step, plan
from nodegraph.plugin.registry import Registry
from nodegraph.runs.folder import content_of, graph_name
from nodegraph.runs.record import Cell, CellKey, Record, RecordedStep
from nodegraph.state import State
from nodegraph.store import Store


def open_run(graph: Graph, record: Record, store: Store) -> Run:
    """Return a finished run: its values come from a store, or are computed when asked for.

    Parameters
    ----------
    graph
        See `saved_graph`.
    record
    store
    """
    planned = plan(graph)
    outcomes = _outcomes(planned, record)
    return _opened(StoredSteps(planned, store), planned, outcomes, record.settings, record.seconds)


def open_unfinished(
    graph: Graph, settings: RunSettings, ended: Mapping[CellKey, Outcome], store: Store
) -> Run:
    """Return a run that goes on or was interrupted; what it has not stored is computed when asked.

    Parameters
    ----------
    graph
        See `saved_graph`.
    settings
    ended
        How steps ended without a value, by `Cell.key`; the others are expected to succeed.
    store
    """
    planned = plan(graph)
    cache = StoredSteps(planned, store)
    outcomes: dict[int, Outcome] = {}
    for step in planned.steps:
        outcome = ended.get(_cell(step).key, Outcome(State.DONE))
        cause = skipped(planned, step, outcomes) if outcome.state is State.SKIPPED else None
        key = cache.key(step, outcomes)
        outcomes[step.index] = replace(outcome, key=key, cause=cause.cause if cause else None)
    return _opened(cache, planned, outcomes, settings, 0.0)


def _opened(
    cache: StoredSteps,
    planned: Plan,
    outcomes: Mapping[int, Outcome],
    settings: RunSettings,
    seconds: float,
) -> Run:
    packer = cache.store.packer
    return Run(planned, outcomes, {}, seconds, cache, packer, settings, is_opened=True)


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
        The settings with which the run was started.
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


def _outcomes(planned: Plan, record: Record) -> Mapping[int, Outcome]:
    """Return the outcomes of the steps of a plan in a run."""
    recorded = {cell.key: step for step in record.steps for cell in step.cells}
    outcomes: dict[int, Outcome] = {}
    for step in planned.steps:
        earlier = recorded.get(_cell(step).key)
        outcomes[step.index] = (
            Outcome(State.SKIPPED, reason="it was not in the run")
            if earlier is None
            else _outcome(earlier, skipped(planned, step, outcomes))
        )
    return outcomes


def _cell(step: Step) -> Cell:
    return Cell(step.node, plain(step.labels))


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
