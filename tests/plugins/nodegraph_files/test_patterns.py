"""No pattern that reads a file takes more than linear time, whatever the file repeats."""

from __future__ import annotations

import importlib
import pkgutil
import re
import signal
from collections.abc import Iterator
from itertools import islice, product
from pathlib import Path
from re import _parser  # type: ignore[attr-defined]
from typing import Any

import pytest

import nodegraph.archive
import nodegraph.graphfile
import nodegraph.live
import nodegraph.lock
import nodegraph_files
import nodegraph_live
import nodegraph_mocap
import nodegraph_xarray

READERS = (
    nodegraph.archive, nodegraph.graphfile, nodegraph.live, nodegraph.lock, nodegraph_files,
    nodegraph_live, nodegraph_mocap, nodegraph_xarray,
)  # fmt: skip
METHODS = "match|fullmatch|search|sub|split|findall|finditer"
OFTEN = 50_000
SECONDS = 1.0
"""Of processor time for a text: linear time is a hundredth of that, square time ten times it."""
MOST_EXAMPLES = 6


def patterns() -> Iterator[Any]:
    """Yield the patterns of the readers, each with a method that they call."""
    for package in READERS:
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            module = importlib.import_module(found.name)
            source = Path(str(module.__file__)).read_text(encoding="utf-8")
            for name, value in vars(module).items():
                if isinstance(value, re.Pattern):
                    for used in sorted(set(re.findall(rf"\b{name}\.({METHODS})\b", source))):
                        yield pytest.param(value, used, id=f"{found.name}.{name}.{used}")


def letter(kind: object, what: Any) -> str:
    """Return a letter that a part of a pattern matches."""
    match str(kind), what:
        case "LITERAL", code:
            return chr(code)
        case "RANGE", (first, _):
            return chr(first)
        case "CATEGORY", category:
            return {"CATEGORY_SPACE": " ", "CATEGORY_DIGIT": "0"}.get(str(category), "a")
        case "IN", (first, *_):
            return letter(*first)
    return "a"  # of what may be anything, or anything but something


def examples(parsed: Any) -> list[str]:
    """Return texts that a pattern may match, with each of its parts at least once."""
    parts: list[list[str]] = []
    for kind, what in parsed:
        match str(kind), what:
            case "MAX_REPEAT" | "MIN_REPEAT" | "POSSESSIVE_REPEAT", (least, _, inner):
                parts.append([text * max(1, least) for text in examples(inner)])
            case "SUBPATTERN", (*_, inner):
                parts.append(examples(inner))
            case "BRANCH", (_, branches):
                parts.append([text for branch in branches for text in examples(branch)])
            case ("LITERAL" | "NOT_LITERAL" | "IN" | "ANY"), _:
                parts.append([letter(kind, what)])
    return ["".join(chosen) for chosen in islice(product(*parts), MOST_EXAMPLES)]


def pumped(pattern: re.Pattern[Any]) -> Iterator[str]:
    """Yield texts that repeat a letter where the pattern may, and do not end as it wants."""
    for example in examples(_parser.parse(pattern.pattern, pattern.flags)):
        for place in range(len(example) + 1):
            for repeated in {*example[max(0, place - 1) : place + 1], *" _0a\n"}:
                yield example[:place] + repeated * OFTEN + example[place:] + "\0"


@pytest.mark.parametrize(("pattern", "method"), list(patterns()))
def test_a_pattern_takes_linear_time(pattern: re.Pattern[Any], method: str) -> None:
    def stop(*_: object) -> None:
        raise AssertionError(f"{pattern.pattern!r}: {shown}")

    use = getattr(pattern, method)
    before = signal.signal(signal.SIGVTALRM, stop)
    try:
        for text in pumped(pattern):
            shown = re.sub(r"(.)\1{99,}", r"\1...", text, flags=re.DOTALL)
            data = text if isinstance(pattern.pattern, str) else text.encode()
            signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
            use(*(["", data] if method == "sub" else [data]))
            signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)
