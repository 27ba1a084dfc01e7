"""The answer of an alignment's score: how much head motion is left, and a card per recording."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_tables.answer import Answer, Card
from nodegraph_tables.lead import svg
from nodegraph_tables.text import HERE, Text, Word, say

if TYPE_CHECKING:
    from nodegraph_mocap import Table, Trajectories
    from nodegraph_score.components import Components, Movement

HEAD, FACE = "head motion", "face"
_FEWEST = 2
_MOST_BARS = 8
_TALL = 60.0


def named(part: Table, axes: tuple[str, ...]) -> str:
    """Return the labels of a recording's rows as one text."""
    first = part.iloc[0]
    return ", ".join(str(first[axis]) for axis in axes if first[axis] != "")


def left_out(recording: Trajectories, pca: Components, moved: Movement) -> Iterator[str]:
    """Yield notes on data left out, and on results that cannot be determined."""
    frames = len(moved.curves)
    if frames < _FEWEST:
        yield f"needs {_FEWEST} complete frames; {_lacking(recording)}"
        return
    if frames < recording.frames:
        yield f"{recording.frames - frames} of {recording.frames} frames lack samples: left out"
    if not len(pca.sd):
        yield "nothing moves: there are no components"
    elif not moved.columns.size:
        yield "the head does not move: nothing can go with it"
    elif not moved.conclusive:
        numbers = moved.basis.shape[1]
        yield f"{frames} frames are too few to say what goes with {numbers} numbers of the head"


def _lacking(recording: Trajectories) -> str:
    complete = int(np.count_nonzero(recording.present.all(axis=1)))
    if not recording.frames or not recording.markers:
        return f"there are {recording.frames} frames of {len(recording.markers)} markers"
    missing = np.count_nonzero(~recording.present, axis=0)
    worst = int(missing.argmax())
    summary = f"{complete} of {recording.frames} are"
    if not missing[worst]:
        return summary
    return f"{summary} ({recording.markers[worst]} alone lacks {missing[worst]}): fill it first"


def answer_of(parts: Sequence[Table], axes: tuple[str, ...]) -> Answer:
    """Return the answer: how much of the variance head motion makes, in each recording.

    Parameters
    ----------
    parts
        The rows of each recording.
    axes
        Their columns with labels.
    """
    scope = (
        "Scope: these recordings. Large: the share of head motion in the first principal "
        "component; the rest is the face's. Bars: the share of all variance that each component "
        "has; filled, what head motion makes of it."
    )
    return Answer(_headline(parts, axes), (scope,), tuple(_card(part, axes) for part in parts))


def _headline(parts: Sequence[Table], axes: tuple[str, ...]) -> Text:
    most = max(parts, key=_in_first)
    rest = [part for part in parts if part is not most]
    in_first = say(f"{HERE} head motion", Word(_percent(_in_first(most)), "number"))
    where = f" in {named(most, axes)}" if rest else ""
    in_all = Word(_percent(_in_all(most)), "number")
    sentence = say(
        f"The first principal component is {HERE}{where}, as is {HERE} of all variance",
        in_first,
        in_all,
    )
    if not rest:
        return say(f"{HERE}.", sentence)
    others = "the other" if len(rest) == 1 else f"the {len(rest)} others"
    first, every = (
        Word(_percent(max(map(share, rest))), "number") for share in (_in_first, _in_all)
    )
    return say(f"{HERE}; in {others} at most {HERE}, and {HERE}.", sentence, first, every)


def _card(part: Table, axes: tuple[str, ...]) -> Card:
    return Card(
        title=(named(part, axes) or "recording",),
        headline=(_percent(_in_first(part)),),
        aside=(f"head motion; {_percent(_in_all(part))} of all variance",),
        picture=_picture(part),
        facts=(("Finds", (", ".join(part["finds"]),)),),
    )


def _picture(part: Table) -> str:
    rows = part.head(_MOST_BARS)
    wide = 240.0 / max(len(rows), 4)
    bars = []
    largest = float(rows["share"].max())
    for place, (share, head) in enumerate(zip(rows["share"], rows["head motion"], strict=True)):
        x = place * wide
        for kind, size in (("", share), ("part", share * min(max(head, 0.0), 1.0))):
            tall = _TALL * (size / largest)  # the largest is as tall as all, to the last bit
            bars.append(
                f'<rect class="{kind}" x="{x:g}" y="{_TALL - tall:.1f}" width="{wide - 6:g}" '
                f'height="{tall:.1f}"/>'
            )
        bars.append(
            f'<text class="middle" x="{x + wide / 2 - 3:g}" y="{_TALL + 14:g}">'
            f"{100 * share:.0f} %</text>"
        )
    return svg("shares of the variance of the principal components", _TALL + 18.0, bars)


def _in_first(part: Table) -> float:
    return float(part["head motion"].iloc[0])


def _in_all(part: Table) -> float:
    return float(part["in all"].iloc[0])


def _percent(share: float) -> str:
    """Return a share; where head and face work against each other, it may be below 0."""
    return f"{round(100 * share) + 0} %"
