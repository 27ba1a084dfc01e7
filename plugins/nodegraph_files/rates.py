"""Rates that files come in, stated by the file or by the user."""

from __future__ import annotations

import math
import warnings
from typing import Annotated, TypeVar

from pydantic import Field

from nodegraph import Unit
from nodegraph_mocap.checks import FASTEST, SLOWEST

RateSetting = Annotated[float, Field(ge=SLOWEST, le=FASTEST), Unit("Hz")] | None


_Stated = TypeVar("_Stated", bound=float | None)


def rate_from(setting: float | None, stated: _Stated) -> float | _Stated:
    """Return the rate that the user sets, or else what a file states, which may be None.

    A warning says where the two differ.
    """
    if setting is None or stated is None:
        return stated if setting is None else setting
    if not math.isclose(setting, stated, rel_tol=1e-6):
        warnings.warn(
            f"the file states a rate of {stated:g} Hz; {setting:g} Hz is taken, as `rate` says",
            stacklevel=4,
        )
    return setting
