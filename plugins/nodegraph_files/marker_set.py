"""Marker sets as YAML files."""

from __future__ import annotations

import reprlib
from dataclasses import fields
from pathlib import Path
from typing import Any

from nodegraph import quoted
from nodegraph_files.yaml_document import parts_in, yaml_document
from nodegraph_mocap.marker_set import MarkerSet

PARTS = tuple(field.name for field in fields(MarkerSet))
_COUPLES = ("pairs", "edges")


def read_marker_set_yaml(path: Path) -> MarkerSet:
    """Read a marker set.

    The file lists ``markers`` and, where they are known, ``pairs``, ``midline``, ``stable`` and
    ``edges``.

    Raises
    ------
    ValueError
        If the file is not of that form, with the place where it is not.
    """
    try:
        return marker_set_of(yaml_document(path))
    except ValueError as error:
        raise ValueError(f"{path}: not a marker set: {error}") from None


def marker_set_of(data: object) -> MarkerSet:
    """Return the marker set that plain data describe.

    Raises
    ------
    ValueError
        If they are not of its form.
    """
    return MarkerSet(**{part: _part(part, it) for part, it in parts_in(data, PARTS).items()})


def plain_marker_set(marker_set: MarkerSet) -> dict[str, list[Any]]:
    """Return a marker set as plain data, empty parts left out."""
    parts = {part: getattr(marker_set, part) for part in PARTS}
    return {
        part: [list(item) if part in _COUPLES else item for item in items]
        for part, items in parts.items()
        if items or part == "markers"
    }


def marker_set_text(marker_set: MarkerSet) -> str:
    """Return a marker set as the text of its YAML file, which reads back equal."""
    import json

    # JSON is YAML, and quotes every name
    lines = [
        f"{part}: {_printable(json.dumps(items, ensure_ascii=False))}"
        for part, items in plain_marker_set(marker_set).items()
    ]
    return "\n".join(lines) + "\n"


def _printable(text: str) -> str:
    """Escape what YAML, unlike JSON, does not let stand between quotes."""
    return "".join(
        character if character.isprintable() else f"\\U{ord(character):08X}" for character in text
    )


def _part(part: str, items: object) -> tuple[Any, ...]:
    if items in ("", None):
        return ()
    if not isinstance(items, list):
        raise ValueError(f"{quoted(part)} must be a list")
    if part in _COUPLES:
        return tuple(_couple(part, item) for item in items)
    bad = [item for item in items if not isinstance(item, str) or not item]
    if bad:
        raise ValueError(f"{quoted(part)} must be a list of names, not {reprlib.repr(bad[0])}")
    return tuple(items)


def _couple(part: str, item: object) -> tuple[str, str]:
    if not isinstance(item, list) or len(item) != 2 or not all(isinstance(x, str) for x in item):
        raise ValueError(
            f"{quoted(part)} must be a list of two names each, not {reprlib.repr(item)}"
        )
    return item[0], item[1]
