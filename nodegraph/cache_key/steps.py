"""Keys: everything that decides the result of a step, as one digest that can be explained.

A key is made of the node's name, its code with all that it reaches in plugin packages, the
versions of the other distributions, the settings with their defaults, the content of the files
that they name, and the keys of the steps that feed it. Two steps of one key have one result.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from nodegraph.cache_key.files import FileDigests
from nodegraph.cache_key.functions import Code, Reached
from nodegraph.node.ports import Across
from nodegraph.state import State

if TYPE_CHECKING:
    from nodegraph.plan import Output, Step, StepInput
    from nodegraph.plugin.registry import Registry

_ADDRESS = " at 0x"
"""Text in the representation of a value that differs in each process."""


class _Result(Protocol):
    """The part of a step's outcome that enters the keys of the steps that it feeds."""

    @property
    def key(self) -> str: ...
    @property
    def state(self) -> State: ...
    @property
    def root(self) -> State: ...
    @property
    def reason(self) -> str: ...


def step_key(own: str, inputs: Mapping[str, StepInput], results: Mapping[int, _Result]) -> str:
    """Return the key of a step; empty if it has none.

    Parameters
    ----------
    own
        Digest of the step itself, see `StepDigest`; empty if there is none.
    inputs
        The source of each port.
    results
        How each step ended that feeds it, or is expected to end.
    """
    parts = [own]
    for port, source in inputs.items():
        parts.append(port)
        if isinstance(source, Across):
            parts.extend(_gathered(source, results))
        else:
            key = results[source.step].key
            parts.append(key and f"{key}.{source.position}")
    return _joined(parts) if all(parts) else ""


def _gathered(source: Across[Output], results: Mapping[int, _Result]) -> Iterator[str]:
    facts = source.axes, source.known, source.sources, source.unused, source.methods, source.fields
    yield repr((*facts, source.synthetic, source.units, source.files))
    for labels, output in source:
        result = results[output.step]
        if result.state is State.DONE:
            yield result.key and f"{labels!r} {result.key}.{output.position}"
        else:
            yield f"{labels!r} {result.root}: {result.reason}"
    yield from (f"{each.labels!r} skipped: {each.reason}" for each in source.absent)


def _joined(parts: list[str]) -> str:
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


@dataclass(frozen=True)
class StepDigest:
    """The part of a key that depends on the step alone: its code, settings and files.

    Attributes
    ----------
    digest : str
        Empty if there is none; then the step has no key.
    code : Reached
        The node's code.
    files : mapping of setting to digest
        Digest of the content of each file that a setting names.
    reason : str
        Why there is no digest.
    """

    digest: str
    code: Reached
    files: Mapping[str, str] = field(default_factory=dict)
    reason: str = ""


class StepDigests:
    """The digests of steps, each computed once.

    Parameters
    ----------
    code
        Reads the code of nodes.
    files
        Reads the content of files.
    distrust
        Returns why the code of a digest has no single result; an empty text if nothing is known
        against it.
    """

    def __init__(self, code: Code, files: FileDigests, distrust: Callable[[str], str]) -> None:
        self._code = code
        self._files = files
        self._distrust = distrust
        self._known: dict[tuple[str, str, int], StepDigest] = {}

    def of(self, step: Step) -> StepDigest:
        """Return the digest of a step itself."""
        at = (step.node, step.method.label, id(step.settings))
        known = self._known.get(at)
        if known is None:
            known = self._known[at] = self._computed(step)
        return known

    def unchanged(self, step: Step) -> bool:
        """Whether the files that a step's settings name are still as they were for its digest."""
        before = self.of(step).files
        try:
            return all(
                self._files.digest(path) == before[name] for name, path in _paths(step).items()
            )
        except OSError:
            return False

    def _computed(self, step: Step) -> StepDigest:
        node = step.method.node
        code = self._code.of(node.function)
        if code.unstable:
            return StepDigest("", code, reason=code.unstable)
        try:
            files = {name: self._files.digest(path) for name, path in _paths(step).items()}
        except OSError as error:
            return StepDigest("", code, reason=f"a file cannot be read: {error}")
        if reason := self._distrust(code.digest):
            return StepDigest("", code, files, reason)
        settings = repr(sorted(item for item in step.settings.items() if item[0] not in files))
        if _ADDRESS in settings:
            return StepDigest("", code, files, "a setting has no lasting text")
        parts = [node.name, code.digest, settings, repr(sorted(files.items()))]
        return StepDigest(_joined(parts), code, files)


def code_of(registry: Registry, remembered: Mapping[str, Any] | None = None) -> Code:
    """Return a finder of the code of nodes that use the plugins of a registry."""
    return Code(followed(registry), remembered, lambda: registry.hooks.of("formats"))


def followed(registry: Registry) -> set[str]:
    """Return the packages whose code counts by its content, and not by its version."""
    return {
        "nodegraph",
        *(plugin.module.__name__.partition(".")[0] for plugin in registry.loaded),
    }


def _paths(step: Step) -> Mapping[str, Path]:
    return {
        name: Path(step.settings[name])
        for name, setting in step.method.node.settings.items()
        if setting.is_file and step.settings.get(name) is not None
    }
