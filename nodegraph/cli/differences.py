"""The combinations with which the differences of two runs begin, as lines of text."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from nodegraph.cli.output import MOST, few
from nodegraph.formatting import first_and_more

if TYPE_CHECKING:
    from nodegraph.cli.answers import FirstDifference
    from nodegraph.plugin.registry import Registry
    from nodegraph.runs.compare import Agreements, Judged, Pair
    from nodegraph.runs.record import RecordedStep
    from nodegraph.runs.recorded_value import StoredValues


def origins(
    agreements: Agreements, registry: Registry, stores: tuple[StoredValues, StoredValues]
) -> list[FirstDifference]:
    """Return where differences begin, an entry for each change of a node, in the order of the plan.

    Parameters
    ----------
    agreements
    registry
    stores
        Where the values of the two runs are.
    """
    from nodegraph.cli.answers import FirstDifference

    found: list[FirstDifference] = []
    for same in agreements.by_change():
        pair, judged = same[0]
        found.append(
            FirstDifference(
                node=pair.cell.node,
                labels=[other.cell.labels for other, _ in same],
                changes=pair.change.own,
                versions=pair.change.around,
                distance=max(other.distance for _, other in same),
                text=judged.text,
                values=list(_values(pair, registry, stores)) if len(found) < MOST else (),
            )
        )
    return found


def origin_lines(
    agreements: Agreements, found: list[FirstDifference], unexplained: Callable[[RecordedStep], str]
) -> Iterator[str]:
    """Yield what differs first, how much and why, a paragraph for each change.

    Parameters
    ----------
    agreements, found
        See `origins`.
    unexplained
        Returns a sentence on a step of the second run whose difference no change explains.
    """
    for number, (same, origin) in enumerate(
        zip(agreements.by_change(), found[:MOST], strict=False)
    ):
        pair, _ = same[0]
        groups = {other.cell.group for other, _ in same}
        whole = pair.cell.group if len(groups) == 1 else pair.cell.node
        name = first_and_more(pair.cell.name, len(same), whole)
        yield f"\n{'also' if number else 'first'}: {name}"
        lines = [*few(origin.changes, "changes"), *few(origin.versions, "versions")]
        if not (lines or pair.follows):
            lines = [unexplained(pair.now)]
        lines += [origin.text] if origin.text else []
        lines += [*_distance(same), *few(origin.values, "differences")]
        yield from (f"    {line}" for line in lines)


def _distance(same: list[tuple[Pair, Judged]]) -> Iterator[str]:
    pair, judged = max(same, key=lambda item: item[1].distance)
    if judged.distance:
        most = "" if len(same) == 1 else f", {pair.cell.name} most"
        yield f"by {judged.distance:.2g} times their usual size (root mean square{most})"


def _values(
    pair: Pair, registry: Registry, stores: tuple[StoredValues, StoredValues]
) -> Iterator[str]:
    """Yield the differences between the outputs of the two steps, as far as they are stored."""
    from nodegraph.runs.compare import output_differences

    if not (pair.was.has_result and pair.now.has_result):
        return
    before, after = stores[0].of(pair.was), stores[1].of(pair.now)
    if not before or not after:
        if pair.was.key:  # a lock has none, and seldom finds its values
            yield "its values are no longer stored and cannot be compared"
        return
    outputs = [
        record.method(step).outputs
        for record, step in zip(pair.records, (pair.was, pair.now), strict=True)
    ]
    was, now = (
        dict(zip(names, values, strict=False))
        for names, values in zip(outputs, (before, after), strict=True)
    )
    yield from output_differences(was, now, registry.hooks)
