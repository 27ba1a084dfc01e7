"""A plugin file of nodes that executors call in other processes."""

from __future__ import annotations

import os
import signal
import time
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from nodegraph import Across, InputFile, Refusal, Value, node, read_only


@dataclass(frozen=True)
class Pair(Value):
    """Two arrays that travel together."""

    first: NDArray[np.float64]
    second: NDArray[np.float64]


class Cut(NamedTuple):
    kept: Pair
    hidden: int


class Opaque:
    """A value that cannot be sent."""

    def __init__(self, number: float) -> None:
        self.number = number


@node("away.pair")
def pair(*, seed: int = 0, rows: int = 40) -> Pair:
    random = np.random.default_rng(seed)
    first = random.normal(size=(rows, 6, 3))
    first[::7] = np.nan
    second = np.asfortranarray(random.normal(size=(rows, 18)))
    return Pair(read_only(first), read_only(second))


@node("away.cut")
def cut(whole: Pair, *, length: Annotated[int, Field(ge=1)] = 5, at: tuple[int, ...] = (3,)) -> Cut:
    positions = whole.first.copy()
    for start in at:
        positions[start : start + length] = np.nan
    return Cut(Pair(read_only(positions), whole.second), int(np.isnan(positions).sum()))


@node("away.mean")
def mean(pair: Pair, *, power: float = 1.0) -> float:
    return float(np.nanmean(pair.first**2) ** power + pair.second.sum(axis=1).sum())


@node("away.table")
def table(scores: Across[float], hidden: Across[int] | None = None) -> str:
    rows = [f"{sorted(at.items())} {value.hex()}" for at, value in scores]
    return "\n".join([*rows, *map(str, scores.absent), str(hidden and len(hidden))])


@node("away.size")
def size(pair: Pair) -> int:
    return pair.first.nbytes + pair.second.nbytes


@node("away.also_size")
def also_size(pair: Pair, x: int, *, k: int = 0) -> int:
    return size(pair)


@node("away.number")
def number() -> int:
    return 7


@node("away.pid")
def pid(*, mark: int = 0) -> int:
    return os.getpid()


@node("away.file_pid")
def file_pid(*, path: InputFile) -> int:
    return os.getpid()


@node("away.opaque")
def opaque(x: int) -> Opaque:
    return Opaque(float(os.getpid()))


@node("away.list")
def listed(x: int) -> list:  # type: ignore[type-arg]
    return [Opaque(float(os.getpid()))]


@node("away.known")
def known(x: Opaque) -> int:
    return int(x.number)


@node("away.known_first")
def known_first(x: list) -> int:  # type: ignore[type-arg]
    return int(x[0].number)


@node("away.warns")
def warns(x: int) -> int:
    warnings.warn("two of them are odd", stacklevel=2)
    return x


@node("away.refuses")
def refuses(x: int) -> int:
    raise Refusal("needs one complete frame")


@node("away.fails")
def fails(x: int) -> int:
    raise KeyError("no such marker")


@node("away.lies")
def lies(x: int) -> int:
    return "a text"  # type: ignore[return-value]


@node("away.writes")
def writes(pair: Pair) -> Pair:
    pair.first[0] = 0.0
    return pair


@node("away.prints")
def prints(x: int) -> int:
    print("noise")
    return x


@node("away.killed")
def killed(x: int) -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return x


@node("away.killed_once")
def killed_once(x: int, *, mark: str, number: int = 0, at: int = 0) -> int:
    """Die at one number, the first time that it comes."""
    if number == at:
        try:
            os.close(os.open(mark, os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            pass
        else:
            os.kill(os.getpid(), signal.SIGKILL)
    return x + number


@node("away.meets")
def meets(x: int, *, read: str, write: str, first: bool) -> int:
    """Return when another one is called at the same time."""
    if first:
        Path(write).write_text("here")
        return int(Path(read).read_text() == "there")
    came = Path(read).read_text()
    Path(write).write_text("there")
    return int(came == "here")


@node("away.for_ever")
def for_ever(x: int, *, alive: str) -> int:
    """Open a pipe, write the process's number, and never return."""
    held = open(alive, "w")  # noqa: SIM115
    held.write(f"{os.getpid()}\n")
    held.flush()
    while True:
        time.sleep(1)
