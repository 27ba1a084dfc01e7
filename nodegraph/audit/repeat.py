"""One call of a node made again: here, with more threads, in another process."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Any, Literal

from nodegraph.errors import NodegraphError
from nodegraph.execute import Run
from nodegraph.execute.call import Call, Outcome, collecting_warnings, perform
from nodegraph.execute.numeric_threads import one_thread_each
from nodegraph.execute.schedule import Schedule
from nodegraph.execute.step_cache import StepCache
from nodegraph.execute.worker.client import CallCodec, Worker, WorkerEndedError
from nodegraph.execute.worker.protocol import ResponseKind
from nodegraph.lock.sketch import FLOOR, TOLERANCE, sketch
from nodegraph.node.ports import Across
from nodegraph.plugin.hook_types import Comparison
from nodegraph.runs.diff import value_differences
from nodegraph.state import State
from nodegraph.store import DamagedEntry, Packed, Packer, Unstorable

Grade = Literal["identical", "close", "differs"]

_LAYOUT = "equal numbers, whose bits or places in memory are others"


@dataclass(frozen=True)
class Given:
    """What a call gave.

    Attributes
    ----------
    values : tuple
        One per output; what stands in for it where it cannot be kept as itself.
    digests : tuple of str
        One per output, of its content; empty where there is none.
    packed : tuple of Packed or None
        Of the outputs that are kept as themselves.
    """

    values: tuple[Any, ...]
    digests: tuple[str, ...]
    packed: tuple[Packed | None, ...]

    @classmethod
    def of(cls, values: Iterable[Any], packer: Packer) -> Given:
        """Return values such that they can be compared."""
        taken = [_taken(value, packer) for value in values]
        return cls(
            tuple(value for value, _ in taken),
            tuple(one.digest if one is not None else "" for _, one in taken),
            tuple(one if one is not None and one.faithful else None for _, one in taken),
        )


@dataclass(frozen=True)
class Drift:
    """How far two results are apart.

    Attributes
    ----------
    grade : str
        ``identical`` to the bit; ``close``, up to what rounding makes of the numbers; or
        ``differs``.
    said : tuple of str
        What differs, in words.
    """

    grade: Grade = "identical"
    said: tuple[str, ...] = ()


def drift(
    one: Given,
    other: Given,
    ports: Sequence[str],
    comparisons: Iterable[Comparison],
    floor: float = 0.0,
) -> Drift:
    """Return how far two results of one call are apart.

    Numbers are close if they differ by no more than the ``TOLERANCE`` of locks, relative to the
    root mean square of those at the same place of the value. Whatever is no float must be equal,
    and so must be which floats are missing.

    Parameters
    ----------
    one, other
    ports
        Names of the outputs.
    comparisons
        Say in words of their field how two values differ.
    floor
        The size below which numbers count as of that size.
    """
    kinds = tuple(comparisons)
    found: list[Drift] = []
    for place, port in enumerate(ports):
        if not one.digests[place] or one.digests[place] != other.digests[place]:
            words = value_differences(one.values[place], other.values[place], kinds)
            grade = _grade(one.packed[place], other.packed[place], words, floor)
            several = len(ports) > 1
            said = tuple(f"{port}: {text}" if several else text for text in words)
            found.append(Drift(grade, said or ((_LAYOUT,) if grade == "close" else ())))
    grades: list[Grade] = ["identical", *(drifted.grade for drifted in found)]
    return Drift(
        max(grades, key=_RANK.__getitem__),
        tuple(text for drifted in found for text in drifted.said),
    )


def floor_of(inputs: Mapping[str, Any], packer: Packer) -> float:
    """Return the size below which the results of a call may be rounding of its inputs."""
    packed = {port: _taken(value, packer)[1] for port, value in inputs.items()}
    found = sketch({port: one for port, one in packed.items() if one is not None})
    return FLOOR * max((leaf.size for leaf in found.leaves.values()), default=0.0)


_RANK: Mapping[Grade, int] = {"identical": 0, "close": 1, "differs": 2}


def _grade(one: Packed | None, other: Packed | None, words: tuple[str, ...], floor: float) -> Grade:
    if one is None or other is None:
        return "differs" if words else "identical"
    first, second = sketch({"": one}), sketch({"": other})
    if first.exact != second.exact:
        return "differs" if words else "close"
    scales = {place: max(leaf.size, floor) for place, leaf in first.leaves.items()}
    apart = first.against(scales).apart(second.against(scales).projections)
    return "close" if apart <= TOLERANCE else "differs"


def _taken(value: Any, packer: Packer) -> tuple[Any, Packed | None]:
    try:
        packed = packer.pack(value)
    except Unstorable:
        return value, None
    return value if packed.faithful else packer.unpack(packed.head, packed.buffers), packed


SEVERAL = 2
"""Threads of numerical libraries, where one is what each call of a run gets."""


@dataclass(frozen=True)
class Case:
    """A call that can be made again.

    Attributes
    ----------
    call : Call
    marks : mapping of port to str
        A digest of each input as the node should leave it; an empty one of what cannot be taken
        apart.
    """

    call: Call
    marks: Mapping[str, str]


class Repeats:
    """Makes the calls of a finished run again, each as often as one likes with the same inputs.

    Use it in a ``with`` statement, at whose end the other process ends.

    Parameters
    ----------
    run
        With a store, from which come the inputs.
    """

    def __init__(self, run: Run) -> None:
        assert run.cache is not None, "an audit needs a store"
        self._run = run
        # another one, which takes what the run has just stored for found, and computes no less
        self._cache = StepCache(run.plan, run.cache.store)
        registry = run.plan.graph.registry
        self._codec = CallCodec(registry, run.packer, shares_files=True, is_new=True)
        self._worker: Worker | None = None
        self._open = ExitStack()

    def __enter__(self) -> Repeats:
        self._open.enter_context(collecting_warnings())
        self._open.enter_context(one_thread_each())
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._open.close()
        if self._worker is not None:
            self._worker.close() if kind is None else self._worker.kill()

    def case(self, index: int) -> Case:
        """Return the call of a step, with the inputs that the run gave it.

        Raises
        ------
        NodegraphError
            If they are not stored any more and cannot be computed again.
        """
        ended = self._run.outcomes.items()
        without = {at: one for at, one in ended if not one.state.has_value}
        known = {at: one for at, one in (self._cache.known | without).items() if at != index}
        schedule = Schedule(
            self._run.plan,
            cache=self._cache,
            known=known,
            packer=self._run.packer,
            wanted=[index],
        )
        while (call := schedule.next()) is not None:
            if call.step == index:
                return Case(call, _marks(call.inputs, self._run.packer))
            schedule.finish(call.step, perform(call))
        reason = schedule.outcomes[index].reason
        raise NodegraphError(f"what feeds it cannot be computed again: {reason}")

    def here(self, case: Case, threads: int = 1) -> tuple[Outcome, str]:
        """Make a call in this process; return its outcome and which of its inputs it changed."""
        packer = self._run.packer
        inputs = {port: _lent(value, packer) for port, value in case.call.inputs.items()}
        with numeric_threads(threads):
            outcome = perform(replace(case.call, inputs=inputs))
        after = _marks(inputs, packer)
        return outcome, ", ".join(port for port in inputs if case.marks[port] != after[port])

    def elsewhere(self, case: Case) -> Outcome | str:
        """Make a call in another process; return its outcome, or why it cannot be made there.

        Raises
        ------
        WorkerEndedError
            If the process dies of it.
        """
        request = self._codec.encode(case.call)
        if request is None:
            return "the node or what feeds it cannot be sent there"
        if self._worker is None or not self._worker.is_alive:
            self._worker = Worker()
        try:
            response = self._worker.send(request)
        except WorkerEndedError:
            self._worker.close()
            self._worker = None
            raise
        if response.kind in (ResponseKind.MISSING, ResponseKind.UNSENDABLE):
            return response.outcome.reason
        outcome = self._codec.decode(response, "a process")
        return "what comes back cannot be read" if outcome is None else outcome

    def given(self, outcome: Outcome) -> Given:
        """Return what a call gave, such that it can be compared."""
        return Given.of(outcome.values, self._run.packer)

    def stored(self, index: int) -> Given | None:
        """Return what the store has of a step."""
        step, key = self._run.plan.steps[index], self._run.outcomes[index].key
        entry = self._cache.entry(step, key)
        if entry is None or entry.state != State.DONE:
            return None
        try:
            values = self._cache.values(step, entry)
        except DamagedEntry:
            return None
        return replace(Given.of(values, self._run.packer), digests=entry.digests)


@contextmanager
def numeric_threads(count: int) -> Iterator[None]:
    """Have numerical libraries use so many threads for what is called in this thread."""
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=count), _numba_threads(count):
        yield


@contextmanager
def _numba_threads(count: int) -> Iterator[None]:
    numba = sys.modules.get("numba")
    if numba is None:
        yield
        return
    before = numba.get_num_threads()
    numba.set_num_threads(min(count, numba.config.NUMBA_NUM_THREADS))
    try:
        yield
    finally:
        numba.set_num_threads(before)


def _lent(value: Any, packer: Packer) -> Any:
    """Return what one call gets of a value, which a later call gets as it is now."""
    if not isinstance(value, Across):
        return packer.lend(value)
    entries = tuple((labels, packer.lend(one)) for labels, one in value)
    return replace(value, entries=entries)


def _marks(inputs: Mapping[str, Any], packer: Packer) -> dict[str, str]:
    return {port: _mark(value, packer) for port, value in inputs.items()}


def _mark(value: Any, packer: Packer) -> str:
    try:
        return packer.digest(value)
    except Unstorable:
        return ""
