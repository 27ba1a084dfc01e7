"""Declarations of a method besides its ports and settings, which keep comparisons fair."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, Final, Literal, TypedDict


class Undeclared(Enum):
    """The type of `UNDECLARED`, which is not None: None is the whole take."""

    UNDECLARED = "undeclared"


UNDECLARED: Final = Undeclared.UNDECLARED
"""The look-ahead of a node that declares none, as one that is not a method."""

LookAhead = int | None | Literal[Undeclared.UNDECLARED] | Callable[[Mapping[str, Any]], int | None]
"""Frames, None for the whole take, or what returns one of these for settings."""

Adapted = str | Callable[[Mapping[str, Any]], str]
"""What the method is taken from and what differs, or what returns it for settings."""

Ends = bool | None | Callable[[Mapping[str, Any]], bool]
"""True if both ends of a gap are met, or a function of the settings; None: not declared."""


Synthetic = bool | Callable[[Mapping[str, Any]], bool]
"""True if the data are made, not recorded, or a function of the settings."""


class Declared(TypedDict, total=False):
    """The declarations of a method for given settings; those it does not make are left out.

    The text of what differs from the published method, the look-ahead in frames (None: the whole
    take), whether both ends of a gap are met (None: by a setting that varies), and the axes of
    its settings.
    """

    adapted: str
    lookahead: int | None
    ends: bool | None
    axes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Declaration:
    """The properties of a method that a fair comparison depends on; see `nodegraph.node`.

    `nodegraph.node.decorator.Node` evaluates it for settings.

    Attributes
    ----------
    adapted : Adapted
        Empty for a method that is as published.
    lookahead : LookAhead
    ends : Ends
    synthetic : Synthetic
        Whether the data of a node without inputs are made, not recorded.
    """

    adapted: Adapted = ""
    lookahead: LookAhead = UNDECLARED
    ends: Ends = None
    synthetic: Synthetic = False
