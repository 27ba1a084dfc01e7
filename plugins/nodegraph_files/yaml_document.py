"""YAML files of names and numbers, every word as it was written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from nodegraph import quoted

_MOST_DEPTH = 100


def yaml_document(path: Path) -> Any:
    """Return lists, mappings and words of a YAML file.

    Raises
    ------
    ValueError
        If it is not YAML, is nested too deep, or a key stands twice.
    """
    import yaml

    try:
        text = path.read_text(encoding="utf-8-sig")
        _check_depth(text)
        loader = yaml.CBaseLoader(text)  # which lets a marker be called `no` or `1e3`
        root = loader.get_single_node()
        _check_keys(root)
        return root and loader.construct_document(root)
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(str(error)) from None


def parts_in(data: object, parts: Sequence[str]) -> Mapping[str, Any]:
    """Return what is a mapping with the first of some parts, and perhaps with others of them.

    Raises
    ------
    ValueError
        If it is anything else.
    """
    if not isinstance(data, Mapping) or parts[0] not in data:
        raise ValueError(
            f"it must be a mapping with {quoted(parts[0])}, and may have {', '.join(parts[1:])}"
        )
    unknown = [str(key) for key in data if key not in parts]
    if unknown:
        raise ValueError(f"unknown key {quoted(unknown[0])}; there is {', '.join(parts)}")
    return data


def _check_depth(text: str) -> None:
    """Refuse what is nested so deep that the loader in C would end the process."""
    import yaml

    depth = 0
    for event in yaml.parse(text, yaml.CBaseLoader):
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if depth > _MOST_DEPTH:
            raise ValueError(f"nested more than {_MOST_DEPTH} deep")


def _check_keys(node: Any) -> None:
    """Refuse a key that stands twice, of which YAML would keep the last in silence."""
    pairs = node.value if getattr(node, "id", "") == "mapping" else []
    lines: dict[str, int] = {}
    for key, _ in pairs:
        line = key.start_mark.line + 1
        if key.id == "scalar" and lines.setdefault(key.value, line) != line:
            raise ValueError(
                f"line {line}: {quoted(key.value)} again, after line {lines[key.value]}"
            )
