"""Locks read back as they were written, and damaged ones are refused."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph import NodegraphError
from nodegraph.execute import Run
from nodegraph.lock.lockfile import Lock, is_lock, lock_text, read_lock, study_from
from nodegraph.lock.results import Results, cells_of, recorded, scales

Frozen = tuple[Run, Lock]


def test_every_result_reads_back(frozen: Frozen) -> None:
    run, lock = frozen
    cells, results = list(cells_of(run)), Results(run)
    usual = scales(cells, results, run)
    assert {group: locked.scale for group, locked in lock.study.results.items()} == usual
    for cell in cells:
        was = lock.study.recorded(cell.group, cell.at)
        now = recorded(cell, results, usual[cell.group])
        assert was is not None
        assert (was.digest, was.exact, was.ending) == (now.digest, now.exact, now.ending)
        assert was.projections is not None
        assert now.projections is not None
        assert np.allclose(was.projections, now.projections, rtol=1e-10)


def test_a_run_has_the_same_lock_each_time(frozen: Frozen) -> None:
    run, lock = frozen
    assert lock_text(run, lock.path) == lock.path.read_text()


def test_line_endings_and_a_byte_order_mark_do_not_count(frozen: Frozen) -> None:
    _, lock = frozen
    text = lock.path.read_bytes()
    lock.path.write_bytes(b"\xef\xbb\xbf" + text.replace(b"\n", b"\r\n"))
    assert is_lock(lock.path)
    assert read_lock(lock.path).study.methods == lock.study.methods
    assert read_lock(lock.path).study.text == lock.study.text


@pytest.mark.parametrize("length", [0.2, 0.9, 0.999])
def test_a_truncated_lock_is_refused(frozen: Frozen, length: float) -> None:
    path: Path = frozen[1].path
    text = path.read_text()
    path.write_text(text[: int(length * len(text))])
    with pytest.raises(NodegraphError, match="truncated"):
        read_lock(path)


@pytest.mark.parametrize("end", ["\n", " ", "more: 3\n"])
def test_a_lock_with_text_after_its_end_is_refused(frozen: Frozen, end: str) -> None:
    path: Path = frozen[1].path
    path.write_text(path.read_text() + end)
    with pytest.raises(NodegraphError, match="checksum"):
        read_lock(path)


@pytest.mark.parametrize(
    ("place", "value", "key"),
    [
        (("methods", "cut", "use"), ["gaps.cut"], "methods.cut.use: "),
        (("methods", "cut"), 3, "methods.cut: "),
        (("methods", "cut", "in"), "a", "methods.cut.in: "),
        (("choices",), [], "choices: "),
        (("choices",), {"only": {"fill": 3}}, "choices.only.fill: "),
        (("removed",), {"fill": "hold"}, "removed.fill: "),
        (("axes", "length"), 3, "axes.length: "),
        (("axes", "length"), [[3]], "axes.length.0: "),
        (("versions",), {"numpy": "2.4"}, "versions: "),
        (("versions", "numpy"), 2.4, "versions.numpy: "),
        (("results", "cut", "steps"), {"3": 4}, "results.cut.steps.3: "),
        (("results", "cut", "scale"), {"gappy": 0.0}, "results.cut.scale.gappy: "),
        (("conclusions",), {"table": "a < b"}, "conclusions.table: "),
        (("text",), {}, "text: "),
        (("text",), {"toy.yaml": 3}, "text.toy.yaml: "),
        (("tolerance",), "little", "tolerance: "),
        (("tolerance",), -1e-9, "tolerance: "),
        (("tolerance",), float("nan"), "tolerance: "),
    ],
)
def test_an_invalid_value_is_reported_with_its_key(
    frozen: Frozen, place: tuple[str, ...], value: object, key: str
) -> None:
    _, lock = frozen
    data = lock.study.model_dump(by_alias=True)
    assert study_from(deepcopy(data), lock.path).methods == lock.study.methods
    parent: Any = data
    for name in place[:-1]:
        parent = parent[name]
    parent[place[-1]] = value
    with pytest.raises(NodegraphError) as raised:
        study_from(data, lock.path)
    assert f": {key}" in str(raised.value)


@pytest.mark.parametrize("data", [None, 3, [], "text"])
def test_a_lock_must_be_a_mapping(data: object) -> None:
    with pytest.raises(NodegraphError, match="dictionary"):
        study_from(data, Path("toy.lock"))
