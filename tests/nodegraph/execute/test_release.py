"""A value is released when its last reader is done."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable
from dataclasses import dataclass

import pytest

from nodegraph import Across, Value, node
from nodegraph.execute import HowToRun, Run

WAYS = [HowToRun("serial"), HowToRun("threads", 1), HowToRun("threads", 3)]
ALIVE: weakref.WeakSet[Big] = weakref.WeakSet()
PEAK: list[int] = []


@dataclass(frozen=True, eq=False)
class Big(Value):
    """A value whose instances are counted while they live."""

    number: float = 0.0


def made(number: float) -> Big:
    big = Big(number)
    ALIVE.add(big)
    PEAK.append(len(ALIVE))
    return big


@node("big.make")
def make(*, number: float = 0.0) -> Big:
    return made(number)


@node("big.next")
def following(big: Big, *, add: float = 1.0) -> Big:
    return made(big.number + add)


@node("big.size")
def size(big: Big) -> float:
    return big.number


@node("big.sum")
def total(sizes: Across[float]) -> float:
    return sum(sizes.values())


BIG = (make, following, size, total)


@pytest.fixture
def peak() -> list[int]:
    gc.collect()
    ALIVE.clear()
    PEAK.clear()
    return PEAK


@pytest.mark.parametrize("how", WAYS[:2])
def test_a_chain_holds_two_values_at_most(
    run_of: Callable[..., Run], peak: list[int], how: HowToRun
) -> None:
    lines = [f"  n{i}: {{use: big.next, in: n{i - 1}}}" for i in range(1, 30)]
    text = (
        "nodes:\n  n0: {use: big.make}\n" + "\n".join(lines) + "\n  end: {use: big.size, in: n29}\n"
    )
    run = run_of(text, more=BIG, how=how)
    assert run["end"].value == 29
    assert max(peak) == 2
    assert len(ALIVE) == 0


@pytest.mark.parametrize("how", WAYS)
def test_a_wide_fan_does_not_keep_all(
    run_of: Callable[..., Run], peak: list[int], how: HowToRun
) -> None:
    text = """
        axes: {k: {count: 40}}
        nodes:
          a: {use: big.make}
          b: {use: big.next, in: a, with: {add: $k}}
          c: {use: big.next, in: b}
          d: {use: big.size, in: c}
          e: {use: big.sum, in: d}
        """
    run = run_of(text, more=BIG, how=how)
    assert run["e"].value == sum(range(1, 41))
    assert len(peak) == 81
    assert max(peak) <= (4 if how.executor == "serial" else 12)
    assert len(ALIVE) == 0


def test_what_is_reported_stays(run_of: Callable[..., Run], peak: list[int]) -> None:
    text = "nodes: {a: {use: big.make}, b: {use: big.next, in: a}, c: {use: big.next, in: b}}"
    run = run_of(f"{text}\nreport: [b]", more=BIG)
    assert [one.number for one in ALIVE] == [1]
    assert run["b"].value is next(iter(ALIVE))
    assert run["c"].value.number == 2
