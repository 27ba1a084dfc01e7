"""Simulated studies of the inference of compare.table and compare.bayes, and of rivals to it.

``python -m tests.simulations.inference [CELL ...]`` prints, for each cell, the rates that were
expected and those found; it fails where one is off by more than 0.02. ``--quick`` takes the cells
that the tests run. What holds across made actors and recordings: `tests.simulations.actors`.
"""

from __future__ import annotations

import math
import sys
import zlib
from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.signal import lfilter

from nodegraph_compare.blocks import Group
from nodegraph_compare.inference import (
    contrasts,
    mean_interval,
    posterior,
    range_quantile,
    student,
)
from nodegraph_compare.units import units_of

Numbers = NDArray[np.float64]
Rates = Mapping[str, float]

TOLERANCE: Final = 0.02
BLOCKS: Final = 40


def random_of(name: str) -> np.random.Generator:
    """Return the generator of a cell."""
    return np.random.default_rng(zlib.crc32(name.encode()))


def sizes(kind: str, clusters: int) -> NDArray[np.intp]:
    """Return the number of blocks of each cluster: 40, or from 5 to 400."""
    if kind == "equal":
        return np.full(clusters, BLOCKS)
    unequal = np.exp(np.linspace(math.log(5), math.log(400), clusters))
    return np.round(unequal).astype(np.intp)


def noise(random: np.random.Generator, kind: str, shape: tuple[int, ...]) -> Numbers:
    """Return noise of mean 0 and variance 1: normal, or log-normal (``ln1.5``) and centred."""
    if kind == "normal":
        return random.standard_normal(shape)
    variance = float(kind[2:]) ** 2
    drawn = np.exp(math.sqrt(variance) * random.standard_normal(shape))
    scale = math.sqrt((math.exp(variance) - 1) * math.exp(variance))
    return np.asarray((drawn - math.exp(variance / 2)) / scale)


def cluster_means(values: Numbers, n: NDArray[np.intp]) -> Numbers:
    """Return the means of consecutive blocks, n of each cluster, along axis 1."""
    starts = np.concatenate([[0], np.cumsum(n)[:-1]])
    shape = (1, -1) + (1,) * (values.ndim - 2)
    return np.asarray(np.add.reduceat(values, starts, axis=1) / n.reshape(shape))


def covers(interval: tuple[Numbers, Numbers], target: float = 0.0) -> float:
    """Return the share of intervals that hold the target."""
    low, high = interval
    return float(((low <= target) & (target <= high)).mean())


def t_covers(y: Numbers, target: float = 0.0) -> float:
    """Return the share of studies, (R, C), whose t interval holds the target."""
    return covers(mean_interval(y[..., np.newaxis]), target)


def two(
    clusters: int, kind: str, spread: float, size: str, effect: str = "normal", studies: int = 4000
) -> Rates:
    """Coverage of the mean difference of two methods.

    Parameters
    ----------
    clusters, kind, size
        Number of clusters, noise of blocks, blocks per cluster.
    spread
        Standard deviation of the clusters over the standard error of a mean of 40 blocks.
    effect
        Distribution of the clusters.
    studies
        How many.
    """
    random = random_of(f"two {clusters} {kind} {spread} {size} {effect}")
    n = sizes(size, clusters)
    d = noise(random, kind, (studies, int(n.sum())))
    shift = spread / math.sqrt(BLOCKS) * noise(random, effect, (studies, clusters))
    d += np.repeat(shift, n, axis=1)
    y = cluster_means(d, n)
    pooled = d.mean(axis=1)
    reach = student(0.975, len(d[0]) - 1) * d.std(axis=1, ddof=1) / math.sqrt(len(d[0]))
    resampled = [_bootstraps(random, part) for part in np.array_split(y, studies // 2000)]
    percentile, studentised = np.mean(resampled, axis=0)
    return {
        "t": t_covers(y),
        "blocks": covers((pooled - reach, pooled + reach)),
        "percentile": percentile,
        "bootstrap-t": studentised,
        "mixed z": _mixed(y, d, n),
        "CR2": _cr2(y, n),
    }


def _bootstraps(random: np.random.Generator, y: Numbers, draws: int = 399) -> tuple[float, float]:
    """Return the coverage of the percentile and the symmetric studentised bootstrap."""
    studies, count = y.shape
    mean, error = y.mean(axis=1), y.std(axis=1, ddof=1) / math.sqrt(count)
    drawn = np.take_along_axis(
        y[:, np.newaxis], random.integers(count, size=(studies, draws, count)), axis=2
    )
    means = drawn.mean(axis=2)
    errors = drawn.std(axis=2, ddof=1) / math.sqrt(count)
    ends = np.quantile(means, [0.025, 0.975], axis=1)
    known = errors > 1e-9 * error[:, np.newaxis]
    t = np.abs(means - mean[:, np.newaxis]) / np.where(known, errors, np.nan)
    far = np.nanquantile(t, 0.95, axis=1) * error
    return covers((ends[0], ends[1])), covers((mean - far, mean + far))


def _mixed(y: Numbers, d: Numbers, n: NDArray[np.intp]) -> float:
    """Return the coverage of a random intercept by REML with normal quantiles."""
    within = np.square(d).sum(axis=1) - (n * np.square(y)).sum(axis=1)
    blocks = int(n.sum())
    best: Numbers = np.full(len(y), np.inf)
    mu, error = np.zeros(len(y)), np.ones(len(y))
    for ratio in (0.0, *np.exp(np.arange(-9.0, 6.0, 0.1))):
        weight = n / (1 + n * ratio)
        mean = y @ weight / weight.sum()
        square = within + (np.square(y - mean[:, np.newaxis]) * weight).sum(axis=1)
        loss = (blocks - 1) * np.log(square) + np.log1p(n * ratio).sum() + np.log(weight.sum())
        better = loss < best
        best = np.where(better, loss, best)
        mu = np.where(better, mean, mu)
        error = np.where(better, np.sqrt(square / (blocks - 1) / weight.sum()), error)
    return covers((mu - 1.959964 * error, mu + 1.959964 * error))


def _cr2(y: Numbers, n: NDArray[np.intp]) -> float:
    """Return the coverage of the mean over blocks with CR2 (Bell and McCaffrey 2002)."""
    weight = n / n.sum()
    mean = y @ weight
    share = weight**2 / (1 - weight)
    error = np.sqrt(np.square(y - mean[:, np.newaxis]) @ share)
    spread = share[:, np.newaxis] * (np.diag(1 / n) - 1 / n.sum())
    freedom = np.trace(spread) ** 2 / np.trace(spread @ spread)
    reach = stats.t.ppf(0.975, freedom) * error
    return covers((mean - reach, mean + reach))


def multi(scenario: str, clusters: int, methods: int, kind: str, studies: int = 10000) -> Rates:
    """How often any method that is as good as the best is called behind, or power.

    Parameters
    ----------
    scenario
        ``null_r1``: clusters differ by method as much as a mean of 40 blocks does; ``het_x``: from
        0.3 to 5 times that; ``het_skew``: from 0 to 3 times, skewed; ``power2``: one method is
        better than all others by two standard deviations of a cluster's difference.
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
    shape = (studies, clusters, methods)
    effect = noise(random, "ln1.0" if scenario == "het_skew" else "normal", shape)
    y = mean + spread / math.sqrt(BLOCKS) * effect
    if kind == "normal":  # means of 40 normal blocks
        y += random.standard_normal(shape) / math.sqrt(BLOCKS)
    else:
        for at in range(studies):
            y[at] += noise(random, kind, (clusters, BLOCKS, methods)).mean(axis=1)
    best = y.mean(axis=1).argmin(axis=1)
    result = contrasts(y, best)
    freedom = (methods - 1) * (clusters - 1)
    others = np.arange(methods) != best[:, np.newaxis]
    pooled = np.sqrt(2 * _residual(y) / freedom / clusters)[:, np.newaxis]
    rules = {
        "floored": result.apart,
        "unadjusted": result.p_alone <= 0.05,
        "pooled": result.mean / pooled > range_quantile(methods, freedom),
        "pair SE": _ratio(result.mean, result.own) > range_quantile(methods, clusters - 1),
        "Holm v best": _holm(result.p_alone, others),
    }
    if scenario == "het_skew":
        rules["flips"] = _flips(random, y, best)
    behind = {name: rule & others for name, rule in rules.items()}
    if scenario.startswith("power"):
        return {name: float(rule[best == 0][:, 1:].mean()) for name, rule in behind.items()}
    return {name: float(rule.any(axis=1).mean()) for name, rule in behind.items()}


def _ratio(mean: Numbers, error: Numbers) -> Numbers:
    return mean / np.where(error > 0.0, error, np.inf)


def _residual(y: Numbers) -> Numbers:
    left = y - y.mean(axis=2, keepdims=True)
    return np.asarray(np.square(left - left.mean(axis=1, keepdims=True)).sum(axis=(1, 2)))


def _holm(p: Numbers, others: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return what Holm's method rejects of the comparisons with the best."""
    p = np.where(others, p, 2.0)
    order = np.argsort(p, axis=1)
    limits = 0.05 / np.maximum(p.shape[1] - 1 - np.arange(p.shape[1]), 1)
    passed = np.cumprod(np.take_along_axis(p, order, axis=1) <= limits, axis=1).astype(bool)
    rejected = np.zeros_like(passed)
    np.put_along_axis(rejected, order, passed, axis=1)
    return rejected


def _flips(
    random: np.random.Generator, y: Numbers, best: NDArray[np.intp], draws: int = 199
) -> NDArray[np.bool_]:
    """Return what single-step sign flips over all pairs reject."""
    studies, clusters, methods = y.shape
    first, second = np.triu_indices(methods, 1)
    rejected = np.zeros((studies, methods), dtype=bool)
    for at in range(studies):
        d = y[at][:, first] - y[at][:, second]
        size = np.sqrt(np.square(d).sum(axis=0))
        signs = random.choice([-1.0, 1.0], (draws, clusters))
        most = (np.abs(signs @ d) / size).max(axis=1)
        observed = np.abs(d.sum(axis=0)) / size
        p = (1 + (most[:, np.newaxis] >= observed - 1e-9).sum(axis=0)) / (draws + 1)
        of_best = (first == best[at]) | (second == best[at])
        other = np.where(first == best[at], second, first)
        rejected[at, other[of_best]] = p[of_best] <= 0.05
    return rejected


def positive(clusters: int = 12, spread: float = 0.1, studies: int = 2000) -> Rates:
    """Two methods of equal mean error and unequal tails: coverage, and what blocks' ratios say."""
    random = random_of("positive")
    first, second = 0.8, 1.2
    shape = (studies, clusters, BLOCKS)
    base = 0.4 * random.standard_normal((studies, clusters, 1)) + random.standard_normal(shape)
    logs = []
    for scale, shift in ((first, 0.0), (second, (first**2 - second**2) / 2)):
        effect = spread * random.standard_normal((studies, clusters, 1))
        logs.append(base + shift + effect + scale * random.standard_normal(shape))
    means = np.log([np.exp(log).mean(axis=2) for log in logs])
    typical = (logs[1] - logs[0]).mean(axis=2)
    return {
        "log ratio": t_covers(means[1] - means[0]),
        "block log ratio rejects": 1 - t_covers(typical),
    }


def alone(clusters: int = 5, spread: float = 1.0, studies: int = 20000) -> Rates:
    """Coverage of one method's mean error."""
    random = random_of("alone")
    blocks = np.concatenate(
        [
            np.exp(random.standard_normal((2000, clusters, BLOCKS))).mean(axis=2)
            for _ in range(studies // 2000)
        ]
    )
    x = blocks * np.exp(spread * random.standard_normal(blocks.shape))
    return {
        "log t": t_covers(np.log(x), 0.5),
        "raw t": t_covers(x, math.exp((spread**2 + 1) / 2)),
    }


def bayes(clusters: int = 12, kind: str = "ln1.5", studies: int = 6000) -> Rates:
    """How often a difference at the edge of the margin is called equivalent, P >= 0.95."""
    random = random_of("bayes")
    margin = 0.15
    d = noise(random, kind, (studies, clusters, BLOCKS))
    spread = random.choice([0.0, 1.0, 3.0], (studies, 1)) / math.sqrt(BLOCKS)
    y = d.mean(axis=2) + margin + spread * random.standard_normal((studies, clusters))
    own = d.var(axis=2, ddof=1) / BLOCKS
    return {
        "pooled": float((posterior(y, own.mean(axis=1), margin)[1] >= 0.95).mean()),
        "own": float((_own_variances(y, own, margin) >= 0.95).mean()),
    }


def _own_variances(y: Numbers, variance: Numbers, margin: float) -> Numbers:
    """Return the probability of equivalence where each cluster has a variance of its own."""
    quantile = np.tan((np.arange(80) + 0.5) / 80 * np.pi / 2)
    tau = y.std(axis=1, ddof=1)[:, np.newaxis] * quantile
    weight = 1 / (variance[:, np.newaxis] + np.square(tau)[..., np.newaxis])
    total = weight.sum(axis=2)
    mean = (weight * y[:, np.newaxis]).sum(axis=2) / total
    squares = (weight * np.square(y[:, np.newaxis] - mean[..., np.newaxis])).sum(axis=2)
    log = 0.5 * (np.log(weight).sum(axis=2) - np.log(total) - squares)
    chance = np.exp(log - log.max(axis=1, keepdims=True))
    chance /= chance.sum(axis=1, keepdims=True)
    sd = np.sqrt(1 / total)
    inside = stats.norm.cdf((margin - mean) / sd) - stats.norm.cdf((-margin - mean) / sd)
    return np.asarray((chance * inside).sum(axis=1))


def within(
    gaps: int = 150, time: float = 40, length: int = 20, frames: int = 4000, studies: int = 1500
) -> Rates:
    """Coverage of a recording's mean by its segments: gaps in an autoregressive process."""
    random = random_of("within")
    phi = math.exp(-1 / time)
    drive = random.standard_normal((studies, frames + length))
    drive[:, 1:] *= math.sqrt(1 - phi * phi)
    sums = np.cumsum(lfilter([1.0], [1.0, -phi], drive, axis=1), axis=1)
    sums = np.concatenate([np.zeros((studies, 1)), sums], axis=1)
    start = np.sort(random.integers(0, frames, (studies, gaps)), axis=1)
    d = np.take_along_axis(sums, start + length, 1) - np.take_along_axis(sums, start, 1)
    d /= length
    segments = np.floor(start * 6 / frames).astype(np.intp)
    parts = [[d[at][segments[at] == place].mean() for place in range(6)] for at in range(studies)]
    chosen = []
    for at in range(studies):
        units = units_of(_recording(d[at], start[at], length), _pair(d[at]), np.ones(gaps, bool))
        if units.count:
            y = units.means[:, 1] - units.means[:, 0]
            chosen.append(covers(mean_interval(y[:, np.newaxis])))
    return {
        "segments": t_covers(np.array(parts)),
        "as chosen": float(np.mean(chosen)),
        "silent": 1 - len(chosen) / studies,
        "gaps": t_covers(d),
    }


def _pair(d: Numbers) -> Numbers:
    return np.stack([10.0 - d / 2, 10.0 + d / 2], axis=1)


def _recording(d: Numbers, start: NDArray[np.intp], length: int) -> Group:
    values, blocks = _pair(d), np.arange(len(d))
    none, time = np.zeros(2), start.astype(np.float64)
    frames = np.full(len(d), float(length))
    return Group(
        (), ("a", "b"), values, none, none, 0 * blocks, blocks, 1, time, frames, blocks, blocks
    )


CELLS: Final[Mapping[str, tuple[Callable[[], Rates], Rates]]] = {
    "two methods, 5 clusters": (
        lambda: two(5, "normal", 1, "equal", studies=16000),
        {"t": 0.956, "percentile": 0.843, "mixed z": 0.922, "blocks": 0.846},
    ),
    "two methods, 5 unequal clusters": (
        lambda: two(5, "normal", 3, "unequal"),
        {"t": 0.951, "CR2": 0.955, "blocks": 0.194},
    ),
    "two methods, 8 clusters, heavy tails": (
        lambda: two(8, "ln1.5", 0, "unequal"),
        {"t": 0.919, "bootstrap-t": 0.938},
    ),
    "two methods, 5 skewed clusters": (
        lambda: two(5, "ln1.5", 3, "equal", "ln1.0"),
        {"t": 0.864, "bootstrap-t": 0.924},
    ),
    "6 equal methods, 5 clusters": (
        lambda: multi("null_r1", 5, 6, "normal"),
        {"floored": 0.040, "unadjusted": 0.323},
    ),
    "17 equal methods, 5 clusters": (
        lambda: multi("null_r1", 5, 17, "normal"),
        {"floored": 0.039, "Holm v best": 0.150},
    ),
    "17 methods of unequal variance, 8 clusters": (
        lambda: multi("het_x", 8, 17, "normal"),
        {"floored": 0.063, "pooled": 0.202},
    ),
    "17 methods, skewed, 12 clusters": (
        lambda: multi("het_skew", 12, 17, "ln1.5", studies=2000),
        {"floored": 0.013, "flips": 0.135},
    ),
    "power, 17 methods, 5 clusters": (
        lambda: multi("power2", 5, 17, "normal"),
        {"floored": 0.678, "pair SE": 0.290},
    ),
    "unequal tails, 12 clusters": (
        positive,
        {"log ratio": 0.940, "block log ratio rejects": 0.999},
    ),
    "one method, 5 clusters": (alone, {"log t": 0.949, "raw t": 0.815}),
    "Bayes, 12 clusters": (bayes, {"pooled": 0.063, "own": 0.287}),
    "one recording": (within, {"segments": 0.947, "gaps": 0.625}),
}
QUICK: Final = (
    "6 equal methods, 5 clusters",
    "17 methods of unequal variance, 8 clusters",
    "power, 17 methods, 5 clusters",
    "one method, 5 clusters",
)


def deviations(name: str) -> tuple[Rates, dict[str, float]]:
    """Return the rates of a cell, and by how much those with an expectation are off."""
    simulate, expected = CELLS[name]
    rates = simulate()
    return rates, {rule: rates[rule] - rate for rule, rate in expected.items()}


def main(words: list[str]) -> int:
    """Simulate the cells named, or all; return how many are off."""
    names = list(QUICK) if words == ["--quick"] else words or list(CELLS)
    off = 0
    for name in names:
        rates, differences = deviations(name)
        texts = [
            f"{rule} {rate:.3f}"
            + (f" (expected {CELLS[name][1][rule]:.3f})" if rule in differences else "")
            for rule, rate in rates.items()
        ]
        bad = [rule for rule, change in differences.items() if abs(change) > TOLERANCE]
        off += bool(bad)
        print(f"{'OFF ' if bad else ''}{name}: {', '.join(texts)}", flush=True)
    return off


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
