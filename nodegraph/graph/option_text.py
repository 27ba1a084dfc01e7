"""Values and labels as the texts of the options ``--set``, ``--axis`` and ``--only``."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Mapping
from typing import Any

from nodegraph.errors import GraphError, NodegraphError
from nodegraph.graphfile.yaml_text import read_yaml

_BRACES = re.compile(r"{\s*files\s*:\s*([^\"'\s].*}.*)}\s*")
_GENERATOR = re.compile(r"(?:{\s*(?=\w+[:=]\S))?(count|range|files)\s*[:=]")


def read_value(option: str, text: str) -> object:
    """Return the value that an option such as ``--set start`` has: YAML, or else the text."""
    try:
        return read_yaml(text, option).plain()
    except GraphError:
        return text  # a path may contain characters that YAML gives a meaning


def read_axis(option: str, text: str) -> Any:
    """Return the labels that ``--axis k`` has, or its labels with values, or its generator.

    Raises
    ------
    NodegraphError
        If it is no YAML, a generator without braces or a blank, which would be a label, or a
        pattern with fields that is not in quotes.
    """
    if match := _BRACES.fullmatch(text):
        instead = shlex.quote(f"{option.removeprefix('--axis ')}={{files: {_yaml(match[1])}}}")
        raise NodegraphError(f"{option}: braces in a pattern need quotes; write --axis {instead}")
    if match := _GENERATOR.match(text):
        value = text[match.end() :].strip(" }")
        meant = {"count": value, "range": f"[{value.strip('[]')}]", "files": _yaml(value)}[match[1]]
        name = option.removeprefix("--axis ")
        instead = shlex.quote(f"{name}={{{match[1]}: {meant}}}")
        raise NodegraphError(f"{option}={text}: that would be a label; write --axis {instead}")
    return read_labels(option, text)


def read_labels(option: str, text: str) -> Any:
    """Return the labels that an option such as ``--only k`` has: ``1,2``, or YAML."""
    if not text.startswith(("[", "{")):
        labels = text.split(",")
        # *.c3d is an alias in YAML
        text = f"[{','.join(_yaml(each) if each[:1] == '*' else each for each in labels)}]"
    return read_yaml(text, option).plain()


def value_text(value: object) -> str:
    """Return the text that `read_value` reads as a value."""
    text = value if isinstance(value, str) else _yaml(value)
    return text if _same(read_value("", text), value) else _yaml(value)


def labels_text(labels: Any) -> str:
    """Return the text that `read_axis` and `read_labels` read as labels."""
    if isinstance(labels, Mapping):
        return _yaml(labels)
    text = ",".join(label if isinstance(label, str) else _yaml(label) for label in labels)
    try:
        is_plain = not text.startswith(("[", "{")) and _same(read_axis("", text), labels)
    except NodegraphError:
        is_plain = False
    return text if is_plain else _yaml(labels)


def _yaml(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


def _same(value: object, other: object) -> bool:
    return repr(value) == repr(other)  # 1 and True are equal, as labels they are not
