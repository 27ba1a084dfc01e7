"""Locks read back as they were written, and damaged ones are refused."""

from __future__ import annotations

import pytest

from nodegraph.errors import NodegraphError
from nodegraph.lock.lockfile import is_lock, lock_of, lock_text, read_lock
from tests.nodegraph.lock.conftest import Frozen


def test_a_lock_reads_back(frozen: Frozen) -> None:
    run, lock, path = frozen
    assert lock == lock_of(run, path)
    assert lock_text(run, path) == path.read_text()


def test_line_endings_and_a_byte_order_mark_do_not_count(frozen: Frozen) -> None:
    _, lock, path = frozen
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r\n"))
    assert is_lock(path)
    assert read_lock(path) == lock


@pytest.mark.parametrize("length", [0.2, 0.9, 0.999])
def test_a_truncated_lock_is_refused(frozen: Frozen, length: float) -> None:
    text = frozen.path.read_text()
    frozen.path.write_text(text[: int(length * len(text))])
    with pytest.raises(NodegraphError, match="truncated"):
        read_lock(frozen.path)


@pytest.mark.parametrize("end", ["\n", " ", "more: 3\n"])
def test_a_lock_with_text_after_its_end_is_refused(frozen: Frozen, end: str) -> None:
    frozen.path.write_text(frozen.path.read_text() + end)
    with pytest.raises(NodegraphError, match="checksum"):
        read_lock(frozen.path)
