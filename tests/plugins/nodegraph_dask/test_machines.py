"""A cluster of machines: network namespaces with addresses and disks of their own."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

SCHEDULER, *WORKERS, PROGRAM = (f"10.77.0.{number}" for number in range(1, 5))
ADDRESS = f"tcp://{SCHEDULER}:8786"
COUNT = 40
RUN = """
from nodegraph.cli.main import program
from nodegraph_dask import cluster
cluster._SECONDS_TO_RECONNECT = 3.0
program()
"""
"""A program that tries to reach a scheduler that was there for less long than others do."""
NODES = """
import os
import time
import numpy as np
from nodegraph import Across, node

@node("far.make")
def make(*, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(4000, 12))

@node("far.work")
def work(x: np.ndarray, *, file: str) -> np.ndarray:
    time.sleep(0.05)
    where = [os.stat("/proc/self/ns/net").st_ino, os.path.exists(file)]
    return np.concatenate([x.ravel(), where])

@node("far.total")
def total(parts: Across[np.ndarray]) -> str:
    arrays = list(parts.values())
    places = sorted({int(array[-2]) for array in arrays})
    same_disk = any(array[-1] for array in arrays)
    return f"total {sum(float(array[:-2].sum()) for array in arrays).hex()} {places} {same_disk}"
"""
GRAPH = f"""
nodegraph: 1
inputs: {{file: ""}}
axes: {{seed: {{count: {COUNT}}}}}
nodes:
  make: {{use: far.make, with: {{seed: $seed}}}}
  work: {{use: far.work, in: make, with: {{file: $file}}}}
  total: {{use: far.total, in: work}}
"""


def ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True, capture_output=True, text=True)


class Machines:
    """Machines on one network, by their addresses."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._mark = f"ng{os.getpid() % 100_000}"
        self._processes: list[subprocess.Popen[str]] = []

    def connect(self) -> None:
        """Make a switch, and a machine for each address."""
        ip("netns", "add", self._mark)
        ip("-n", self._mark, "link", "add", "switch", "type", "bridge")
        ip("-n", self._mark, "link", "set", "switch", "up")
        for address in (SCHEDULER, *WORKERS, PROGRAM):
            name, port = self._name(address), f"p{address[-1]}"
            ip("netns", "add", name)
            ends = ("link", "add", "eth", "netns", name, "type", "veth", "peer", "name", port)
            ip(*ends, "netns", self._mark)
            ip("-n", self._mark, "link", "set", port, "master", "switch", "up")
            ip("-n", name, "address", "add", f"{address}/24", "dev", "eth")
            for device in ("lo", "eth"):
                ip("-n", name, "link", "set", device, "up")

    def start(self, address: str, *words: str) -> subprocess.Popen[str]:
        """Start Python; only programs of the last machine see the folder of the test."""
        command = ["ip", "netns", "exec", self._name(address)]
        if address != PROGRAM:
            hidden = f'mount -t tmpfs none "{self.folder}" && cd / && exec "$@"'
            command += ["unshare", "--mount", "sh", "-c", hidden, "sh"]
        started = subprocess.Popen(
            [*command, sys.executable, "-P", *words],
            cwd=self.folder,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            stdout=subprocess.DEVNULL if address in WORKERS else subprocess.PIPE,
            stderr=subprocess.DEVNULL if address in WORKERS else subprocess.PIPE,
            text=True,
        )
        self._processes.append(started)
        return started

    def scheduler(self) -> subprocess.Popen[str]:
        """Start the scheduler, and return when it listens."""
        words = ["scheduler", "--host", SCHEDULER, "--port", "8786", "--no-dashboard"]
        started = self.start(SCHEDULER, "-m", "dask", *words)
        assert started.stderr is not None
        assert any("Scheduler at:" in line for line in started.stderr)
        return started

    def worker(self, address: str) -> subprocess.Popen[str]:
        options = ["--host", address, "--nthreads", "1", "--no-nanny", "--no-dashboard"]
        return self.start(address, "-m", "dask", "worker", ADDRESS, *options)

    def run(self) -> subprocess.Popen[str]:
        """Run the study."""
        words = ["run", "far.yaml", "--plugin", "far.py", "--set", f"file={self.folder}/far.yaml"]
        words += ["--executor", "dask", "--scheduler", ADDRESS, "--store", "kept", "--out", "out"]
        return self.start(PROGRAM, "-c", RUN, *words)

    def wait_for(
        self, program: subprocess.Popen[str], is_so: Callable[[Counter[str]], bool]
    ) -> None:
        """Wait until the events of a run are so."""
        events = self.folder / "out" / "events.jsonl"
        while program.poll() is None:
            if events.is_file():
                lines = events.read_text().splitlines()
                if is_so(Counter(re.findall(r'"event": "(\w+)"', "\n".join(lines)))):
                    return
            time.sleep(0.02)
        raise AssertionError(program.communicate())

    def close(self) -> None:
        for process in self._processes:
            process.kill()
            process.communicate()
        for address in (SCHEDULER, *WORKERS, PROGRAM):
            subprocess.run(["ip", "netns", "delete", self._name(address)], check=False)
        subprocess.run(["ip", "netns", "delete", self._mark], check=False)

    def place(self, address: str) -> int:
        """Return what a program on a machine sees as its network."""
        return Path("/run/netns", self._name(address)).stat().st_ino

    def _name(self, address: str) -> str:
        return f"{self._mark}-{address[-1]}"


@pytest.fixture
def machines(tmp_path: Path) -> Iterator[Machines]:
    if not (shutil.which("ip") and shutil.which("unshare")):
        pytest.skip("ip and unshare make the machines")
    (tmp_path / "far.py").write_text(NODES)
    (tmp_path / "far.yaml").write_text(GRAPH)
    machines = Machines(tmp_path)
    try:
        machines.connect()
    except subprocess.CalledProcessError as error:
        machines.close()
        pytest.skip(f"network namespaces need CAP_NET_ADMIN: {error.stderr.strip()}")
    try:
        yield machines
    finally:
        machines.close()


def test_a_study_is_complete_though_machines_are_lost_and_come_back(machines: Machines) -> None:
    scheduler = machines.scheduler()
    workers = [machines.worker(address) for address in WORKERS]
    program = machines.run()
    machines.wait_for(program, lambda counts: counts["done"] > 10)
    workers[0].kill()
    machines.wait_for(program, lambda counts: counts["done"] > 25)
    workers[0] = machines.worker(WORKERS[0])
    machines.wait_for(program, lambda counts: counts["done"] > 40)
    scheduler.kill()
    out, errors = program.communicate()
    assert program.returncode == 2, out + errors
    assert f"the Dask cluster at {ADDRESS} is gone" in errors

    for worker in workers:
        worker.kill()
        worker.wait()
    scheduler.wait()
    machines.scheduler()
    machines.worker(WORKERS[0])
    again = machines.run()
    out, errors = again.communicate()
    assert again.returncode == 0, out + errors
    counts = json.loads((machines.folder / "out" / "run.json").read_text())["counts"]
    assert counts["stored"] > 20
    assert counts["failed"] == 0
    assert counts["done"] + counts["stored"] + counts["unneeded"] == 2 * COUNT + 1
    line = next(line for line in out.splitlines() if line.startswith("total "))
    sums = (np.random.default_rng(seed).normal(size=48_000).sum() for seed in range(COUNT))
    assert line.split()[1] == sum(map(float, sums), 0.0).hex()
    assert line.endswith(f"{sorted(map(machines.place, WORKERS))} False")
