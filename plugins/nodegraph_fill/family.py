"""The family of fills: the settings, documentation and warnings that every method has.

A method estimates the samples in the gaps that it is given. Which gaps these are, whether the
estimate is moved to meet their ends, how its samples are marked and what is left missing is the
same for all fills, and so are the settings `ends` and `max_gap` that say so.
"""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache, wraps
from typing import Any, Literal, Protocol, get_args, get_origin, get_type_hints

import numpy as np

from nodegraph_fill.gaps import Gaps, MaxGap
from nodegraph_fill.meet_ends import Ends
from nodegraph_mocap import Origin, Trajectories

LEFT = """\
A marker that is never measured stays missing, counted in a warning. Samples that are present
come out as they went in; those that an earlier fill has made count like measured ones."""
"""The paragraph on what most fills leave as it is."""

CALLER = 5
"""The `stacklevel` by which a warning in what `fill_gaps` calls names the caller of the fill."""


class Fill(Protocol):
    """A method with the settings of all fills, called with a recording."""

    __name__: str

    def __call__(
        self,
        recording: Trajectories,
        *,
        ends: Ends = "as_published",
        max_gap: int | None = None,
        **settings: Any,
    ) -> Trajectories:
        """Return the recording with filled samples."""


@dataclass(frozen=True)
class Setting:
    """A setting that fills share, with its line in their documentation."""

    name: str
    annotation: object
    default: object
    meaning: str


ENDS = Setting(
    "ends",
    Ends,
    "as_published",
    """\
as_published: the estimate as it is. met: its mismatch at each end of a gap, sample minus
estimate, is spread linearly over the gap, all of it at that end and none at the other;
a gap that the take begins or ends with has one end.""",
)
NO_ENDS = Setting(
    "ends", Ends, "as_published", "No effect: the fill meets both ends of a gap by itself."
)
MAX_GAP = Setting(
    "max_gap",
    MaxGap,
    None,
    """\
Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
of missing samples of one marker.""",
)


def make_fill(
    method: Callable[..., object],
    fill: Callable[..., Trajectories],
    shared: Iterable[Setting],
    left: str,
) -> Fill:
    """Return a method as a function of a recording with its own and the shared settings.

    Parameters
    ----------
    method
        Its keyword-only arguments are settings; its docstring describes it and these.
    fill
        ``fill(recording, **settings)`` fills by that method; all settings are given.
    shared
        Settings that are added to the method's own.
    left
        The paragraph that says what stays missing, which is added to the docstring.
    """
    own = inspect.signature(method).parameters.values()
    keyword = inspect.Parameter.KEYWORD_ONLY
    signature = inspect.Signature(
        [
            inspect.Parameter(
                "recording", inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=Trajectories
            ),
            *(setting for setting in own if setting.kind is keyword),
            *(
                inspect.Parameter(
                    each.name, keyword, default=each.default, annotation=each.annotation
                )
                for each in shared
            ),
        ],
        return_annotation=Trajectories,
    )

    @cache
    def choices() -> dict[str, tuple[object, ...]]:
        # read when a fill is called: annotations of the method may name what is defined below it
        hints = get_type_hints(filled)
        return {name: get_args(hint) for name, hint in hints.items() if get_origin(hint) is Literal}

    @wraps(method)
    def filled(*inputs: Any, **settings: Any) -> Trajectories:
        bound = signature.bind(*inputs, **settings)
        bound.apply_defaults()
        for name, allowed in choices().items():
            given = bound.arguments[name]
            if given not in allowed:
                *others, last = map(str, allowed)
                raise ValueError(f"{name} must be {', '.join(others)} or {last}, got {given!r}")
        return fill(**bound.arguments)

    filled.__signature__ = signature  # type: ignore[attr-defined]
    filled.__annotations__ = {
        **{name: each.annotation for name, each in signature.parameters.items()},
        "return": Trajectories,
    }
    filled.__doc__ = _documentation(inspect.getdoc(method) or "", shared, left)
    return filled


def _documentation(doc: str, shared: Iterable[Setting], left: str) -> str:
    """Return a method's docstring with what all fills have."""
    text, _, raises = doc.partition("\n\nRaises\n------\n")
    text, _, settings = text.partition("\n\nParameters\n----------\n")
    entries = ["recording\n    Trajectories with gaps.", *filter(None, [settings])]
    entries += [f"{each.name}\n    " + each.meaning.replace("\n", "\n    ") for each in shared]
    sections = {
        "Parameters": "\n".join(entries),
        "Returns": (
            "Trajectories\n    The recording with filled samples, their origin `Origin.FILLED`."
        ),
        "Raises": raises,
    }
    return "\n\n".join(
        [text, left]
        + [f"{name}\n{'-' * len(name)}\n{each}" for name, each in sections.items() if each]
    )


def fill_gaps(
    recording: Trajectories,
    max_gap: int | None,
    fill: Callable[[Trajectories, Gaps], Trajectories],
    *,
    both_ends: bool = False,
    otherwise: str = "",
) -> Trajectories:
    """Fill the gaps that are not too long, and warn of what is left; called by a fill.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    max_gap
        Longer gaps stay missing.
    fill
        Takes the recording and the gaps to fill; not called when there are none.
    both_ends
        Whether it only fills gaps between two samples of the marker.
    otherwise
        Why it may leave a sample missing.
    """
    gaps = Gaps.of(recording)
    long = gaps.longer_than(max_gap) & ~gaps.never
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
