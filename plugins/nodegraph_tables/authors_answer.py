"""The answer in the words of a graph's author, with what was found filled in."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeVar

from nodegraph import NodegraphError, listed
from nodegraph_tables.answer import Answer, Finding
from nodegraph_tables.numbers import difference_text, ends_text, ranged, without_rounding
from nodegraph_tables.style import bare_unit
from nodegraph_tables.text import Text, Word, joined, listing

if TYPE_CHECKING:
    from nodegraph import Placeholder

_T = TypeVar("_T")


def in_authors_words(answer: Answer, parts: Sequence[str | Placeholder]) -> Answer:
    """Return an answer whose sentence is the author's, with what it found filled in.

    Parameters
    ----------
    answer
    parts
        Of the author's answer; the answer stays as it is without any.

    Raises
    ------
    NodegraphError
        If the author's answer says what was not found, calls a method by name that is best
        nowhere, or has as its first ``{best}`` another method than the one to take.
    """
    if not parts:
        return answer
    every = (*answer.findings, *([answer.overall] if answer.overall else []))
    behind = {name for found in every for name in found.mean}
    behind -= {name for found in every for name in found.best}
    filled: list[Text] = []
    for part in parts:
        if isinstance(part, str):
            _check_names(part, behind)
            filled.append((part,))
        else:
            filled.append(_filled(answer, part))
    pairs = zip(parts, filled, strict=True)
    best = next(
        (text for part, text in pairs if not isinstance(part, str) and part.name == "best"), ()
    )
    named = [word.method for word in best if isinstance(word, Word)]
    if answer.take and named and answer.take not in named:
        raise NodegraphError(
            f"the first that it calls best is {listed(named)}, and {answer.take} is the one to "
            "take: begin with that"
        )
    return replace(answer, sentence=joined("", filled))


def _check_names(text: str, behind: Iterable[str]) -> None:
    for name in sorted(behind):
        # numbers and single letters may be anything
        if len(name) > 2 and re.search(rf"(?<![\w.-]){re.escape(name)}(?![\w-])", text):
            raise NodegraphError(
                f"it names {name}, which is best nowhere; say what it is: {{behind {name}}}, "
                f"{{tied {name}}} or {{number {name}}}"
            )


def _filled(answer: Answer, part: Placeholder) -> Text:
    """Return what stands in place of a placeholder."""
    if part.name == "scope":
        return (answer.held.rstrip("."),)
    found = _about(answer, part)
    if part.name in _NUMBERS:
        return (Word(_NUMBERS[part.name](found, part), "number"),)
    for finding in found if part.name not in ("better", "worse") else ():
        if not finding.verdict:
            where = f" for {finding.title}" if finding.title else ""
            raise NodegraphError(f"{part.text} says what there is no verdict on{where}")
    named = [getattr(finding, part.name) for finding in found]
    if part.label:
        for finding, names in zip(found, named, strict=True):
            if part.label not in names:
                where = f" for {finding.title}" if finding.title else ""
                raise NodegraphError(f"{part.text}{where}: {part.name} {_are(names)}")
        return (_method(part, part.label),)
    if any({*names} != {*named[0]} for names in named):
        each = "; ".join(
            f"{_names(names)} for {finding.title}"
            for finding, names in zip(found, named, strict=True)
        )
        raise NodegraphError(f"{part.text} differs: {each}; write {{{part.name} at AXIS=LABEL}}")
    return listing([_method(part, name) for name in named[0]]) or ("none",)


def _about(answer: Answer, part: Placeholder) -> list[Finding]:
    """Return the findings that a placeholder is about."""
    if part.at is None:
        if answer.overall is None:
            raise NodegraphError(f"{part.text}: the groups cannot be taken together")
        return [answer.overall]
    at = part.at.items()
    found = [
        finding
        for finding in answer.findings
        if all(str(finding.group.get(axis)) == label for axis, label in at)
    ]
    if not found:
        groups = listed([finding.title or "all" for finding in answer.findings]) or "none"
        raise NodegraphError(f"{part.text} is about no group; there are: {groups}")
    return found


def _method(part: Placeholder, name: str) -> Word:
    return Word(name, "strong" if part.name in ("best", "better") else "method", name)


def _names(names: Sequence[str]) -> str:
    return listed(list(names)) or "none"


def _are(names: Sequence[str]) -> str:
    return f"{'are' if len(names) > 1 else 'is'} {_names(names)}"


def _number_in(found: Sequence[Finding], part: Placeholder) -> str:
    """Return the mean of the best, or of a method, over some groups; of another column by name."""
    columns = {name for finding in found for name in finding.beside}
    column, _, label = part.label.rpartition(" of ")
    if part.label in columns:
        column, label = part.label, ""
    if column in columns:
        found = [finding for finding in found if column in finding.beside]
        unit, of_each = found[0].units[column], [finding.beside[column] for finding in found]
    else:
        label, unit, of_each = part.label, found[0].unit, [finding.mean for finding in found]
    numbers = [
        _known(_as_shown(means), name, part)
        for finding, means in zip(found, of_each, strict=True)
        for name in ([label] if label else finding.first[:1])
    ]
    if not numbers:
        raise NodegraphError(f"{part.text}: no method comes first")
    return _ranged(ends_text(numbers, unit), found)


def _difference_in(found: Sequence[Finding], part: Placeholder) -> str:
    """Return by how much the mean of a method is above that of another, over some groups."""
    pair = _pair(found, part)
    means = [_as_shown(finding.mean) for finding in found]
    pairs = [(_known(mean, pair[0], part), _known(mean, pair[1], part)) for mean in means]
    pairs.sort(key=lambda means: means[0] - means[1])
    if pairs[0][0] < pairs[0][1]:
        raise NodegraphError(f"{part.text} is below 0; write {{difference {pair[1]} to {pair[0]}}}")
    return _ranged(difference_text([pairs[0], pairs[-1]], found[0].unit), found)


def _ranged(text: str, found: Sequence[Finding]) -> str:
    axes = [axis for axis in found[0].group if len({each.group[axis] for each in found}) > 1]
    return ranged(text, axes)


def _interval_in(found: Sequence[Finding], part: Placeholder) -> str:
    """Return the interval of a mean, or of a difference, in a group."""
    if len(found) > 1:
        titles = listed([finding.title for finding in found])
        raise NodegraphError(f"{part.text} is about one group, and there are: {titles}")
    (finding,) = found
    if part.label and part.label not in finding.mean:
        method, other = _pair(found, part)
        if finding.reference not in (method, other):
            to = f"to {finding.reference}" if finding.reference else "here to none"
            raise NodegraphError(f"{part.text}: differences have intervals {to}")
        low, high = _known(finding.apart, method if finding.reference == other else other, part)
        ends = (low, high) if finding.reference == other else (-high, -low)
    else:
        name = part.label or next(iter(finding.first), "the best")
        ends = (_known(finding.low, name, part), _known(finding.high, name, part))
    return f"95 %: {ends_text(ends, bare_unit(finding.unit))}"


def _count_in(found: Sequence[Finding], part: Placeholder) -> str:
    """Return in how many groups a method is the best, behind, or what else is claimed of it."""
    claim, _, name = part.label.partition(" ")
    if claim not in _CLAIMS or not name:
        claims = ", ".join(_CLAIMS)
        raise NodegraphError(
            f"{part.text} counts no claim; write {{count CLAIM METHOD}}, of the claims {claims}"
        )
    for finding in found:
        _known(finding.mean, name, part)
    if claim in _CLAIMS[:3] and not any(finding.verdict for finding in found):
        raise NodegraphError(f"{part.text} counts what there is no verdict on")
    count = sum(name in getattr(finding, claim) for finding in found)
    return f"all {count}" if count == len(found) else f"{count or 'none'} of {len(found)}"


def _pair(found: Sequence[Finding], part: Placeholder) -> tuple[str, str]:
    """Return the methods of a difference: ``linear to ridge``."""
    names = {name for finding in found for name in finding.mean}
    pairs = ((a, b) for a in names for b in names if f"{a} to {b}" == part.label)
    pair = next(pairs, None)
    if pair is None:
        raise NodegraphError(
            f"{part.text} is about no two methods; write {{{part.name} METHOD to METHOD}}, of: "
            f"{listed(sorted(names)) or 'none'}"
        )
    return pair


def _as_shown(means: Mapping[str, float]) -> Mapping[str, float]:
    return dict(zip(means, without_rounding([*means.values()]), strict=True))


def _known(numbers: Mapping[str, _T], name: str, part: Placeholder) -> _T:
    if name not in numbers:
        raise NodegraphError(f"{part.text}: {name} has no {part.name} there")
    return numbers[name]


_CLAIMS = ("best", "tied", "behind", "better", "worse")

_NUMBERS: Mapping[str, Callable[[Sequence[Finding], Placeholder], str]] = {
    "number": _number_in,
    "interval": _interval_in,
    "difference": _difference_in,
    "count": _count_in,
}
"""Placeholders in whose place numbers stand."""
