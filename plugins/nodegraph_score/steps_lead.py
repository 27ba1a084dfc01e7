"""The answer of the score of steps at a glance: a card per step with before and after."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from nodegraph_score.steps_text import BETTER, WORSE
from nodegraph_tables.lead import Card, Lead, Line, dot, line_of, svg
from nodegraph_tables.numbers import number_text

Row = Mapping[str, Any]
_Y = 12.0


def lead_of(rows: Sequence[Row]) -> Lead:
    """Return the lead: which step does most, whether any makes it worse, and each step.

    Parameters
    ----------
    rows
        Of the table, the first of what came.
    """
    names = ("before", "after", "added rmse", "rmse")
    line = line_of([float(row[name]) for row in rows for name in names])
    scope = (
        "Scope: one recording whose truth is known. Numbers: root mean square distance to the "
        "truth, in mm; large, of all samples after the step; on the line, of those that it "
        "changed, hollow before and filled after, or of those that it added."
    )
    return Lead(_sentence(rows), tuple(_card(row, line) for row in rows), scope)


def _sentence(rows: Sequence[Row]) -> tuple[str, ...]:
    better = [row for row in rows if row["verdict"] == BETTER]
    worse = [str(row["step"]) for row in rows if row["verdict"] == WORSE]
    if better:
        most = max(better, key=_gain)
        change = f"{number_text(most['before'])} to {number_text(most['after'], 'mm')}"
        over = f" over the {most['changed']:,} samples that it changes."
        text: tuple[str, ...] = ("", str(most["step"]), " does most: ", change, over)
    else:
        text = ("No step brings the samples that it changes nearer to the truth.",)
    verb = "makes" if len(worse) == 1 else "make"
    if worse:
        return (*text[:-1], f"{text[-1]} ", " and ".join(worse), f" {verb} it worse.")
    return (*text[:-1], f"{text[-1]} No step makes it worse.") if better else text


def _gain(row: Row) -> float:
    """Return by how much a step lowers the sum of squared errors."""
    return float(row["changed"] * (row["before"] ** 2 - row["after"] ** 2))


def _card(row: Row, line: Line) -> Card:
    left = f"{row['missing']:,} missing"
    facts = []
    if row["changed"]:
        facts.append(f"changes {row['changed']:,} samples; {row['nearer']:.0%} come nearer")
    begins = row["verdict"] == "begins"
    if row["added"] and not begins:
        facts.append(f"adds {row['added']:,} at {number_text(row['added rmse'], 'mm')}")
    if row["removed"]:
        facts.append(f"removes {row['removed']:,}")
    misplaced = f", {row['misplaced']:,} misplaced" if row["misplaced"] else ""
    start = [f"begins with {row['added']:,} samples"] if begins else facts or ["changes nothing"]
    return Card(
        title=str(row["step"]),
        headline=number_text(row["rmse"], "mm"),
        picture=_picture(row, line),
        facts=(("Step", "; ".join(start)), ("Then", f"{left}{misplaced}")),
        best=row["verdict"] == BETTER,
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
