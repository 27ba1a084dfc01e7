"""The answer of the score of steps: which does most, and a card per step with before and after."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import listed
from nodegraph_tables.answer import Answer, Card
from nodegraph_tables.lead import dot, svg
from nodegraph_tables.line import Line, line_of
from nodegraph_tables.numbers import number_text
from nodegraph_tables.text import HERE, Text, Word, listing, say

if TYPE_CHECKING:
    from nodegraph import Across
    from nodegraph_mocap import Trajectories

BETTER, WORSE = "better", "worse"
Row = Mapping[str, Any]
_Y = 12.0


def worse(rows: Iterable[Mapping[str, object]]) -> Iterator[str]:
    """Yield a warning for each step that makes it worse."""
    for row in rows:
        if row["verdict"] == WORSE:
            yield f"{row['step']} makes it worse: {_moved(row)}"


def left_out(stages: Across[Trajectories], truth: Trajectories) -> Iterator[str]:
    """Yield which stages are absent, and which markers and samples do not count."""
    if stages.absent:
        yield f"stages are passed over{absences(stages)}"
    known = set(truth.markers)
    extra: dict[tuple[str, ...], list[str]] = {}
    for name, stage in zip(stages.names(), stages.values(), strict=True):
        beyond = tuple(marker for marker in stage.markers if marker not in known)
        extra.setdefault(beyond, []).append(name)
    for markers, names in extra.items():
        if markers:
            yield (
                f"{len(markers)} markers of {', '.join(names)} are not in the truth and do not "
                f"count: {listed(markers)}"
            )
    unknown = np.count_nonzero(~truth.present)
    if unknown:
        yield f"{unknown} of {truth.origin.size} samples lack a truth and do not count"


def absences(stages: Across[Trajectories]) -> str:
    """Return which stages are absent, and why."""
    reasons = [
        f"{', '.join(map(str, absence.labels.values()))} was {absence.kind} ({absence.reason})"
        for absence in stages.absent
    ]
    return f"; {'; '.join(reasons)}" if reasons else ""


def _moved(row: Mapping[str, object]) -> str:
    return (
        f"{row['before']:.3g} mm before and {row['after']:.3g} mm after, over the "
        f"{row['changed']} samples that it changed"
    )


def answer_of(rows: Sequence[Row]) -> Answer:
    """Return the answer: which step does most, whether any makes it worse, and each step.

    Parameters
    ----------
    rows
        Rows of the table, the first of what came.
    """
    names = ("before", "after", "added rmse", "rmse")
    line = line_of([float(row[name]) for row in rows for name in names])
    scope = (
        "Scope: one recording whose truth is known. Numbers: root mean square distance to the "
        "truth, in mm; large, of all samples after the step; on the line, of those that it "
        "changed, hollow before and filled after, or of those that it added."
    )
    return Answer(_headline(rows), (scope,), tuple(_card(row, line) for row in rows))


def _headline(rows: Sequence[Row]) -> Text:
    better = [row for row in rows if row["verdict"] == BETTER]
    worse = [str(row["step"]) for row in rows if row["verdict"] == WORSE]
    text: Text = ("No step brings the samples that it changes nearer to the truth.",)
    if better:
        most = max(better, key=_gain)
        change = f"{number_text(most['before'])} to {number_text(most['after'], 'mm')}"
        count = Word(f"{most['changed']:,}", "number")
        text = say(
            f"{HERE} does most: {HERE} over the {HERE} samples that it changes.",
            Word(str(most["step"])), Word(change, "number"), count,
        )  # fmt: skip
    if worse:
        verb = "makes" if len(worse) == 1 else "make"
        return say(f"{HERE} {HERE} {verb} it worse.", text, listing([Word(step) for step in worse]))
    return (*text, " No step makes it worse.") if better else text


def _gain(row: Row) -> float:
    """Return by how much a step lowers the sum of squared errors."""
    return float(row["changed"] * (row["before"] ** 2 - row["after"] ** 2))


def _card(row: Row, line: Line) -> Card:
    left = f"{row['missing']:,} missing"
    facts = []
    if row["changed"]:
        facts.append(f"changes {row['changed']:,} samples; {100 * row['nearer']:.0f} % come nearer")
    begins = row["verdict"] == "begins"
    if row["added"] and not begins:
        facts.append(f"adds {row['added']:,} at {number_text(row['added rmse'], 'mm')}")
    if row["removed"]:
        facts.append(f"removes {row['removed']:,}")
    misplaced = f", {row['misplaced']:,} misplaced" if row["misplaced"] else ""
    start = [f"begins with {row['added']:,} samples"] if begins else facts or ["changes nothing"]
    return Card(
        title=(str(row["step"]),),
        headline=(number_text(row["rmse"], "mm"),),
        picture=_picture(row, line),
        facts=(("Step", ("; ".join(start),)), ("Then", (f"{left}{misplaced}",))),
        kind="best" if row["verdict"] == BETTER else "rest",
    )


def _picture(row: Row, line: Line) -> str:
    parts = [line.drawn(28.0, "mm")]
    before, after, added = (float(row[name]) for name in ("before", "after", "added rmse"))
    if math.isfinite(before):
        kind = "worse" if row["verdict"] == WORSE else "best"
        parts.append(
            f'<line class="change {"worse" if kind == "worse" else ""}" x1="{line.at(before):g}" '
            f'x2="{line.at(after):g}" y1="{_Y:g}" y2="{_Y:g}"/>'
        )
        parts.append(dot(line.at(before), _Y, "before", f"before {number_text(before, 'mm')}"))
        parts.append(dot(line.at(after), _Y, kind, f"after {number_text(after, 'mm')}", 5.0))
    if math.isfinite(added):
        x = line.at(added)
        parts.append(
            f'<polygon class="before" points="{x - 5:g},{_Y:g} {x:g},{_Y - 5:g} {x + 5:g},{_Y:g} '
            f'{x:g},{_Y + 5:g}"><title>added {number_text(added, "mm")}</title></polygon>'
        )
    return svg(f"errors of the step {row['step']}", 44.0, parts)
