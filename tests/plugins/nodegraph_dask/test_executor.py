"""Studies on a Dask cluster: on one of the run's own, and on one that is already running."""

from __future__ import annotations

import os
import re
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest
from distributed import Client, LocalCluster

from nodegraph.errors import NodegraphError
from nodegraph.execute import messages
from nodegraph.execute.events import Event
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.results import Run
from nodegraph.plugin.registry import Registry
from nodegraph.state import State
from nodegraph_dask import cluster as cluster_module
from nodegraph_dask.worker import no_logs

OWN = HowToRun("dask", 2)


class SharedCluster:
    """A running scheduler, and workers to be added to it."""

    def __init__(self, cluster: Any) -> None:
        self._cluster = cluster
        self._workers: list[subprocess.Popen[bytes]] = []
        self.how = HowToRun("dask", scheduler=cluster.scheduler_address)

    def add(self, *, path: str = "", without: str = "", wait: bool = True) -> None:
        """Start a worker with another folder of modules, or without one."""
        folders = [path, *(folder for folder in sys.path if folder != without)]
        there = os.pathsep.join(filter(None, folders))
        words = ["worker", self.how.scheduler, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
        started = subprocess.Popen(
            [sys.executable, "-P", "-m", "dask", *words],
            env={**os.environ, "PYTHONPATH": there},
            stderr=subprocess.DEVNULL,
        )
        self._workers.append(started)
        if wait:
            with Client(self._cluster, set_as_default=False) as client:  # type: ignore[no-untyped-call]
                client.wait_for_workers(len(self._workers), timeout=60)

    def end(self) -> None:
        """End all workers."""
        for worker in self._workers:
            worker.kill()
            worker.wait()


@contextmanager
def shared_cluster() -> Iterator[SharedCluster]:
    with no_logs():
        options = {"host": "127.0.0.1", "dashboard_address": ":0"}
        with LocalCluster(n_workers=0, **options) as local:  # type: ignore[no-untyped-call]
            cluster = SharedCluster(local)
            try:
                yield cluster
            finally:
                cluster.end()


@pytest.fixture
def empty_cluster() -> Iterator[SharedCluster]:
    """A scheduler without workers."""
    with shared_cluster() as cluster:
        yield cluster


@pytest.fixture(scope="module")
def two_workers() -> Iterator[HowToRun]:
    """A cluster of two workers that serves several runs."""
    with shared_cluster() as cluster:
        cluster.add(wait=False)
        cluster.add()
        yield cluster.how


def test_results_are_those_of_the_serial_executor(
    same_as_serial: Callable[[HowToRun], bool], made_here: list[str], two_workers: HowToRun
) -> None:
    assert same_as_serial(two_workers)
    assert made_here.count("pass") == 2 * 4
    assert made_here.count("away.mean") == 4


@pytest.fixture
def sent(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Sizes of the arrays that are sent apart from calls, in bytes."""
    sizes: list[int] = []
    scatter = Client.scatter

    def count(client: Client, arrays: list[Any], **options: Any) -> object:
        sizes.extend(array.nbytes for array in arrays)
        return scatter(client, arrays, **options)  # type: ignore[no-untyped-call]

    monkeypatch.setattr(Client, "scatter", count)
    return sizes


def test_a_large_value_is_sent_once(
    study: Callable[..., Run], two_workers: HowToRun, sent: list[int]
) -> None:
    text = """
        axes: {length: [1, 2, 3, 4, 5, 6, 7, 8]}
        nodes:
          a: {use: away.pair, with: {rows: 6000}}
          b: {use: away.cut, in: a, with: {length: $length, at: [5]}}
          c: {use: away.size, in: a}
        """
    run = study(text, two_workers)
    assert run.counts()["done"] == 10
    assert sent == 2 * [6000 * 18 * 8]


def test_calls_that_read_files_are_made_here(
    study: Callable[..., Run], two_workers: HowToRun, tmp_path: Path
) -> None:
    (tmp_path / "input.txt").write_text("here")
    text = "nodes: {a: {use: away.file_pid, with: {path: input.txt}}, b: {use: away.pid}}"
    run = study(text, two_workers)
    assert run["a"].value == os.getpid()
    assert run["b"].value != os.getpid()


VERSION = """
from nodegraph import node

@node("edited.version")
def version(*, k: int = 0) -> str:
    return "{}"
"""


def test_a_plugin_file_goes_along_as_it_is_now(
    study: Callable[..., Run], two_workers: HowToRun, tmp_path: Path
) -> None:
    file, text = tmp_path / "edited.py", "nodes: {a: {use: edited.version}}"
    file.write_text(VERSION.format("first"))
    first = study(text, two_workers, nodes=Registry.installed([file]))["a"].value
    file.write_text(VERSION.format("second"))
    second = study(text, two_workers, nodes=Registry.installed([file]))["a"].value
    assert (first, second) == ("first", "second")


def acme(folder: Path, version: str, code: str = "return 1") -> str:
    """Install a plugin into a folder of its own, as pip does, and return the folder."""
    about = folder / f"acme-{version}.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: acme\nVersion: {version}\n")
    (about / "entry_points.txt").write_text("[nodegraph]\nacme = acme_nodes\n")
    (folder / "acme_nodes.py").write_text(
        "from nodegraph import hookimpl, node\n"
        '@node("acme.one")\n'
        f"def one(*, k: int = 0) -> int:\n    {code}\n"
        "@hookimpl\n"
        "def nodegraph_nodes(): return [one]\n"
    )
    return str(folder)


@pytest.fixture
def acme_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Registry]:
    """The registry of a process in which acme 0.1 is installed."""
    monkeypatch.syspath_prepend(acme(tmp_path / "here", "0.1"))
    yield Registry.installed()
    sys.modules.pop("acme_nodes", None)


MANY = "axes: {k: {count: 40}}\nnodes: {a: {use: acme.one, with: {k: $k}}}"


def reasons(run: Run) -> set[str]:
    return {outcome.reason for _, outcome in run.settled(State.FAILED)}


def test_a_worker_without_the_code_of_here_is_named(
    study: Callable[..., Run], empty_cluster: SharedCluster, tmp_path: Path, acme_here: Registry
) -> None:
    here = str(tmp_path / "here")
    empty_cluster.add(path=here, wait=False)
    empty_cluster.add(without=here, wait=False)
    empty_cluster.add(path=acme(tmp_path / "there", "0.2"), without=here)
    run = study(MANY, empty_cluster.how, nodes=acme_here)
    assert run.counts()["done"] > 0
    other_version, no_plugin = sorted(reasons(run), key=len)
    assert re.fullmatch(
        r"worker tcp://127\.0\.0\.1:\d+ has acme 0\.2, here it is acme 0\.1, for acme\.one",
        other_version,
    )
    assert no_plugin.startswith("worker tcp://127.0.0.1:")
    assert no_plugin.endswith(
        " has no plugin 'acme', which defines acme.one; install it there (acme 0.1)"
    )

    file = tmp_path / "here" / "acme_nodes.py"
    file.write_text(file.read_text().replace("return 1", "return 2"))
    run = study(MANY, empty_cluster.how, nodes=acme_here)
    assert run.counts()["failed"] == 40
    (old,) = reasons(run) - {other_version, no_plugin}
    assert "has other code of acme_nodes than here, for acme.one" in old


def test_other_versions_are_reported_once(
    study: Callable[..., Run], two_workers: HowToRun, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(messages, "VERSIONS", {"Python": "3.9", "numpy": "1.0"})
    text = "axes: {k: {count: 9}}\nnodes: {a: {use: away.pid, with: {mark: $k}}}"
    message = r"worker tcp://.* has Python .*, here it is 3\.9; numpy .*, here it is 1\.0"
    with pytest.warns(UserWarning, match=message) as warned:
        run = study(text, two_workers)
    assert len(warned) == 1
    assert run.counts()["done"] == 9


def test_a_node_that_kills_its_worker_fails_alone(study: Callable[..., Run]) -> None:
    text = """
        axes: {k: {count: 20}}
        nodes:
          x: {use: away.pid, with: {mark: $k}}
          bad: {use: away.killed, in: {from: x, at: {k: 3}}}
          good: {use: away.warns, in: x}
        """
    run = study(text, HowToRun("dask", 1))
    assert reasons(run) == {"2 workers that computed it died of it"}
    assert run.counts() == {**run.counts(), "done": 40, "failed": 1}


def test_a_run_is_complete_though_its_worker_is_killed_with_a_value_that_was_sent(
    study: Callable[..., Run], sent: list[int], tmp_path: Path
) -> None:
    mark = tmp_path / "killed"
    text = """
        inputs: {mark: ""}
        axes: {k: {count: 30}}
        nodes:
          big: {use: away.pair, with: {rows: 20000}}
          x: {use: away.number}
          a: {use: away.killed_once, in: x, with: {mark: $mark, number: $k, at: 20}}
          size: {use: away.also_size, in: {pair: big, x: a}}
        """
    run = study(text, HowToRun("dask", 1), mark=str(mark))
    assert mark.exists()
    assert run.counts() == {**run.counts(), "done": 62, "failed": 0}
    assert [value for _, value in run["a"]] == [7 + k for k in range(30)]
    assert {value for _, value in run["size"]} == {20000 * 36 * 8}
    assert len(sent) > 2


def test_a_run_waits_for_a_worker_and_gives_up_after_long_without(
    study: Callable[..., Run], empty_cluster: SharedCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    def add(event: Event) -> None:
        if event.kind == "started" and event.node == "a":
            empty_cluster.add(wait=False)

    run = study("nodes: {a: {use: away.number}}", empty_cluster.how, listeners=[add])
    assert run["a"].value == 7

    monkeypatch.setattr(cluster_module, "SECONDS_WITHOUT_WORKERS", 0.0)
    text = """
        nodes:
          a: {use: away.number}
          b: {use: away.for_ever, in: a, with: {alive: /dev/null}}
        """
    seen: list[str] = []

    def end(event: Event) -> None:
        seen.append(f"{event.node} {event.kind}")
        if event.kind == "done":
            empty_cluster.end()

    with pytest.raises(NodegraphError, match=r"the Dask cluster at tcp://.* has had no worker"):
        study(text, empty_cluster.how, listeners=[end])
    assert "a done" in seen


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("tcp://127.0.0.1:1", "no Dask scheduler answers at tcp://127.0.0.1:1; start one with"),
        ("127.0.0.1:99999999", "no Dask scheduler answers at 127.0.0.1:99999999"),
        ("cluster", "'cluster' is not the address of a Dask scheduler; write it as tcp://"),
        ("xyz://127.0.0.1:1", "'xyz://127.0.0.1:1' is not the address of a Dask scheduler"),
    ],
)
def test_an_address_without_a_scheduler(
    study: Callable[..., Run], address: str, message: str
) -> None:
    with pytest.raises(NodegraphError, match=message):
        study("nodes: {a: {use: away.number}}", HowToRun("dask", scheduler=address))


def test_an_address_at_which_something_else_listens(
    study: Callable[..., Run], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster_module, "_SECONDS_TO_ANSWER", 0.2)
    with socket.create_server(("127.0.0.1", 0)) as silent:
        how = HowToRun("dask", scheduler=f"tcp://127.0.0.1:{silent.getsockname()[1]}")
        with pytest.raises(NodegraphError, match="no Dask scheduler answers at tcp://127"):
            study("nodes: {a: {use: away.number}}", how)


def test_dask_must_be_installed(study: Callable[..., Run], monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith("nodegraph") and "dask" in name]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(NodegraphError, match=r"pip install 'nodegraph\[dask\]'"):
        study("nodes: {a: {use: away.number}}", OWN)


def test_a_script_without_a_guard_runs_once(script: Callable[..., subprocess.Popen[str]]) -> None:
    nodes = "{x: {use: away.pid}, a: {use: script.own, in: x}, b: {use: away.prints, in: a}}"
    output, complained = script(nodes, "dask").communicate(timeout=60)
    assert (output, complained) == ("3\n", "noise\n")


@pytest.fixture(scope="module")
def own_cluster() -> Iterator[cluster_module.Cluster]:
    """A cluster as a run has."""
    with cluster_module.cluster_for(HowToRun("dask", 1)) as own:
        yield own


def test_a_cluster_of_its_own_serves_no_pages(own_cluster: cluster_module.Cluster) -> None:
    info = own_cluster.client.scheduler_info()
    ports = [info["services"]["dashboard"]]
    ports += [worker["services"]["dashboard"] for worker in info["workers"].values()]
    for port in ports:
        for page in ("info/main/workers.html", "json/identity.json", "info/logs/x.html"):
            with pytest.raises(HTTPError, match="404"):
                urlopen(f"http://127.0.0.1:{port}/{page}")


@pytest.mark.parametrize("protocol", ["tls", "tcp"])
def test_nobody_else_reaches_the_scheduler_of_a_run(
    own_cluster: cluster_module.Cluster, protocol: str
) -> None:
    address = own_cluster.client.scheduler.address.replace("tls:", f"{protocol}:")
    stranger = cluster_module.cluster_for(HowToRun("dask", scheduler=address))
    with pytest.raises(NodegraphError, match="no Dask scheduler answers at"), stranger:
        pass
