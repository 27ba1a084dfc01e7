"""Selections of markers as YAML files."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from nodegraph import quoted
from nodegraph_files.yaml_document import parts_in, yaml_document
from nodegraph_mocap.selection import Selection

_PARTS = tuple(field.name for field in fields(Selection))


def read_selection_yaml(path: Path) -> Selection:
    """Read a selection.

    The file lists ``chosen`` and, where they are known, ``pairs``, ``frequencies``, ``columns`` and
    ``history``.

    Raises
    ------
    ValueError
        If the file is not of that form.
    """
    try:
        data = parts_in(yaml_document(path), _PARTS)
        return Selection(**{part: _part(part, items) for part, items in data.items()})
    except ValueError as error:
        raise ValueError(f"{path}: not a selection: {error}") from None


def selection_text(selection: Selection) -> str:
    """Return a selection as the text of its YAML file; a number that is not known is null."""
    import yaml

    parts: dict[str, object] = {"chosen": list(selection.chosen)}
    if selection.pairs:
        parts["pairs"] = [list(pair) for pair in selection.pairs]
    if selection.frequencies is not None:
        parts["frequencies"] = selection.frequencies.tolist()
    if selection.history is not None:
        parts["columns"] = list(selection.columns)
        parts["history"] = [
            [None if number != number else number for number in row]
            for row in selection.history.tolist()
        ]
    return yaml.safe_dump(parts, sort_keys=False, allow_unicode=True, default_flow_style=None)


def _part(part: str, items: object) -> Any:
    if not isinstance(items, list):
        raise ValueError(f"{quoted(part)} must be a list")
    if part in ("chosen", "columns"):
        return _names(part, items)
    if part == "frequencies":
        return np.array(_numbers(part, items))
    if not all(isinstance(item, list) for item in items):
        raise ValueError(f"{quoted(part)} must be a list of lists")
    if part == "pairs":
        return tuple(_names(part, item) for item in items)
    rows = [_numbers(part, item) for item in items]
    if len({len(row) for row in rows}) > 1:
        raise ValueError(f"{quoted(part)} has rows of several lengths")
    return np.array(rows) if rows else None


def _names(part: str, items: list[Any]) -> tuple[str, ...]:
    bad = [item for item in items if not isinstance(item, str) or not item]
    if bad:
        raise ValueError(f"{quoted(part)} must hold names, not {bad[0]!r:.80}")
    return tuple(items)


def _numbers(part: str, items: list[Any]) -> list[float]:
    try:
        return [float("nan") if item in ("null", "") else float(item) for item in items]
    except (TypeError, ValueError):
        raise ValueError(f"{quoted(part)} must hold numbers") from None
