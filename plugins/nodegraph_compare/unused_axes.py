"""Sentences on axes that are settings of some methods only."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph import listed

if TYPE_CHECKING:
    from nodegraph import Across, Label
    from nodegraph_mocap import Table


def unused_axes(scores: Across[Table], compare: str | None) -> dict[str, str]:
    """Return which gathered axes concern some of the tables only, and a sentence on which.

    The others stand at every label of such an axis with one number, and count as often.
    """
    return {
        axis: _sentence(scores, axis, [axis in names for names in scores.unused], compare)
        for axis in scores.axes
        if any(axis in names for names in scores.unused)
    }


def _sentence(scores: Across[Table], axis: str, unused: list[bool], compare: str | None) -> str:
    count = f"with the same numbers at each of its {len(scores.labels(axis))} labels"
    if all(unused):
        return f"nothing depends on {axis}: every table counts {count}"
    for other in sorted(scores.axes, key=lambda name: name != compare):
        split = None if other == axis else _split(scores, other, unused)
        if split:
            using, rest = split
            verb = "depends" if len(using) == 1 else "depend"
            verb_rest = "counts" if len(rest) == 1 else "count"
            return f"only {listed(using)} {verb} on {axis}: {listed(rest)} {verb_rest} {count}"
    return f"{sum(unused)} of {len(unused)} tables do not depend on {axis}: they count {count}"


def _split(
    scores: Across[Table], axis: str, unused: list[bool]
) -> tuple[list[Label], list[Label]] | None:
    """Return the labels of an axis that use another one and those that do not, if they differ."""
    flags: dict[Label, set[bool]] = {}
    for (labels, _), is_unused in zip(scores, unused, strict=True):
        flags.setdefault(labels.get(axis, ""), set()).add(is_unused)
    if any(len(several) > 1 for several in flags.values()):
        return None
    return (
        [label for label, several in flags.items() if False in several],
        [label for label, several in flags.items() if True in several],
    )
