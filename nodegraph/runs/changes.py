"""What differs between two accounts of one step: its code, its settings, what feeds it."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

Sources = Mapping[str, tuple[str, ...]]
"""What feeds each port: a text per value."""


def settings_changed(
    was: Mapping[str, Any], now: Mapping[str, Any], files: Collection[str] = ()
) -> Iterator[str]:
    """Yield each setting that has another value, except those that name files."""
    for name in {**was, **now}:
        if name not in files and was.get(name) != now.get(name):
            yield f"{name} was {was.get(name)!r}, now {now.get(name)!r}"


def code_changed(was: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    """Yield each function and each distribution that is not what it was.

    Parameters
    ----------
    was, now
        ``units``: digests of functions, classes and constants by name; ``versions`` of
        distributions.
    """
    for name, how in _edited(was.get("units", {}), now.get("units", {})):
        yield f"code: {name} {how}"
    before, here = was.get("versions", {}), now.get("versions", {})
    for name in {**before, **here}:
        if before.get(name) != here.get(name):
            yield f"{name} was {before.get(name, 'not used')}, now {here.get(name, 'not used')}"


def sources_changed(was: Sources, now: Sources) -> Iterator[str]:
    """Yield each port that is fed by something else."""
    for port in {**was, **now}:
        then, here = was.get(port, ()), now.get(port, ())
        if len(then) != len(here):
            yield f"{port} took {len(then)} values, now {len(here)}"
        elif then != here:
            at = next(index for index, one in enumerate(then) if one != here[index])
            yield f"{port} took {then[at]}, now {here[at]}"


def recorded_sources(step: Mapping[str, Any], steps: Mapping[int, Mapping[str, Any]]) -> Sources:
    """Return what fed each port of a step in a record.

    Parameters
    ----------
    step
        One of the steps of ``run.json``.
    steps
        All of them, by their numbers.
    """
    return {
        port: tuple(
            source(steps[one["step"]]["node"], one["output"], one.get("labels", {}))
            for one in (fed if isinstance(fed, list) else [fed])
        )
        for port, fed in step["inputs"].items()
    }


def source(node: str, output: str, labels: Mapping[str, Any]) -> str:
    """Return what feeds a port, as text."""
    at = ", ".join(f"{axis}={label}" for axis, label in labels.items())
    return f"{node}.{output}" + (f" as {at}" if at else "")


def _edited(was: Mapping[str, str], now: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    for name in {**was, **now}:
        if name not in was:
            yield name, "is new to it"
        elif name not in now:
            yield name, "is no longer part of it"
        elif was[name] != now[name]:
            yield name, "was edited"
