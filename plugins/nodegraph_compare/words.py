"""Words for the parts of verdicts: what they hold for, why there is none, numbers and names."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

from nodegraph import listed
from nodegraph_compare.inference import FEWEST, FEWEST_SETTLED, LEVEL
from nodegraph_compare.question import EXTREME
from nodegraph_compare.units import MOST_RECORDINGS
from nodegraph_compare.verdict import COMMON
from nodegraph_tables.answer import MAY_BE
from nodegraph_tables.numbers import (
    MINUS,
    SPACE,
    above_text,
    chance_text,
    change_percent,
    difference_text,
    shares_text,
    span_text,
    to_digits_of,
)
from nodegraph_tables.style import bare_unit, unit_text
from nodegraph_tables.text import HERE, Word, joined, listing, plain, say

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from nodegraph import Label
    from nodegraph_compare.question import Question
    from nodegraph_compare.units import Shortage
    from nodegraph_compare.verdict import Metric, Paired, Rule, Scope, Verdict, Verdicts
    from nodegraph_tables.text import Text

UNCLEAR = "with no clear change"

_FEW_BLOCKS = 10
_MOST_NAMES = 3


def scope_text(scope: Scope) -> str:
    """Return what a result holds for: ``over 8 actors``, ``for further gaps in this recording``."""
    if scope.kind == "clusters":
        return f"over {scope.clusters} {scope.several}"
    if not scope.blocks:
        return f"for further {scope.several}"
    where = "this recording" if scope.clusters == 1 else f"these {scope.clusters} recordings"
    if scope.kind == "segments":
        return f"for the next minutes of {where}"
    return f"for further {scope.blocks} in {where}"


def units_text(scope: Scope) -> str:
    """Return the number of units with their name: ``8 actors``, ``10 segments``."""
    count = scope.clusters if scope.kind == "clusters" else scope.units
    return f"{count} {units_name(scope)}"


def units_name(scope: Scope) -> str:
    """Return what several units are called."""
    if scope.kind == "clusters":
        return scope.several
    if scope.kind == "draws":
        return f"{_repetition(scope)}s" if scope.clusters == 1 else "repetitions"
    return "segments of the recording" if scope.kind == "segments" else "recordings"


def _repetition(scope: Scope) -> str:
    """Return what a repetition on the same data is called, as the graph's axis is: ``trial``."""
    return scope.drawn or "repetition"


def caution_text(scope: Scope) -> str:
    """Return why nothing can be said, or what too few units leave open; empty for enough."""
    if scope.speech == "nothing":
        return _shortage_text(scope) or f"{scope.count} units"
    if scope.speech == "described":
        return f"{units_text(scope)} describe the methods and decide nothing"
    if scope.speech == "provisional":
        return f"provisional, as of {units_text(scope)}"
    return ""


def _shortage_text(scope: Scope) -> str:
    shortage = scope.shortage
    if shortage is None:
        return ""
    if shortage.of == "numbers":
        return "no block has a number for every method"
    if shortage.of == "repetitions":
        several = shortage.there > 1
        there = f"{shortage.there:.0f}" if several else "one"
        name = f"{_repetition(scope)}{'s' * several}"
        few = f"{there} {name} where {shortage.needed:.0f} are needed"
    else:
        few = f"fewer than three {_repetition(scope)}s, and {segments_text(scope, shortage)}"
    if not scope.drawn:
        return f"{few}; an axis of repetitions, each with damage of its own, would help"
    return f'{few}; ten {_repetition(scope)}s are enough: --axis "{scope.drawn}={{count: 10}}"'


def segments_text(scope: Scope, shortage: Shortage) -> str:
    """Return why a recording has no segments."""
    there, needed = f"{shortage.there:,.0f}", f"{shortage.needed:,.0f}"
    if shortage.of == "frames":
        return f"{there} frames where {needed} are needed"
    of = scope.blocks or "blocks"
    return f"{there} {of} leave one of {needed} segments of time without any"


def few_blocks_text(scope: Scope) -> str:
    """Return a remark on units of so few blocks that the means of skewed errors are biased."""
    if scope.kind != "clusters" or not 1 < scope.fewest < _FEW_BLOCKS:
        return ""
    return (
        f"fewer than {_FEW_BLOCKS} blocks in some of the {scope.several} "
        f"(at least {scope.fewest}): means of skewed errors are biased"
    )


def rules_text(question: Question, several: str, clusters: int) -> str:
    """Return what units are, and how many of them say how much.

    Parameters
    ----------
    question
        Of the comparison.
    several
        What several clusters are called.
    clusters
        How many there are.
    """
    if question.clusters and clusters > MOST_RECORDINGS:
        return (
            f"The independent units are {several}, which weigh equally: three or four are "
            f"described without p, fewer than {FEWEST_SETTLED} are provisional."
        )
    one = "one recording" if clusters == 1 else f"{clusters} recordings"
    return (
        f"All blocks are of {one}, and results hold for no other. The units are repetitions, which "
        f"say what further ones would; or, without {FEWEST} of these, equal segments, long against "
        "the time over which a recording is correlated, which say what its next minutes would. "
        f"Fewer than {FEWEST_SETTLED} units are provisional."
    )


def rule_text(rule: Rule, blocks: str) -> str:
    """Return a rule for missing blocks as a sentence has it: ``over common gaps``."""
    if rule == COMMON:
        return f"over common {blocks}"
    return f"with the worst error of {blocks} instead"


def reason_text(verdicts: Verdicts, group: Verdict) -> str:
    """Return why a group has no verdict."""
    if group.stands:
        return "no difference is clear"
    if objection := _objection(verdicts, group):
        return f"the rules for missing blocks disagree: {objection}"
    return caution_text(group.scope)


def reasons_of(verdicts: Verdicts, groups: Iterable[Verdict]) -> list[str]:
    """Return why groups have no verdict, each reason once; of shortages of a kind the largest."""
    largest: dict[str, Verdict] = {}
    for group in groups:
        shortage = None if group.objections else group.scope.shortage
        kind = reason_text(verdicts, group) if shortage is None else shortage.of
        if kind not in largest or _lack(group) > _lack(largest[kind]):
            largest[kind] = group
    return [reason_text(verdicts, group) for group in largest.values()]


def _lack(group: Verdict) -> float:
    shortage = group.scope.shortage
    return 0.0 if shortage is None else shortage.needed - shortage.there


def _objection(verdicts: Verdicts, group: Verdict) -> str:
    return " and ".join(
        f"{rule_text(rule, verdicts.blocks)} {_best_instead(verdicts, other)}"
        for rule, other in group.objections.items()
    )


def _best_instead(verdicts: Verdicts, other: Verdict) -> str:
    if not other.best:
        return "nothing can be said"
    names = plain_names(verdicts, other.best)
    return f"{listed(names)} {'share' if len(names) > 1 else 'has'} the best mean"


def change_of(verdicts: Verdicts, group: Verdict, other: Verdict) -> str:
    """Return what another rule says in place of a verdict; empty where it says the same."""
    if other.best != group.best:
        return _best_instead(verdicts, other)
    behind, still = group.worse_than_best, other.worse_than_best
    gone = [place for place in behind if place not in still]
    new = [place for place in still if place not in behind]
    return " and ".join(
        f"{listed(plain_names(verdicts, places))} {'are' if len(places) > 1 else 'is'} {how} "
        "clearly behind"
        for places, how in ((gone, "no longer"), (new, "also"))
        if places
    )


def number_name(verdicts: Verdicts, unit: str = "") -> str:
    """Return what the number of a method is: ``Mean rmse (mm) of a typical actor``.

    Parameters
    ----------
    verdicts
        Of the comparison.
    unit
        Of the metric, as a reader sees it.
    """
    name = f"{verdicts.metric.name}{f' ({unit})' if unit else ''}"
    if all(group.of_blocks == 1 for group in verdicts.groups):
        return f"{name[:1].upper()}{name[1:]}"
    mean = f"Mean {name}"
    clusters = max((group.scope.clusters for group in verdicts.groups), default=1)
    if clusters == 1:
        return f"{mean} over {verdicts.blocks}"
    if not verdicts.ratio:
        return f"{mean} over {verdicts.units}"
    are_clusters = any(group.scope.kind == "clusters" for group in verdicts.groups)
    several = verdicts.units if are_clusters else "recordings"
    one = several.removesuffix("s").replace("combinations of", "combination of")
    return f"{mean} of a typical {one}"


def beside_text(verdicts: Verdicts, values: Sequence[float], metric: Metric) -> str:
    """Return means of the metrics shown next to the first, from first to last, in few digits.

    Frames are given in time where the rate is known.
    """
    if metric.unit == "share":
        return shares_text(values)
    rate = verdicts.recordings.rate
    if metric.unit != "frames" or not rate:
        return span_text(values, metric.unit)
    times = dict.fromkeys(str(round(1000 * value / rate)) for value in values)
    return f"{' to '.join(times)}{SPACE}ms".replace("-", MINUS)


def method_words(verdicts: Verdicts, places: Iterable[int]) -> list[Word]:
    """Return the names of methods; a number with what it is a value of: ``threshold 2``."""
    return [
        Word(_name(verdicts, label), "method", str(label))
        for label in (verdicts.methods[place] for place in places)
    ]


def best_words(verdicts: Verdicts, places: Iterable[int]) -> list[Word]:
    """Return the names of methods that stand out, as a verdict has them for the best."""
    return [replace(word, kind="strong") for word in method_words(verdicts, places)]


def _name(verdicts: Verdicts, label: Label) -> str:
    return str(label) if isinstance(label, str) else f"{verdicts.compare} {label}"


def plain_names(verdicts: Verdicts, places: Iterable[int]) -> list[str]:
    """Return the labels of methods as text."""
    return [str(verdicts.methods[place]) for place in places]


def count_text(count: int, several: str) -> str:
    """Return a number of things: ``10 gaps``, ``1 gap``."""
    return f"{count:,} {several if count != 1 else several.removesuffix('s')}"


def label_text(label: Label, unit: str = "", rate: float = 0.0) -> str:
    """Return a label as a reader sees it: words, or a number without useless digits and its unit.

    Frames are given in time, too, where the rate is known: ``5 frames (83 ms)``.
    """
    if isinstance(label, bool):
        return "yes" if label else "no"
    if not isinstance(label, (int, float)):
        return label.replace("_", " ")
    if unit == "share":
        return f"{100 * label:.10g}{SPACE}%"
    time = f" ({_time_text(label / rate)})" if unit == "frames" and rate else ""
    if label == 1 and len(unit) > 1:
        unit = unit.removesuffix("s")  # 1 frame
    return f"{label:.12g}{SPACE}{unit_text(unit)}".rstrip(SPACE) + time


def _time_text(seconds: float) -> str:
    return f"{1000 * seconds:.0f}{SPACE}ms" if seconds < 1 else f"{seconds:.3g}{SPACE}s"


def with_units(verdicts: Verdicts, *, times: bool = True) -> Verdicts:
    """Return verdicts as a reader sees them: labels with their units, fields without their axis.

    Parameters
    ----------
    verdicts
    times
        Whether frames are given in time, too.
    """
    rate = verdicts.recordings.rate if times else 0.0
    groups = (
        replace(
            group,
            labels=tuple(
                label_text(label, unit, rate)
                for label, unit in zip(group.labels, verdicts.axis_units, strict=True)
            ),
        )
        for group in verdicts.groups
    )
    varied = (replace(each, axis=_field(each.axis)) for each in verdicts.variations)
    return replace(
        verdicts,
        within=tuple(map(_field, verdicts.within)),
        variations=tuple(varied),
        groups=tuple(groups),
    )


def times_text(verdicts: Verdicts, axis: int) -> str:
    """Return how long the labels of an axis of frames are; empty for others."""
    unit, rate = verdicts.axis_units[axis], verdicts.recordings.rate
    if unit != "frames" or not rate:
        return ""
    labels = dict.fromkeys(label_text(group.labels[axis], unit, rate) for group in verdicts.groups)
    return f"{verdicts.within[axis].capitalize()}: {listed(list(labels))}."


def tied_text(verdicts: Verdicts, group: Verdict) -> Text:
    """Return which methods may be as good as the best, the nearest first, and how far they are."""
    order = nearest_first(group, group.tied)
    names = method_words(verdicts, order)
    texts = [
        say(f"{HERE} {HERE}", name, uncertain_text(verdicts, group, place))
        for name, place in zip(names, order, strict=True)
    ]
    more = len(order) - _MOST_NAMES
    return joined("; ", [*texts[:_MOST_NAMES], f"{more} more" if more > 0 else ""])


def nearest_first(group: Verdict, places: Iterable[int]) -> list[int]:
    """Return methods by their distance to the best."""
    return sorted(places, key=lambda place: abs(group.to_best_of(place)))


def uncertain_text(verdicts: Verdicts, group: Verdict, place: int) -> Text:
    """Return how far a method is from the best, in how many units, and the p of that."""
    paired = group.to_best
    assert paired is not None
    of, losses, wins = group.scope.units, int(paired.losses[place]), int(paired.wins[place])
    counts = [("worse", losses), *[("equal", equal) for equal in [of - losses - wins] if equal]]
    claims = [say(f"{claim} in {HERE}", Word(f"{count}", "number")) for claim, count in counts]
    units = units_name(group.scope).removeprefix("synthetic ")
    far = Word(_above(verdicts, group, place, group.best[0]), "number")
    start = say(f"{HERE}, {HERE} of {of} {units}", far, listing(claims))
    if place in group.worse_than_best:
        return (*start, f", not by every rule for missing {verdicts.blocks}")
    return say(f"{HERE}, {HERE}", start, Word(chance_text(float(paired.p[place])), "number"))


def _above(verdicts: Verdicts, group: Verdict, place: int, to: int) -> str:
    """Return by how much the mean of a method is above that of another, with its sign."""
    means = (float(group.mean[place]), float(group.mean[to]))
    text = difference_text([means], verdicts.metric.unit)
    if text.startswith("under"):
        return f"{text} apart"
    return text if text.startswith(MINUS) else f"+{text}"


def beside_best(verdicts: Verdicts, group: Verdict) -> list[int]:
    """Return the methods that are told beside the best of a group.

    It is the one to take, where that is another; else those that may be as good, or else the
    nearest.
    """
    take = verdicts.for_all
    if group.stands and take is not None and take not in group.best:
        return [take]
    if not group.told:
        return []
    return nearest_first(group, group.tied) or nearest_first(group, group.behind)[:1]


def standing_text(verdicts: Verdicts, group: Verdict) -> Text:
    """Return how those that are told beside the best of a group stand to it."""
    beside = beside_best(verdicts, group)
    if not beside:
        return ()
    first = f"{EXTREME[group.better] if group.tied else 'clearly best'}; " * group.told
    if len(beside) > 1:
        return (f"{first}{len(beside)} others {MAY_BE}",)
    (place,) = beside
    (name,) = method_words(verdicts, beside)
    if place != verdicts.for_all:
        if place in group.tied:
            return say(f"{first}{HERE} {MAY_BE}", name)
        return say(f"{first}next, {HERE} {HERE}", name, behind_text(verdicts, group, place))
    claim = f", {MAY_BE}" if place in group.tied else ", clearly behind" * bool(group.tied)
    return say(f"{first}{HERE} {HERE}{claim}", name, behind_text(verdicts, group, place))


def behind_text(verdicts: Verdicts, group: Verdict, place: int) -> Text:
    """Return how far a method is from the best, in its unit and as a share."""
    best, mean = float(group.mean[group.best[0]]), float(group.mean[place])
    text = _above(verdicts, group, place, group.best[0])
    is_share = best > 0 and verdicts.ratio and not text.startswith("under")
    share = f" ({above_text(mean, best)})" if is_share else ""
    return (Word(f"{text}{share}", "number"),)


def within_text(verdicts: Verdicts, group: Verdict, place: int, paired: Paired) -> Text:
    """Return how far a method is from the one that it is paired with, and the interval of that."""
    unit, mean = verdicts.metric.unit, float(group.mean[paired.reference])
    ends = to_digits_of(
        mean, [float(paired.difference_low[place]), float(paired.difference_high[place])]
    )
    between = Word(f"95 %: {span_text(ends, bare_unit(unit))}", "number")
    far = Word(_above(verdicts, group, place, paired.reference), "number")
    return say(f"{HERE} ({HERE})", far, between)


def changes(group: Verdict) -> dict[int, tuple[int, str]]:
    """Return the step before each step, and whether this one lowers or raises the mean."""
    return {
        step: (before, ("lowers" if group.mean[step] < group.mean[before] else "raises")
               if group.stands and group.p_of_step[step] <= LEVEL else UNCLEAR)
        for before, step in pairwise(group.known)
    }  # fmt: skip


def change_text(verdicts: Verdicts, group: Verdict, before: int, step: int) -> str:
    """Return the distance between the means of two steps: ``36 %``, or ``0.12 mm``."""
    first, second = float(group.mean[before]), float(group.mean[step])
    if verdicts.ratio and first > 0:
        return change_percent(second, first)
    return span_text([abs(second - first)], verdicts.metric.unit)


def group_title(verdicts: Verdicts, group: Verdict, axes: Sequence[int] | None = None) -> str:
    """Return the labels of a group along some axes, by default those in which groups differ."""
    return plain(group_words(verdicts, group, axes))


def group_words(verdicts: Verdicts, group: Verdict, axes: Sequence[int] | None = None) -> Text:
    """Return the title of a group, in which its labels stand out."""
    axes = varying(verdicts) if axes is None else axes
    texts = (
        say(f"{_field(verdicts.within[axis])} {HERE}", Word(str(group.labels[axis])))
        for axis in axes
    )
    return joined(", ", texts)


def _field(name: str) -> str:
    """Return the name of a field without that of its axis: ``missing`` for ``mask.missing``."""
    return name.rpartition(".")[2]


def varying(verdicts: Verdicts) -> list[int]:
    """Return the places in `within` of the axes along which groups differ; all, if none does."""
    axes = [
        axis
        for axis in range(len(verdicts.within))
        if len({group.labels[axis] for group in verdicts.groups}) > 1
    ]
    return axes or list(range(len(verdicts.within)))
