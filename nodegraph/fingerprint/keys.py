"""Keys: what decides the result of a step, as one digest that can be explained part by part.

A key is made of the node's name, its code with all that it reaches in plugin packages, the
versions of the other distributions, the settings after defaults, the content of the files that
they name, and the keys of what feeds the step. Two steps with one key have one result.
"""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from nodegraph.fingerprint.code import Code, Reached
from nodegraph.fingerprint.source import SETTLED
from nodegraph.plan import Gathered, Plan, Step

if TYPE_CHECKING:
    from nodegraph.plugin.registry import Registry

_AT_AN_ADDRESS = " at 0x"


class Ended(Protocol):
    """How a step ended, as far as those who gather it may see."""

    @property
    def state(self) -> str:
        """``done``, ``refused``, ``failed`` or ``skipped``."""
        ...

    @property
    def cause(self) -> str:
        """For a skipped step, what became of the one that it needed."""
        ...

    @property
    def reason(self) -> str:
        """Why there is no value."""
        ...


@dataclass(frozen=True)
class Fixed:
    """What of a key does not come from other steps.

    Attributes
    ----------
    digest : str
        Empty when there is none.
    reached : Reached
        The node's code.
    files : mapping of setting to digest
        Of the content of each file that a setting names.
    reason : str
        Why there is no digest.
    """

    digest: str
    reached: Reached
    files: Mapping[str, str] = field(default_factory=dict)
    reason: str = ""


class Keys:
    """The keys of a plan's steps.

    Parameters
    ----------
    plan
    code
        Reads the code of nodes.
    files
        Reads the content of files.
    doubt
        Returns why code of that digest has no one result, or nothing if it is not known to have
        several.
    """

    def __init__(
        self, plan: Plan, code: Code, files: Files, doubt: Callable[[str], str] = lambda _: ""
    ) -> None:
        self._plan = plan
        self._code = code
        self._files = files
        self._doubt = doubt
        self._fixed: dict[tuple[int, int], Fixed] = {}
        self.of: list[str] = [""] * len(plan.steps)

    def make(self, step: Step, ended: Mapping[int, Ended]) -> str:
        """Return the key of a step whose needs have keys; empty when it has none.

        Parameters
        ----------
        step
        ended
            How steps before it ended, as far as that is known. A gathered step that is not in it
            counts as present.
        """
        parts = [self.fixed(step).digest]
        for port, fed in step.inputs.items():
            parts.append(port)
            if isinstance(fed, Gathered):
                parts.extend(self._gathered(fed, ended))
            else:
                parts.append(self.of[fed.step] and f"{self.of[fed.step]}.{fed.position}")
        key = hashlib.sha256("\n".join(parts).encode()).hexdigest() if all(parts) else ""
        self.of[step.index] = key
        return key

    def fixed(self, step: Step) -> Fixed:
        """Return what of a step's key does not come from other steps."""
        at = (id(step.method.node), id(step.settings))
        found = self._fixed.get(at)
        if found is None:
            found = self._fixed[at] = self._made(step)
        return found

    def unchanged(self, step: Step) -> bool:
        """Whether the files that a step's settings name are still as they were for its key."""
        files = self.fixed(step).files
        try:
            return all(
                self._files.digest(path) == files[name] for name, path in _files(step).items()
            )
        except OSError:
            return False

    def why_none(self, step: Step) -> str:
        """Return why a step has no key."""
        if reason := self.fixed(step).reason:
            return f"{step.method.node.name}: {reason}"
        return "they are made of results that are not stored"

    def _gathered(self, fed: Gathered, ended: Mapping[int, Ended]) -> list[str]:
        parts = [repr((fed.axes, fed.known))]
        for labels, output in fed.entries:
            there = ended.get(output.step)
            if there is None or there.state == "done":
                key = self.of[output.step]
                parts.append(key and f"{labels!r} {key}.{output.position}")
            else:
                parts.append(f"{labels!r} {there.cause}: {there.reason}")
        return parts + [f"{labels!r} skipped: {reason}" for labels, reason in fed.absent]

    def _made(self, step: Step) -> Fixed:
        node = step.method.node
        reached = self._code.of(node.function)
        if reached.unstable:
            return Fixed("", reached, reason=reached.unstable)
        try:
            files = {name: self._files.digest(path) for name, path in _files(step).items()}
        except OSError as error:
            return Fixed("", reached, reason=f"a file cannot be read: {error}")
        if doubt := self._doubt(reached.digest):
            return Fixed("", reached, files, doubt)
        settings = {name: value for name, value in step.settings.items() if name not in files}
        text = repr(sorted(settings.items()))
        if _AT_AN_ADDRESS in text:
            return Fixed("", reached, files, "a setting has no lasting text")
        parts = [node.name, reached.digest, text, repr(sorted(files.items()))]
        return Fixed(hashlib.sha256("\n".join(parts).encode()).hexdigest(), reached, files)


class Files:
    """Digests of the content of files; one that has not changed is not read again.

    Parameters
    ----------
    remembered
        What `remembered` returned in an earlier process.
    """

    def __init__(self, remembered: Mapping[str, Any] | None = None) -> None:
        self._known = dict(remembered or {})

    def digest(self, path: Path) -> str:
        """Return the digest of a file, or of all files in a folder, with the suffix.

        Raises
        ------
        OSError
            If it cannot be read.
        """
        if not path.is_dir():
            return self._one(str(path)) + path.suffix.lower()
        inside = sorted(one for one in path.rglob("*") if one.is_file())
        named = [f"{one.relative_to(path).as_posix()} {self._one(str(one))}" for one in inside]
        return hashlib.sha256("\n".join(named).encode()).hexdigest()

    def remembered(self) -> dict[str, Any]:
        """Return what a later process needs so as not to read the same files again."""
        return self._known

    def _one(self, path: str) -> str:
        status = os.stat(path)
        mark = [status.st_size, status.st_mtime_ns, status.st_ino]
        known = self._known.get(path)
        if isinstance(known, list) and known[:1] == [mark]:
            return str(known[1])
        with open(path, "rb") as opened:
            digest = hashlib.file_digest(opened, "sha256").hexdigest()
        # a file that was written just now may be written again within one tick of its clock
        if time.time_ns() - status.st_mtime_ns > SETTLED:
            self._known[path] = [mark, digest]
        return digest


def followed(registry: Registry) -> set[str]:
    """Return the packages whose code counts by what is in it, and not by its version."""
    return {"nodegraph", *(one.module.__name__.partition(".")[0] for one in registry.loaded)}


def _files(step: Step) -> Mapping[str, Path]:
    return {
        name: Path(step.settings[name])
        for name, setting in step.method.node.settings.items()
        if setting.is_file and step.settings.get(name) is not None
    }
