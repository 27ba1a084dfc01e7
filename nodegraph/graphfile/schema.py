"""The whole schema: what stands where in a graph file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from nodegraph.graphfile.node_schema import (
    NAME,
    Schema,
    Usable,
    fixed_or,
    one_of,
    ref,
    shared_parts,
    usable,
)
from nodegraph.plugin.registry import Registry

PASS = "pass"
_FAMILY = r"\.\*$"
_NO_SETTING: Schema = {"properties": {"with": {"maxProperties": 0}}}


def alternatives_schema(nodes: Iterable[Usable]) -> Schema:
    """Return the forms of ``alternatives``: a family, a list, or labels."""
    families = _families(nodes)
    family = {"type": "string", "enum": families}
    listed = {
        "type": "array",
        "minItems": 1,
        "items": {"anyOf": [ref("method name"), family]},
        "contains": {"not": {"const": PASS}},
    }
    labels = {
        "type": "object",
        "minProperties": 1,
        "propertyNames": {"if": {"pattern": _FAMILY}, "then": {"enum": families}},
        "properties": {PASS: ref("pass"), **{one: ref("family") for one in families}},
        "additionalProperties": ref("method"),
    }
    return {
        "description": (
            "Label -> {use, in, with}; a list of nodes; or a family, family.*. They are an axis."
        ),
        "anyOf": [family, listed, labels],
    }


def alternatives_parts(nodes: list[Usable]) -> dict[str, Schema]:
    """Return the definitions that alternatives refer to."""
    families = _families(nodes)
    settings = sorted({name for one in nodes for name in one.settings})
    return {
        **_methods(nodes),
        **{f"whole {family}": _whole(family, nodes) for family in families},
        **{f"own {setting}": _own(setting) for setting in settings},
    }


def shared_checks(nodes: Iterable[Usable]) -> Iterator[Schema]:
    """Yield what ``in`` and ``with`` of a node must be, given which alternatives it has."""
    for one in nodes:
        names = {"in": _shared_ports(one), "with": _only(one.settings)}
        values = [_shared_value(one, setting) for setting in one.settings]
        then: Schema = {"properties": names, **({"allOf": values} if values else {})}
        yield _when(_some_use(one), then)
        if one.node.deprecated:
            continue  # a family leaves it out
        beside = {"properties": {"alternatives": {"properties": {one.family: ref(one.key)}}}}
        yield _when({"type": "object", **_in_family(one)}, beside)


def _families(nodes: Iterable[Usable]) -> list[str]:
    return sorted({one.family for one in nodes if not one.node.deprecated})


def _methods(nodes: Iterable[Usable]) -> dict[str, Schema]:
    keys = {"in": ref("wiring"), "with": ref("settings")}
    needs_use = {"required": ["use"]}
    by_use = [one.when_used(ref(one.key)) for one in nodes]
    passes = {"if": {**needs_use, "properties": {"use": {"const": PASS}}}, "then": _NO_SETTING}
    method = {
        "type": "object",
        "properties": {"use": ref("method name"), **keys},
        "additionalProperties": False,
        "allOf": [*by_use, passes],
    }
    pass_alone = {"if": needs_use, "else": _NO_SETTING}
    return {
        "method of": method,
        "method": {"anyOf": [ref("method name"), {"allOf": [ref("method of"), needs_use]}]},
        "pass": {
            "description": "The input as it is, named as what its siblings give.",
            "anyOf": [
                {"type": "null"},
                ref("method name"),
                {"allOf": [ref("method of"), pass_alone]},
            ],
        },
        "family": {
            "description": "Every installed method of the family.",
            "type": ["object", "null"],
            "properties": keys,
            "additionalProperties": False,
        },
    }


def _whole(family: str, nodes: Iterable[Usable]) -> Schema:
    """Hold for alternatives that take a family.

    Another family beside it may replace some of its methods, and so may a node of another family
    in a list; this does not hold for such alternatives.
    """
    names = [name for one in nodes if one.family == family for name in one.names]
    alone = {"anyOf": [{"const": family}, {"not": {"pattern": _FAMILY}}]}
    listed = {"contains": {"const": family}, "items": one_of([family, PASS, *names])}
    return {
        "anyOf": [
            {"const": family},
            {"type": "array", **listed},
            {"type": "object", "required": [family], "propertyNames": alone},
        ]
    }


def _own(setting: str) -> Schema:
    """Hold for alternatives of which one has this setting for itself."""
    given = {"type": "object", "required": [setting]}
    one = {"type": "object", "required": ["with"], "properties": {"with": given}}
    return {"type": "object", "not": {"additionalProperties": {"not": one}}}


def _some_use(one: Usable) -> Schema:
    """Hold for alternatives of which one uses this node."""
    parts = {"required": ["use"], "properties": {"use": one.named}}
    labelled = {**one.named, "type": ["string", "object"], **parts}
    forms: list[Schema] = [
        {"type": "array", "contains": one.named},
        {"type": "object", "not": {"additionalProperties": {"not": labelled}}},
    ]
    return {"anyOf": forms if one.node.deprecated else [*forms, _in_family(one)]}


def _in_family(one: Usable) -> Schema:
    replaced = {"type": "object", "required": [one.label]}
    return {**ref(f"whole {one.family}"), "not": replaced}


def _when(alternatives: Schema, then: Schema) -> Schema:
    return {"if": {"properties": {"alternatives": alternatives}}, "then": then}


def _only(names: Iterable[str]) -> Schema:
    return {"properties": dict.fromkeys(names, True), "additionalProperties": False}


def _shared_ports(one: Usable) -> Schema:
    if not one.node.inputs:
        return {"type": ["object", "null"], "maxProperties": 0}
    return fixed_or(_only(port.name for port in one.node.inputs))


def _shared_value(one: Usable, setting: str) -> Schema:
    value = ref(f"{one.key}/properties/with/properties/{setting}")
    settings: Schema = {"properties": {setting: value}}
    then: Schema = {"properties": {"with": settings}}
    if one.node.settings[setting].required:
        settings.update(type="object", required=[setting])
        then["required"] = ["with"]
    return {"if": {"properties": {"alternatives": ref(f"own {setting}")}}, "else": then}


_FILE = r"\.ya?ml$"


def graph_schema(registry: Registry) -> Schema:
    """Return the JSON Schema of graph files that use the nodes of a registry."""
    nodes = usable(registry)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "description": "A graph of nodes with alternatives side by side.",
        "type": "object",
        "required": ["nodegraph", "nodes"],
        "properties": _sections(),
        "additionalProperties": False,
        "$defs": {
            **shared_parts(),
            "node name": {"oneOf": _names(nodes)},
            "method name": {"anyOf": [ref("node name"), {"const": PASS}]},
            "node": _node(nodes),
            **alternatives_parts(nodes),
            **{key: one for each in nodes for key, one in each.definitions.items()},
        },
    }


def _sections() -> Schema:
    text = ["string", "number", "boolean", "null"]
    return {
        "nodegraph": {"description": "The format's number.", "const": 1},
        "title": {"description": "What the report is called.", "type": text},
        "notes": {"description": "Markdown that the report shows.", "type": text},
        "inputs": _named(
            "One value each, $name in settings; --set NAME=VALUE. In a graph that is used as a"
            " node, the name of a type makes a port.",
            True,
        ),
        "axes": _named(
            "A list, labels with values, {count: n} or {range: [first, last, step]}. A node runs"
            " once for each label of the axes that reach it.",
            ref("axis"),
        ),
        "nodes": {
            **_named("What is done, by name.", ref("node")),
            "type": "object",
            "minProperties": 1,
        },
        "skip": {
            "description": "Combinations to leave out: [{axis: label or labels}].",
            "type": ["array", "null"],
            "items": {
                "type": "object",
                "minProperties": 1,
                "additionalProperties": {
                    "anyOf": [ref("label"), {"type": "array", "items": ref("label")}]
                },
            },
        },
        "known": {"description": "Nodes or ports that a method may know.", **ref("references")},
        "requires": {
            "description": "Distributions that must be installed, as pip names them.",
            "type": ["array", "null"],
            "items": {"type": "string"},
        },
        "outputs": {
            "description": "What a graph gives when it is used as a node: name -> reference.",
            "type": ["object", "null"],
            "propertyNames": NAME,
            "additionalProperties": ref("reference"),
        },
        "report": {"description": "What the report shows.", **ref("references")},
    }


def _named(text: str, each: Schema | bool) -> Schema:
    return {
        "description": text,
        "type": ["object", "null"],
        "propertyNames": NAME,
        "additionalProperties": each,
    }


def _names(nodes: list[Usable]) -> list[Schema]:
    """Return a constant for each node, so that an editor shows its text beside it.

    A graph file is named as well, and so is a node with its plugin; an editor need not offer
    these.
    """
    full = [name for one in nodes for name in one.names[1:]]
    patterns = [_FILE, *([one_of(full)["pattern"]] if full else [])]
    message = "no installed node has this name; nodegraph nodes lists them"
    others = {"type": "string", "pattern": "|".join(patterns), "patternErrorMessage": message}
    return [*(one.constant() for one in nodes), others]


def _node(nodes: list[Usable]) -> Schema:
    """Return the schema of one node.

    Chains of if/then rather than oneOf: a wrong setting is then named by itself, by validators
    and editors alike, and editors complete what stands in the branch that ``use`` has chosen.
    """
    return {
        "type": "object",
        "properties": {
            "use": {"description": "A node, or a graph file.", **ref("node name")},
            "in": ref("wiring"),
            "with": ref("settings"),
            "alternatives": alternatives_schema(nodes),
            "over": {
                "description": "The axes to gather, for a node that gathers.",
                "type": "array",
                "items": {"type": "string"},
            },
        },
        "additionalProperties": False,
        "if": {"required": ["alternatives"]},
        "then": {"allOf": [{"properties": {"use": False}}, *shared_checks(nodes)]},
        "else": {"allOf": [{"required": ["use"]}, *map(_plain, nodes)]},
    }


def _plain(one: Usable) -> Schema:
    return one.when_used({"allOf": [ref(one.key), one.alone()]})
