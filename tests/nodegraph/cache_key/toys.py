"""Functions that are made with values; the module imports little, so that little is reached."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any, NamedTuple

Function = Callable[..., Any]


class Kind(Enum):
    ONE = 1
    TWO = 2


class Pair(NamedTuple):
    left: Any
    right: Any


@dataclass(frozen=True)
class Rule:
    weight: float
    parts: tuple[Any, ...] = ()


def over(value: object) -> Function:
    def inner(x: object) -> Any:
        return x, value

    return inner


def with_default(value: object) -> Function:
    def inner(x: object = value, *, y: object = value) -> Any:
        return x, y

    return inner


def near(x: float) -> float:
    return x + 1


def far(x: float) -> float:
    return x + 2
