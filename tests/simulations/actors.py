"""Whether what is said of actors holds for other actors, and what is said of a take for others.

``python -m tests.simulations.actors made`` splits twenty made actors into ten that are judged by
and ten others; ``recordings FILE ...`` asks how often what three draws of gaps in a recording say
holds in that recording, and in the others; ``studies`` runs graphs/fill.yaml, with ends as
published, on its eight faces and on eight others, and fails if the two contradict each other.
"""

from __future__ import annotations

import math
import sys
import tempfile
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from pandas import DataFrame

import nodegraph
from nodegraph import Across, Label
from nodegraph_compare.inference import LEVEL, mean_interval
from nodegraph_compare.table.node import table

Numbers = NDArray[np.float64]

FILLS: Final = ("linear", "muscle", "waters", "pchip")
"""Those that are compared to the first."""
LENGTH: Final = 10
"""Frames of a gap."""
SPLITS: Final = 400
STUDIES, DRAWS, GAPS = 20, 3, 14
"""Studies of a recording, draws of gaps in each, and gaps in a draw."""
GRAPH: Final = Path(__file__).parents[2] / "graphs" / "fill.yaml"
ACTORS: Final = range(101, 109)
"""Seeds of faces that are not samples."""


def scores(captured: object, truth: object, count: int, seed: int) -> DataFrame:
    """Return the error of each fill in gaps of a recording."""
    cut, score = nodegraph.get_node("gaps.cut"), nodegraph.get_node("score.gaps")
    gaps: Any = cut(captured, truth=truth, length=LENGTH, count=count, seed=seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of gaps that are left
        tables = [
            score(nodegraph.get_node(f"fill.{name}")(gaps.gappy), gaps.truth, gaps.hidden)
            for name in FILLS
        ]
    errors = {name: table["rmse"] for name, table in zip(FILLS, tables, strict=True)}
    return DataFrame(errors).dropna()


def synthetic(count: int = 20) -> Mapping[str, float]:
    """Return how often the mean log ratio of ten made actors lies in the interval from ten others.

    A 95 % interval is for the mean over all actors; the mean over ten others varies as much as
    the one that it is held against, so that it falls into the interval in about 86 % of splits,
    and in 95 % into one that is sqrt(2) times as wide.
    """
    face = nodegraph.get_node("synthesize.face")
    means = np.empty((count, len(FILLS)))
    for seed in range(count):
        of_seed: Any = face(seconds=4, rate=30, markers=20, impulses=0, seed=seed)
        means[seed] = scores(of_seed.captured, of_seed.truth, 20, seed)[[*FILLS]].mean()
    d = _to_first(means)
    random = np.random.default_rng(1)
    inside, wide = [], []
    for _ in range(SPLITS):
        order = random.permutation(count)
        low, high = mean_interval(d[order[: count // 2]])
        other = d[order[count // 2 :]].mean(axis=0)
        half, middle = (high - low) / 2, (low + high) / 2
        inside.append((np.abs(other - middle) <= half).mean())
        wide.append((np.abs(other - middle) <= math.sqrt(2) * half).mean())
    return {"interval": float(np.mean(inside)), "sqrt(2) wider": float(np.mean(wide))}


def recordings(paths: Sequence[str]) -> Mapping[str, float]:
    """Return how often intervals from three draws of gaps hold the ratio in it and in others.

    Of each recording there are twenty studies. The ratio of the recording is that over the gaps of
    all other studies, so that it hardly varies.
    """
    read = nodegraph.get_node("read.recording")
    studies: list[list[list[DataFrame]]] = []
    for path in paths:
        recording = read(path=path)
        drawn = [scores(recording, None, GAPS, seed) for seed in range(DRAWS * STUDIES)]
        studies.append([drawn[at * DRAWS : (at + 1) * DRAWS] for at in range(STUDIES)])
    inside: dict[str, list[bool]] = {}
    for own, of_own in enumerate(studies):
        for at, study in enumerate(of_own):
            interval = _of_recording(study)
            if interval is None:
                inside.setdefault("silent", []).append(True)
                continue
            inside.setdefault("silent", []).append(False)
            for other, of_other in enumerate(studies):
                rest = [
                    each
                    for place, other_study in enumerate(of_other)
                    for each in other_study
                    if (other, place) != (own, at)
                ]
                means = np.array([np.mean([each[name].mean() for each in rest]) for name in FILLS])
                target = _to_first(means[np.newaxis])[0]
                holds = (interval[0] <= target) & (target <= interval[1])
                name = "its own recording" if other == own else "another recording"
                inside.setdefault(name, []).extend(holds.tolist())
    return {name: float(np.mean(holds)) for name, holds in inside.items()}


def _to_first(means: Numbers) -> Numbers:
    return np.asarray(np.log(means[:, 1:]) - np.log(means[:, :1]))


def _of_recording(draws: Sequence[DataFrame]) -> tuple[Numbers, Numbers] | None:
    """Return what compare.table says of some draws of gaps in one recording; None if nothing."""
    entries: list[tuple[dict[str, Label], DataFrame]] = [
        ({"draw": draw, "fill": name}, DataFrame({"gap": range(len(each)), "rmse": each[name]}))
        for draw, each in enumerate(draws)
        for name in FILLS
    ]
    scores = Across(("draw", "fill"), tuple(entries), sources=())
    compared = table(scores, metric="rmse", baseline=FILLS[0], blocks=("draw", "gap"))
    paired = compared.overview.verdicts.groups[0].to_baseline
    return None if paired is None else (np.log(paired.low[1:]), np.log(paired.high[1:]))


def studies() -> bool:
    """Print what two disjoint sets of faces say of the fills; return whether they contradict."""
    only = {"condition": "own_noise", "terms": "ends_met"}
    with tempfile.TemporaryDirectory() as folder:
        faces = {f"made_{seed}": str(_saved(seed, Path(folder))) for seed in ACTORS}
        tables = [
            nodegraph.run(GRAPH, until=["table"], only=only, axis=axis)["table.table"].value
            for axis in (None, {"recording": faces})
        ]
    contradicts = False
    for length in tables[0]["length"].unique():
        known = [_verdict(table[table["length"] == length]) for table in tables]
        (first, tied), (second, also) = known
        bad = not (second in {first, *tied} and first in {second, *also})
        contradicts |= bad
        word = "same" if first == second else "contradiction" if bad else "cannot be told"
        print(f"{length} frames: {word}; {first} or {tied}; {second} or {also}", flush=True)
    return contradicts


def _verdict(rows: DataFrame) -> tuple[str, list[str]]:
    """Return the method with the best mean, and those that are not clearly behind."""
    best = rows["fill"].iloc[0]
    return best, rows["fill"].iloc[1:][~(rows["p"].iloc[1:] <= LEVEL)].tolist()


def _saved(seed: int, folder: Path) -> Path:
    """Return the folder of a face that is damaged as the samples are."""
    face: Any = nodegraph.get_node("synthesize.face")(seconds=8, seed=seed)
    at = folder / str(seed)
    at.mkdir()
    for name, recording in (("recording", face.captured), ("truth", face.truth)):
        files: Any = nodegraph.get_node("write.npz")(recording, name=name)
        for file, content in files.content.items():
            (at / file).write_bytes(content)
    return at


COMMANDS: Final[Mapping[str, Callable[[list[str]], bool]]] = {
    "made": lambda _: _print("ten made actors by ten others", synthetic()),
    "recordings": lambda paths: _print("three draws of gaps in a recording", recordings(paths)),
    "studies": lambda _: studies(),
}


def _print(what: str, rates: Mapping[str, float]) -> bool:
    print(f"{what}: {', '.join(f'{name} {rate:.3f}' for name, rate in rates.items())}", flush=True)
    return False


if __name__ == "__main__":
    sys.exit(COMMANDS[sys.argv[1]](sys.argv[2:]))
