"""Reading takes time and memory by the size of a file, whatever the file repeats."""

from __future__ import annotations

import importlib
import pkgutil
import re
import signal
import tracemalloc
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice, product
from pathlib import Path
from re import _parser  # type: ignore[attr-defined]
from typing import Any

import numpy as np
import pytest

import nodegraph.archive
import nodegraph.graphfile
import nodegraph.live
import nodegraph.lock
import nodegraph_compare
import nodegraph_files
import nodegraph_live
import nodegraph_mocap
import nodegraph_xarray
from nodegraph import get_node
from nodegraph_files.glb import buffers
from nodegraph_files.glb.buffers import GlbBuffer, joined_glb

READERS = (
    nodegraph.archive, nodegraph.graphfile, nodegraph.live, nodegraph.lock, nodegraph_compare,
    nodegraph_files, nodegraph_live, nodegraph_mocap, nodegraph_xarray,
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
            case (("LITERAL" | "NOT_LITERAL" | "IN" | "ANY"), _):
                parts.append([letter(kind, what)])
    return ["".join(chosen) for chosen in islice(product(*parts), MOST_EXAMPLES)]


def pumped(pattern: re.Pattern[Any]) -> Iterator[str]:
    """Yield texts that repeat a letter where the pattern may, and do not end as it wants."""
    for example in examples(_parser.parse(pattern.pattern, pattern.flags)):
        for place in range(len(example) + 1):
            for repeated in {*example[max(0, place - 1) : place + 1], *" _0a\n"}:
                yield example[:place] + repeated * OFTEN + example[place:] + "\0"


@contextmanager
def limited(text: str) -> Iterator[None]:
    """Fail where the body, which reads a text, takes more than some seconds of processor time."""

    def stop(*_: object) -> None:
        what = re.sub(r"(.)\1{99,}", r"\1...", text, flags=re.DOTALL)
        raise AssertionError(f"{what} takes more than {SECONDS} s")

    before = signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        signal.signal(signal.SIGVTALRM, before)


@pytest.mark.parametrize(("pattern", "method"), list(patterns()))
def test_a_pattern_takes_linear_time(pattern: re.Pattern[Any], method: str) -> None:
    use = getattr(pattern, method)
    for text in pumped(pattern):
        data = text if isinstance(pattern.pattern, str) else text.encode()
        with limited(text):
            use(*(["", data] if method == "sub" else [data]))


MANY = 30_000
ROWS = "0,1,2\n" * 3
NAMES = ",".join(f"a{number}" for number in range(MANY))
TEXTS = {
    "read.head": {
        "continued.obj": "\\\n" * 5 * MANY + "v 0 0 0\n",
        "a word a line.obj": "f " + "1 \\\n" * 5 * MANY,
    },
    "read.recording": {
        "left out.csv": f"{NAMES}\n{'0,' * (MANY - 1)}0\n",
        "blanks.csv": f"time{' ' * MANY}1,a.x,a.y,a.z\n0,1,2,3\n",
        "a unit.csv": f"time,a.x ({' ' * MANY}b,a.y,a.z\n0,1,2,3\n",
        "a number.csv": f"time,x{'1' * MANY},y1,z1\n0,1,2,3\n",
        "twice.mot": f"nRows=1\nendheader\ntime\t{NAMES.replace(',', chr(9))}\ta1\n",
    },
    "read.weights": {
        "dropped.csv": f"Timecode,BlendShapeCount,{NAMES}\n"
        + "".join(
            f"00:00:{time},1{',0' * MANY}\n" for time in ("00:00", "00:01", "00:02", "50:00")
        ),
    },
    "read.marker_set": {
        "twice.yaml": f"markers: [{NAMES[: NAMES.index(',a5000')]}, a1]",
    },
}
"""Files that repeat something, by node and name; none is of use."""
CASES = [(node, name) for node, files in TEXTS.items() for name in files]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("node", "name"), CASES, ids=[name for _, name in CASES])
def test_a_text_that_repeats_something_is_soon_refused(
    node: str, name: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    path.write_text(TEXTS[node][name], encoding="utf-8")
    with limited(name), pytest.raises(ValueError, match=re.escape(name)):
        get_node(node)(path=path)


def glb(primitives: list[dict[str, object]], **more: object) -> bytes:
    """Return a head of a few thousand vertices and triangles, in 100 kB."""
    buffer = GlbBuffer()
    rest = buffer.vertices(np.zeros((4000, 3)), "vertices")
    corners = buffer.corners(np.zeros((4000, 3), np.int64))
    given = {"attributes": {"POSITION": rest}, "indices": corners}
    document = {
        "asset": {"version": "2.0"},
        "meshes": [{"primitives": [{**given, **each} for each in primitives]}],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.content)}],
    }
    return joined_glb(document | more, buffer.content)


HEADS = {
    "empty targets": glb([{"targets": [{}] * 5000}]),
    "corners of one accessor": glb([{"material": 1}] * 5000),
    "vertices of one accessor": glb(
        [{"attributes": {"POSITION": 0, f"_{each}": 0}} for each in range(5000)]
    ),
    "places of nothing": glb([{}], nodes=[{"mesh": 0}, *([{}] * 4_000)]),
    "places of one mesh": glb([{"mode": 1, "targets": [{}] * 3000}], nodes=[{"mesh": 0}] * 3000),
}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", HEADS)
def test_a_head_that_repeats_its_parts_is_refused_early(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(buffers, "_FEW", 3_000_000)  # a tenth, which takes a tenth of the memory
    path = tmp_path / "it.glb"
    path.write_bytes(HEADS[name])
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match=r"it\.glb.*more than 3000000 numbers, too many for"):
            get_node("read.head")(path=path)
        assert tracemalloc.get_traced_memory()[1] < 5e7
    finally:
        tracemalloc.stop()
