"""The conclusions of a table: its answer, and what is best."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from nodegraph_tables.cells import ALL
from nodegraph_tables.info import info_of
from nodegraph_tables.text import plain
from nodegraph_tables.types import Table

if TYPE_CHECKING:
    from nodegraph_tables.answer import Answer, Finding

_GROUP_ENDS = "blocks"
"""The column after the labels of a row."""


def conclude_table(table: Table) -> Iterator[str]:
    """Yield the conclusions of a table, without measured numbers.

    They are the sentence of its answer, which methods are best, not certain to be worse and behind
    in each group, and the rows that are marked as best. The order of all others may change by
    rounding.
    """
    info = info_of(table)
    if info.answer.sentence:
        yield plain(
            tuple(
                "\N{HORIZONTAL ELLIPSIS}"
                if not isinstance(part, str) and part.kind == "number"
                else part
                for part in info.answer.sentence
            )
        )
        yield from map(_concluded, info.answer.findings)
    for column, rows in info.best.items():
        if rows and column in table:
            best = sorted(_row(table, place) for place in rows)
            yield f"best {column}: {'; '.join(best)}"


def _concluded(finding: Finding) -> str:
    group = ", ".join(f"{axis} {label}" for axis, label in finding.group.items())
    if not finding.verdict:
        return f"{group or 'all'}: no verdict"
    kinds = (("best", finding.best), ("may be as good", finding.tied), ("behind", finding.behind))
    texts = (f"{kind}: {', '.join(sorted(names))}" for kind, names in kinds if names)
    return f"{group or 'all'}: {'; '.join(texts)}"


def table_numbers(table: Table) -> str:
    """Return the table as CSV, its numbers to ten digits."""
    return table.to_csv(index=False, lineterminator="\n", float_format="%.10g")


def table_data(table: Table) -> dict[str, object]:
    """Return the table as plain data, its numbers as numbers, with what its marks mean."""
    info = info_of(table)
    rows = table.astype(object).where(table.notna(), None).to_numpy().tolist()
    return {
        "title": info.title,
        "answer": _answer_data(info.answer),
        "columns": [str(column) for column in table.columns],
        "rows": rows,
        "units": dict(info.units),
        "better": dict(info.better),
        "best": {column: list(places) for column, places in info.best.items()},
        "tied": {column: list(places) for column, places in info.tied.items()},
        "cells": {column: dict(parts) for column, parts in info.cells.items()},
        "notes": list(info.notes),
    }


def _answer_data(answer: Answer) -> dict[str, object]:
    return {
        "sentence": plain(answer.sentence),
        "scope": plain(answer.scope),
        "certainty": plain(answer.certainty),
        "groups": [_finding_data(finding) for finding in answer.findings],
        "overall": None if answer.overall is None else _finding_data(answer.overall),
    }


def _finding_data(finding: Finding) -> dict[str, object]:
    methods = ("best", "tied", "behind", "better", "worse", "first")
    numbers = ("mean", "low", "high", "p")
    return {
        "group": dict(finding.group),
        "verdict": finding.verdict,
        **{name: list(getattr(finding, name)) for name in methods},
        **{name: dict(getattr(finding, name)) for name in numbers},
    }


def _row(table: Table, place: int) -> str:
    columns = list(table.columns)
    overall = info_of(table).overall
    labels = columns[: columns.index(_GROUP_ENDS)] if _GROUP_ENDS in columns else []
    texts = [
        f"{name} {ALL if place in overall and missing else label}"
        for name in labels
        for label, missing in [(table[name].iloc[place], table[name].isna().iloc[place])]
    ]
    return ", ".join(texts) or f"row {place}"
