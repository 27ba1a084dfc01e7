"""The family of fills: the settings, documentation and warnings that every method has.

A method estimates the samples in the gaps that it is given. Which gaps these are, whether the
estimate is moved to meet their ends, how its samples are marked and what is left missing is the
same for all fills, and so are the settings `ends` and `max_gap` that say so.
"""

from __future__ import annotations

import inspect
import re
import warnings
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from functools import cache, wraps
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Literal,
    TypeVar,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np

from nodegraph_fill.filling import Filling
from nodegraph_fill.gaps import Gaps
from nodegraph_fill.tuning import Tune, marks_of, tuned
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

LEFT = """\
A marker that is never measured stays missing, counted in a warning. Samples that are present
come out as they went in; those that an earlier fill has made count like measured ones."""
"""The paragraph on what most fills leave as it is."""

CALLER = 4
"""The `stacklevel` by which a warning in what a fill calls names the caller of the fill."""


F = TypeVar("F", bound=Filling)


def make_fill(
    method: Callable[..., object],
    kind: type[F],
    fill: Callable[..., Trajectories],
    left: str,
    *,
    both_ends: bool = False,
    otherwise: str = "",
) -> Callable[..., Trajectories]:
    """Return a method as a function of what its kind of fill takes and of its own settings.

    Parameters
    ----------
    method
        Its keyword-only arguments are settings; its docstring describes it and these.
    kind
        The dataclass that the function takes besides.
    fill
        ``fill(filling, gaps, **settings)`` fills these gaps by that method.
    left
        The paragraph that says what stays missing, which is added to the docstring.
    both_ends
        Whether it only fills gaps between two samples of the marker.
    otherwise
        Why it may leave a sample missing.
    """
    keyword = inspect.Parameter.KEYWORD_ONLY
    own = [each for each in inspect.signature(method).parameters.values() if each.kind is keyword]
    defaults = {each.name: each.default for each in own}

    @cache
    def hints() -> dict[str, Any]:
        # read when a fill is called: annotations of the method may name what is defined below it
        marked = get_type_hints(kind, include_extras=True)
        return marked | get_type_hints(filled, include_extras=True)

    @cache
    def choices() -> dict[str, tuple[object, ...]]:
        plain = {name: _without_marks(hint) for name, hint in hints().items()}
        return {name: get_args(hint) for name, hint in plain.items() if get_origin(hint) is Literal}

    @cache
    def marks() -> Mapping[str, Tune]:
        shared = {each.name: each.default for each in fields(kind)}
        return marks_of(hints(), shared | defaults)

    @wraps(method)
    def filled(*, filling: F, **settings: Any) -> Trajectories:
        for name, given in (vars(filling) | settings).items():
            if given not in choices().get(name, [given]):
                *others, last = map(str, choices()[name])
                raise ValueError(f"{name} must be {', '.join(others)} or {last}, got {given!r}")
        recording, gaps = filling.recording, Gaps.of(filling.recording)
        reasons = _reasons(gaps, filling.max_gap, both_ends=both_ends)
        wanted = gaps.subset(~np.any(list(reasons.values()), axis=0))
        if filling.settings == "tuned" and len(wanted.start) and marks():
            filling, settings, tuning = tuned(fill, filling, wanted, defaults | settings, marks())
            recording = replace(fill(filling, wanted, **settings), tuning=tuning)
        else:
            recording = fill(filling, wanted, **settings)
        counts = {reason: int(gaps.length[which].sum()) for reason, which in reasons.items()}
        _warn_left(recording, counts, otherwise)
        return recording

    filled.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [*own, inspect.Parameter("filling", keyword, annotation=kind)],
        return_annotation=Trajectories,
    )
    filled.__annotations__ = {each.name: each.annotation for each in own}
    text, *sections = re.split(r"\n\n(?=\w+\n-+\n)", inspect.getdoc(method) or "")
    filled.__doc__ = "\n\n".join([text, left, *sections])
    return filled


def _without_marks(hint: Any) -> Any:
    return get_args(hint)[0] if get_origin(hint) is Annotated else hint


def _reasons(gaps: Gaps, max_gap: int | None, *, both_ends: bool) -> dict[str, NDArray[np.bool_]]:
    """Return for each reason to leave a gap missing which gaps it concerns."""
    long = gaps.longer_than(max_gap) & ~gaps.never
    reasons = {"never measured": gaps.never, "longer than max_gap": long}
    if both_ends:
        reasons["at the take's start"] = gaps.at_start & ~long
        reasons["at the take's end"] = gaps.at_end & ~long
    return reasons


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
