"""Alternatives: their forms, and which shared settings and ports all of them must have.

What is shared holds for every alternative, and an alternative's own comes on top. Whatever some
alternative sets itself is therefore not judged where it is shared, and a required setting may
stand in either place. Where a file leaves open which methods it has (two families with equal
labels), nothing is refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from nodegraph.schema.nodes import Usable
from nodegraph.schema.parts import Schema, fixed_or, one_of, ref

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
