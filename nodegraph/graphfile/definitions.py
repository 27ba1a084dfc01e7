"""Parts of the JSON Schema that others refer to: names, references, axes, variables."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any
from urllib.parse import quote

from nodegraph.graphfile.keys import (
    FIXED_REFERENCE,
    IDENTIFIER,
    IDENTIFIER_HINT,
    MOST_LABELS,
    REFERENCE,
    REFERENCE_HINT,
    REPORT_ENTRY,
    Form,
    Key,
)

Schema = dict[str, Any]

VARIABLE = rf"^\${IDENTIFIER}(\.{IDENTIFIER})?$"
TEXT: Schema = {"type": ["string", "number", "boolean", "null"]}
NAME: Schema = {"pattern": f"^{IDENTIFIER}$", "patternErrorMessage": IDENTIFIER_HINT}
_REFERENCE: Schema = {
    "type": ["string", "object"],
    "pattern": f"^{REFERENCE}$",
    "patternErrorMessage": REFERENCE_HINT,
}


def ref(name: str) -> Schema:
    """Return a reference to one of the shared definitions."""
    return {"$ref": f"#/$defs/{quote(name)}"}


def one_of(words: Iterable[str]) -> Schema:
    """Return a schema of these words, as a pattern: editors show every enumeration they meet."""
    escaped = (re.sub(r"[\\^$.*+?()\[\]{}|]", r"\\\g<0>", word) for word in words)
    return {"type": "string", "pattern": f"^({'|'.join(escaped)})$"}


def fixed_or(otherwise: Schema) -> Schema:
    """Return a schema of a mapping that is either a reference with fixed axes, or another."""
    fixes = {"type": "object", "required": ["from"]}
    return {"if": fixes, "then": ref("fixed"), "else": otherwise}


def properties(keys: Mapping[str, Key], forms: Mapping[Form, Schema]) -> Schema:
    """Return a schema for each key of a table: its meaning, and what stands there."""
    return {name: {"description": key.meaning, **forms[key.form]} for name, key in keys.items()}


def shared_definitions() -> dict[str, Schema]:
    """Return the definitions that do not depend on the installed nodes."""
    fixed_forms: dict[Form, Schema] = {
        Form.SOURCE: {**_REFERENCE, "type": "string"},
        Form.LABELS: {"type": "object", "additionalProperties": ref("label")},
    }
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
            "properties": properties(FIXED_REFERENCE, fixed_forms),
            "required": ["from"],
            "additionalProperties": False,
        },
        "feed": {
            **_REFERENCE,
            **fixed_or({"minProperties": 1, "additionalProperties": ref("reference")}),
        },
        "wiring": {
            **_REFERENCE,
            "type": ["string", "object", "null"],
            **fixed_or({"additionalProperties": ref("feed")}),
        },
        "settings": {"type": ["object", "null"]},
        "report": {"type": ["array", "null"], "items": _report_entry(fixed_forms)},
        "references": {"type": ["array", "null"], "items": ref("reference")},
        "axis": _axis(),
    }


def _report_entry(forms: Mapping[Form, Schema]) -> Schema:
    """Return the schema of an entry of ``report``: a reference, or one with title and caption."""
    entry = {
        "properties": properties(REPORT_ENTRY, {**forms, Form.TEXT: TEXT}),
        "additionalProperties": False,
    }
    shows = {"type": "object", "required": ["show"]}
    return {**_REFERENCE, "if": shows, "then": entry, "else": ref("reference")}


def _axis() -> Schema:
    count = {"type": "integer", "minimum": 1, "maximum": MOST_LABELS}
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
                "count": {"description": "How many labels: 0, 1, ... count - 1.", **count},
                "range": {"description": "[first, last, step]", **numbers},
                "files": {
                    "description": "A file per label, which is its name without the suffix.",
                    "type": "string",
                    "minLength": 1,
                },
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
            {
                "label": '{files: "data/*.csv"}',
                "description": "a file per label",
                "bodyText": '{files: "${1:data/*.csv}"}',
            },
        ],
    }
