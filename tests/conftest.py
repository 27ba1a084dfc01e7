"""No test finds what another has stored, and none writes where a user's results lie."""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections.abc import Generator, Iterator
from itertools import count

import hypothesis
import pytest

from tests.memory import give_back
from tests.studies import Studies

pytest_plugins = ("tests.browser",)

# no draw depends on the day or the speed of the machine
hypothesis.settings.register_profile("tests", max_examples=30, deadline=None, derandomize=True)
hypothesis.settings.load_profile("tests")


# tests run side by side, as steps of a run do: threads of numerical libraries would wait for each
# other, which takes a third more time; numpy reads it when it is imported
os.environ.setdefault("OMP_NUM_THREADS", "1")

# the C library of workers keeps what threads have freed for all of them, not for each by itself
os.environ.setdefault("MALLOC_ARENA_MAX", "1")

# in the background, a shell without job control has SIGINT ignored, by children as well
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# jsonschema looks for it to check addresses, which no test does, and its grammar takes a second
sys.modules["rfc3987_syntax"] = None  # type: ignore[assignment]

# every process of the tests, and every program that they start, would compile each module again
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

WORKER = os.environ.get("PYTEST_XDIST_WORKER", "")
"""The name of this process where there are several: gw0, gw1, ..."""

_NUMBERS = count()

gc.disable()  # until all tests are collected: nothing of theirs is garbage

LONG = (
    *("test_contracts", "test_locked_studies", "test_stored_studies", "test_reports"),
    *("test_misbehaving_nodes", "test_third_party", "test_fill_study", "test_executor"),
    *("test_page", "test_charts", "test_answers", "test_jupyter"),
    *("test_readme", "test_live_page", "test_machines", "test_odd_reports"),
    *("test_documentation", "test_tracking_study", "test_marker_selection_study"),
)
"""Modules that take longest."""


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Have every other process import from the last module to the first: each compiles half."""
    report = yield
    if isinstance(collector, pytest.Directory) and WORKER.endswith(tuple("13579")):
        report.result.reverse()
    return report


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the long tests, so that no process waits for one of them at the end."""
    order = {name: place for place, name in enumerate(LONG)}
    items.sort(key=lambda item: (order.get(item.path.stem, len(LONG)), item.path))


def pytest_collection_finish() -> None:
    """Look for garbage from now on, seldom, among what tests make only."""
    gc.freeze()
    gc.set_threshold(20_000, 20, 20)
    gc.enable()


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> None:
    """Give the system back what a file's tests have freed."""
    if nextitem is None or nextitem.path != item.path:
        give_back()


@pytest.fixture(scope="session", autouse=True)
def _not_the_users_store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep fixtures that live longer than a test from the user's store, too."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("NODEGRAPH_STORE", str(tmp_path_factory.mktemp("store")))
        yield


@pytest.fixture(autouse=True)
def _a_store_of_its_own(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Give every test a store of its own, in a folder that most never make."""
    folder = tmp_path_factory.getbasetemp() / "stores" / str(next(_NUMBERS))
    monkeypatch.setenv("NODEGRAPH_STORE", str(folder))


@pytest.fixture
def without_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw nothing of comparisons, which would take most of their time."""
    from matplotlib.figure import Figure

    for part in ("table", "ranks", "curve"):
        monkeypatch.setattr(f"nodegraph_compare.{part}.figure.draw", lambda *given: Figure())


@pytest.fixture(scope="session")
def studies(tmp_path_factory: pytest.TempPathFactory) -> Studies:
    """Runs of shipped graphs; workers of pytest-xdist share their store."""
    folder = tmp_path_factory.getbasetemp()
    shared = folder.parent if WORKER else folder
    return Studies(tmp_path_factory, shared / "studies")
