"""The family of fills: the settings, documentation and warnings that every method has.

A method estimates the samples in the gaps that it is given. Which gaps these are, whether the
estimate is moved to meet their ends, how its samples are marked and what is left missing is the
same for all fills, and so are the settings `ends` and `max_gap` that say so.
"""

from __future__ import annotations

import inspect
import re
import warnings
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from functools import cache, wraps
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

import numpy as np

from nodegraph_fill.gaps import Gaps, MaxGap
from nodegraph_fill.meet_ends import Ends
from nodegraph_mocap import Origin, Trajectories

LEFT = """\
A marker that is never measured stays missing, counted in a warning. Samples that are present
come out as they went in; those that an earlier fill has made count like measured ones."""
"""The paragraph on what most fills leave as it is."""

CALLER = 6
"""The `stacklevel` by which a warning in what `fill_gaps` calls names the caller of the fill."""

_RETURNS = """\
Returns
-------
Trajectories
    The recording with filled samples, their origin `Origin.FILLED`."""


@dataclass(frozen=True)
class Filling:
    """A recording with gaps, and the settings of every fill.

    Attributes
    ----------
    recording
        Trajectories with gaps.
    ends
        as_published: the estimate as it is. met: its mismatch at each end of a gap, sample minus
        estimate, is spread linearly over the gap, all of it at that end and none at the other;
        a gap that the take begins or ends with has one end.
    max_gap
        Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
        of missing samples of one marker.
    """

    recording: Trajectories
    _: KW_ONLY
    ends: Ends = "as_published"
    max_gap: MaxGap = None


F = TypeVar("F", bound=Filling)


def make_fill(
    method: Callable[..., object], kind: type[F], fill: Callable[..., Trajectories], left: str
) -> Callable[..., Trajectories]:
    """Return a method as a function of what its kind of fill takes and of its own settings.

    Parameters
    ----------
    method
        Its keyword-only arguments are settings; its docstring describes it and these.
    kind
        The dataclass that the function takes besides.
    fill
        ``fill(filling, **settings)`` fills by that method, with the settings that are given.
    left
        The paragraph that says what stays missing, which is added to the docstring.
    """
    keyword = inspect.Parameter.KEYWORD_ONLY
    own = [each for each in inspect.signature(method).parameters.values() if each.kind is keyword]

    @cache
    def choices() -> dict[str, tuple[object, ...]]:
        # read when a fill is called: annotations of the method may name what is defined below it
        hints = get_type_hints(kind) | get_type_hints(filled)
        return {name: get_args(hint) for name, hint in hints.items() if get_origin(hint) is Literal}

    @wraps(method)
    def filled(*, filling: F, **settings: Any) -> Trajectories:
        for name, given in (vars(filling) | settings).items():
            if given not in choices().get(name, [given]):
                *others, last = map(str, choices()[name])
                raise ValueError(f"{name} must be {', '.join(others)} or {last}, got {given!r}")
        return fill(filling, **settings)

    filled.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [*own, inspect.Parameter("filling", keyword, annotation=kind)],
        return_annotation=Trajectories,
    )
    filled.__annotations__ = {each.name: each.annotation for each in own}
    text, *sections = re.split(r"\n\n(?=\w+\n-+\n)", inspect.getdoc(method) or "")
    at = sum(section.startswith("Parameters") for section in sections)
    filled.__doc__ = "\n\n".join([text, left, *sections[:at], _RETURNS, *sections[at:]])
    return filled


def fill_gaps(
    filling: Filling,
    fill: Callable[[Trajectories, Gaps], Trajectories],
    *,
    both_ends: bool = False,
    otherwise: str = "",
) -> Trajectories:
    """Fill the gaps that are not too long, and warn of what is left; called by a fill.

    Parameters
    ----------
    filling
        The recording and the settings of the fill.
    fill
        Takes the recording and the gaps to fill; not called when there are none.
    both_ends
        Whether it only fills gaps between two samples of the marker.
    otherwise
        Why it may leave a sample missing.
    """
    recording = filling.recording
    gaps = Gaps.of(recording)
    long = gaps.longer_than(filling.max_gap) & ~gaps.never
    left = {"never measured": gaps.never, "longer than max_gap": long}
    if both_ends:
        left["at the take's start"] = gaps.at_start & ~long
        left["at the take's end"] = gaps.at_end & ~long
    wanted = gaps.subset(~np.any(list(left.values()), axis=0))
    filled = fill(recording, wanted) if len(wanted.start) else recording
    counts = {reason: int(gaps.length[which].sum()) for reason, which in left.items()}
    _warn_left(filled, counts, otherwise)
    return filled


def _warn_left(filled: Trajectories, counts: dict[str, int], otherwise: str) -> None:
    missing = filled.origin == Origin.MISSING
    left = int(np.count_nonzero(missing))
    counts[otherwise] = left - sum(counts.values())
    if left:
        details = ", ".join(f"{reason} {count}" for reason, count in counts.items() if count)
        markers = _counted(int(np.count_nonzero(missing.any(axis=0))), "marker")
        warnings.warn(
            f"{_counted(left, 'sample')} of {markers} left missing: {details}",
            stacklevel=CALLER,
        )


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" + ("" if count == 1 else "s")
