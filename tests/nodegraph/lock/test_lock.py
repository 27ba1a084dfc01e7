"""What a lock holds is read back as it was written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nodegraph import NodegraphError
from nodegraph.execute import Run
from nodegraph.lock.lockfile import Lock, is_lock, lock_text, read_lock
from nodegraph.lock.results import Results, cells_of, recorded, scales

Frozen = tuple[Run, Lock]


def test_every_result_is_read_as_it_was(frozen: Frozen) -> None:
    run, lock = frozen
    cells, results = list(cells_of(run)), Results(run)
    usual = scales(cells, results, run)
    assert lock.scales == usual
    for cell in cells:
        was, now = lock.results[cell.group][cell.at], recorded(cell, results, usual[cell.group])
        assert (was.digest, was.exact, was.ended) == (now.digest, now.exact, now.ended)
        assert was.projections is not None
        assert now.projections is not None
        assert np.allclose(was.projections, now.projections, rtol=1e-10)


def test_one_run_has_one_lock(frozen: Frozen) -> None:
    run, lock = frozen
    assert lock_text(run, lock.path) == lock.path.read_text()


def test_windows_ends_of_lines_and_an_editors_mark_are_none_of_the_text(frozen: Frozen) -> None:
    _, lock = frozen
    text = lock.path.read_bytes()
    lock.path.write_bytes(b"\xef\xbb\xbf" + text.replace(b"\n", b"\r\n"))
    assert is_lock(lock.path)
    assert read_lock(lock.path).data == lock.data


@pytest.mark.parametrize("length", [0.2, 0.9, 0.999])
def test_the_beginning_of_a_lock_is_cut_off(frozen: Frozen, length: float) -> None:
    path: Path = frozen[1].path
    text = path.read_text()
    path.write_text(text[: int(length * len(text))])
    with pytest.raises(NodegraphError, match="the lock is cut off; get the whole file"):
        read_lock(path)


@pytest.mark.parametrize("end", ["\n", " ", "more: 3\n"])
def test_a_lock_with_something_more_is_not_as_it_was_written(frozen: Frozen, end: str) -> None:
    path: Path = frozen[1].path
    path.write_text(path.read_text() + end)
    with pytest.raises(NodegraphError, match="the lock is not as it was written"):
        read_lock(path)
