"""One entry of ``nodes``: what it uses, what feeds it, what is set, which alternatives it has."""

from __future__ import annotations

import re
from pathlib import PurePath
from typing import Any

from nodegraph.errors import Place, Problems, nearest
from nodegraph.graphfile.axes import is_label
from nodegraph.graphfile.spec import (
    Gathering,
    MethodSpec,
    NodeSpec,
    Reference,
    Variable,
    Wiring,
    Written,
    is_graph_file,
)
from nodegraph.graphfile.yaml_text import Located

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


_NODE_KEYS = ("use", "in", "with", "alternatives", "over")
_METHOD_KEYS = ("use", "in", "with")
_VARIABLE = re.compile(r"\$([A-Za-z_][A-Za-z0-9_]*)(?:\.([A-Za-z_][A-Za-z0-9_]*))?")
_ALTERNATIVE_FORMS = (
    "write {label: {use: family.method}}, [family.method, ...] or family.* for all its methods"
)


class NodeReader:
    """Reads entries of ``nodes`` and notes their mistakes."""

    def __init__(self, problems: Problems) -> None:
        self._problems = problems

    def read(self, name: str, item: Located) -> NodeSpec:
        """Return what one entry says, without methods when that cannot be read."""
        if not self._is_mapping(item, f"node {name!r}", _NODE_KEYS):
            return NodeSpec(name, item.place, (), False, {}, {}, None)
        found = item.value
        methods, has_alternatives = self._methods(name, item)
        return NodeSpec(
            name=name,
            place=item.place,
            methods=methods,
            has_alternatives=has_alternatives,
            wiring=self._wiring(found.get("in")),
            settings=self._settings(found.get("with")),
            over=self._over(found.get("over")),
        )

    def _methods(self, name: str, item: Located) -> tuple[tuple[MethodSpec, ...], bool]:
        use, alternatives = item.value.get("use"), item.value.get("alternatives")
        if (use is None) == (alternatives is None):
            which = (
                "needs 'use' or 'alternatives'"
                if use is None
                else "has both 'use' and 'alternatives'"
            )
            self._problems.add(item.place, f"node {name!r} {which}", "give one of the two")
        if alternatives is not None:
            return self._alternatives(name, alternatives), True
        if use is None or not self._is_word(use, "'use' names a node"):
            return (), False
        if use.value.endswith(".*"):
            message = f"{use.value!r} stands only among alternatives"
            self._problems.add(use.place, message, f"write alternatives: {use.value}")
            return (), False
        return (MethodSpec("", use.value, use.place),), False

    def _alternatives(self, name: str, item: Located) -> tuple[MethodSpec, ...]:
        if isinstance(item.value, str):
            made = self._family_or_none(item.value, item.place)
        elif isinstance(item.value, list):
            made = [one for one in map(self._listed, item.value) if one]
        elif isinstance(item.value, dict):
            made = [self._labelled(key, item.keys[key], one) for key, one in item.value.items()]
        else:
            made = []
        if not made:
            self._problems.add(item.place, f"node {name!r} has no alternative", _ALTERNATIVE_FORMS)
        self._refuse_repeats(made)
        return tuple(made)

    def _family_or_none(self, text: str, place: Place) -> list[MethodSpec]:
        if text.endswith(".*"):
            return [MethodSpec("", text, place)]
        return []

    def _listed(self, item: Located) -> MethodSpec | None:
        if not self._is_word(item, "a listed alternative is a node's name"):
            return None
        if is_graph_file(item.value):
            return MethodSpec(PurePath(item.value).stem, item.value, item.place)
        plugin, _, name = item.value.rpartition(":")
        label = name.rpartition(".")[2]
        return MethodSpec(f"{plugin}:{label}" if plugin else label, item.value, item.place)

    def _labelled(self, key: Any, place: Place, item: Located) -> MethodSpec:
        label = str(key)
        if not isinstance(key, str):
            message = f"the label {label} of an alternative must be a word"
            self._problems.add(place, message, f"write a name, such as order_{label}")
        is_family = label.endswith(".*")
        if item.value is None:
            item = Located({}, item.place)
        if isinstance(item.value, str):
            item = Located({"use": item}, item.place, {"use": item.place})
        keys = ("in", "with") if is_family else _METHOD_KEYS
        if not self._is_mapping(item, f"alternative {label!r}", keys):
            return MethodSpec(label, "", place)
        if is_family:
            use = label
        elif label == "pass" and "use" not in item.value:
            use = "pass"
        else:
            use = self._use(item, label)
        return MethodSpec(
            "" if is_family else label,
            use,
            item.value["use"].place if "use" in item.value else place,
            self._wiring(item.value.get("in")),
            self._settings(item.value.get("with")),
        )

    def _use(self, item: Located, label: str) -> str:
        use = item.value.get("use")
        if use is None:
            self._problems.add(
                item.place, f"alternative {label!r} has no 'use'", _ALTERNATIVE_FORMS
            )
            return ""
        if not self._is_word(use, "'use' names a node"):
            return ""
        if use.value.endswith(".*"):
            message = f"{use.value!r} has a label for each of its methods, and takes none"
            self._problems.add(use.place, message, f"write {{{use.value}: {{}}}}")
            return ""
        return str(use.value)

    def _refuse_repeats(self, methods: list[MethodSpec]) -> None:
        seen: set[str] = set()
        for one in methods:
            if one.label and one.label in seen:
                self._problems.add(
                    one.place, f"label {one.label!r} is used twice", _ALTERNATIVE_FORMS
                )
            seen.add(one.label)

    def _wiring(self, item: Located | None) -> Wiring:
        if item is None or item.value is None:
            return {}
        if isinstance(item.value, dict) and "from" not in item.value:
            fed = {str(port): self._feed(one) for port, one in item.value.items()}
            return {port: one for port, one in fed.items() if one is not None}
        reference = read_reference(item, self._problems)
        return {"": reference} if reference else {}

    def _feed(self, item: Located) -> Reference | Gathering | None:
        if isinstance(item.value, dict) and item.value and "from" not in item.value:
            return self._gathering(item)
        return read_reference(item, self._problems)

    def _gathering(self, item: Located) -> Gathering:
        sources: dict[str, Reference] = {}
        for key, one in item.value.items():
            if str(key) in sources:
                self._problems.add(item.keys[key], f"label {str(key)!r} is used twice")
            found = read_reference(one, self._problems)
            if found is not None:
                sources[str(key)] = found
        return Gathering(sources, item.place)

    def _settings(self, item: Located | None) -> dict[str, Written]:
        if item is None or item.value is None:
            return {}
        if not isinstance(item.value, dict):
            self._problems.add(item.place, "'with' is a mapping: {setting: value}")
            return {}
        return {
            str(name): Written(_substituted(one), one.place) for name, one in item.value.items()
        }

    def _over(self, item: Located | None) -> tuple[tuple[str, Place], ...] | None:
        if item is None:
            return None
        if not isinstance(item.value, list):
            self._problems.add(item.place, "'over' is a list of axes: [trial]")
            return None
        return tuple((str(one.plain()), one.place) for one in item.value)

    def _is_mapping(self, item: Located, what: str, keys: tuple[str, ...]) -> bool:
        if not isinstance(item.value, dict):
            self._problems.add(
                item.place, f"{what} must be a mapping", nearest("", keys, what="keys")
            )
            return False
        for key in item.value:
            if key not in keys:
                self._problems.add(
                    item.keys[key], f"{what}: unknown key {key!r}", nearest(key, keys)
                )
        return True

    def _is_word(self, item: Located, message: str) -> bool:
        if isinstance(item.value, str) and item.value:
            return True
        self._problems.add(item.place, f"{message}, not {item.plain()!r}")
        return False


def _substituted(item: Located) -> Any:
    if isinstance(item.value, dict):
        return {key: _substituted(one) for key, one in item.value.items()}
    if isinstance(item.value, list):
        return [_substituted(one) for one in item.value]
    if isinstance(item.value, str):
        found = _VARIABLE.fullmatch(item.value)
        return Variable(found[1], found[2] or "", item.place) if found else item.value
    return item.value
