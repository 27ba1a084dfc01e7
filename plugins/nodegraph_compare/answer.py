"""The answer of a comparison: who is best, what that holds for, and what was found in each group.

It is made once, of verdicts; whatever shows an answer draws it from this.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from nodegraph_compare.cards import cards_of
from nodegraph_compare.described import described, is_described
from nodegraph_compare.inference import LEVEL
from nodegraph_compare.question import EXTREME
from nodegraph_compare.words import (
    UNCLEAR,
    beside_text,
    best_words,
    caution_text,
    change_text,
    changes,
    count_text,
    group_title,
    label_text,
    method_words,
    number_name,
    plain_names,
    reasons_of,
    scope_text,
    tied_text,
    units_text,
    varying,
    with_units,
)
from nodegraph_tables.answer import MAY_BE, MOST_CARDS, ONE_ROW, Answer, Finding
from nodegraph_tables.numbers import (
    MANY_TIMES,
    apart_text,
    change_percent,
    is_seen,
    ranged,
    span_text,
)
from nodegraph_tables.style import SHARE, unit_text
from nodegraph_tables.text import HERE, Text, Word, few, joined, listing, plain, say

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.verdict import Variation, Verdict, Verdicts

    Side = Literal["lower", "higher"]

_LINES = "Described, without a verdict: lines are 95 % intervals, and the dot hides a shorter one."
_CLEAR = (
    "the best is clear",
    "others may be as good as the best",
    "no difference is clear",
    "there is no verdict",
)
_MOST_NAMES = 3
_MOST_CLAUSES = 6
_MOST_TIED = 2
_MOST_LABELS = 5
_ALIKE = "not clearly different"


def answer_of(verdicts: Verdicts) -> Answer:
    """Return the answer of verdicts on all groups."""
    named = with_units(verdicts)
    findings = tuple(
        _finding(verdicts, group, shown)
        for group, shown in zip(verdicts.groups, named.groups, strict=True)
    )
    if is_described(named):
        answer = described(named)
        lines = (_LINES, *_without_0(findings)) if any(each.low for each in findings) else ()
        scope = scope_words(named)
        return replace(answer, scope=scope, findings=findings, certainty=lines)
    cards = cards_of(named) if len(named.groups) <= MOST_CARDS else ()
    overall = None if verdicts.overall is None else _finding(verdicts, verdicts.overall)
    take = "" if verdicts.for_all is None else str(verdicts.methods[verdicts.for_all])
    sentence, scope, certainty = _sentence(named), scope_words(named), _certainty(named)
    return Answer(sentence, scope, cards, (), findings, overall, take, certainty)


def _finding(verdicts: Verdicts, group: Verdict, shown: Verdict | None = None) -> Finding:
    """Return what is found in a group, `shown` to readers with units; or over all of them."""
    marks = group.marks
    axes = range(len(verdicts.within))

    def named(places: Sequence[int]) -> tuple[str, ...]:
        return tuple(plain_names(verdicts, places))

    def numbers(values: NDArray[np.float64]) -> dict[str, float]:
        known = [place for place in group.known if np.isfinite(values[place])]
        return {str(verdicts.methods[place]): float(values[place]) for place in known}

    def ends(low: NDArray[np.float64], high: NDArray[np.float64]) -> dict[str, tuple[float, float]]:
        lows, highs = numbers(low), numbers(high)
        return {name: (lows[name], highs[name]) for name in lows}

    paired = group.paired
    better, worse = _sides(verdicts)
    return Finding(
        group=dict(zip(verdicts.within, group.labels, strict=True)) if shown else {},
        title=group_title(verdicts, shown, axes) if shown else "all groups together",
        verdict=group.told,
        best=named(group.best) if group.told else (),
        tied=named(group.tied) if marks else (),
        behind=named(group.behind),
        better=named(group.beyond_baseline(better)),
        worse=named(group.beyond_baseline(worse)),
        first=named(group.best),
        mean=numbers(group.mean),
        low=numbers(group.low),
        high=numbers(group.high),
        p={} if paired is None else numbers(paired.p),
        unit=verdicts.metric.unit,
        reference="" if paired is None else str(verdicts.methods[paired.reference]),
        apart={} if paired is None else ends(paired.difference_low, paired.difference_high),
        beside={name: numbers(values) for name, values in group.beside.items()},
        units={metric.name: metric.unit for metric in verdicts.beside},
    )


# the sentence


def _sentence(verdicts: Verdicts) -> Text:
    known = [group for group in verdicts.groups if group.known]
    metric = verdicts.metric
    if not known:
        return ("No block has a number for every method: nothing can be said.",)
    if all(len(group.known) == 1 for group in known):
        return _values(verdicts, known)
    if metric.better == "none":
        return (f"Neither end of {metric.name} is the better one: what follows describes it.",)
    stands = [group for group in known if group.stands]
    if verdicts.is_sequence and stands:
        return _steps(verdicts, stands)
    told = [group for group in known if group.told]
    first = _decided(verdicts, known, told) if told else _undecided(verdicts, known)
    varied = [_varied(verdicts, each) for each in verdicts.variations if told]
    more = [_without_suspects(verdicts, known), *varied, _absent(verdicts, known)]
    return joined(" ", [first, *_against(verdicts, known), *more])


def _undecided(verdicts: Verdicts, known: Sequence[Verdict]) -> Text:
    """Return why there is no verdict, and which methods come first all the same."""
    reasons = reasons_of(verdicts, known)
    others = len(reasons) - 1
    more = f" (and {others} more reason{'s' * (others > 1)})" if others else ""
    what = f"what each {verdicts.compare} does" if verdicts.is_sequence else "which is best"
    why = f"The data cannot tell {what}: {reasons[0]}{more}."
    if verdicts.is_sequence:
        return (why,)
    return say(f"{HERE}. {why}", _firsts(verdicts, known))


def _firsts(verdicts: Verdicts, groups: Sequence[Verdict]) -> Text:
    """Return which methods have the best mean in groups, without a verdict."""
    end = EXTREME[verdicts.metric.better].capitalize()
    metric = verdicts.metric.name
    by_leader = _by_leader(groups)
    if len(by_leader) > 1 and len(varying(verdicts)) > 1 and len(groups) > ONE_ROW:
        counts = sorted(by_leader.items(), key=lambda item: -len(item[1]))
        names = [say(f"{HERE} in {len(of)}", _names(verdicts, each)) for each, of in counts]
        start = f"{end} mean {metric}, of {len(groups)} groups: {HERE}"
        return say(start, few(names, _MOST_NAMES))
    if len(by_leader) > 1:
        clauses = [
            say(
                f"{HERE} for {HERE} ({HERE})", _names(verdicts, leaders),
                _where(verdicts, of), _number(verdicts, of, leaders[0]),
            )
            for leaders, of in by_leader.items()
        ]  # fmt: skip
        return say(f"{end} mean {metric}: {HERE}", _shortened(clauses, "; "))
    (leaders,) = by_leader
    number = _number(verdicts, groups, leaders[0])
    where = {1: "", 2: " in both groups"}.get(len(groups), f" in all {len(groups)} groups")
    first = say(f"{end} mean {metric}{where}: {HERE} ({HERE})", _names(verdicts, leaders), number)
    rest = [place for place in groups[0].ranked if place in {*groups[0].known} - {*leaders}]
    if len(groups) > 1 or not 0 < len(rest) <= _MOST_NAMES:
        return first
    then = [
        say(f"{HERE} ({HERE})", name, _number(verdicts, groups, place))
        for name, place in zip(method_words(verdicts, rest), rest, strict=True)
    ]
    return say(f"{HERE}, then {HERE}", first, listing(then))


def _names(verdicts: Verdicts, places: Sequence[int]) -> Text:
    return listing(method_words(verdicts, places))


def _by_leader(groups: Sequence[Verdict]) -> dict[tuple[int, ...], list[Verdict]]:
    result: dict[tuple[int, ...], list[Verdict]] = {}
    for group in groups:
        result.setdefault(group.best, []).append(group)
    return result


def _number(verdicts: Verdicts, groups: Sequence[Verdict], place: int) -> Word:
    """Return the mean of a method, or the range of its means in several groups."""
    return _range(verdicts, [float(group.mean[place]) for group in groups])


def _range(verdicts: Verdicts, means: Sequence[float]) -> Word:
    """Return the means of groups, from the least to the largest."""
    text = span_text(sorted({min(means), max(means)}), verdicts.metric.unit)
    return Word(ranged(text, [verdicts.within[axis] for axis in varying(verdicts)]), "number")


def _decided(verdicts: Verdicts, known: Sequence[Verdict], told: Sequence[Verdict]) -> Text:
    """Return which method is best where, and where that is not clear."""
    leaders = set.intersection(*(set(group.best) for group in told))
    texts = [_throughout(verdicts, told, sorted(leaders)) if leaders else _depends(verdicts, told)]
    texts.append(_besides(verdicts, told))
    rest = [group for group in known if group not in told]
    if rest:
        reasons = reasons_of(verdicts, rest)
        where = _where(verdicts, rest) if len(rest) <= _MOST_CLAUSES else f"{len(rest)} groups"
        # where there are no cards, a reader finds which come first in the table
        is_short = len(known) <= MOST_CARDS
        first = say(f": {HERE}", _lower(_firsts(verdicts, rest))) if is_short else ()
        texts.append(say(f"Not clear for {where} ({'; '.join(reasons)}){HERE}.", first))
    return joined(" ", texts)


def _lower(text: Text) -> Text:
    first, *rest = text
    return (first[:1].lower() + first[1:], *rest) if isinstance(first, str) else text


def _throughout(verdicts: Verdicts, told: Sequence[Verdict], leaders: Sequence[int]) -> Text:
    names = listing(best_words(verdicts, leaders))
    several = len(leaders) > 1
    where, count = "", len(verdicts.groups)
    if len(told) < count:
        where = f" in {len(told)} of {count} groups"
    elif count > 1:
        where = " throughout"
    metric, number = verdicts.metric, _number(verdicts, told, leaders[0])
    if all(len(group.known) == len(leaders) for group in told):
        return say(f"{HERE} have the same mean {metric.name}{where} ({HERE}).", names, number)
    if not any(group.tied for group in told):
        verb = "are" if several else "is"
        return say(f"{HERE} {verb} best{where} ({HERE}); {HERE}.", names, number,
                   _all_behind(verdicts, told))  # fmt: skip
    verb = "share" if several else "has"
    start = f"{HERE} {verb} the {EXTREME[metric.better]} mean {metric.name}{where} ({HERE})"
    if len(told) == 1:
        others = tied_text(verdicts, told[0])
        behind = len(told[0].behind)
        rest = f"; {'the other' if behind == 1 else f'the other {behind}'} clearly behind"
        return say(f"{start}; {MAY_BE}: {HERE}{rest * bool(behind)}.", names, number, others)
    tied = set.intersection(*(set(group.tied) for group in told))
    if tied:
        order = sorted(tied, key=lambda place: abs(told[0].to_best_of(place)))
        against = few(method_words(verdicts, order), _MOST_NAMES)
        return say(f"{start}; {HERE} {MAY_BE}.", names, number, against)
    open_groups = [group for group in told if group.tied]
    if len(open_groups) > _MOST_CLAUSES:
        places = f"in {len(open_groups)} of {count} groups"
        return say(f"{start}; others {MAY_BE} {places}.", names, number)
    against = listing(method_words(verdicts, sorted({*open_groups[0].tied})))
    if any(group.tied != open_groups[0].tied for group in open_groups):
        against = ("others",)
    places = f"for {_where(verdicts, open_groups)}"
    return say(f"{start}; {HERE} {MAY_BE} {places}.", names, number, against)


def _all_behind(verdicts: Verdicts, told: Sequence[Verdict]) -> Text:
    """Return that all methods but the best are behind, and how far the nearest of them is."""
    far = [(group, place) for group in told for place in group.behind]
    nearest = _apart(verdicts, *min(far, key=lambda each: each[0].distance(each[1])))
    others = "the other" if all(len(group.behind) == 1 for group in told) else "every other"
    more = " or more" * (len(far) > 1)
    return say(f"{others} is clearly behind, by {HERE}{more}", nearest)


def _depends(verdicts: Verdicts, told: Sequence[Verdict]) -> Text:
    """Return what does for all, and which is best where, groups with the same best together."""
    by_leader: dict[int, list[Verdict]] = {}
    for group in told:
        by_leader.setdefault(group.best[0], []).append(group)
    axes = _deciding(verdicts, told)
    depends = f"It depends on {plain(listing([verdicts.within[axis] for axis in axes]))}"
    best = _best_by_group(verdicts, told, by_leader, axes)
    if verdicts.for_all is not None:
        take = _for_all(verdicts, told, verdicts.for_all)
        end = EXTREME[verdicts.metric.better].capitalize()
        return say(f"{depends}. {HERE} {end}: {HERE}.", take, best)
    return say(f"{depends}: {HERE}.", best)


def _best_by_group(
    verdicts: Verdicts,
    told: Sequence[Verdict],
    by_leader: Mapping[int, Sequence[Verdict]],
    axes: Sequence[int],
) -> Text:
    """Return the best of each group, in clauses; of many, how often each is the best."""
    if len(by_leader) > _MOST_CLAUSES:
        counts = sorted(by_leader.items(), key=lambda item: -len(item[1]))
        names = [
            say(f"{HERE} in {len(groups)}", best_words(verdicts, [place])[0])
            for place, groups in counts
        ]
        return say(f"{HERE}, of {len(told)} groups", few(names, _MOST_NAMES))
    most = max(by_leader, key=lambda place: len(by_leader[place]))
    several = len(axes) > 1 and len(by_leader[most]) > 1
    otherwise = several and len(by_leader) > 1 and len(told) == len(verdicts.groups)
    order = [place for place in by_leader if not (otherwise and place == most)]
    named = axes if len(told) == len(verdicts.groups) else varying(verdicts)
    clauses = [
        _clause(verdicts, place, of := by_leader[place], f"for {_where(verdicts, of, named)}")
        for place in order
    ]
    if otherwise:
        clauses.append(_clause(verdicts, most, by_leader[most], "otherwise"))
    return joined("; ", clauses)


def _deciding(verdicts: Verdicts, told: Sequence[Verdict]) -> list[int]:
    """Return the axes along which alone the best changes; all, if it takes more than one."""
    axes = varying(verdicts)

    def changes_best(axis: int) -> bool:
        best: dict[tuple[Label, ...], set[int]] = {}
        for group in told:
            others = (*group.labels[:axis], *group.labels[axis + 1 :])
            best.setdefault(others, set()).add(group.best[0])
        return any(len(places) > 1 for places in best.values())

    return [axis for axis in axes if changes_best(axis)] or axes


def _clause(verdicts: Verdicts, leader: int, groups: Sequence[Verdict], where: str) -> Text:
    """Return the best of groups, with the methods that may be as good in all of them."""
    equal = set.intersection(*({*group.best} for group in groups))
    tied = set.intersection(*({*group.tied, *group.best} for group in groups)) - equal
    number = _number(verdicts, groups, leader)
    names = listing(best_words(verdicts, sorted(equal)))
    if not any(group.tied for group in groups):
        return say(f"{HERE} {where} ({HERE})", names, number)
    order = sorted(tied, key=lambda place: np.nanmax([abs(g.to_best_of(place)) for g in groups]))
    others = _names(verdicts, order) or ("others",)
    if len(tied) > _MOST_TIED:
        others = (f"{len(tied)} others",)
    return say(f"{HERE} {where} ({HERE}; {HERE} {MAY_BE})", names, number, others)


def _where(verdicts: Verdicts, groups: Sequence[Verdict], axes: Sequence[int] | None = None) -> str:
    """Return the labels of groups along some axes, by as few as tell them from all others.

    The axes are, by default, those in which groups differ.
    """
    axes = varying(verdicts) if axes is None else axes
    if not axes:
        return "all"
    if len(axes) == 1:
        return _both([*dict.fromkeys(str(group.labels[axes[0]]) for group in groups)])
    left = {group.labels for group in groups}
    texts: dict[str, list[str]] = {}
    for axis in reversed(axes):
        for label in dict.fromkeys(group.labels[axis] for group in groups):
            same = {group.labels for group in verdicts.groups if group.labels[axis] == label}
            if same <= {group.labels for group in groups} and same & left:
                texts.setdefault(verdicts.within[axis], []).append(str(label))
                left -= same
    for group in groups:
        if group.labels in left:
            first = group_title(verdicts, group, axes[:-1])
            name = ", ".join(filter(None, [first, verdicts.within[axes[-1]]]))
            texts.setdefault(name, []).append(str(group.labels[axes[-1]]))
    named = [f"{name} {_both([*dict.fromkeys(labels)])}" for name, labels in texts.items()]
    return " and for ".join(filter(None, [", ".join(named[:-1]), *named[-1:]]))


def _both(texts: Sequence[str]) -> str:
    rest = len(texts) - _MOST_LABELS
    if rest > 1:
        texts = [*texts[:_MOST_LABELS], f"{rest} more"]
    return " and ".join(filter(None, [", ".join(texts[:-1]), *texts[-1:]]))


def _shortened(clauses: Sequence[Text], separator: str) -> Text:
    rest = len(clauses) - _MOST_CLAUSES
    more = f"{rest} more are in the table" if rest > 0 else ""
    return joined(separator, [*clauses[:_MOST_CLAUSES], more])


def _for_all(verdicts: Verdicts, told: Sequence[Verdict], place: int) -> Text:
    """Return the method to take whichever the group is, and what it does besides."""
    besides = listing(_beside_means(verdicts, [(group, place) for group in told]))
    also = say(f" ({HERE})", besides) if besides else ()
    return say(f"One method for all: {HERE}{HERE}.", *best_words(verdicts, [place]), also)


def _certainty(verdicts: Verdicts) -> Text:
    """Return why a method is the one to take, and by which rule methods are told apart."""
    stands = [group for group in verdicts.groups if group.stands]
    if not stands or verdicts.metric.better == "none":
        return ()
    take = () if verdicts.for_all is None else _taken(verdicts, verdicts.for_all)
    units = {units_text(group.scope) for group in stands}
    over = f" over {units.pop()}" if len(units) == 1 else ""
    counts = sorted({len(group.known) for group in stands})
    several = count_text(counts[-1], "steps" if verdicts.is_sequence else "methods")
    of = f"{'up to ' * (len(counts) > 1)}{several}"
    rule = f"Clearly: p \N{LESS-THAN OR EQUAL TO} {LEVEL:g}, paired tests{over}, adjusted for {of}."
    if verdicts.is_sequence:
        clear = _clear_steps(verdicts, stands)
    else:
        clear = "" if take else _told_apart(verdicts)
    return joined(" ", [take, clear, rule])


def _clear_steps(verdicts: Verdicts, groups: Sequence[Verdict]) -> str:
    """Return how many of the changes between steps are clear, and what the others are."""
    unit = verdicts.metric.unit
    every = [(group, *change) for group in groups for change in changes(group).items()]
    seen = [
        verb
        for group, step, (before, verb) in every
        if is_seen(float(group.mean[step]), float(group.mean[before]), unit)
    ]
    hardly, unclear = len(every) - len(seen), seen.count(UNCLEAR)
    parts = [f"{len(seen) - unclear} of {len(every)} changes are clear"]
    parts += [f"in {hardly} the mean hardly changes"] * bool(hardly)
    parts += [f"{unclear} {'are' if unclear > 1 else 'is'} not clear"] * bool(unclear)
    return f"{'; '.join(parts)}."


def _without_0(findings: Sequence[Finding]) -> Text:
    """Return how many differences to a reference have an interval without 0, of those shown."""
    every = [
        ends
        for each in findings
        for name, ends in each.apart.items()
        if each.reference not in ("", name)
    ]
    if not every:
        return ()
    reference = next(each.reference for each in findings if each.reference)
    above, below = sum(low > 0.0 for low, _ in every), sum(high < 0.0 for _, high in every)
    sides = [f"{above} above 0"] * bool(above) + [f"{below} below 0"] * bool(below)
    text = " and ".join(sides) or "none without 0"
    return (f" Of {len(every)} intervals of the difference to {reference}: {text}.",)


def _told_apart(verdicts: Verdicts) -> str:
    """Return in how many groups the best is clear, others may be as good, or none is best."""
    counts = Counter(map(_how_clear, verdicts.groups))
    parts, of = [text for text in _CLEAR if text in counts], f" of {len(verdicts.groups)} groups"
    if len(verdicts.groups) > 1 == len(parts):
        parts = [f"{parts[0]} in {'each' if parts[0] in _CLEAR[:2] else 'any'} group"]
    elif len(verdicts.groups) > 1:
        first, *rest = parts
        where = ["the other" if len(rest) == counts[text] == 1 else counts[text] for text in rest]
        parts = [f"{first} in {counts[first]}{of}"]
        parts += [f"in {place} {text}" for place, text in zip(where, rest, strict=True)]
    return f"{'; '.join(parts).capitalize()}."


def _how_clear(group: Verdict) -> str:
    if not group.told:
        return _CLEAR[2 if group.stands else 3]
    return _CLEAR[0 if group.behind and not group.tied else 1]


def _taken(verdicts: Verdicts, take: int) -> Text:
    """Return why a method is the one to take whichever the group is, and which is next."""
    groups, of_all = verdicts.groups, verdicts.overall
    end = EXTREME[verdicts.metric.better]
    worst = say(f"at most {HERE} in any", _far(verdicts, verdicts.worst_of(take), take))
    if all(take in group.best for group in groups):
        worst = (f"{end} in each",)
    if of_all is not None and take == verdicts.best_over_all:
        first = f"{end} over all {len(groups)} groups together"
        rest = [place for place in of_all.ranked if place in {*of_all.known} - {take}][:1]
        after = [f"over all is {HERE}, {HERE}" for _ in rest]
        far = [_how_far(verdicts, of_all, place) for place in rest]
    else:
        of, counts = f"of {len(groups)}", [verdicts.behind_in(p) for p in verdicts.least_behind]
        first = f"clearly behind in {counts[0] or 'none'} {of} groups"
        first += ", no method in fewer" * bool(counts[0])
        rest = [place for place in verdicts.least_behind if place != take][:1]
        after = [f"is {HERE} ({count or 'none'} {of}, at most {HERE})" for count in counts[1:2]]
        far = [_far(verdicts, verdicts.worst_of(place), place) for place in rest]
    others = [
        say(f"next {text}", name, size)
        for text, name, size in zip(after, method_words(verdicts, rest), far, strict=True)
    ]
    reason = joined("; ", [joined(", ", [first, worst]), *others])
    return say(f"{HERE} is {HERE}.", *best_words(verdicts, [take]), reason)


def _far(verdicts: Verdicts, group: Verdict, place: int) -> Text:
    """Return how far a method is from the best: ``12 % behind``, or ``2.5 times the best``."""
    times = group.distance(place)
    if verdicts.ratio and times >= MANY_TIMES and verdicts.metric.better != "higher":
        return (Word(f"{times:.1f} times", "number"), " the best")
    return (_apart(verdicts, group, place), " behind")


def _how_far(verdicts: Verdicts, group: Verdict, place: int) -> Text:
    """Return how far a method is from the best, and whether that is clear."""
    far = _far(verdicts, group, place)
    if place not in group.behind:
        return (f"{MAY_BE}, ", *far)
    return ("clearly " if far[-1] == " behind" else "clearly behind, ", *far)


def _apart(verdicts: Verdicts, group: Verdict, place: int) -> Word:
    """Return how far the means of a method and of the best are apart, in percent of ratios."""
    unit, means = verdicts.metric.unit, (float(group.mean[place]), float(group.mean[group.best[0]]))
    is_ratio = verdicts.ratio and unit != SHARE
    return Word(change_percent(*means) if is_ratio else apart_text(means, unit), "number")


def _varied(verdicts: Verdicts, variation: Variation) -> Text:
    """Return for how many methods one of two ways is better."""
    places = [axis for axis in varying(verdicts) if verdicts.within[axis] != variation.axis]
    every = f" at every {_both([verdicts.within[axis] for axis in places])}" if places else ""
    worse = method_words(verdicts, variation.worse)
    label, other = (label_text(each) for each in (variation.label, variation.other))
    start = (
        f"{variation.axis.capitalize()} {label}: better than {variation.axis} {other} for "
        f"{len(variation.better)} of {variation.methods} {verdicts.compare}s{every}; worse for "
    )
    return say(f"{start}{HERE}.", few(worse, _MOST_NAMES) if worse else "none")


def _without_suspects(verdicts: Verdicts, known: Sequence[Verdict]) -> Text:
    """Return which method is best without the suspect blocks, where these decide it."""
    by_leader: dict[tuple[int, ...], list[Verdict]] = {}
    for group in known:
        if group.suspects_decide and group.without_suspects is not None:
            by_leader.setdefault(group.without_suspects.best, []).append(group)
    clauses = [
        say(
            f"{HERE}{f' for {_where(verdicts, groups)}' * (len(known) > 1)}",
            listing(best_words(verdicts, leaders)),
        )
        for leaders, groups in by_leader.items()
    ]
    start = f"Without {verdicts.blocks} whose truth is suspect the best is {HERE}."
    return say(start, joined("; ", clauses)) if clauses else ()


def _absent(verdicts: Verdicts, known: Sequence[Verdict]) -> Text:
    """Return which methods have no number in some group, which are neither good nor behind."""
    absent = sorted({place for group in known for place in group.not_compared})
    if not absent:
        return ()
    where = "" if all({*absent} <= {*group.not_compared} for group in known) else " everywhere"
    names = few(method_words(verdicts, absent), _MOST_NAMES)
    return say(f"Not compared{where}, without any number: {HERE}.", names)


def _steps(verdicts: Verdicts, stands: Sequence[Verdict]) -> Text:
    """Return the effect of each step on the mean, with the groups in which it has it."""
    clauses: list[Text] = []
    for step in sorted({step for group in stands for step in changes(group)}):
        does: dict[str, list[Text]] = {}
        for group in stands:
            if step in (differences := changes(group)):
                before, verb = differences[step]
                clear = verb != UNCLEAR
                size = Word(change_text(verdicts, group, before, step), "number")
                by = say(f"by {HERE}", size) if clear else ()
                where = _where(verdicts, [group])
                does.setdefault(verb, []).append(
                    joined(" ", [by, f"({where})" if len(verdicts.groups) > 1 else ""])
                )
        (name,) = method_words(verdicts, [step])
        metric = "it" if clauses else verdicts.metric.name
        parts = [
            joined(" ", [verb, metric if verb != UNCLEAR else "", listing(sizes)])
            for verb, sizes in sorted(does.items())
        ]
        clauses.append(say(f"{HERE} {HERE}", name, joined(", ", parts)))
    return say(f"{HERE}.", joined("; ", clauses))


def _besides(verdicts: Verdicts, told: Sequence[Verdict]) -> Text:
    """Return what else the best methods do."""
    texts = _beside_means(verdicts, [(group, group.best[0]) for group in told])
    return say(f"Of the best: {HERE}.", listing(texts)) if texts else ()


def _beside_means(verdicts: Verdicts, of: Sequence[tuple[Verdict, int]]) -> list[Text]:
    """Return, of a method in each of some groups, the means of what else is asked."""
    texts = []
    for metric in verdicts.beside:
        means = [float(group.beside[metric.name][place]) for group, place in of]
        span = Word(beside_text(verdicts, [min(means), max(means)], metric), "number")
        texts.append(say(f"{metric.name} {HERE}", span))
    return texts


def _values(verdicts: Verdicts, known: Sequence[Verdict]) -> Text:
    """Return the mean of the only method, or the range of its means."""
    place = known[0].known[0]
    ends = _range(verdicts, [float(np.nanmin(group.mean)) for group in known])
    if not str(verdicts.methods[place]):
        return say(f"The mean {verdicts.metric.name} is {HERE}.", ends)
    (name,) = method_words(verdicts, [place])
    return say(
        f"The mean {verdicts.metric.name} of {HERE} is {HERE}. There is nothing to compare it to.",
        name, ends,
    )  # fmt: skip


def _against(verdicts: Verdicts, known: Sequence[Verdict]) -> list[Text]:
    """Return where methods are better than the baseline, and where they are not.

    There is a sentence for each combination of the labels of all axes but the last.
    """
    if verdicts.baseline is None:
        return []
    against = verdicts.methods.index(verdicts.baseline)
    judged = [group for group in known if group.judged and np.isfinite(group.mean[against])]
    axes = varying(verdicts)
    parts: dict[str, list[Verdict]] = {}
    for group in judged:
        parts.setdefault(group_title(verdicts, group, axes[:-1]), []).append(group)
    (baseline,) = method_words(verdicts, [against])
    texts = []
    for part, groups in parts.items():
        same: dict[str, list[int]] = {}
        for place in range(len(verdicts.methods)):
            where = [group for group in groups if np.isfinite(group.mean[place])]
            if place != against and where:
                same.setdefault(_beside_baseline(verdicts, place, where), []).append(place)
        clauses = [
            say(
                f"{HERE} {'are' if len(places) > 1 else 'is'} {clause}",
                listing(method_words(verdicts, places)),
            )
            for clause, places in same.items()
        ]
        start = f"Against {HERE}{f', {part}' if part else ''}: {HERE}."
        texts.append(say(start, baseline, _shortened(clauses, "; ")))
    rest = len(texts) - _MOST_CLAUSES
    more: list[Text] = [(f"{rest} more are in the table.",)] if rest > 0 else []
    return [*texts[:_MOST_CLAUSES], *more]


def _sides(verdicts: Verdicts) -> tuple[Side, Side]:
    """Return on which side of a number the better ones are, and the worse ones."""
    return ("higher", "lower") if verdicts.metric.better == "higher" else ("lower", "higher")


def _beside_baseline(verdicts: Verdicts, place: int, groups: Sequence[Verdict]) -> str:
    """Return in which groups a method is better than the baseline, worse, or neither."""
    better, worse = _sides(verdicts)
    where: dict[str, list[Verdict]] = {"better": [], "worse": [], "": []}
    for group in groups:
        is_better = place in group.beyond_baseline(better)
        word = "better" if is_better else "worse" * (place in group.beyond_baseline(worse))
        where[word].append(group)
    words = [word for word, of in where.items() if of]
    if len(words) == 1:
        alike = words[0] or _ALIKE
        return f"{alike} throughout" if len(groups) > 1 else alike
    axis = varying(verdicts)[-1]
    name = verdicts.within[axis]
    return ", ".join(
        f"{word or _ALIKE} at {name} {_both([str(group.labels[axis]) for group in where[word]])}"
        for word in words
    )


# what it holds for


def scope_words(verdicts: Verdicts) -> Text:
    """Return what the verdicts hold for and how far, in bold, and what the numbers are."""
    groups, metric = verdicts.groups, verdicts.metric
    cautions = Counter(caution_text(group.scope) for group in groups if group.stands)
    of_some = [
        f"{text[:1].upper()}{text[1:]}"
        f"{'' if count == len(groups) else f' (in {count} of {len(groups)} groups)'}."
        for text, count in cautions.items()
        if text
    ]
    end = "" if metric.better == "none" else f", {metric.better} is better"
    are_clusters = any(group.scope.kind == "clusters" for group in groups)
    over = verdicts.units.removeprefix("synthetic ") if are_clusters else "recordings"
    over += " and groups" * (verdicts.overall is not None and verdicts.for_all is not None)
    is_geometric = verdicts.ratio and any(group.scope.clusters > 1 for group in groups)
    geometric = f" (geometric mean over {over})" * is_geometric
    has_differences = verdicts.is_sequence or any(group.paired is not None for group in groups)
    rounded = "; differences are taken before rounding" * has_differences
    unit = unit_text(metric.unit)
    held = _held(verdicts) if groups else ""
    return joined(
        " ",
        [
            Word(held[:1].upper() + held[1:]) if held else "",
            *map(Word, of_some),
            f"{number_name(verdicts, unit)}{geometric}{end}{rounded}.",
        ],
    )


def _held(verdicts: Verdicts) -> str:
    """Return what the data are, and what the verdicts hold for beyond them."""
    scope, recordings = verdicts.groups[0].scope, verdicts.recordings
    judged = any(group.stands for group in verdicts.groups)
    sizes = recordings.sizes
    if scope.kind == "clusters":
        described = "the" if verdicts.metric.better == "none" else "only the"
        what = "holds" if judged else f"{described} intervals hold"
        whom = f"for further {verdicts.units}"
        if recordings.synthetic:
            whom += "; untested on people"
        return f"{units_text(scope)}{f' ({sizes})' if sizes else ''}: {what} {whom}."
    count = "one" if scope.clusters == 1 else str(scope.clusters)
    kind = "recording" if recordings.seconds or not recordings.markers else "frame"
    kind = f"{'synthetic ' * recordings.synthetic}{kind}"
    of = f"{count} {kind}{'s' * (scope.clusters != 1)}"
    if recordings.actors and scope.clusters > 1:
        of += " of one actor" if recordings.actors == 1 else f" of {recordings.actors} actors"
    described = ", ".join(filter(None, [of, recordings.names, sizes]))
    further = scope_text(scope).replace("this recording", "it")
    if not judged and verdicts.metric.better == "none":
        return f"{described}: it is described, and nothing is said of others."
    if not judged:
        return f"{described}: nothing is said {further}."
    return f"{described}: holds {further}, not for others."
