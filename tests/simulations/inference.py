"""Simulated studies, each judged by compare.table (compare.bayes): how often it errs, and says so.

``python -m tests.simulations.inference [CELL ...] [--studies N]`` prints, for each cell, what was
found; it fails where a rate is out of its bounds. Without cells it takes all, with 600 studies
each, which takes an hour of one core; ``--quick`` takes those that the tests run. A study of
several actors draws errors of methods around means that are known; one of a recording draws gaps
in a process whose mean is known. What holds across made actors and recordings:
`tests.simulations.actors`.
"""

from __future__ import annotations

import argparse
import math
import sys
import warnings
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from pandas import DataFrame
from scipy.signal import lfilter

from nodegraph import Across
from nodegraph_compare.bayes.node import bayes
from nodegraph_compare.table.node import table
from nodegraph_compare.verdict import Verdict
from nodegraph_tables import TableInfo, Take, with_info

Numbers = NDArray[np.float64]
Rates = Mapping[str, float]
Bounds = Mapping[str, tuple[float, float]]

STUDIES: Final = 600
AT_ONCE: Final = 100
"""Studies in a call: the groups of one table."""
BLOCKS: Final = 40


@dataclass(frozen=True)
class Cell:
    """A kind of study.

    Attributes
    ----------
    simulate
        Returns the rates found in so many studies.
    bounds : mapping of str to (float, float)
        Between which a rate may lie, apart from the noise of so many studies.
    """

    simulate: Callable[[int], Rates]
    bounds: Bounds


def random_of(name: str) -> np.random.Generator:
    """Return the generator of a cell."""
    return np.random.default_rng(zlib.crc32(name.encode()))


def parts(studies: int) -> Iterator[int]:
    """Return the numbers of studies of the calls."""
    for start in range(0, studies, AT_ONCE):
        yield min(AT_ONCE, studies - start)


def tables(values: Numbers, take: Take | None = None, **columns: NDArray[Any]) -> Across[DataFrame]:
    """Return a table per method of (S, N, K) values, N rows in each of S studies.

    Parameters
    ----------
    values
        The errors.
    take
        The recording that they are of.
    columns
        (N,) or (S, N), what else the rows hold.
    """
    studies, rows, methods = values.shape
    shape = (studies, rows)
    common = {"study": np.repeat(np.arange(studies), rows)}
    common |= {name: np.broadcast_to(each, shape).ravel() for name, each in columns.items()}
    info = TableInfo(take=take)
    return Across.of(
        {
            f"method {at}": with_info(DataFrame(common | {"error": values[..., at].ravel()}), info)
            for at in range(methods)
        },
        axis="method",
    )


def verdicts(scores: Across[Any], *blocks: str, **settings: Any) -> Sequence[Verdict]:
    """Return what compare.table says of each study."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result = table(
            scores, metric="error", compare="method", within=("study",), blocks=blocks, **settings
        )
    return result.overview.verdicts.groups


def over_actors(values: Numbers, sizes: NDArray[np.intp] | None = None) -> Sequence[Verdict]:
    """Return what compare.table says of (S, C, K) errors, or (S, N, K) with `sizes` per actor."""
    sizes = np.ones(values.shape[1], dtype=np.intp) if sizes is None else sizes
    scores = tables(
        values,
        actor=np.repeat(np.arange(len(sizes)), sizes),
        gap=np.concatenate([np.arange(size) for size in sizes]),
    )
    return verdicts(scores, "gap", clusters=("actor",))


def noise(random: np.random.Generator, kind: str, shape: tuple[int, ...]) -> Numbers:
    """Return noise of mean 0 and variance 1: normal, or log-normal (``ln1.5``) and centred."""
    if kind == "normal":
        return random.standard_normal(shape)
    variance = float(kind[2:]) ** 2
    drawn = np.exp(math.sqrt(variance) * random.standard_normal(shape))
    scale = math.sqrt((math.exp(variance) - 1) * math.exp(variance))
    return np.asarray((drawn - math.exp(variance / 2)) / scale)


def covers(group: Verdict, difference: float) -> bool:
    """Whether the interval of the difference of two methods holds a number, 1 minus 0."""
    paired = group.to_best
    assert paired is not None
    scale = np.log if group.ratio else np.asarray
    other = 1 - paired.reference
    low, high = sorted(float(scale(each[other])) for each in (paired.low, paired.high))
    true = difference if other == 1 else -difference
    return low <= true <= high


# several actors


def two(clusters: int, kind: str, spread: float, size: str, effect: str, *, studies: int) -> Rates:
    """Coverage of the mean difference of two methods.

    Parameters
    ----------
    clusters, kind, size
        Number of actors, noise of blocks, 40 blocks (``equal``) or from 5 to 400 of each.
    spread
        Standard deviation of the actors over the standard error of a mean of 40 blocks.
    effect
        Distribution of the actors.
    studies
        How many.
    """
    random = random_of(f"two {clusters} {kind} {spread} {size} {effect}")
    n = np.full(clusters, BLOCKS)
    if size == "unequal":
        n = np.round(np.exp(np.linspace(math.log(5), math.log(400), clusters))).astype(np.intp)
    found = []
    for count in parts(studies):
        d = noise(random, kind, (count, int(n.sum())))
        shift = spread / math.sqrt(BLOCKS) * noise(random, effect, (count, clusters))
        d += np.repeat(shift, n, axis=1)
        found += [covers(group, 0.0) for group in over_actors(np.stack([-d / 2, d / 2], 2), n)]
    return {"coverage": float(np.mean(found))}


def drawn(
    random: np.random.Generator,
    scene: str,
    shape: tuple[int, int, int],
    behind: float,
    skewed: bool,
) -> tuple[Numbers, Numbers]:
    """Return (S, C, K) logarithms of errors, and (K,) their means."""
    methods = shape[2]
    sd, mean, half = np.ones(methods), np.zeros(methods), (methods + 1) // 2
    tied = np.arange(methods) < half
    if scene == "unequal":
        sd = np.exp(np.linspace(math.log(0.3), math.log(5), methods))
    elif scene == "half far, tied ones noisy":
        sd, mean = np.where(tied, 3.0, 0.0), np.where(tied, 0.0, 16.0)
    elif scene == "half far, tied ones quiet":
        sd, mean = np.where(tied, 0.0, 3.0), np.where(tied, 0.0, 16.0)
    elif scene == "half near":
        sd, mean = np.where(tied, 3.0, 1.0), np.where(tied, 0.0, 5.0)
    elif scene == "ladder":
        sd = np.linspace(2, 0.5, methods)
        mean = np.concatenate([np.zeros(half), 2 * np.linspace(1, 6, methods - half)])
    elif scene.endswith("distant"):
        last = int(scene.split()[0])
        sd[-last:], mean[-last:] = 5.0, 30.0
    mean[1] += behind * 2.0  # the sd of a difference of two methods of sd 1 over a noise of 1 is 2
    effect = random.standard_normal(shape)
    if skewed:
        effect = (np.exp(effect) - math.exp(0.5)) / math.sqrt((math.e - 1) * math.e)
    return random.standard_normal(shape) + sd * effect + mean, mean


def many(
    scene: str, clusters: int, methods: int, behind: float, skewed: bool, *, studies: int
) -> Rates:
    """How often methods are called behind: one that ties with the best, and one that does not.

    Parameters
    ----------
    scene
        Which methods are far, and how they vary.
    clusters, methods
        How many.
    behind
        By how many standard deviations of its paired differences one method is.
    skewed
        Whether actors differ by a skewed distribution.
    studies
        How many.
    """
    random = random_of(f"many {scene} {clusters} {methods} {behind} {skewed}")
    counts = np.zeros(3)
    for count in parts(studies):
        y, mean = drawn(random, scene, (count, clusters, methods), behind, skewed)
        # errors are ratios: a unit of these logarithms is a tenth
        for group in over_actors(np.exp(y / 10)):
            paired, (best, *_) = group.to_best, group.best
            assert paired is not None
            apart = {*group.worse_than_best}
            wrong = any(mean[at] == mean.min() for at in apart)
            truth = np.delete(np.exp((mean - mean[best]) / 10), best)
            low, high = np.delete(paired.low, best), np.delete(paired.high, best)
            inside = ((low <= truth) & (truth <= high)).all()
            counts += np.array([wrong, 1 in apart, inside], dtype=np.float64)
    error, power, coverage = counts / studies
    return {"error": error, "power": power, "coverage": coverage}


def of_spread(scenario: str, clusters: int, methods: int, kind: str, *, studies: int) -> Rates:
    """How often any method that is as good as the best is called behind; or power.

    Parameters
    ----------
    scenario
        ``null_r1``: actors differ by method as much as a mean of 40 blocks does; ``het_x``: from
        0.3 to 5 times that; ``het_skew``: from 0 to 3 times, skewed; ``power2``: one method is
        better than all others by two standard deviations of an actor's difference.
    clusters, methods, kind
        Numbers of them, and the noise of blocks.
    studies
        How many.
    """
    random = random_of(f"multi {scenario} {clusters} {methods} {kind}")
    spreads = {
        "het_x": np.exp(np.linspace(math.log(0.3), math.log(5), methods)),
        "het_skew": np.linspace(0, 3, methods),
    }
    spread = spreads.get(scenario, np.ones(methods))
    mean = np.zeros(methods)
    if scenario.startswith("power"):
        mean[1:] = float(scenario[5:]) * math.sqrt(4 / BLOCKS)
    found = []
    for count in parts(studies):
        shape = (count, clusters, methods)
        effect = noise(random, "ln1.0" if scenario == "het_skew" else "normal", shape)
        y = mean + spread / math.sqrt(BLOCKS) * effect
        y += noise(random, kind, (count, clusters, BLOCKS, methods)).mean(axis=2)
        for group in over_actors(y):
            behind = group.worse_than_best
            if not scenario.startswith("power"):
                found.append(float(len(behind) > 0))
            elif group.best == (0,):
                found.append(len(behind) / (methods - 1))
    return {"power" if scenario.startswith("power") else "error": float(np.mean(found))}


def unequal_tails(clusters: int, spread: float, *, studies: int) -> Rates:
    """Coverage for two methods of equal mean error whose blocks have unequal tails."""
    random = random_of("unequal tails")
    found = []
    for count in parts(studies):
        shape = (count, clusters, BLOCKS)
        base = 0.4 * random.standard_normal((*shape[:2], 1)) + random.standard_normal(shape)
        logs = []
        for scale, shift in ((0.8, 0.0), (1.2, (0.8**2 - 1.2**2) / 2)):
            effect = spread * random.standard_normal((*shape[:2], 1))
            logs.append(base + shift + effect + scale * random.standard_normal(shape))
        errors = np.exp(np.stack(logs, 3)).reshape(count, -1, 2)
        groups = over_actors(errors, np.full(clusters, BLOCKS))
        found += [covers(group, 0.0) for group in groups]
    return {"coverage": float(np.mean(found))}


def alone(clusters: int, spread: float, *, studies: int) -> Rates:
    """Coverage of the number of one method: the mean error of a typical actor."""
    random = random_of("alone")
    found = []
    for count in parts(studies):
        shape = (count, clusters, BLOCKS)
        actors = spread * random.standard_normal((*shape[:2], 1))
        errors = np.exp(random.standard_normal(shape) + actors).reshape(count, -1, 1)
        for group in over_actors(errors, np.full(clusters, BLOCKS)):
            found.append(group.low[0] <= math.exp(0.5) <= group.high[0])
    return {"coverage": float(np.mean(found))}


def beliefs(clusters: int, kind: str, *, studies: int) -> Rates:
    """How often compare.bayes calls a difference at the edge of the margin equivalent."""
    random = random_of("bayes")
    margin, found = 0.15, []
    for count in parts(studies):
        d = noise(random, kind, (count, clusters, BLOCKS)) + margin
        spread = random.choice([0.0, 1.0, 3.0], (count, 1, 1)) / math.sqrt(BLOCKS)
        d = (d + spread * random.standard_normal((count, clusters, 1))).reshape(count, -1)
        scores = tables(
            np.stack([-d / 2, d / 2], 2),
            actor=np.repeat(np.arange(clusters), BLOCKS),
            gap=np.tile(np.arange(BLOCKS), clusters),
        )
        units = {name: with_info(each, TableInfo(units={"error": "mm"})) for name, each in zip(
            scores.labels("method"), scores.values(), strict=True)}  # fmt: skip
        frame = bayes(
            Across.of(units, axis="method"), metric="error", compare="method", within=("study",),
            blocks=("gap",), clusters=("actor",), baseline="method 0", equivalent=f"{margin} mm",
        ).table  # fmt: skip
        found += (frame["equivalent"] >= 0.95).tolist()
    return {"equivalent": float(np.mean(found))}


# one recording


def processes(
    random: np.random.Generator, studies: int, count: int, frames: int, time: float
) -> Numbers:
    """Return (count, S, T) autoregressive processes of variance 1."""
    phi = math.exp(-1 / time)
    drive = random.standard_normal((count, studies, frames))
    drive[..., 1:] *= math.sqrt(1 - phi * phi)
    return np.asarray(lfilter([1.0], [1.0, -phi], drive, axis=-1))


def in_one_recording(
    frames: int, segments: int, gaps: int, sds: tuple[float, float], *, studies: int
) -> Rates:
    """Coverage of the ratio of two methods' mean errors in a process, by segments of time.

    The process has a correlation time of 40 frames. Which number of segments it is judged by is
    set by what the table says of the recording; where it leaves a segment empty, nothing is said.
    """
    random = random_of(f"one recording {frames} {segments} {gaps} {sds}")
    truth = 0.98 * (sds[1] ** 2 - sds[0] ** 2) / 2
    found, silent = [], 0
    take = Take(frames, correlation=0.5 * (frames / {10: 100, 6: 36}[segments] - 1.0))
    for count in parts(studies):
        at, values = _gaps(random, count, frames, gaps, sds)
        scores = tables(values, take, gap=np.arange(gaps), start=at, frames=np.ones(gaps))
        for group in verdicts(scores, "gap"):
            if group.scope.kind == "segments" and group.scope.units == segments:
                found.append(covers(group, truth))
            else:
                silent += 1
    return {"coverage": float(np.mean(found)), "left out": silent / studies}


def _gaps(
    random: np.random.Generator, count: int, frames: int, gaps: int, sds: Sequence[float]
) -> tuple[NDArray[np.intp], Numbers]:
    """Return (S, G) when gaps are, and (S, G, K) the errors of methods in them."""
    shared, *own = processes(random, count, 1 + len(sds), frames, 40.0)
    at = random.integers(0, frames, (count, gaps))
    row = np.arange(count)[:, np.newaxis]
    base = 0.8 * shared[row, at] + 0.6 * random.standard_normal((count, gaps))
    logs = [
        base + 0.7 * sd * (mine[row, at] + random.standard_normal((count, gaps)))
        for sd, mine in zip(sds, own, strict=True)
    ]
    return at, np.exp(np.stack(logs, 2))


def of_draws(draws: int, gaps: int, methods: int, *, studies: int) -> Rates:
    """Coverage over further gaps in one recording, by repetitions; errors, and how often silent.

    Of two methods the coverage of their ratio in this recording; of more, all of which are equal
    in it, how often any is called behind.
    """
    random = random_of(f"draws {draws} {gaps} {methods}")
    found, silent, frames = [], 0, 1600
    sds = (1.2, *[0.5] * (methods - 1)) if methods == 2 else [0.8] * methods
    for count in parts(studies):
        shared, *own = processes(random, count, 1 + methods, frames, 40.0)
        if methods > 2:
            own = [own[0]] * methods  # one mean in this recording, and errors that are not the same
        logs = [0.8 * shared + 0.7 * sd * mine for sd, mine in zip(sds, own, strict=True)]
        means = [np.exp(each).mean(axis=1) for each in logs]  # of each recording
        truth = np.log(means[1] / means[0]) + 0.245 * (sds[1] ** 2 - sds[0] ** 2)
        at = random.integers(0, frames, (count, draws * gaps))
        row = np.arange(count)[:, np.newaxis]
        common = 0.6 * random.standard_normal(at.shape)
        values = np.exp(np.stack([
            each[row, at] + common + 0.7 * sd * random.standard_normal(at.shape)
            for each, sd in zip(logs, sds, strict=True)
        ], 2))  # fmt: skip
        scores = _with_draws(values, draws, gaps)
        for group, true in zip(verdicts(scores, "draw", "gap"), truth, strict=True):
            silent += not group.judged
            wrong = float(len(group.worse_than_best) > 0)
            found.append(float(covers(group, true)) if methods == 2 else wrong)
    name = "coverage" if methods == 2 else "error"
    return {name: float(np.mean(found)), "silent": silent / studies}


def _with_draws(values: Numbers, draws: int, gaps: int) -> Across[Any]:
    """Return tables over a gathered axis of draws, as repetitions on the same data are."""
    entries = [
        ({"draw": draw, "method": labels["method"]}, part)
        for draw in range(draws)
        for labels, part in tables(values[:, draw * gaps : (draw + 1) * gaps], gap=np.arange(gaps))
    ]
    return Across(("draw", "method"), tuple(entries), sources=())


NOISE: Final = 2.6
"""Standard errors of a rate by which it may be beyond its bounds."""

_TWO: Final = {
    (5, "normal", 1.0, "equal", "normal"): 0.956,
    (5, "normal", 3.0, "unequal", "normal"): 0.951,
    (8, "ln1.5", 0.0, "unequal", "normal"): 0.919,
    (5, "ln1.5", 3.0, "equal", "ln1.0"): 0.864,
}
_SPREAD: Final = {
    ("null_r1", 5, 6, "normal"): ("error", 0.040),
    ("null_r1", 5, 17, "normal"): ("error", 0.039),
    ("het_x", 8, 17, "normal"): ("error", 0.063),
    ("het_skew", 12, 17, "ln1.5"): ("error", 0.013),
    ("power2", 5, 17, "normal"): ("power", 0.678),
}
_SCENES: Final = (
    "equal", "unequal", "half far, tied ones noisy", "half far, tied ones quiet", "half near",
    "ladder",
)  # fmt: skip


def _near(rate: float) -> tuple[float, float]:
    return rate - 0.02, rate + 0.02


def cells() -> dict[str, Cell]:
    """Return every kind of study by its name."""
    made: dict[str, Cell] = {}

    def add(name: str, simulate: Callable[..., Rates], *of: object, **bounds: object) -> None:
        limits: Any = bounds
        made[name] = Cell(lambda studies: partial(simulate, *of)(studies=studies), limits)

    for two_of, rate in _TWO.items():
        add(f"two methods, {two_of}", two, *two_of, coverage=_near(rate))
    for spread_of, (what, rate) in _SPREAD.items():
        limits = (0.0, rate + 0.02) if what == "error" else (rate - 0.02, 1.0)
        add(f"methods of one mean, {spread_of}", of_spread, *spread_of, **{what: limits})
    add("unequal tails, 12 actors", unequal_tails, 12, 0.1, coverage=_near(0.940))
    add("one method, 5 actors", alone, 5, 1.0, coverage=_near(0.949))
    add("probabilities, 12 actors", beliefs, 12, "ln1.5", equivalent=_near(0.063))
    for clusters, methods in product((5, 8, 12), (6, 17)):
        for scene, behind, skewed in (
            *((scene, 0.0, False) for scene in _SCENES),
            *((scene, 0.0, True) for scene in ("unequal", "half near", "ladder")),
            *((scene, 1.0, False) for scene in ("equal", "1 distant", "3 distant")),
        ):
            name = (
                f"{scene}{', skewed' * skewed}, {clusters} actors, {methods} methods"
                f"{', power' * (behind > 0)}"
            )
            error = (0.0, 0.09 if scene == "unequal" else 0.07)
            bounds = {"error": error, "coverage": (0.91, 1.0)}
            add(name, many, scene, clusters, methods, behind, skewed, **bounds)
    for (frames, segments), gaps, sds in product(
        ((4000, 10), (2000, 6)), (40, 100, 400), ((0.5, 0.5), (1.2, 0.5))
    ):
        name = f"next minutes, {segments} segments, {gaps} gaps, tails {sds[0]} and {sds[1]}"
        add(name, in_one_recording, frames, segments, gaps, sds, coverage=(0.89, 1.0))
    for draws in (3, 5, 10):
        for gaps in (20, 100):
            name = f"further gaps, {draws} draws of {gaps} gaps"
            add(name, of_draws, draws, gaps, 2, coverage=(0.93, 1.0), silent=(0.0, 0.0))
        for methods in (6, 17):
            name = f"further gaps, {draws} draws of 40 gaps, {methods} methods"
            add(name, of_draws, draws, 40, methods, error=(0.0, 0.07), silent=(0.0, 0.0))
    return made


CELLS: Final = cells()
QUICK: Final = {
    "one method, 5 actors": 100,
    "1 distant, 5 actors, 6 methods, power": 100,
    "unequal, 5 actors, 6 methods": 100,
    "next minutes, 6 segments, 100 gaps, tails 1.2 and 0.5": 100,
    "further gaps, 3 draws of 20 gaps": 100,
}
"""Cells that the tests run, with so many studies."""


def beyond(name: str, studies: int) -> tuple[Rates, list[str]]:
    """Return the rates of a cell, and those that are out of their bounds by more than noise."""
    cell = CELLS[name]
    rates = cell.simulate(studies)
    off = []
    for rate, (low, high) in cell.bounds.items():
        share = min(max(rates[rate], 0.02), 0.98)
        slack = NOISE * math.sqrt(share * (1 - share) / studies)
        if not low - slack * (low > 0) <= rates[rate] <= high + slack * (high > 0):
            off.append(rate)
    return rates, off


def main(words: list[str]) -> int:
    """Simulate the cells named, or all; return how many are off."""
    parser = argparse.ArgumentParser()
    parser.add_argument("cells", nargs="*")
    parser.add_argument("--studies", type=int, default=STUDIES)
    parser.add_argument("--quick", action="store_true")
    given = parser.parse_args(words)
    names = list(QUICK) if given.quick else given.cells or list(CELLS)
    bad = 0
    for name in names:
        rates, off = beyond(name, given.studies)
        texts = ", ".join(f"{rate} {value:.3f}" for rate, value in rates.items())
        bad += bool(off)
        print(f"{'OFF ' if off else ''}{name}: {texts}", flush=True)
    return bad


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
