"""References: which output of which node is meant, at which labels."""

from __future__ import annotations

import re
from typing import Any

from nodegraph.errors import Problems
from nodegraph.spec.axes import is_label
from nodegraph.spec.parts import Reference
from nodegraph.spec.yaml_text import Located

_REFERENCE = re.compile(r"\$?[A-Za-z_][A-Za-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)?")
_REFERENCE_FORMS = "write node, node.port, or {from: node.port, at: {axis: label}}"


def read_reference(item: Located, problems: Problems) -> Reference | None:
    """Return the reference that a value is, or None, with the mistake noted."""
    if isinstance(item.value, dict):
        return _fixed(item, problems)
    if not isinstance(item.value, str) or not _REFERENCE.fullmatch(item.value):
        problems.add(item.place, f"{item.plain()!r} is not a reference", _REFERENCE_FORMS)
        return None
    node, _, port = item.value.partition(".")
    return Reference(node, port, item.place)


def _fixed(item: Located, problems: Problems) -> Reference | None:
    for key in item.value:
        if key not in ("from", "at"):
            problems.add(item.keys[key], f"unknown key {key!r}", _REFERENCE_FORMS)
    if "from" not in item.value:
        problems.add(item.place, "a reference needs 'from'", _REFERENCE_FORMS)
        return None
    source = item.value["from"]
    if isinstance(source.value, dict):
        problems.add(source.place, "'from' holds another 'from'", _REFERENCE_FORMS)
        return None
    found = read_reference(source, problems)
    if found is None:
        return None
    return Reference(
        found.node, found.port, found.place, _fixed_labels(item.value.get("at"), problems)
    )


def _fixed_labels(item: Located | None, problems: Problems) -> dict[str, Any]:
    if item is None:
        return {}
    fixed = item.plain()
    if not isinstance(fixed, dict) or not all(is_label(label) for label in fixed.values()):
        problems.add(item.place, "'at' is {axis: label}, one label for each axis", _REFERENCE_FORMS)
        return {}
    return fixed
