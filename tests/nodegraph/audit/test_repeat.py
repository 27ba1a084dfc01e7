"""Conditions under which calls are repeated."""

from __future__ import annotations

import subprocess
import sys

PROGRAM = """
import scipy.linalg, sklearn  # which load OpenBLAS and OpenMP
from threadpoolctl import threadpool_info
from nodegraph.audit.repeat import numeric_threads

def now():
    return {pool["num_threads"] for pool in threadpool_info()}

before = now()
with numeric_threads(1):
    assert now() == {1}, now()
    with numeric_threads(2):
        assert now() == {2}, now()
    assert now() == {1}, now()
assert now() == before, now()
"""


def test_numeric_threads_are_restored() -> None:
    """In a process of its own, as threads that other tests have left may set them meanwhile."""
    subprocess.run([sys.executable, "-c", PROGRAM], check=True)
