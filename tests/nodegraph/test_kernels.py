"""Machine code of kernels: where it is kept, and when it is used again."""

from __future__ import annotations

import os
import runpy
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from numba.core.errors import TypingError
from numpy.typing import NDArray

from nodegraph import kernel, read_only

SOURCE = """
from nodegraph import kernel

@kernel()
def scaled(value):
    return {factor} * value
"""


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The user's cache folder, which is not there yet."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    monkeypatch.setattr("numba.config.CACHE_DIR", "")
    return folder


def write(folder: Path, factor: float) -> Path:
    """Write a module with a kernel; its size and time do not depend on the factor."""
    folder.mkdir(exist_ok=True)
    path = folder / "scaling.py"
    path.write_text(SOURCE.format(factor=factor))
    os.utime(path, (10**9, 10**9))
    return path


def load(path: Path) -> Callable[..., object]:
    """Return the kernel of a module, as a new process would."""
    function: Callable[..., object] = runpy.run_path(str(path))["scaled"]
    return function


def hits(function: Any) -> int:
    """Return how many times machine code was read from a file."""
    return sum(function.stats.cache_hits.values())


def test_machine_code_is_kept_in_the_cache_folder_and_used_again(
    cache: Path, tmp_path: Path
) -> None:
    path = write(tmp_path / "package", 2.0)
    for count in (0, 1):
        function = load(path)
        assert function(3.0) == 6.0
        assert hits(function) == count
    assert list((cache / "nodegraph" / "kernels").rglob("scaling.scaled-*.nbc"))
    assert list(path.parent.iterdir()) == [path]


def test_a_folder_that_numba_is_set_to_is_used(
    cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path / "numba"))
    assert load(write(tmp_path / "package", 2.0))(3.0) == 6.0
    assert list((tmp_path / "numba").rglob("scaling.scaled-*.nbc"))
    assert not cache.exists()


@pytest.mark.parametrize("set_to", ["", "numba"])
def test_a_kernel_compiles_where_the_folder_cannot_be_written(
    cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, set_to: str
) -> None:
    monkeypatch.setattr("numba.config.CACHE_DIR", set_to and str(tmp_path / set_to))
    (tmp_path / set_to if set_to else cache).touch()
    path = write(tmp_path / "package", 2.0)
    assert load(path)(3.0) == 6.0
    assert list(path.parent.iterdir()) == [path]


def test_a_kernel_compiles_where_the_folder_goes_away(cache: Path, tmp_path: Path) -> None:
    path = write(tmp_path / "package", 2.0)
    load(path)(3.0)
    function = load(path)
    shutil.rmtree(cache)
    cache.touch()
    assert function(3.0) == 6.0


def test_another_version_in_its_place_is_compiled(cache: Path, tmp_path: Path) -> None:
    for factor in (2.0, 4.0):
        function = load(write(tmp_path / "package", factor))
        assert function(3.0) == 3.0 * factor
        assert hits(function) == 0


def test_copies_share_machine_code(cache: Path, tmp_path: Path) -> None:
    for place, count in (("here", 0), ("there", 1)):
        (tmp_path / place).mkdir()
        function = load(write(tmp_path / place / "package", 2.0))
        assert function(3.0) == 6.0
        assert hits(function) == count


def test_two_installed_versions_keep_their_machine_code_apart(cache: Path, tmp_path: Path) -> None:
    for count in (0, 1):
        for name, factor in (("old", 2.0), ("new", 4.0)):
            function = load(write(tmp_path / name, factor))
            assert function(3.0) == 3.0 * factor
            assert hits(function) == count


def test_a_kernel_without_a_file_compiles(cache: Path) -> None:
    names: dict[str, Any] = {}
    exec(SOURCE.format(factor=2.0), names)
    assert names["scaled"](3.0) == 6.0


def test_without_compilation_a_kernel_is_the_function(
    cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("numba.config.DISABLE_JIT", 1)
    assert load(write(tmp_path / "package", 2.0))(3.0) == 6.0
    assert not cache.exists()


class Sums(NamedTuple):
    once: NDArray[np.float64]
    twice: NDArray[np.float64]


@kernel("sums")
def add(sums: Sums, values: NDArray[np.float64]) -> None:
    for index in range(len(values)):
        sums.once[index] += values[index]
        sums.twice[index] += 2.0 * values[index]


@kernel()
def total(sums: Sums) -> float:
    both: float = sums.once.sum() + sums.twice.sum()
    return both


def test_one_compilation_serves_for_arrays_that_may_be_written_to_and_that_may_not() -> None:
    sums, locked = Sums(np.zeros(2), np.zeros(2)), read_only(np.ones(2))
    for values in (np.ones(2), locked, np.ones(2)):
        add(sums, values)
    assert sums.once.tolist() == [3.0, 3.0]
    for given in (sums, Sums(locked, locked), Sums(sums.once, locked)):
        assert total(given) == given.once.sum() + given.twice.sum()
    compiled: Any = (add, total)
    assert [len(function.signatures) for function in compiled] == [1, 1]


def test_one_compilation_serves_for_every_number_that_a_kernel_passes_on(cache: Path) -> None:
    @kernel()
    def scaled(value: float, factor: int) -> float:
        return factor * value

    @kernel()
    def scaled_twice(value: float) -> float:
        return scaled(value, 2) + scaled(value, 3)

    compiled: Any = scaled
    assert scaled_twice(1.0) == 5.0
    assert len(compiled.signatures) == 1


def test_nothing_is_written_to_an_array_that_is_read_only() -> None:
    with pytest.raises(TypingError, match="Cannot modify readonly array"):
        add(Sums(np.zeros(2), read_only(np.zeros(2))), np.ones(2))


def test_a_kernel_writes_to_no_argument_that_it_does_not_name() -> None:
    @kernel()
    def doubled(values: NDArray[np.float64]) -> None:
        for index in range(len(values)):
            values[index] *= 2.0

    values = np.ones(2)
    with pytest.raises(TypingError, match="Cannot modify readonly array"):
        doubled(values)
    assert values.tolist() == [1.0, 1.0]
