"""The conclusions of a table: its answer, and what is best."""

from __future__ import annotations

import re
from collections.abc import Iterator

from nodegraph_tables.cells import ALL
from nodegraph_tables.info import info_of
from nodegraph_tables.types import Table

_NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?(?![\w.]*\w)", re.I)
_MEASURED = re.compile(r"(?<![\w.])[-+]?\d*\.\d+(?:e[-+]?\d+)?(?!\w)|(?<![\w.])\d+e[-+]?\d+", re.I)
_ASIDE = re.compile(r"\([^()]*\)")
_GROUP_ENDS = "blocks"
"""The column after the labels of a row."""


def conclude_table(table: Table) -> Iterator[str]:
    """Yield the conclusions of a table, without measured numbers.

    They are its answer without the numbers that are in brackets or not whole, and the rows that
    are marked as best. The order of all others may change by rounding.
    """
    info = info_of(table)
    for sentence in info.answer:
        yield without_measured(sentence)
    for column, rows in info.best.items():
        if rows and column in table:
            best = sorted(_row(table, place) for place in rows)
            yield f"best {column}: {'; '.join(best)}"


def table_numbers(table: Table) -> str:
    """Return the table as CSV, its numbers to ten digits."""
    return table.to_csv(index=False, lineterminator="\n", float_format="%.10g")


def table_data(table: Table) -> dict[str, object]:
    """Return the table as plain data, its numbers as numbers, with what its marks mean."""
    info = info_of(table)
    rows = table.astype(object).where(table.notna(), None).to_numpy().tolist()
    return {
        "title": info.title,
        "answer": list(info.answer),
        "columns": [str(column) for column in table.columns],
        "rows": rows,
        "units": dict(info.units),
        "better": dict(info.better),
        "best": {column: list(places) for column, places in info.best.items()},
        "tied": {column: list(places) for column, places in info.tied.items()},
        "cells": {column: dict(parts) for column, parts in info.cells.items()},
        "notes": list(info.notes),
    }


def without_measured(sentence: str) -> str:
    """Return a sentence without its measured numbers; labels and whole numbers stay.

    Numbers in brackets are details of what stands before them, and go whatever they are.
    """
    bare = _ASIDE.sub(lambda match: _NUMBER.sub("#", match[0]), sentence)
    return _MEASURED.sub("#", bare)


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
