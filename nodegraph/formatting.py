"""Sizes, labels and names as text."""

from __future__ import annotations

import shlex
from collections.abc import Mapping

SIZES = {"TB": 10**12, "GB": 10**9, "MB": 10**6, "KB": 10**3, "B": 1}


def size_text(size: int) -> str:
    """Return a number of bytes in a fitting unit: ``1.2 MB``."""
    unit = next((name for name in SIZES if size >= SIZES[name]), "B")
    return f"{size} B" if unit == "B" else f"{size / SIZES[unit]:.1f} {unit}"


def number_of(count: int, what: str) -> str:
    """Return a number of things: ``3 steps``, ``1 step``."""
    return f"{count:,} {what}{'' if count == 1 else 's'}"


def labels_of(labels: Mapping[str, object]) -> str:
    """Return one combination of axes as text: ``fill=muscle, length=5``."""
    return ", ".join(f"{axis}={label}" for axis, label in labels.items())


def name_at(node: str, labels: Mapping[str, object]) -> str:
    """Return the name of one combination of a node: ``fill(fill=muscle, length=5)``."""
    return f"{node}({labels_of(labels)})" if labels else node


def first_and_more(first: str, count: int, whole: str) -> str:
    """Return the name of the first of several items: ``fill(length=5) and 3 more of fill``."""
    return f"{first} and {count - 1} more of {whole}" if count > 1 else first


def printable(text: str) -> str:
    """Return a text with what UTF-8 cannot encode, such as parts of a file's name, escaped."""
    return text if text.isascii() else text.encode("utf-8", "backslashreplace").decode()


def duration(seconds: float) -> str:
    """Return a time as people say it: ``0.3 s``, ``42 s``, ``3 min 20 s``, ``2 h 5 min``."""
    if seconds < 10:
        return f"{seconds:.2g} s" if seconds >= 0.095 else f"{seconds * 1000:.0f} ms"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def options_of(command: str) -> str:
    """Return the options of a command that runs a graph: what follows ``nodegraph run GRAPH``."""
    return shlex.join(shlex.split(command)[3:])
