"""The cut-off frequency, which several methods share, and windows in seconds."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from nodegraph import Refusal, Unit

Cutoff = Annotated[float, Field(gt=0.0, allow_inf_nan=False), Unit("Hz")]
"""The setting ``cutoff``: the frequency of which half the amplitude is kept."""

Seconds = Annotated[float, Field(gt=0.0, allow_inf_nan=False), Unit("s")]


def angle(cutoff: float, rate: float) -> float:
    """Return a cut-off in radians per frame, between 0 and pi.

    Raises
    ------
    ValueError
        If it is not positive.
    Refusal
        If it is not below half the frame rate.
    """
    if not cutoff > 0.0:
        raise ValueError(f"a cut-off must be a positive number of Hz, got {cutoff}")
    if not cutoff < rate / 2.0:
        raise Refusal(
            f"cut-off {cutoff:g} Hz is not below {rate / 2.0:g} Hz, half the frame rate: there "
            "is nothing above it to take away"
        )
    return 2.0 * math.pi * cutoff / rate


def frames_of(seconds: float, rate: float) -> float:
    """Return how many frames a length of time is, not rounded.

    Raises
    ------
    ValueError
        If it is not positive.
    """
    if not 0.0 < seconds < math.inf:
        raise ValueError(f"a length of time must be a positive number of s, got {seconds}")
    return seconds * rate


STIFFEST = 1e10
"""The largest penalty; of a movement of centimetres rounding then changes less than a micron."""


def check_stiffness(penalty: float, cutoff: float, rate: float) -> None:
    """Refuse a cut-off that is too low to be computed.

    Parameters
    ----------
    penalty
        The factor of the squared differences or derivatives, in frames.
    cutoff, rate
        Cut-off and rate from which it was made, for the message.
    """
    if penalty > STIFFEST:
        raise Refusal(
            f"cut-off {cutoff:g} Hz is too low at {rate:g} Hz to be computed with this order; "
            "take a higher cut-off, a lower order or fewer frames per second"
        )
