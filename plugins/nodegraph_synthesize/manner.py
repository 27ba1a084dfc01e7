"""Manners of moving: without rest, or in bursts with rests between, as people do."""

from __future__ import annotations

from dataclasses import dataclass

Range = tuple[float, float]


@dataclass(frozen=True)
class Manner:
    """What makes a performance restless or calm.

    Attributes
    ----------
    silence : range
        From which an actor's share of time in pauses is drawn.
    jaw : range
        The same of how far the jaw opens on a strong syllable, 0 to 1.
    blinks : range
        The same of the blinks per second.
    blink : (closed, held, open)
        Seconds from the beginning of a blink.
    calm : float
        Level, in standard deviations, below which a smooth course leaves a muscle at rest.
    shortest, longest : (onset, apex, offset, pause)
        Seconds of an expression.
    faintest : float
        Strength of the faintest expression, of the strongest.
    slack : float
        Share by which a held expression gives way.
    skin : float
        Standard deviation of the skin's own movement in each direction, mm.
    skin_pace : float
        Cut-off of that, Hz.
    skin_rests : bool
        Whether skin moves by itself mostly while muscles do.
    """

    silence: Range
    jaw: Range
    blinks: Range
    blink: tuple[float, float, float]
    calm: float
    shortest: tuple[float, float, float, float]
    longest: tuple[float, float, float, float]
    faintest: float
    slack: float
    skin: float
    skin_pace: float
    skin_rests: bool


WITHOUT_REST = Manner(
    silence=(0.15, 0.35),
    jaw=(0.2, 0.38),
    blinks=(0.25, 0.45),
    blink=(0.08, 0.11, 0.24),
    calm=-0.2,
    shortest=(0.3, 0.5, 0.4, 0.3),
    longest=(0.6, 1.7, 0.8, 0.5),
    faintest=0.9,
    slack=0.25,
    skin=0.2,
    skin_pace=1.5,
    skin_rests=False,
)
IN_BURSTS = Manner(
    silence=(0.4, 0.8),
    jaw=(0.15, 0.3),
    blinks=(0.2, 0.3),
    blink=(0.11, 0.12, 0.31),
    calm=0.5,
    shortest=(0.35, 0.5, 0.5, 0.3),
    longest=(0.7, 1.5, 0.9, 1.6),
    faintest=0.6,
    slack=0.05,
    skin=0.25,
    skin_pace=0.8,
    skin_rests=True,
)
