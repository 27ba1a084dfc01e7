"""Random graphs have the same results with a store as without."""

from __future__ import annotations

import random
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from nodegraph import Across, hookimpl
from nodegraph.execute.events import Event
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.results import Run
from nodegraph.execute.resume import open_store
from nodegraph.execute.run import execute
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import Plan, Step, plan
from nodegraph.plugin.kind import Kind
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.state import State
from nodegraph.store import Entry, Upkeep
from tests.nodegraph.words import NODES, Sketch, content_of, stand_in

AXES = {"i": (1, 2), "j": (3, 4, 5)}
THREADS = HowToRun("threads", 3)
SEEDS = range(10)


SKETCHES = Kind(Sketch, take_apart=lambda word: word.text, put_together=stand_in, faithful=False)
MODULE = SimpleNamespace(__name__="sketches", nodegraph_kinds=hookimpl(lambda: [SKETCHES]))


@dataclass(frozen=True)
class Drawn:
    """One node of a random graph."""

    name: str
    kind: str
    first: str = ""
    second: str = ""
    mark: str = "0"

    def text(self) -> str:
        second = f", second: {self.second}" if self.second else ""
        if self.kind == "make":
            return f"  {self.name}: {{use: word.make, with: {{mark: {self.mark}}}}}"
        if self.kind == "choose":
            use = "alternatives: {join: word.join, draw: word.draw, pass: {}}"
        else:
            use = f"use: word.{self.kind}"
        port = "parts" if self.kind == "all" else "first"
        fed = f"in: {{{port}: {self.first}{second}}}"
        return f"  {self.name}: {{{use}, {fed}, with: {{mark: {self.mark}}}}}"


class Study:
    """A random graph, and its runs with and without a store."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.chance = random.Random(seed)
        self.folder = folder
        self.how = THREADS if seed % 2 else HowToRun("serial")
        self.registry = Registry.of(NODES, plugin="words")
        self.registry.loaded.append(Plugin("sketches", MODULE))
        self.drawn = self._drawn()
        self.kept: set[int] = set()
        self.skip = self.chance.choice(["", "", "i", "j"])

    def plan(self) -> Plan:
        used = [axis for axis in AXES if any(node.mark == f"${axis}" for node in self.drawn)]
        lines = ["nodegraph: 1", "axes: {" if used else ""]
        lines += [f"  {axis}: {list(AXES[axis])}," for axis in used] + ["}" if used else ""]
        lines += ["nodes:", *(node.text() for node in self.drawn)]
        if self.skip in used:
            lines.append(f"skip: [{{{self.skip}: {AXES[self.skip][0]}}}]")
        return plan(build(read_graph_text("\n".join(lines), "random.yaml", Path()), self.registry))

    def run(
        self,
        say: Callable[[str], None] = pytest.fail,
        listeners: Iterable[Callable[[Event], None]] = (),
    ) -> tuple[Run, list[int]]:
        """Run with the store; return the indices of the steps that were called, too."""
        steps, events = self.plan(), list[Event]()
        store = open_store(self.registry, self.folder, say)
        keep = [name for name in steps.graph.nodes if self.chance.random() < 0.3]
        self.kept = {index for name in keep for index in steps.cells[name].values()}
        every = [events.append, *listeners]
        run = execute(steps, how=self.how, store=store, keep=keep, listeners=every)
        assert sum(events[-1].detail.values()) == len(steps.steps)
        return run, [event.step for event in events if event.kind == "started"]

    def alone(self) -> Run:
        steps = self.plan()
        return execute(steps, how=HowToRun("serial"), keep=list(steps.graph.nodes))

    def change(self) -> None:
        at = self.chance.randrange(len(self.drawn))
        self.drawn[at] = replace(self.drawn[at], mark=str(self.chance.randrange(100, 1000)))

    def _drawn(self) -> list[Drawn]:
        choice = self.chance.choice
        drawn = [Drawn("n0", "make", mark="$i"), Drawn("n1", "make", mark="$j")]
        for number in range(2, self.chance.randint(5, 8)):
            choices = sum(node.kind == "choose" for node in drawn)
            kinds = ["join", "draw", "all", "all"] + ["choose"] * (2 if choices < 2 else 0)
            ports = [node.name for node in drawn]
            ports += [f"{node.name}.sketch" for node in drawn if node.kind == "make"]
            mark = choice(["7", "8", "$i", "$j"])
            second = choice(["", choice(ports)])
            drawn.append(Drawn(f"n{number}", choice(kinds), choice(ports), second, mark))
        return drawn


def same(run: Run, alone: Run, *, unneeded: bool = False) -> None:
    """Assert that a run ended as one without stored results did."""
    for step, expected in alone.settled():
        actual = run.outcomes[step.index]
        if not (unneeded and actual.state == "unneeded"):
            assert (actual.state, actual.reason) == (expected.state, expected.reason), step.name


def same_values(run: Run, alone: Run) -> None:
    """Assert that a run gives each value as one without stored results does."""
    for step, _ in alone.settled(State.DONE):
        actual, expected = run.values_of(step.index), alone.values_of(step.index)
        assert list(map(content_of, actual)) == list(map(content_of, expected)), step.name
        assert list(map(type, actual)) == list(map(type, expected)), step.name


class Needed:
    """Determines which steps must be called, from those that are stored."""

    def __init__(self, alone: Run, stored: set[int], keep: set[int]) -> None:
        self._alone = alone
        self._steps = alone.plan.steps
        self._stored = stored
        self.called: set[int] = set()
        self._certain: dict[int, bool] = {}
        read = {index for step in self._steps for index in step.needed}
        self._settled: set[int] = set()
        for step in self._steps:
            if step.index not in read or step.index in keep:
                self._settle(step)

    def _settle(self, step: Step) -> None:
        """Have a step end; if it is stored under the key that it has at the outset, it has."""
        if step.index in self._settled:
            return
        self._settled.add(step.index)
        if step.index in self._stored and self._is_certain(step):
            return
        for index in step.needed:
            self._settle(self._steps[index])
        if step.index not in self._stored and self._state(step.index) != "skipped":
            self._call(step)

    def _call(self, step: Step) -> None:
        if step.index in self.called:
            return
        self.called.add(step.index)
        for index in step.needed:
            self._settle(self._steps[index])
            values = self._alone.in_memory.get(index, ())
            read = {output.position for output in step.reads() if output.step == index}
            lent = any(type(values[position]) is Sketch for position in read if values)
            if lent or (index not in self._stored and self._state(index) == "done"):
                self._call(self._steps[index])

    def _is_certain(self, step: Step) -> bool:
        """Whether a step's key is known before anything is computed."""
        if step.index not in self._certain:
            gathered = [fed for fed in step.inputs.values() if isinstance(fed, Across)]
            entries = {output.step for fed in gathered for _, output in fed.entries}
            self._certain[step.index] = all(
                self._is_certain(self._steps[index]) for index in step.needed
            ) and all(self._state(index) == "done" or self._is_known(index) for index in entries)
        return self._certain[step.index]

    def _is_known(self, index: int) -> bool:
        """Whether it is known before anything is computed that a step has no value."""
        step = self._steps[index]
        if self._state(index) != "skipped":
            return index in self._stored and self._is_certain(step)
        for fed in step.inputs.values():
            outputs = fed.values() if isinstance(fed, Across) else [fed]
            steps = [output.step for output in outputs]
            if all(self._state(index) != "done" and self._is_known(index) for index in steps):
                return True
        return False

    def _state(self, index: int) -> str:
        return self._alone.outcomes[index].state


def keys_in(folder: Path) -> set[str]:
    """Return the keys of all entries that a store's folder has."""
    return {listed.entry.key for listed in Upkeep(folder).entries()}


def there(run: Run, keys: set[str]) -> set[int]:
    """Return the steps of a run whose keys are among some."""
    return {index for index, outcome in run.outcomes.items() if outcome.key in keys}


@pytest.fixture(params=SEEDS)
def study(request: pytest.FixtureRequest, tmp_path: Path) -> Study:
    return Study(request.param, tmp_path)


def test_stored_results_change_nothing(study: Study) -> None:
    alone = study.alone()
    first, called = study.run()
    same(first, alone)
    assert len(called) == len(set(called))
    same_values(first, alone)
    keys = keys_in(study.folder)
    second, called = study.run()
    same(second, alone)
    assert set(called) == Needed(alone, there(second, keys), study.kept).called
    same_values(second, alone)


def test_a_setting_has_its_dependants_computed_and_no_others(study: Study) -> None:
    study.run()
    study.change()
    alone, keys = study.alone(), keys_in(study.folder)
    run, called = study.run()
    same(run, alone)
    assert set(called) == Needed(alone, there(run, keys), study.kept).called
    same_values(run, alone)


def test_damage_is_reported_and_repaired(study: Study) -> None:
    alone = study.alone()
    study.run()
    damaged = damage(study)
    keys = keys_in(study.folder) - {path.stem for path in damaged}
    messages: list[str] = []
    run, called = study.run(messages.append)
    same(run, alone, unneeded=True)
    for path, content in damaged.items():
        if "entries" in path.parts and content is not None and read(path) != content:
            assert any(str(path) in line for line in messages)
    blobs = {path.name for path in damaged if "blobs" in path.parts}
    harmed = {entry.key for entry in entries(study) if blobs & entry.blobs().keys()}
    assert set(called) <= Needed(alone, there(run, keys - harmed), study.kept).called
    faithful = [index for index in called if not is_sketch(alone, index)]
    assert len(faithful) == len(set(faithful))
    same_values(run, alone)


def test_a_run_continues_where_it_was_interrupted(study: Study) -> None:
    alone = study.alone()
    events: list[Event] = []
    most = study.chance.randrange(4 * len(alone.outcomes))

    def count(event: Event) -> None:
        events.append(event)
        if len(events) == most:
            raise KeyboardInterrupt

    with suppress(KeyboardInterrupt):
        study.run(listeners=[count])
    finished = {event.step for event in events if event.kind in ("done", "refused")}
    run, called = study.run()
    same(run, alone)
    assert not {index for index in finished.intersection(called) if not is_sketch(alone, index)}
    same_values(run, alone)


def test_two_runs_may_use_a_store_at_once(study: Study) -> None:
    study.how = THREADS
    alone = study.alone()
    runs: list[Run] = []
    both = [threading.Thread(target=lambda: runs.append(study.run()[0])) for _ in range(2)]
    for thread in both:
        thread.start()
    for thread in both:
        thread.join()
    assert len(runs) == 2
    for run in runs:
        same(run, alone, unneeded=True)
        same_values(run, alone)


def is_sketch(alone: Run, index: int) -> bool:
    """Whether a stored output of a step is a stand-in."""
    return any(type(value) is Sketch for value in alone.in_memory.get(index, ()))


def entries(study: Study) -> Iterator[Entry]:
    return (listed.entry for listed in Upkeep(study.folder).entries())


def read(path: Path) -> bytes | None:
    return path.read_bytes() if path.exists() else None


def damage(study: Study) -> dict[Path, bytes | None]:
    """Damage some files of the store; return what they hold now, None where they are gone."""
    parts = ("entries/*", "blobs/*")
    files = [path for part in parts for path in sorted(study.folder.glob(f"*/{part}"))]
    before = {path: path.read_bytes() for path in files}
    damaged = study.chance.sample(files, min(len(files), study.chance.randint(1, 6)))
    for path in damaged:
        how, content = study.chance.choice(["gone", "cut", "swapped"]), path.read_bytes()
        rest = [file for file in files if file.exists() and file != path]
        if how == "gone" or not content or not rest:
            path.unlink()
        elif how == "cut":
            path.write_bytes(content[: study.chance.randrange(len(content))])
        else:
            other = study.chance.choice(rest)
            path.write_bytes(other.read_bytes())
            other.write_bytes(content)
    return {path: read(path) for path in files if read(path) != before[path]}
