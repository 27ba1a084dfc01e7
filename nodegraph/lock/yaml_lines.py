"""Plain data as YAML of one reading: a key per line, and no text that looks like a number."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping

from nodegraph.graphfile.yaml_text import scalar

_INDENT = "  "
_LONG = 40
_INVISIBLE = r"\x7f-\x9f\u2028\u2029\ud800-\udfff\ufeff\ufffe\uffff"
_INTEGER = re.compile(r"0|-?[1-9][0-9]{0,17}")
_BARE = re.compile(
    r"[A-Za-z0-9_$./(<+-](?:[ $()*+,./0-9;<=>?A-Z^_a-z~-]|:(?=[A-Za-z0-9_$./(<+-]))*"
)
_VISIBLE = rf"[^\x00-\x20{_INVISIBLE}]"
_BLOCK = re.compile(rf"{_VISIBLE}(?:[^\x00-\x08\x0b-\x1f{_INVISIBLE}]*{_VISIBLE})?\n")
_ESCAPED = re.compile(f"[{_INVISIBLE}]")


def yaml_lines(data: Mapping[str, object], depth: int = 0) -> Iterator[str]:
    """Yield the lines of a mapping of strings, numbers, booleans, None, lists and mappings."""
    indent = _INDENT * depth
    for key, value in data.items():
        head = f"{indent}{key if _INTEGER.fullmatch(key) else _text(key)}:"
        if isinstance(value, Mapping) and value:
            yield head
            yield from yaml_lines(value, depth + 1)
        elif isinstance(value, (list, tuple)) and any(map(_is_long, value)):
            yield head
            yield from (f"{indent}{_INDENT}- {_flow(item)}" for item in value)
        elif isinstance(value, str) and _BLOCK.fullmatch(value):
            yield f"{head} |"
            lines = value.removesuffix("\n").split("\n")
            yield from (f"{indent}{_INDENT}{line}" if line else "" for line in lines)
        else:
            yield f"{head} {_flow(value)}"


def _is_long(value: object) -> bool:
    return len(value) > _LONG if isinstance(value, str) else isinstance(value, (list, Mapping))


def _flow(value: object) -> str:
    """Return a value in one line."""
    if isinstance(value, Mapping):
        pairs = (f"{_inside(str(key))}: {_inside(item)}" for key, item in value.items())
        return f"{{{', '.join(pairs)}}}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_inside, value))}]"
    return _scalar(value)


def _inside(value: object) -> str:
    return _quoted(value) if isinstance(value, str) and "," in value else _flow(value)


def _scalar(value: object) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else f"{'-' if value < 0 else ''}.inf"
    return _text(value) if isinstance(value, str) else repr(value)


def _text(text: str) -> str:
    bare = _BARE.fullmatch(text) and not re.match(r"-+( |$)|---", text) and text[-1] != " "
    return text if bare and isinstance(scalar(text), str) else _quoted(text)


def _quoted(text: str) -> str:
    quoted = json.dumps(text, ensure_ascii=False)
    return _ESCAPED.sub(lambda match: f"\\u{ord(match[0]):04x}", quoted)
