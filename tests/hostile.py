"""Hostile files, kills, crowds and odd studies for hours: ``python -m tests.hostile --hours 2``.

Each round has a seed of its own and prints what it did; the first that fails ends the program with
its seed, and ``--seed`` begins there. The ordinary tests have short forms of all of it.
"""

from __future__ import annotations

import argparse
import faulthandler
import json
import os
import subprocess
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

from nodegraph import NodegraphError
from nodegraph.live.files import replay
from nodegraph.live.packet_file import PacketFileWriter
from nodegraph.plugin.formats import formats_of
from nodegraph.plugin.registry import Registry
from nodegraph_mocap.specimens import recordings
from nodegraph_xarray import to_xarray
from tests.plugins.nodegraph_files.test_hostile import damaged
from tests.plugins.nodegraph_live.test_packets import SOURCES, taken
from tests.test_answers import check_odd

ROOT = Path(__file__).parents[1]
EXECUTE = ROOT / "tests" / "nodegraph" / "execute"
GIB = 2**30
CROWD = 32
TEXTS = {
    "curves.ma": "//Maya ASCII 2017 scene\ncurrentUnit -l centimeter -t ntsc;\n"
    + "".join(
        f'createNode animCurveTL -n "c{axis}";\n\tsetAttr ".ktv[0:2]" 0 1 1 2.5 2 3;\n'
        f'connectAttr "c{axis}.o" "chin.t{axis}";\n'
        for axis in "xyz"
    ),
    "head.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n",
    "long.csv": "Timecode,BlendShapeCount,JawOpen\n00:00:00:01.000,1,0.25\n00:00:00:02.000,1,0.5\n",
    "openface.csv": "frame, timestamp, confidence, success, x_0, y_0, X_0, Y_0, Z_0\n"
    "1, 0.000, 0.98, 1, 640.0, 360.0, 1.5, -2.5, 500.1\n"
    "2, 0.033, 0.10, 0, 640.0, 360.0, 1.5, -2.5, 500.2\n"
    "3, 0.067, 0.98, 1, 640.5, 360.5, 1.6, -2.4, 500.3\n",
    "takes.mot": "\n".join(
        [
            "points",
            "version=1",
            "nRows=2",
            "nColumns=4",
            "Units=mm",
            "inDegrees=no",
            "endheader",
            "time\tlip_tx\tlip_ty\tlip_tz",
            "0\t100\t20\t3",
            "0.01\t101\t20\tnan",
        ]
    ),
}
"""Files of formats that nothing here writes."""
READERS = ("read.recording", "read.weights", "read.head", "read.model")
UNOPENED = {"vmc": "5000?rate=60"}
"""Addresses of sources that are not to be opened, where a number of a port is too little."""
SECONDS = 30
"""That reading a small file may take, however busy the machine is."""
Read = Callable[..., object]
KINDS = ("serial", "threads", "processes", "dask")
"""Executors of runs that are killed."""


def program(*words: object) -> subprocess.Popen[str]:
    """Start a Python program of this checkout."""
    path = os.pathsep.join([str(ROOT), str(ROOT / "plugins"), os.environ.get("PYTHONPATH", "")])
    return subprocess.Popen(
        [sys.executable, *map(str, words)],
        env={**os.environ, "PYTHONPATH": path},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def printed(started: subprocess.Popen[str]) -> dict[str, Any]:
    """Return the line of JSON that a program prints at its end."""
    out, errors = started.communicate()
    assert started.returncode == 0, f"exit status {started.returncode}: {errors[-2000:]}"
    return dict(json.loads(out.splitlines()[-1]))


def readers(seed: int, folder: Path) -> Counter[str]:
    """Read damaged files of every format, in a process with a limit on its memory."""
    return Counter(printed(program("-m", "tests.hostile", "--read", folder, "--seed", seed)))


def stores(seed: int, folder: Path) -> Counter[str]:
    """Read forged entries with valid checksums."""
    report = printed(program("-m", "tests.nodegraph.store.fuzz", folder, seed, 2000))
    assert report["megabytes"] < 300, report
    return Counter(report["counts"])


def kills(seed: int, folder: Path) -> Counter[str]:
    """Kill a run again and again, and compare the last with an undisturbed one."""
    kind = KINDS[seed % len(KINDS)]
    report = printed(program(EXECUTE / "killed.py", folder, seed, kind))
    assert report["same"], report
    assert not report["reported"], report
    return Counter({f"kills, {kind}": report["kills"]})


def crowd(seed: int, folder: Path) -> Counter[str]:
    """Have programs run one study on one store while another empties it, and one on its own."""
    folders = [folder / "alone", *[folder] * CROWD]
    runs = [program(EXECUTE / "killed.py", at, seed, "threads", "once") for at in folders]
    cleared = 0
    while any(run.poll() is None for run in runs):
        clear = ["-m", "nodegraph.cli.main", "cache", "clear", "--store", folder / "store"]
        assert program(*clear).wait() == 0
        cleared += 1
    totals = {printed(run)["total"] for run in runs}
    assert len(totals) == 1, totals
    return Counter({"runs in a crowd": CROWD, "stores emptied": cleared})


def nodes(seed: int, folder: Path) -> Counter[str]:
    """Run graphs with nodes that misbehave."""
    tests = ROOT / "tests" / "test_misbehaving_nodes.py"
    started = program("-m", "pytest", "-q", "-p", "no:cacheprovider", "--basetemp", folder, tests)
    out, _ = started.communicate()
    assert started.returncode == 0, out[-2000:]
    return Counter({"rounds of misbehaving nodes": 1})


def answers(seed: int, folder: Path) -> Counter[str]:
    """Compare what all places say of a study of an odd shape."""
    return Counter({"odd studies": 1, "of these, compared": int(check_odd(seed, folder))})


ROUNDS: tuple[Callable[[int, Path], Counter[str]], ...] = (
    *(readers, stores, kills, crowd, nodes, answers),
)


def replayed(path: Path) -> None:
    """Decode all packets of a file; one that is damaged is left out, as in a stream."""
    source = replay(f"{path}@0")
    header = source.open()
    while True:
        try:
            for packet in source.packets():
                with suppress(ValueError):
                    list(source.frames(packet, 0, header))
        except ConnectionResetError:
            source.open()
        else:
            return


def packet_files(folder: Path) -> Iterator[tuple[str, bytes]]:
    """Yield a file of recorded packets of each protocol."""
    for scheme in sorted(SOURCES):
        received = taken(scheme)
        path = folder / f"{scheme}.packets"
        file = PacketFileWriter(path, f"{scheme}:{UNOPENED.get(scheme, '5000')}")
        for packets in (received.packets[:4], received.packets[4:]):
            file.note_opening(received.header)
            for number, packet in enumerate(packets):
                file.write(packet, number)
        file.close()
        yield path.name, path.read_bytes()


def samples(registry: Registry, folder: Path) -> Iterator[tuple[str, str, Read, bytes]]:
    """Yield files of every kind: their names, what reads them, by name and itself, and contents."""
    for name, content in packet_files(folder):
        yield name, "replay", replayed, content
    specimens = {
        kind.type: next(iter(kind.specimens().values()))
        for kind in registry.hooks.having("specimens")
        if kind.specimens is not None
    }
    files = {name: text.encode() for name, text in TEXTS.items()}
    for writer in (each.node for each in registry if each.node.name.startswith("write.")):
        ports = [port for port in writer.inputs if not port.optional] or writer.inputs[:1]
        if not any(port.across for port in ports):
            files |= writer.function(*(specimens[port.type] for port in ports)).content
    recording = next(iter(recordings().values()))
    to_xarray(recording).to_netcdf(folder / "netcdf4.nc", engine="h5netcdf")
    files["netcdf4.nc"] = (folder / "netcdf4.nc").read_bytes()
    known = set()
    for reader in map(registry.find, READERS):
        for name, content in files.items():
            (folder / name).write_bytes(content)
            with suppress(ValueError):
                reader.node.function(path=folder / name)
                known.add(name)
                yield name, reader.node.name, reader.node.function, content
    unread = {"netcdf4.nc", *TEXTS} - known
    assert not unread, f"nothing reads {', '.join(sorted(unread))}"
    suffixes = {Path(name).suffix for name in known}
    for each in registry.hooks.formats:
        assert not suffixes.isdisjoint(each.suffixes), f"no file of the format {each.name}"


def read_damaged(folder: Path, seed: int, count: int = 2000) -> Counter[str]:
    """Read damaged files: each is a value, or a `ValueError` that names it."""
    import resource

    chance, counts = Random(seed), Counter[str]()
    warnings.simplefilter("ignore")
    registry = Registry.installed()
    files = list(samples(registry, folder))
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + GIB, used + GIB))
    for number in range(count):
        name, reader, read, content = chance.choice(files)
        path = folder / name
        path.write_bytes(damaged(content, chance))
        print(f"seed {seed}, file {number}: {reader} {name}", file=sys.stderr, flush=True)
        faulthandler.dump_traceback_later(SECONDS, exit=True)
        try:
            with formats_of(registry):
                read(path=path)
        except (NodegraphError, ValueError) as error:
            if path.name not in str(error):
                raise AssertionError(str(error)) from error
            counts[f"{reader} {name} refused"] += 1
        else:
            counts[f"{reader} {name} read"] += 1
    faulthandler.cancel_dump_traceback_later()
    return counts


def main() -> None:
    """Go through the rounds until the time is over."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hours", type=float, default=0.1)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--read", type=Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.read:
        print(json.dumps(read_damaged(arguments.read, arguments.seed)))
        return
    end = time.monotonic() + arguments.hours * 3600
    total: Counter[str] = Counter()
    seed = arguments.seed
    while time.monotonic() < end:
        for each in ROUNDS:
            with TemporaryDirectory(prefix="nodegraph-hostile-") as folder:
                try:
                    counts = each(seed, Path(folder))
                except AssertionError as error:
                    sys.exit(f"{each.__name__}, seed {seed}: {error}")
            total += counts
            print(f"seed {seed}, {each.__name__}: {json.dumps(counts)}", flush=True)
        seed += 1
    print(json.dumps(total, indent=2))


if __name__ == "__main__":
    main()
