"""YAML files of names and numbers, every word as it was written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nodegraph import quoted


def yaml_document(path: Path) -> Any:
    """Return lists, mappings and words of a YAML file.

    Raises
    ------
    ValueError
        If it is not YAML, or a key stands twice.
    """
    import yaml

    # nothing is resolved, so that a marker may be called `no` or `1e3`; the loader in C is faster,
    # but ends the process on brackets nested deep enough
    try:
        loader = yaml.BaseLoader(path.read_text(encoding="utf-8-sig"))
        root = loader.get_single_node()
        _check_keys(root)
        return root and loader.construct_document(root)
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(str(error)) from None


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
