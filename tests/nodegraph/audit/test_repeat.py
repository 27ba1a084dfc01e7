"""Conditions under which calls are repeated."""

from __future__ import annotations

from threadpoolctl import threadpool_info

from nodegraph.audit.repeat import numeric_threads


def test_numeric_threads_are_restored() -> None:
    def now() -> set[int]:
        return {pool["num_threads"] for pool in threadpool_info()}

    before = now()
    with numeric_threads(1):
        assert now() == {1}
        with numeric_threads(2):
            assert now() == {2}
        assert now() == {1}
    assert now() == before
