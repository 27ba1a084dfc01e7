"""Settings of a fill that are chosen by gaps of known content, hidden from the recording itself.

A method is at its best with settings that suit the recording, which nobody knows beforehand. A
setting may be tuned if its annotation says which values to try, `Tune`. All methods may try as
many, and none sees what a study has hidden: what is missing from the recording stays missing.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from nodegraph import Refusal
from nodegraph_fill.filling import Filling
from nodegraph_fill.gaps import Gaps
from nodegraph_fill.held_out import moved, without
from nodegraph_mocap import Trajectories, Tuning

if TYPE_CHECKING:
    from collections.abc import Iterator

F = TypeVar("F", bound=Filling)

MOST_TRIES = 6
"""Values that a fill may have tried, beside its defaults."""
_LEAST, _ENOUGH, _MOST = 10, 40, 100
"""Hidden gaps."""
_LATER = (1 / 2, 1 / 4, 3 / 4, 1 / 8, 3 / 8, 5 / 8, 7 / 8)
"""Shares of the take by which gaps are moved, one after another until there are enough."""
_CLEARLY = 1e-6
"""Share by which an error must be lower, so that no rounding decides."""

_trying: ContextVar[bool] = ContextVar("trying", default=False)


class Tune:
    """Marks a setting that may be tuned: ``Annotated[int, Field(ge=1), Tune(4, 8, 16)] = 8``.

    Those of all settings of a fill are six values at most, beside the defaults.

    Parameters
    ----------
    *values
        The values to try.
    times
        Multiples of the value that is set to try, for a setting whose unit is that of the data.
    """

    def __init__(self, *values: str | float | bool, times: tuple[float, ...] = ()) -> None:
        self._values, self._times = values, times

    def beside(self, value: Any) -> tuple[Any, ...]:
        """Return the values to try beside the one that is set."""
        every = (*self._values, *(value * factor for factor in self._times))
        return tuple(each for each in every if each != value)


def is_trying() -> bool:
    """Return whether a fill is called for its error alone: it need not warn, nor give a sigma."""
    return _trying.get()


def unless_tuned(
    lookahead: Callable[[Mapping[str, Any]], int | None],
) -> Callable[[Mapping[str, Any]], int | None]:
    """Return the look-ahead of a fill that looks at the whole take where it is tuned."""
    return lambda settings: None if settings["settings"] == "tuned" else lookahead(settings)


def marks_of(hints: Mapping[str, Any], defaults: Mapping[str, object]) -> Mapping[str, Tune]:
    """Return the mark of each setting that may be tuned.

    Parameters
    ----------
    hints
        The annotations of settings, with their marks.
    defaults
        The defaults of the same settings.

    Raises
    ------
    ValueError
        If they are more than any fill may try.
    """
    marks = {
        name: mark
        for name, hint in hints.items()
        for mark in getattr(hint, "__metadata__", ())
        if isinstance(mark, Tune)
    }
    count = sum(len(mark.beside(defaults[name])) for name, mark in marks.items())
    if count > MOST_TRIES:
        raise ValueError(f"{count} values to try: a fill may have {MOST_TRIES} beside its defaults")
    return marks


def tuned(
    fill: Callable[..., Trajectories],
    filling: F,
    gaps: Gaps,
    settings: Mapping[str, Any],
    marks: Mapping[str, Tune],
) -> tuple[F, dict[str, Any], Tuning]:
    """Return a fill's settings with those values that err least in gaps of known content.

    The gaps are laid over the recording again, later by half its length and from its end on to
    its beginning, wherever the marker is present there and on both sides; by other shares of its
    length, too, while there are fewer than 40. Of more than 100, as many of evenly spread lengths
    are taken. The samples that they hide are filled, all others being known but for the gaps.
    Settings are tried one after another, each value with the best of those before. The error is
    the mean over the gaps of their root mean square; a value that leaves more gaps missing is
    worse.

    Parameters
    ----------
    fill
        ``fill(filling, gaps, **settings)`` fills these gaps.
    filling, settings
        What it takes, and its own settings.
    gaps
        The gaps that are to be filled.
    marks
        The settings that may be tuned, of `filling` or of `settings`.

    Returns
    -------
    tuple
        The same with other settings, and what was chosen. With fewer than ten gaps, or where the
        method refuses the recording that they are hidden from, all are as they were, which is
        warned of.
    """
    recording = filling.recording
    held = _hidden(recording, gaps)
    search = _Search(fill, replace(filling, recording=without(recording, held)), settings, held)
    before = {name: settings.get(name, getattr(filling, name, None)) for name in marks}
    chosen, count, reason = before, 0, ""
    first = best = (0, math.nan)
    if len(held.start) < _LEAST:
        reason = f"{len(held.start)} gaps can be hidden to tune on, of {_LEAST} that it takes"
    else:
        try:
            first = best = search.error(recording, before)
        except Refusal as refusal:
            reason = f"where gaps are hidden to tune on, the method {refusal}"
    if reason:
        warnings.warn(f"settings stay as published: {reason}", stacklevel=4)
    else:
        for name, mark in marks.items():
            start = chosen
            for value in mark.beside(start[name]):
                count += 1
                error = search.error(recording, {**start, name: value})
                if error < (best[0], best[1] * (1.0 - _CLEARLY)):
                    chosen, best = {**start, name: value}, error
    rows = tuple((name, before[name], chosen[name]) for name in marks)
    ends = (error if math.isfinite(error) else math.nan for _, error in (first, best))
    tuning = Tuning(rows, len(held.start), count, *ends)
    return *search.with_values(filling, chosen), tuning


class _Search:
    """The error of a fill by the values of some settings."""

    def __init__(
        self,
        fill: Callable[..., Trajectories],
        hidden: Filling,
        settings: Mapping[str, Any],
        held: Gaps,
    ) -> None:
        self._fill, self._hidden, self._settings, self._held = fill, hidden, settings, held

    def with_values(self, filling: F, values: Mapping[str, Any]) -> tuple[F, dict[str, Any]]:
        """Return what the fill takes, and its own settings, with these values."""
        own = {name: value for name, value in values.items() if name in self._settings}
        shared = {name: value for name, value in values.items() if name not in own}
        return replace(filling, **shared), {**self._settings, **own}

    def error(self, recording: Trajectories, values: Mapping[str, Any]) -> tuple[int, float]:
        """Return how many gaps stay missing, and the mean error of the others, mm."""
        filling, settings = self.with_values(self._hidden, values)
        with _quiet():
            filled = self._fill(filling, self._held, **settings)
        gap, frame, marker, _ = self._held.samples
        off = filled.positions[frame, marker] - recording.positions[frame, marker]
        squares = np.bincount(gap, (off**2).sum(axis=1), len(self._held.start))
        errors = np.sqrt(squares / self._held.length)
        known = ~np.isnan(errors)
        mean = float(errors[known].mean()) if known.any() else math.inf
        return int(np.count_nonzero(~known)), mean


@contextmanager
def _quiet() -> Iterator[None]:
    token = _trying.set(True)
    try:
        yield
    finally:
        _trying.reset(token)


def _hidden(recording: Trajectories, gaps: Gaps) -> Gaps:
    """Return gaps of the same lengths in which the recording is known."""
    held = gaps.subset(np.zeros(len(gaps.start), dtype=np.bool_))
    for share in _LATER:
        if len(held.start) >= _ENOUGH:
            break
        later = round(share * recording.frames)
        held = held.joined(moved(without(recording, held), gaps, later))
    order = np.lexsort((held.start, held.length))
    spread = np.linspace(0, len(order) - 1, min(len(order), _MOST)).round().astype(np.intp)
    return held.subset(np.isin(np.arange(len(order)), order[spread]))
