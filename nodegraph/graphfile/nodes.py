"""References, and the entries of ``nodes``: their methods, wiring and settings."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from pathlib import PurePath
from typing import Any

from nodegraph.errors import Place, Problems, nearest, quoted
from nodegraph.graphfile.answers import read_answer
from nodegraph.graphfile.axes import is_label
from nodegraph.graphfile.keys import (
    ALTERNATIVES_HINT,
    FAMILY,
    FIXED_REFERENCE,
    METHOD,
    NODE,
    PASS,
    REFERENCE,
    REFERENCE_HINT,
    REPORT_ENTRY,
    REPORT_HINT,
    VARIABLE,
)
from nodegraph.graphfile.spec import (
    Gathering,
    MethodSpec,
    NodeSpec,
    Reference,
    ReportEntry,
    Variable,
    Wiring,
    Written,
    is_graph_file,
)
from nodegraph.graphfile.yaml_text import Located

_REFERENCE = re.compile(REFERENCE)
_VARIABLE = re.compile(VARIABLE)


def read_reference(item: Located, problems: Problems) -> Reference | None:
    """Return the reference that a value is, or None, with the error noted."""
    if isinstance(item.value, dict):
        return _fixed_reference(item, problems)
    if not isinstance(item.value, str) or not _REFERENCE.fullmatch(item.value):
        problems.add(item.place, f"{quoted(item.plain())} is not a reference", REFERENCE_HINT)
        return None
    node, _, port = item.value.partition(".")
    return Reference(node, port, item.place)


def _fixed_reference(item: Located, problems: Problems) -> Reference | None:
    for key in item.value:
        if key not in FIXED_REFERENCE:
            problems.add(item.keys[key], f"unknown key {quoted(key)}", REFERENCE_HINT)
    if "from" not in item.value:
        problems.add(item.place, "a reference needs 'from'", REFERENCE_HINT)
        return None
    source = item.value["from"]
    if isinstance(source.value, dict):
        problems.add(source.place, "'from' contains another 'from'", REFERENCE_HINT)
        return None
    reference = read_reference(source, problems)
    if reference is None:
        return None
    labels = _fixed_labels(item.value["at"], problems) if "at" in item.value else {}
    return Reference(reference.node, reference.port, reference.place, labels)


def read_report_entry(item: Located, problems: Problems) -> ReportEntry | None:
    """Return the content of an entry of ``report``; None, with the error noted, if invalid."""
    parts = item.value if isinstance(item.value, dict) else {}
    if "show" not in parts:
        if isinstance(item.value, dict) and "from" not in parts:
            problems.add(item.place, "an entry of 'report' needs 'show'", REPORT_HINT)
            return None
        return _entry(read_reference(item, problems))
    for key in parts:
        if key not in REPORT_ENTRY:
            problems.add(item.keys[key], f"unknown key {quoted(key)}", REPORT_HINT)
    shown = parts["show"]
    if isinstance(shown.value, dict):
        problems.add(shown.place, "'show' is a node or one of its ports", REPORT_HINT)
        return None
    entry = _entry(read_reference(shown, problems))
    at = _fixed_labels(parts["at"], problems) if "at" in parts else {}
    title, caption, notes = (
        read_text(key, parts.get(key), problems) for key in ("title", "caption", "notes")
    )
    answer = read_answer(parts.get("answer"), problems)
    if entry is None:
        return None
    texts = replace(entry, at=at, title=title, caption=caption, notes=notes)
    return replace(texts, answer=answer, answer_place=parts["answer"].place) if answer else texts


def _entry(source: Reference | None) -> ReportEntry | None:
    if source is None:
        return None
    return ReportEntry(source.node, source.port, source.place, source.at)


def read_text(key: str, item: Located | None, problems: Problems) -> str:
    """Return the text at a key; an empty one, with the error noted, if there is something else."""
    if item is None or item.value is None:
        return ""
    if isinstance(item.value, (dict, list)):
        problems.add(item.place, f"{quoted(key)} must be text")
        return ""
    return str(item.value)


def _fixed_labels(item: Located, problems: Problems) -> dict[str, Any]:
    labels = item.plain()
    if not isinstance(labels, dict) or not all(map(is_label, labels.values())):
        problems.add(item.place, "'at' is {axis: label}, one label for each axis", REFERENCE_HINT)
        return {}
    return labels


class NodeReader:
    """Reads entries of ``nodes`` and notes their errors."""

    def __init__(self, problems: Problems) -> None:
        self._problems = problems

    def read(self, name: str, item: Located) -> NodeSpec:
        """Return the spec of one entry, without methods if it cannot be read."""
        if not self._is_mapping(item, f"node {quoted(name)}", NODE):
            return NodeSpec(name, item.place, (), False, {}, {}, None)
        return NodeSpec(
            name=name,
            place=item.place,
            methods=self._methods(name, item),
            has_alternatives="alternatives" in item.value,
            wiring=self._wiring(item.value.get("in")),
            settings=self._settings(item.value.get("with")),
            over=self._over(item.value.get("over")),
        )

    def _methods(self, name: str, item: Located) -> tuple[MethodSpec, ...]:
        use, alternatives = item.value.get("use"), item.value.get("alternatives")
        if use is None and alternatives is None and not _lacks_space(item):
            message = f"node {quoted(name)} needs 'use' or 'alternatives'"
            self._problems.add(item.place, message, "give one of the two")
        if use is not None and alternatives is not None:
            message = f"node {quoted(name)} has both 'use' and 'alternatives'"
            self._problems.add(item.place, message, "give one of the two")
        if alternatives is not None:
            return self._alternatives(name, alternatives)
        of_list = "write alternatives: [...]" if use and isinstance(use.value, list) else ""
        if use is None or not self._is_word(use, "'use' names a node", of_list):
            return ()
        if use.value.endswith(".*"):
            message = f"{quoted(use.value)} stands only among alternatives"
            self._problems.add(use.place, message, f"write alternatives: {use.value}")
            return ()
        return (MethodSpec("", use.value, use.place),)

    def _alternatives(self, name: str, item: Located) -> tuple[MethodSpec, ...]:
        methods: list[MethodSpec] = []
        if isinstance(item.value, str) and item.value.endswith(".*"):
            methods = [MethodSpec("", item.value, item.place)]
        elif isinstance(item.value, list):
            methods = [method for method in map(self._listed, item.value) if method]
        elif isinstance(item.value, dict):
            methods = [
                self._labelled(key, item.keys[key], each) for key, each in item.value.items()
            ]
        if not methods:
            self._problems.add(
                item.place, f"node {quoted(name)} has no alternative", ALTERNATIVES_HINT
            )
        seen: set[str] = set()
        for method in methods:
            if method.label and method.label in seen:
                message = f"label {quoted(method.label)} is used twice"
                self._problems.add(method.place, message, ALTERNATIVES_HINT)
            seen.add(method.label)
        return tuple(methods)

    def _listed(self, item: Located) -> MethodSpec | None:
        if not self._is_word(item, "a listed alternative is a node's name", ALTERNATIVES_HINT):
            return None
        return MethodSpec(label_of(item.value), item.value, item.place)

    def _labelled(self, key: object, place: Place, item: Located) -> MethodSpec:
        label = str(key)
        if not isinstance(key, str):
            message = f"the label {label} of an alternative must be a word"
            self._problems.add(place, message, f"write a name, such as order_{label}")
        is_family = label.endswith(".*")
        if item.value is None:
            item = Located({}, item.place)
        if isinstance(item.value, str):
            item = Located({"use": item}, item.place, {"use": item.place})
        if not self._is_mapping(
            item, f"alternative {quoted(label)}", FAMILY if is_family else METHOD
        ):
            return MethodSpec(label, "", place)
        if is_family:
            use = label
        elif label == PASS and "use" not in item.value:
            use = PASS
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
            if not _lacks_space(item):
                message = f"alternative {quoted(label)} has no 'use'"
                self._problems.add(item.place, message, ALTERNATIVES_HINT)
            return ""
        if not self._is_word(use, "'use' names a node"):
            return ""
        if use.value.endswith(".*"):
            message = f"{quoted(use.value)} has a label for each of its methods, and takes none"
            self._problems.add(use.place, message, f"write {{{use.value}: {{}}}}")
            return ""
        return str(use.value)

    def _wiring(self, item: Located | None) -> Wiring:
        if item is None or item.value is None:
            return {}
        if isinstance(item.value, dict) and "from" not in item.value:
            feeds = {str(port): self._feed(feed) for port, feed in item.value.items()}
            return {port: feed for port, feed in feeds.items() if feed is not None}
        reference = read_reference(item, self._problems)
        return {"": reference} if reference else {}

    def _feed(self, item: Located) -> Reference | Gathering | None:
        if not isinstance(item.value, dict) or not item.value or "from" in item.value:
            return read_reference(item, self._problems)
        sources: dict[str, Reference] = {}
        for key, source in item.value.items():
            if str(key) in sources:
                self._problems.add(item.keys[key], f"label {quoted(str(key))} is used twice")
            reference = read_reference(source, self._problems)
            if reference is not None:
                sources[str(key)] = reference
        return Gathering(sources, item.place)

    def _settings(self, item: Located | None) -> dict[str, Written]:
        if item is None or item.value is None:
            return {}
        if not isinstance(item.value, dict):
            self._problems.add(item.place, "'with' is a mapping: {setting: value}")
            return {}
        return {
            str(name): Written(_with_variables(value), value.place)
            for name, value in item.value.items()
        }

    def _over(self, item: Located | None) -> tuple[tuple[str, Place], ...] | None:
        if item is None:
            return None
        if not isinstance(item.value, list):
            self._problems.add(item.place, "'over' is a list of axes: [trial]")
            return None
        return tuple((str(axis.plain()), axis.place) for axis in item.value)

    def _is_mapping(self, item: Located, what: str, keys: Iterable[str]) -> bool:
        if not isinstance(item.value, dict):
            hint = space_hint(item.value, keys) or nearest("", keys, what="keys")
            if not hint.startswith("put") and "use" in keys and isinstance(item.value, str):
                hint = f"write {{use: {item.value}}}"
            self._problems.add(item.place, f"{what} must be a mapping", hint)
            return False
        for key in item.value:
            if key not in keys:
                message = f"{what}: unknown key {quoted(key)}"
                instead = partial(instead_of_key, key, keys, more="; settings stand under 'with'")
                self._problems.add(item.keys[key], message, instead)
        return True

    def _is_word(self, item: Located, message: str, hint: str = "") -> bool:
        if isinstance(item.value, str) and item.value:
            return True
        self._problems.add(item.place, f"{message}, not {quoted(item.plain())}", hint)
        return False


def _lacks_space(item: Located) -> bool:
    """Whether ``use:x.a`` is a key, which is noted as unknown."""
    return any(space_hint(key, ("use", "alternatives")) for key in item.value)


def label_of(use: str) -> str:
    """Return the label of a method in a list of alternatives."""
    if is_graph_file(use):
        return PurePath(use).stem
    plugin, _, name = use.rpartition(":")
    label = name.rpartition(".")[2]
    return f"{plugin}:{label}" if plugin else label


def instead_of_key(key: object, keys: Iterable[str], more: str = "") -> str:
    """Return what there is instead of an unknown key."""
    return space_hint(key, keys) or f"{nearest(key, keys)}{more}"


def space_hint(written: object, keys: Iterable[str]) -> str:
    """Return what to write for ``key:value``, which YAML takes for a single word, or ""."""
    key, colon, value = written.partition(":") if isinstance(written, str) else ("", "", "")
    return f"put a space after the colon: {key}: {value}" if colon and key in keys else ""


def _with_variables(item: Located) -> object:
    """Return the plain value of a setting, with a `Variable` for each ``$name`` in it."""
    if isinstance(item.value, dict):
        return {key: _with_variables(each) for key, each in item.value.items()}
    if isinstance(item.value, list):
        return [_with_variables(each) for each in item.value]
    if isinstance(item.value, str):
        match = _VARIABLE.fullmatch(item.value)
        return Variable(match[1], match[2] or "", item.place) if match else item.value
    return item.value
