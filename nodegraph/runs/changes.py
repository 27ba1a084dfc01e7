"""Changes of a step between two runs: its settings, its code, the sources of its ports."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from nodegraph.cache_key import Reached
from nodegraph.formatting import labels_of
from nodegraph.runs.record import RecordedCode, RecordedStep

Sources = Mapping[str, tuple[str, ...]]
"""The sources of each port: a text per value."""

Code = RecordedCode | Reached


def setting_changes(
    was: Mapping[str, object], now: Mapping[str, object], files: Collection[str] = ()
) -> Iterator[str]:
    """Yield a text per setting with another value, except those that name files."""
    for name in {**was, **now}:
        if name not in files and was.get(name) != now.get(name):
            yield f"{name} was {was.get(name)!r}, now {now.get(name)!r}"


def file_change(setting: str, was: object, now: object) -> str:
    """Return how a setting that names a file changed, if its content is another now."""
    if was != now:
        return f"{setting} was {was!r}, now {now!r}"
    return f"{setting}: the content of {now} changed"


def code_changes(was: Code, now: Code) -> Iterator[str]:
    """Yield a text per module that was edited, and per distribution of another version."""
    for name in {**was.units, **now.units}:
        if name not in was.units:
            yield f"code: {name} was not used before"
        elif name not in now.units:
            yield f"code: {name} is no longer used"
        elif was.units[name] != now.units[name]:
            yield f"code: {name} was edited"
    for name in {**was.versions, **now.versions}:
        before, after = (code.versions.get(name, "not used") for code in (was, now))
        if before != after:
            yield f"{name} was {before}, now {after}"


def source_changes(was: Sources, now: Sources) -> Iterator[str]:
    """Yield a text per port that is fed by something else."""
    for port in {**was, **now}:
        before, after = was.get(port, ()), now.get(port, ())
        if len(before) != len(after):
            yield f"{port} took {len(before)} values, now {len(after)}"
        else:
            pairs = zip(before, after, strict=True)
            first = next((pair for pair in pairs if pair[0] != pair[1]), None)
            if first is not None:
                yield f"{port} took {first[0]}, now {first[1]}"


def recorded_sources(step: RecordedStep, steps: Mapping[int, RecordedStep]) -> Sources:
    """Return the sources of each port of a step in a record, whose steps are numbered."""
    return {
        port: tuple(
            source_text(steps[source.step].node, source.output, source.labels) for source in sources
        )
        for port, sources in step.sources()
    }


def source_text(node: str, output: str, labels: Mapping[str, object]) -> str:
    """Return the text for an output that feeds a port: ``fill.output as fill=muscle``."""
    return f"{node}.{output}" + (f" as {labels_of(labels)}" if labels else "")
