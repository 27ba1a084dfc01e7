"""An hour of motion capture: makes its files, and tells how much memory a process takes with them.

Each is a process of its own (``python -m tests.benchmarks.hour make FOLDER``), because memory that
a process once had is never told apart from what it has later.
"""

from __future__ import annotations

import sys
import warnings
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

RATE, MARKERS = 120, 100
FRAMES = 3600 * RATE
TENTH = FRAMES // 10
CHAINS = {
    "read": (),
    "read, fill": ("fill.linear",),
    "read, fill, smooth": ("fill.linear", "smooth.bspline"),
    "read, fill, smooth, score": ("fill.linear", "smooth.bspline", "score.roughness"),
    "read, fill, despike, smooth": ("fill.linear", "despike.impulse", "smooth.bspline"),
}


def make(folder: Path) -> None:
    """Write an hour, and a tenth of it, as C3D, and the hour as NPZ."""
    from nodegraph_files import write_c3d
    from nodegraph_mocap import Trajectories

    time = np.arange(FRAMES) / RATE
    positions = np.empty((FRAMES, MARKERS, 3))
    for marker in range(MARKERS):
        for axis in range(3):
            speed = 1 + marker / 100
            positions[:, marker, axis] = 1000 + marker + 100 * np.sin(speed * time + axis)
        # gaps of 20 frames, 5 % in all
        positions[(np.arange(FRAMES) + 7 * marker) % 400 < 20, marker] = np.nan
    markers = tuple(f"m{number}" for number in range(MARKERS))
    hour = Trajectories(positions=positions, markers=markers, rate=RATE)
    write_c3d(hour, folder / "hour.c3d")
    np.savez(folder / "hour.npz", positions=positions, markers=np.array(markers), rate=float(RATE))
    tenth = Trajectories(positions=positions[:TENTH], markers=markers, rate=RATE)
    write_c3d(tenth, folder / "tenth.c3d")


def run(path: Path, chain: str, stored: bool) -> None:
    """Run a chain of nodes on a recording, its results stored or not."""
    import nodegraph

    reading = f"{{use: read.recording, with: {{path: {path}}}}}"
    lines = ["nodegraph: 1", "nodes:", f"  n0: {reading}"]
    lines += [
        f"  n{at}: {{use: {name}, in: n{at - 1}}}" for at, name in enumerate(CHAINS[chain], 1)
    ]
    with TemporaryDirectory(dir=path.parent) as folder:
        graph = Path(folder) / "hour.yaml"
        graph.write_text("\n".join([*lines, ""]))
        store = Path(folder) / "store"
        done = nodegraph.run(graph, executor="serial", cache=stored, store=store)
        assert done.counts()["done"] == len(CHAINS[chain]) + 1


def read(path: Path, library: str) -> object:
    """Read a recording by a library, or by ours."""
    if library == "ezc3d":
        import ezc3d

        return ezc3d.c3d(str(path))["data"]["points"]
    if library == "py-c3d":
        import c3d

        with path.open("rb") as stream:
            return np.array([points for _, points, _ in c3d.Reader(stream).read_frames()])
    if library == "numpy.load":
        with np.load(path) as archive:
            return archive["positions"]
    from nodegraph_files.readers import read_recording

    return read_recording(path=path)


def peak() -> int:
    """Return the most memory that this process had, in bytes."""
    import resource

    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most if sys.platform == "darwin" else most * 1024


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    what, file, *more = sys.argv[1:]
    if what == "make":
        make(Path(file))
    elif what == "read":
        kept = read(Path(file), more[0])
    else:
        run(Path(file), more[0], more[1] == "stored")
    print(peak())
