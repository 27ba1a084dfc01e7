"""The author's answer in an entry of ``report``: words with places for what a verdict says."""

from __future__ import annotations

import re
from functools import partial
from typing import TYPE_CHECKING

from nodegraph.errors import nearest, quoted
from nodegraph.plugin.hook_types import PLACEHOLDERS, Placeholder

if TYPE_CHECKING:
    from nodegraph.errors import Problems
    from nodegraph.graphfile.yaml_text import Located

_BRACES = re.compile(r"\{([^{}]*)\}")
_FORM = re.compile(r"(\S+)(?: (?!at )(.+?))?(?: at (.+))?")
_ALL = "all"
_HINT = "write {best}, {best METHOD}, {best at AXIS=LABEL} or {best at all}; or " + ", ".join(
    f"{{{name}}}" for name in PLACEHOLDERS[1:]
)


def read_answer(item: Located | None, problems: Problems) -> tuple[str | Placeholder, ...]:
    """Return the parts of an author's answer; none, with the error noted, if it is invalid."""
    if item is None or item.value is None:
        return ()
    if not isinstance(item.value, str):
        problems.add(item.place, "'answer' must be text")
        return ()
    parts: list[str | Placeholder] = []
    start = 0
    for match in _BRACES.finditer(item.value):
        parts.append(item.value[start : match.start()])
        start = match.end()
        placeholder = _placeholder(match[1])
        if isinstance(placeholder, str):
            near = partial(nearest, placeholder, PLACEHOLDERS, what="there are")
            problems.add(item.place, f"'answer' has an unknown {quoted(match[0])}", near)
        else:
            parts.append(placeholder)
    parts.append(item.value[start:])
    if any(isinstance(part, str) and set(part) & {"{", "}"} for part in parts):
        problems.add(item.place, "'answer' has a brace without its other", _HINT)
    return tuple(part for part in parts if part)


def _placeholder(text: str) -> Placeholder | str:
    """Return what stands in braces; its name, if there is no such placeholder."""
    match = _FORM.fullmatch(text.strip())
    if match is None or match[1] not in PLACEHOLDERS:
        return match[1] if match else text
    where = (match[3] or "").strip()
    pairs = [pair.partition("=") for pair in where.split(",") if where not in ("", _ALL)]
    if not all(sign for _, sign, _ in pairs):
        return text
    at = {axis.strip(): label.strip() for axis, _, label in pairs}
    written = f"{{{text}}}"
    return Placeholder(match[1], match[2] or "", None if where == _ALL else at, written)
