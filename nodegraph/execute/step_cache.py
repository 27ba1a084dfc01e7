"""What earlier runs have left: finds, loads and saves the results of a plan's steps."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nodegraph.execute.call import Outcome, skipped
from nodegraph.fingerprint import Code
from nodegraph.fingerprint.keys import Files, Keys, followed
from nodegraph.gc_pause import no_collection
from nodegraph.plan import Plan, Step
from nodegraph.store import About, DamagedEntry, Entry, Packer, Store, store_folder

if TYPE_CHECKING:
    from nodegraph.plugin.registry import Registry

_CODE, _FILES = "code", "files"
AUDITED = "audit-"
"""How the names begin under which a store remembers what audits found."""

_SEVERAL = "an audit found that it gives another answer"


def open_store(registry: Registry, folder: Path | None, say: Callable[[str], None]) -> Store:
    """Return the store in a folder, or where the platform keeps such things.

    Parameters
    ----------
    registry
        Says how values of its plugins' types are kept.
    folder
    say
        Hears what is wrong with the store; runs go on without it.
    """
    packages = followed(registry)
    packer = Packer(registry.hooks.storages, packages.__contains__)
    return Store(store_folder(folder), packer, say)


class Recall:
    """The results of a plan's steps, as far as a store has them.

    Parameters
    ----------
    plan
    store

    Attributes
    ----------
    store : Store
    keys : Keys
    not_kept : Counter of str
        Why results could not be kept, and how many.
    """

    def __init__(self, plan: Plan, store: Store) -> None:
        self.store = store
        self._plan = plan
        self._before = {name: store.recall(name) for name in (_CODE, _FILES)}
        self._code = Code(followed(plan.graph.registry), self._before[_CODE])
        self._files = Files(self._before[_FILES])
        self._doubted: dict[str, str] = {}
        self.keys = Keys(plan, self._code, self._files, self._doubt)
        self._entries: dict[int, Entry] = {}
        self._saved: set[str] = set()
        self.not_kept: Counter[str] = Counter()
        self._lock = threading.Lock()

    @no_collection()
    def look_up(self) -> dict[int, Outcome]:
        """Return how those steps ended that are stored, then those that are skipped for it."""
        known: dict[int, Outcome] = {}
        for step in self._plan.steps:
            key = self.keys.make(step, known)
            found = self._find(step, key) or skipped(self._plan, step, known)
            if found is not None:
                known[step.index] = found
        self._remember()
        return dict(sorted(known.items(), key=lambda one: not one[1].stored))

    def look_again(
        self, step: Step, outcomes: Mapping[int, Outcome], *, afresh: bool = False
    ) -> Outcome | None:
        """Return how a step ended, if it is stored now that all is known of what feeds it.

        Parameters
        ----------
        step
        outcomes
        afresh
            Whether a result of which any value is a stand-in is of no use.
        """
        supposed = self.keys.of[step.index]
        key = self.keys.make(step, outcomes)
        if key == supposed and key not in self._saved:
            return None
        self._entries.pop(step.index, None)
        found = self._find(step, key)
        whole = not afresh or self.gives(step.index, range(len(step.method.node.outputs)))
        return found if whole else None

    def known(self) -> dict[int, Outcome]:
        """Return how those steps ended whose results are in the store by now."""
        return {index: _outcome(entry) for index, entry in self._entries.items()}

    def gives(self, index: int, positions: Iterable[int]) -> bool:
        """Whether stored outputs are the values themselves, and no stand-ins to be shown."""
        entry = self._entries.get(index)
        return entry is not None and all(entry.faithful[position] for position in positions)

    def __contains__(self, index: object) -> bool:
        """Whether a step is stored."""
        return index in self._entries

    def load(self, index: int) -> tuple[Any, ...] | None:
        """Return the stored values of a step, or None when there are none or they are damaged."""
        if index not in self._entries:
            return None
        try:
            return self.store.load(self._entries[index])
        except DamagedEntry:
            del self._entries[index]
            return None

    def save(self, step: Step, outcome: Outcome) -> Outcome:
        """Store an outcome, in any thread, and return it with what the store says of it."""
        if outcome.state not in ("done", "refused"):
            return outcome
        key = self.keys.of[step.index]
        if not key:
            self._count(self.keys.why_none(step))
            return self._one_of_several(step, outcome)
        if not self.keys.unchanged(step):
            # nor may anything be found or kept that is made of it
            self.keys.of[step.index] = ""
            self._entries.pop(step.index, None)
            self._count("a file changed while it was read")
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
            return outcome
        self._entries[step.index] = entry
        self._saved.add(key)
        return replace(outcome, digests=entry.digests)

    def doubt(self, step: Step, said: str) -> bool:
        """Have no result of a step's code stored, or taken from the store, by runs from now on.

        Parameters
        ----------
        step
            One that was found to have several results.
        said
            Under which conditions.

        Returns
        -------
        bool
            Whether that could be written down.
        """
        digest = self.keys.fixed(step).reached.digest
        self.store.remember(_audit_of(digest), {"node": step.method.node.name, "said": said})
        return self.store.writable

    def doubted(self, step: Step) -> str:
        """Return what an audit found of a step's code, if it has several results."""
        return self._doubt(self.keys.fixed(step).reached.digest)

    def _doubt(self, digest: str) -> str:
        if digest not in self._doubted:
            said = self.store.recall(_audit_of(digest)).get("said")
            self._doubted[digest] = f"{_SEVERAL} in {said}" if said else ""
        return self._doubted[digest]

    def _one_of_several(self, step: Step, outcome: Outcome) -> Outcome:
        """Return an outcome that says, if its code is in doubt, that it is one of several."""
        doubt = self._doubted.get(self.keys.fixed(step).reached.digest)
        if not doubt:
            return outcome
        said = f"{doubt}: this result is one of several, and is not stored"
        return replace(outcome, warnings=(*outcome.warnings, said))

    def _count(self, reason: str) -> None:
        with self._lock:
            self.not_kept[reason] += 1

    def _find(self, step: Step, key: str) -> Outcome | None:
        entry = self.store.find(key) if key else None
        if entry is None:
            return None
        self._entries[step.index] = entry
        return _outcome(entry)

    def _remember(self) -> None:
        """Leave to the next process what it need not read again."""
        now = {_CODE: self._code.remembered(), _FILES: self._files.remembered()}
        for name, known in now.items():
            if known != self._before[name]:
                self.store.remember(name, known)


def _audit_of(digest: str) -> str:
    return f"{AUDITED}{digest}"


def _outcome(entry: Entry) -> Outcome:
    return Outcome(
        entry.state,
        (),
        entry.reason,
        "",
        tuple(entry.warnings),
        entry.seconds,
        entry.state,
        True,
        tuple(entry.digests),
    )
