"""Forms that stand in several places of a graph file: names, references, labels, variables.

Where a text or a mapping may stand, one schema holds the keywords of both, since each keyword
judges values of its own type only: an editor then names the one thing that is wrong, instead of
two alternatives that both do not fit.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

Schema = dict[str, Any]

VARIABLE = r"^\$[A-Za-z_]\w*(\.[A-Za-z_]\w*)?$"
_REFERENCE: Schema = {
    "type": ["string", "object"],
    "pattern": r"^\$?[A-Za-z_]\w*(\.[A-Za-z_]\w*)?$",
    "patternErrorMessage": "write node, node.port, or {from: node.port, at: {axis: label}}",
}

NAME: Schema = {
    "pattern": r"^[A-Za-z_]\w*$",
    "patternErrorMessage": "use letters, digits and _, not a digit first",
}


def ref(name: str) -> Schema:
    """Return a reference to one of the shared definitions."""
    return {"$ref": f"#/$defs/{name}"}


def one_of(words: Iterable[str]) -> Schema:
    """Return what holds for these words, as a pattern: editors show every enumeration they meet."""
    escaped = (re.sub(r"[\\^$.*+?()\[\]{}|]", r"\\\g<0>", word) for word in words)
    return {"type": "string", "pattern": f"^({'|'.join(escaped)})$"}


def fixed_or(otherwise: Schema) -> Schema:
    """Return a schema of a mapping that either fixes axes of one reference or is another."""
    fixes = {"type": "object", "required": ["from"]}
    return {"if": fixes, "then": ref("fixed"), "else": otherwise}


def shared_parts() -> dict[str, Schema]:
    """Return the definitions that other parts of the schema refer to."""
    return {
        "variable": {
            "description": "The value of an input or an axis: $name, or $axis.field.",
            "type": "string",
            "pattern": VARIABLE,
            "patternErrorMessage": "$name or $axis.field stands for an input or an axis",
        },
        "label": {
            "description": "A label on an axis: a word, a number or a boolean.",
            "type": ["string", "number", "boolean"],
            "minLength": 1,
        },
        "reference": {**_REFERENCE, "if": {"type": "object"}, "then": ref("fixed")},
        "fixed": {
            "properties": {
                "from": {"description": "node, or node.port.", **_REFERENCE, "type": "string"},
                "at": {
                    "description": "Axes that are fixed: {axis: label}.",
                    "type": "object",
                    "additionalProperties": ref("label"),
                },
            },
            "required": ["from"],
            "additionalProperties": False,
        },
        "feed": {
            **_REFERENCE,
            **fixed_or({"minProperties": 1, "additionalProperties": ref("reference")}),
        },
        "wiring": {
            **_REFERENCE,
            "description": "What feeds the node: a reference for its first port, or a mapping.",
            "type": ["string", "object", "null"],
            **fixed_or({"additionalProperties": ref("feed")}),
        },
        "references": {"type": ["array", "null"], "items": ref("reference")},
        "settings": {
            "description": "Settings by name; $name stands for an input or an axis.",
            "type": ["object", "null"],
        },
        "axis": _axis(),
    }


def _axis() -> Schema:
    whole = {"type": "integer", "minimum": 1, "maximum": 1_000_000}
    numbers = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
    return {
        "type": ["array", "object"],
        "minItems": 1,
        "uniqueItems": True,
        "items": ref("label"),
        "minProperties": 1,
        "propertyNames": {"minLength": 1},
        # a mapping of this one key is a generator; beside other keys it is a label like them
        "if": {"type": "object", "maxProperties": 1},
        "then": {
            "properties": {
                "count": {"description": "How many labels: 0, 1, ... count - 1.", **whole},
                "range": {"description": "[first, last, step]", **numbers},
            }
        },
        "defaultSnippets": [
            {"label": "[5, 15, 45]", "description": "labels", "bodyText": "[${1:5, 15, 45}]"},
            {"label": "{count: 20}", "description": "0 .. 19", "bodyText": "{count: ${1:20}}"},
            {
                "label": "{range: [5, 60, 5]}",
                "description": "first, last, step",
                "bodyText": "{range: [${1:5, 60, 5}]}",
            },
        ],
    }
