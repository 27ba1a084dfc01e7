"""Look up, load and save the results of a plan's steps in the store.

A run that was killed resumes here: each result is stored as its step ends, and the same command
finds it.
"""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cache_key import FileDigests, StepDigest, StepDigests, code_of, followed, step_key
from nodegraph.execute.outcome import Outcome, skipped
from nodegraph.gc_pause import gc_paused
from nodegraph.plan import Plan, Step
from nodegraph.state import State
from nodegraph.store import About, DamagedEntry, Entry, Packer, Store, store_folder

if TYPE_CHECKING:
    from nodegraph.plugin.registry import Registry

_CODE, _FILES = "code", "files"
AUDITED = "audit-"
"""Beginning of the names under which a store remembers the findings of audits."""


def open_store(registry: Registry, folder: Path | None, report: Callable[[str], None]) -> Store:
    """Return the store in a folder, by default in the platform's folder for caches.

    Parameters
    ----------
    registry
        How values of its plugins' types are stored.
    folder
    report
        Called with what is wrong with the store; runs continue without it.
    """
    packages = followed(registry)
    packer = Packer(registry.hooks.kinds, packages.__contains__)
    return Store(store_folder(folder), packer, report)


class StoredSteps:
    """The results of a plan's steps, as far as a store has them.

    Every step is looked up at once, under the key that it has if all steps before it that are not
    stored succeed. A step whose inputs turn out otherwise is looked up again under its final key.

    Parameters
    ----------
    plan
    store

    Attributes
    ----------
    store : Store
    known : mapping of step index to Outcome
        Outcomes of the steps that were stored at first, then of those skipped because of these.
    not_stored : Counter of str
        Why results could not be stored, and how many.
    """

    def __init__(self, plan: Plan, store: Store) -> None:
        self.store = store
        self._plan = plan
        self._remembered = {name: store.recall(name) for name in (_CODE, _FILES)}
        registry = plan.graph.registry
        self._code = code_of(registry, self._remembered[_CODE])
        self._files = FileDigests(self._remembered[_FILES])
        self._findings: dict[str, str] = {}
        self._digests = StepDigests(self._code, self._files, self._finding)
        self._expected: dict[int, Outcome] = {}
        self._entries: dict[int, Entry] = {}
        self._saved: set[str] = set()
        self.not_stored: Counter[str] = Counter()
        self._lock = threading.Lock()
        self.known = self._look_up()

    def __contains__(self, index: object) -> bool:
        """Whether a step is stored."""
        return index in self._entries

    def digest_of(self, step: Step) -> StepDigest:
        """Return the part of a step's key that depends on the step alone."""
        return self._digests.of(step)

    def expected_key(self, index: int) -> str:
        """Return the key of a step as far as it was known before anything was computed."""
        return self._expected[index].key

    def key(self, step: Step, outcomes: Mapping[int, Outcome]) -> str:
        """Return the key of a step whose inputs have ended; empty if it has none."""
        return step_key(self._digests.of(step).digest, step.inputs, outcomes)

    def look_again(self, step: Step, key: str, *, whole: bool) -> Outcome | None:
        """Return the outcome of a step, if its final key is stored and was not looked up at first.

        Parameters
        ----------
        step
        key
        whole
            Whether the result is of no use if any of its values is a stand-in.
        """
        entry = self._entries.get(step.index)
        if entry is not None and entry.key != key:
            del self._entries[step.index]
        if key not in self._saved and (whole or key == self.expected_key(step.index)):
            return None
        outcome = self._find(step, key)
        if whole and not self.gives(step.index, range(len(step.method.node.outputs))):
            return None
        return outcome

    def stored(self) -> dict[int, Outcome]:
        """Return the outcomes of the steps whose results are in the store by now."""
        return {index: _outcome(entry) for index, entry in self._entries.items()}

    def gives(self, index: int, positions: Iterable[int]) -> bool:
        """Whether stored outputs are the values themselves, and no stand-ins to be shown."""
        entry = self._entries.get(index)
        return entry is not None and all(entry.faithful[position] for position in positions)

    def load(self, index: int) -> tuple[object, ...] | None:
        """Return the stored values of a step, or None if there are none or they are damaged."""
        if index not in self._entries:
            return None
        try:
            return self.values(self._plan.steps[index], self._entries[index])
        except DamagedEntry:
            del self._entries[index]
            return None

    def entry(self, step: Step, key: str) -> Entry | None:
        """Return the entry of a step under a key, without its values."""
        outputs = len(step.method.node.outputs)
        return self.store.find(key, outputs=outputs) if key else None

    def values(self, step: Step, entry: Entry) -> tuple[object, ...]:
        """Return the values of an entry of a step.

        Raises
        ------
        DamagedEntry
            If they are not what was written, or of other types than the node's outputs.
        """
        return self.store.load(entry, [port.type for port in step.method.node.outputs])

    def save(self, step: Step, key: str, outcome: Outcome) -> Outcome:
        """Store an outcome, in any thread, and return it with its key and its digests."""
        if outcome.state not in (State.DONE, State.REFUSED):
            return replace(outcome, key=key)
        if not key:
            self._count(self._why_no_key(step))
            return self._with_finding(step, outcome)
        if not self._digests.unchanged(step):
            # without a key, nothing that depends on it is looked up or stored either
            self._entries.pop(step.index, None)
            self._count("a file changed while it was read")
            return outcome
        if outcome.undeclared_reads:
            self._entries.pop(step.index, None)
            names = ", ".join(outcome.undeclared_reads)
            self._count(
                f"{step.method.node.name} reads {names}, which no setting names, so that nothing "
                "would say when it changes"
            )
            return outcome
        about = About(
            step.method.node.name,
            step.name,
            outcome.state,
            outcome.reason,
            outcome.warnings,
            outcome.seconds,
        )
        entry = self.store.save(key, about, outcome.values)
        if entry is None:
            return replace(outcome, key=key)
        self._entries[step.index] = entry
        self._saved.add(key)
        return replace(outcome, key=key, digests=entry.digests)

    def distrust(self, step: Step, conditions: str) -> bool:
        """Neither store results of a step's code, nor use stored ones, in runs from now on.

        Parameters
        ----------
        step
            Whose code was found to have several results.
        conditions
            Under which it has others.

        Returns
        -------
        bool
            Whether the store could note it.
        """
        digest = self._digests.of(step).code.digest
        finding = {"node": step.method.node.name, "conditions": conditions}
        self.store.remember(_audit_of(digest), finding)
        return self.store.writable

    def distrusted(self, step: Step) -> str:
        """Return the finding of an audit if a step's code has several results."""
        return self._finding(self._digests.of(step).code.digest)

    @gc_paused()
    def _look_up(self) -> dict[int, Outcome]:
        stored: dict[int, Outcome] = {}
        known: dict[int, Outcome] = {}
        for step in self._plan.steps:
            key = self.key(step, self._expected)
            outcome = self._find(step, key)
            if outcome is not None:
                stored[step.index] = outcome
            elif (outcome := skipped(self._plan, step, known)) is not None:
                outcome.key = key
            if outcome is not None:
                known[step.index] = outcome
            self._expected[step.index] = outcome or Outcome(State.DONE, key=key)
        self._remember()
        return stored | known

    def _find(self, step: Step, key: str) -> Outcome | None:
        entry = self.entry(step, key)
        if entry is None:
            return None
        self._entries[step.index] = entry
        return _outcome(entry)

    def _finding(self, digest: str) -> str:
        if digest not in self._findings:
            conditions = self.store.recall(_audit_of(digest)).get("conditions")
            self._findings[digest] = (
                f"an audit found that it gives another answer in {conditions}" if conditions else ""
            )
        return self._findings[digest]

    def _with_finding(self, step: Step, outcome: Outcome) -> Outcome:
        """Return an outcome with a warning if its code is known to have several results."""
        finding = self._findings.get(self._digests.of(step).code.digest)
        if not finding:
            return outcome
        warning = f"{finding}: this result is one of several, and is not stored"
        return replace(outcome, warnings=(*outcome.warnings, warning))

    def _why_no_key(self, step: Step) -> str:
        if reason := self._digests.of(step).reason:
            return f"{step.method.node.name}: {reason}"
        return "they are made of results that are not stored"

    def _count(self, reason: str) -> None:
        with self._lock:
            self.not_stored[reason] += 1

    def _remember(self) -> None:
        """Leave to the next process what it need not read again."""
        now = {_CODE: self._code.remembered(), _FILES: self._files.remembered}
        for name, known in now.items():
            if known != self._remembered[name]:
                self.store.remember(name, known)


def _audit_of(digest: str) -> str:
    return f"{AUDITED}{digest}"


def _outcome(entry: Entry) -> Outcome:
    return Outcome(
        State(entry.state),
        reason=entry.reason,
        warnings=tuple(entry.warnings),
        seconds=entry.seconds,
        stored=True,
        digests=tuple(entry.digests),
        key=entry.key,
    )
