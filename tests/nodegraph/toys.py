"""Toy nodes over plain numbers, in a module that imports little: keys hold all that it imports."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, NamedTuple

from pydantic import Field

from nodegraph import Across, InputFile, Refusal, Truth, Unit, Value, node

CALLS: list[str] = []


class Cut(NamedTuple):
    gappy: float
    truth: Truth[float]
    hidden: int


@dataclass(frozen=True)
class Seen(Value):
    """What reached a gathering node, to be looked at."""

    scores: Across[float]
    truth: float | None = None


@node("read.number")
def read_number(*, start: float = 1.0) -> float:
    CALLS.append("read.number")
    return start


@node("read.file")
def read_file(*, path: InputFile) -> float:
    return float(path.read_text())


@node("gaps.cut")
def cut(
    recording: float,
    *,
    length: Annotated[int, Field(ge=1, le=99), Unit("frames")] = 15,
    seed: int = 0,
) -> Cut:
    """Cut gaps.

    Parameters
    ----------
    length
        Length of each gap.
    seed
        Where they fall.
    """
    CALLS.append("gaps.cut")
    return Cut(recording - length + seed / 10, recording, length)


@node("fill.hold", cite="hold2001")
def hold(recording: float, *, max_gap: int | None = None) -> float:
    """Add one."""
    CALLS.append("fill.hold")
    return recording + 1.0


@node("fill.scale")
def scale(recording: float, *, max_gap: int | None = None, power: float = 2.0) -> float:
    """Multiply."""
    return recording * power


@node("strict.positive")
def positive(recording: float) -> float:
    if recording < 0:
        raise Refusal(f"{recording} is negative")
    return recording


@node("strict.fails")
def fails(recording: float) -> float:
    if recording < 0:
        raise ValueError(f"{recording} is negative")
    return recording


@node("score.gaps")
def score(estimate: float, truth: Truth[float], hidden: int) -> float:
    CALLS.append("score.gaps")
    return abs(estimate - truth) / hidden


@node("compare.table")
def table(scores: Across[float], floor: Across[float] | None = None, *, metric: str = "x") -> Seen:
    CALLS.append("compare.table")
    return Seen(scores)


@node("compare.beside")
def beside(scores: Across[float], reference: float, *, weight: float = 1.0) -> Seen:
    return Seen(scores, reference * weight)


@node("plot.faces")
def faces(recordings: Across[float], truth: Truth[float] | None = None) -> Seen:
    return Seen(recordings, truth)


@node("plot.stages")
def stages(recordings: Across[float], reference: float | None = None) -> Seen:
    return Seen(recordings, reference)


@node("text.write")
def write(*, text: str = "", number: float = 0.0) -> str:
    return text or f"{number:g}"


@node("text.join")
def join(first: str, second: str | None = None, *, mark: str = "+") -> str:
    return f"({first}{mark}{second})"


@node("text.all")
def join_all(parts: Across[str]) -> str:
    return "[" + "; ".join(f"{', '.join(map(str, at.values()))}: {v}" for at, v in parts) + "]"


TOYS = (
    read_number, read_file, cut, hold, scale, positive, fails, score, table, beside, faces, stages,
    write, join, join_all,
)  # fmt: skip
