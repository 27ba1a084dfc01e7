"""The answer of a table: words, a card for each part of it, and what it holds for.

It is one value, from which a page and a terminal draw what they show.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, Literal, TypeVar, cast

from markupsafe import Markup, escape

from nodegraph import Label, NodegraphError, Value, listed
from nodegraph_tables.numbers import (
    LARGEST,
    MINUS,
    SMALLEST,
    difference_text,
    ends_text,
    number_text,
    ranged,
    shares_text,
    without_rounding,
)
from nodegraph_tables.style import SHARE, bare_unit, scale_of, unit_text

if TYPE_CHECKING:
    from nodegraph import Placeholder

_T = TypeVar("_T")

MOST_CARDS = 8
"""Cards that a reader sees at once."""

ONE_ROW = 4
"""Cards that stand in one row."""

MOST_ROWS = 9
"""Of a card that stands beside no more than three others."""

_WIDE = 240.0
"""Width of the picture on a card, in pixels."""

_NARROW = 105.0
"""Width of the line of a row where four cards stand side by side, in pixels."""

_TICKS = 5
_PARTS = 10
"""Of a line whose ends are round."""

_DECADE = 10.0
_LETTER = 6.0
"""Across, in pixels."""

_PLAIN = 1e3
"""Number from which on three digits would be a power of ten."""

_SHORT_UNIT = 3

_LONGEST = 24
"""Letters of a name up to which the lines of all cards make room for it."""

_EDGE = 0.3
"""Share of a line at either end where numbers do not stand around their place."""


@dataclass(frozen=True)
class Word(Value):
    """A part of a text that is more than its letters.

    Attributes
    ----------
    text : str
    kind : {"strong", "suspect", "method", "number"}
        What stands out, what is doubted, what is compared, and what was measured, which is no
        conclusion.
    method : str
        The label of a method that stands out, or whose text says more.
    does : str
        What the method does, in a sentence.
    """

    text: str
    kind: Literal["strong", "suspect", "method", "number"] = "strong"
    method: str = ""
    does: str = ""

    @property
    def label(self) -> str:
        """The label of the method that it names; empty where it names none."""
        return self.text if self.kind == "method" and not self.method else self.method


MAY_BE = "may be as good"
"""Said of what is not certain to be worse than the best."""

Text = tuple[str | Word, ...]
Kind = Literal["best", "tied", "open", "before", "worse", "rest"]


HERE = "\N{OBJECT REPLACEMENT CHARACTER}"
"""Stands in a sentence where a part of it comes; see `say`."""


def say(sentence: str, *parts: str | Word | Text) -> Text:
    """Return a sentence with its parts, in their order, in the places of `HERE`."""
    pieces = sentence.split(HERE, len(parts))
    return joined("", itertools.chain.from_iterable(zip(pieces, (*parts, ""), strict=False)))


def joined(separator: str, texts: Iterable[str | Word | Text]) -> Text:
    """Return texts, those that are not empty, one after the other."""
    result: list[str | Word] = []
    for text in texts:
        parts = [part for part in (text if isinstance(text, tuple) else (text,)) if part]
        if parts and result and separator:
            result.append(separator)
        result += parts
    merged: list[str | Word] = []
    for part in result:
        if isinstance(part, str) and merged and isinstance(merged[-1], str):
            merged[-1] += part
        else:
            merged.append(part)
    return tuple(merged)


def listing(texts: Sequence[str | Word | Text], word: str = "and") -> Text:
    """Return texts as a list: ``a, b and c``."""
    return joined(f" {word} ", [joined(", ", texts[:-1]), *texts[-1:]])


def few(texts: Sequence[str | Word | Text], most: int) -> Text:
    """Return the first of several: ``a, b, c and 4 more``."""
    more = len(texts) - most
    return joined("", [joined(", ", texts[:most]), f" and {more} more" if more > 0 else ""])


def plain(text: Text) -> str:
    """Return the letters of a text."""
    return "".join(part if isinstance(part, str) else part.text for part in text)


def html_of(text: Text) -> Markup:
    """Return a text as HTML."""
    return Markup("").join(map(_part_html, text))


def _part_html(part: str | Word) -> Markup:
    if isinstance(part, str):
        return escape(part)
    if part.kind == "number":
        return Markup(f'<span class="lead-number">{escape(part.text)}</span>')
    tag = "span" if part.kind == "method" else "strong"
    method = _of_method(part.label, part.does) if part.label else ""
    suspect = ' class="suspect"' if part.kind == "suspect" else ""
    return Markup(f"<{tag}{method}{suspect}>{escape(part.text)}</{tag}>")


def _of_method(label: str, does: str) -> str:
    """Return the attributes of an element that names a method."""
    return f' data-method="{escape(label)}"' + (f' title="{escape(does)}"' if does else "")


@dataclass(frozen=True)
class Line(Value):
    """A line of numbers across a card.

    Attributes
    ----------
    low, high : float
        Its ends.
    log : bool
        Whether equal distances are equal ratios.
    least : float
        With a line from 0: the number down to which they are; 0 on other lines.
    one : float
        The number of which its ticks are multiples; 0 where they are numbers.
    """

    low: float
    high: float
    log: bool = False
    least: float = 0.0
    one: float = 0.0

    @property
    def to_rounds(self) -> Line:
        """The line on to the next round numbers at both ends."""
        if not self.high > self.low:
            return self
        if not self.log:
            step = self._step(_PARTS)
            first, last = math.floor(self.low / step), math.ceil(self.high / step)
            return replace(self, low=step * first, high=step * last)
        low = self.low and max(each for each in _rounds(self.low) if each <= self.low)
        return replace(self, low=low, high=min(e for e in _rounds(self.high) if e >= self.high))

    @classmethod
    def through(cls, values: Sequence[float], *, log: bool) -> Line:
        """Return the line on which all values lie; logarithmic, if wanted, where none is below 0.

        Values of 0 among others of many sizes lie at its left end.
        """
        low, high = min(values), max(values)
        above = min((value for value in values if value > 0.0), default=high)
        from_0 = log and low == 0.0 and high > _DECADE * above
        return cls(low, high, log and (low > 0.0 or from_0), above if from_0 else 0.0)

    def at(self, value: float) -> float:
        """Return where a value lies, in pixels from the left."""
        return round(10.0 + (_WIDE - 20.0) * self.share(value), 1)

    def share(self, value: float) -> float:
        """Return where a value lies, as a share of the line; at an end, where it is beyond."""
        near = min(max(value, self.low), self.high)
        low, high, place = (self._along(each) for each in (self.low, self.high, near))
        return (place - low) / (high - low) if high > low else 0.5

    def _along(self, value: float) -> float:
        if self.least:
            return math.asinh(value / self.least)
        return math.log(value) if self.log else value

    def drawn(self, y: float, unit: str = "") -> str:
        """Return the line with its ticks, whose numbers stand below it."""
        ticks = self.ticks()
        marks: list[str] = []
        free = _WIDE
        # the last has the unit, and others a number as far as there is room before it
        for tick in reversed(ticks):
            x = self.at(tick)
            text = tick_text(tick, unit, with_unit=tick == ticks[-1])
            width = _LETTER * len(text)
            anchor = "start" if x < width / 2 else "end" if x > _WIDE - width / 2 else "middle"
            left = x - width * {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor]
            mark = f'<line x1="{x:g}" x2="{x:g}" y1="{y:g}" y2="{y + 4:g}"/>'
            if left + width <= free:
                mark += f'<text class="{anchor}" x="{x:g}" y="{y + 16:g}">{escape(text)}</text>'
                free = left - _LETTER
            marks.append(mark)
        return f'<line x1="4" x2="{_WIDE - 4:g}" y1="{y:g}" y2="{y:g}"/>{"".join(reversed(marks))}'

    def ticks(self, width: float = _WIDE - 20.0) -> list[float]:
        """Return at most a handful of round values on a line so wide, far enough apart."""
        if not self.high > self.low:
            return [self.low]
        for steps in ((1, 2, 5), (1, 3), (1,)):
            values = self._rounds(steps) if self.log else self._steps()
            if len(values) <= _TICKS:
                break
        values = values[:: math.ceil(len(values) / _TICKS) or 1]
        if len(values) < 2:
            values = [self.low, self.high]
        place = 1
        while place < len(values):
            before, value = values[place - 1 : place + 1]
            letters = len(tick_text(before, "")) + len(tick_text(value, ""))
            if width * (self.share(value) - self.share(before)) >= _LETTER * letters / 2 + 6:
                place += 1
                continue
            values.pop(max(place - 1, 1))  # the first stays, and the last beside others
            place = max(place - 1, 1)
        return values

    def _rounds(self, steps: Sequence[int]) -> list[float]:
        low = self.least or self.low
        decades = range(math.floor(math.log10(low)), math.ceil(math.log10(self.high)) + 1)
        values = (step * 10.0**decade for decade in decades for step in steps)
        rounds = [value for value in values if low <= value <= self.high]
        return [0.0, *rounds] if self.least else rounds

    def _steps(self) -> list[float]:
        step = self._step(_TICKS - 1)
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return [step * place for place in range(first, last + 1)]

    def _step(self, most: int) -> float:
        """Return the smallest round number of which the line is so many long at most."""
        rough = (self.high - self.low) / most
        decade = 10.0 ** math.floor(math.log10(rough))
        return next(decade * each for each in (1, 2, 5, 10) if decade * each >= rough)


def _rounds(value: float) -> list[float]:
    """Return the round numbers around one above 0."""
    decade = 10.0 ** math.floor(math.log10(value))
    return [decade * step for step in (0.5, 1, 2, 5, 10)]


@dataclass(frozen=True)
class Row(Value):
    """One of several things that a card compares, such as a method.

    Attributes
    ----------
    name : str
    value : float
    low, high : float
        Ends of its interval; NaN where there is none.
    kind : {"best", "tied", "open", "before", "worse", "rest"}
        What a verdict says of it: the best, not certain to be worse, not told apart from others,
        what these are held against, clearly worse than that; or nothing.
    note : text
        What is said of it beside its number.
    for_all : bool
        Whether it is the one to take, whichever the card is.
    does : str
        What it does, in a sentence.
    """

    name: str
    value: float
    low: float = math.nan
    high: float = math.nan
    kind: Kind = "rest"
    note: Text = ()
    for_all: bool = False
    does: str = ""

    @property
    def label(self) -> str:
        """The label of the method, which is its name."""
        return self.name


@dataclass(frozen=True)
class Rows(Value):
    """What a card compares: a row each, with a dot and its interval on a line that cards share.

    Attributes
    ----------
    rows : tuple of Row
    line : Line
    unit : str
        Of the numbers.
    others : tuple of Row
        Further ones, whose dots stand in one row.
    """

    rows: tuple[Row, ...]
    line: Line
    unit: str = ""
    others: tuple[Row, ...] = ()

    @classmethod
    def of(cls, rows: Sequence[Row], line: Line, unit: str = "", most: int = MOST_ROWS) -> Rows:
        """Return rows in their order; of many, with names for those that matter, then the first.

        Parameters
        ----------
        rows, line, unit
        most
            Rows on the card.
        """
        if len(rows) <= most:
            return cls(tuple(rows), line, unit)
        order = sorted(rows, key=lambda row: not (row.for_all or row.kind in ("best", "before")))
        named = {row.name for row in order[: most - 1]}
        return cls(
            tuple(row for row in rows if row.name in named),
            line,
            unit,
            tuple(row for row in rows if row.name not in named),
        )

    @property
    def every(self) -> tuple[Row, ...]:
        """All rows."""
        return (*self.rows, *self.others)

    def number(self, row: Row) -> str:
        """Return the number of a row as a reader sees it, without a unit but of shares."""
        if self.unit == SHARE:
            return shares_text([row.value])
        return number_text(row.value, bare_unit(self.unit))

    def words(self, headline: Text) -> list[Text]:
        """Return what is said of rows, and the first; or, without a headline, every row.

        Parameters
        ----------
        headline
            What stands above the rows, with the number of what it names.
        """
        first = self.rows[0].value
        named = {part.method for part in headline if isinstance(part, Word)}
        others = {row.name for row in self.rows if row.kind == "tied" and row.value != first}
        return [
            joined(
                ", ", [f"{row.name} {self.number(row)}", MAY_BE * (row.name in others), row.note]
            )
            for row in self.rows
            if not headline
            or row.note
            or row.name in others
            or (row.value == first and row.name not in named)
        ]


@dataclass(frozen=True)
class Card(Value):
    """A part of an answer.

    Attributes
    ----------
    title : text
        What it is about, such as an actor or a step.
    headline : text
        The answer in a word or a number.
    value, aside : text
        What stands below it, large and small.
    picture : str
        An SVG element: see `svg`. It is taken as it is.
    rows : Rows, optional
        What it compares.
    facts : tuple of (term, text)
    status : text
        How the headline stands beside what else the card compares.
    kind : {"best", "tied", "open", "before", "worse", "rest"}
        What a verdict says of the headline, which has its colour; see `Row`.
    """

    title: Text
    headline: Text
    value: Text = ()
    aside: Text = ()
    picture: str = ""
    rows: Rows | None = None
    facts: tuple[tuple[str, Text], ...] = ()
    status: Text = ()
    kind: Kind = "rest"

    @property
    def line(self) -> str:
        """The card in words."""
        head = joined(", ", [self.headline, self.value, self.aside])
        head = joined("; ", [head, self.status])
        facts = [
            say(f"{HERE}: {HERE}", term[:1].lower() + term[1:], text) for term, text in self.facts
        ]
        rows = self.rows.words(self.headline) if self.rows else ()
        start = f"{plain(self.title)}: " if self.title else ""
        return f"{start}{plain(joined('; ', [head, *rows, *facts]))}."


@dataclass(frozen=True)
class Finding(Value):
    """What a comparison found in one of its groups.

    Attributes
    ----------
    group : mapping of axis to label
    title : str
        The labels as a reader sees them; empty where there is one group.
    verdict : bool
        Whether there is one.
    best, tied, behind : tuple of str
        Methods, as the verdict has them; none without one.
    better, worse : tuple of str
        Methods that are clearly so than the baseline, if there is one.
    first : tuple of str
        The methods with the best mean, which no verdict need have found best.
    mean, low, high, p : mapping of str to float
        Of each method: the number that decides, its interval, and the p of its difference.
    unit : str
        The unit of the means.
    reference : str
        The method to which the others' differences have intervals; empty without one.
    apart : mapping of str to (float, float)
        Of each other method: the ends of the interval of its difference to that one.
    beside : mapping of str to mapping of str to float
        Of each method: the means of what else is asked, by its name.
    units : mapping of str to str
        Units of these means.
    """

    group: Mapping[str, Label]
    title: str
    verdict: bool
    best: tuple[str, ...]
    tied: tuple[str, ...]
    behind: tuple[str, ...]
    better: tuple[str, ...] = ()
    worse: tuple[str, ...] = ()
    first: tuple[str, ...] = ()
    mean: Mapping[str, float] = field(default_factory=dict)
    low: Mapping[str, float] = field(default_factory=dict)
    high: Mapping[str, float] = field(default_factory=dict)
    p: Mapping[str, float] = field(default_factory=dict)
    unit: str = ""
    reference: str = ""
    apart: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    beside: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Answer(Value):
    """The answer of a table to the question of the study.

    Attributes
    ----------
    sentence : text
        The answer in a sentence or two.
    scope : text
        What it holds for, and what the numbers are.
    cards : tuple of Card
        The parts of it; a page shows eight at most.
    more : tuple of str
        Further sentences.
    findings : tuple of Finding
        What it says, as data, where methods are compared.
    overall : Finding, optional
        The same over all groups taken together.
    take : str
        The method to take whichever the group is; empty without one.
    certainty : text
        How certain that is: by which rule, and why that method is the one to take.
    """

    sentence: Text = ()
    scope: Text = ()
    cards: tuple[Card, ...] = ()
    more: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()
    overall: Finding | None = None
    take: str = ""
    certainty: Text = ()

    @property
    def held(self) -> str:
        """What it holds for, in a sentence."""
        return " ".join(word.text for word in self.scope if isinstance(word, Word))

    @property
    def lines(self) -> tuple[str, ...]:
        """The answer in words: its sentence, what it holds for, how certain, then each part."""
        first = (plain(text) for text in (self.sentence, self.scope, self.certainty) if text)
        return (*first, *(card.line for card in self.cards), *self.more)

    @property
    def in_words(self) -> Answer:
        """The same without cards, their words among the further sentences."""
        return replace(self, cards=(), more=(*(card.line for card in self.cards), *self.more))


def with_descriptions(part: _T, does: Mapping[str, str]) -> _T:
    """Return an answer, or a part of one, in which methods say what they do.

    Parameters
    ----------
    part
    does
        A sentence for each label.
    """
    if isinstance(part, tuple):
        return cast("_T", tuple(with_descriptions(each, does) for each in part))
    if not isinstance(part, (Answer, Card, Rows, Row, Word)):
        return part
    parts = {each.name: getattr(part, each.name) for each in fields(part)}
    parts = {name: with_descriptions(value, does) for name, value in parts.items()}
    if isinstance(part, (Row, Word)):
        parts["does"] = does.get(part.label, "")
    return replace(part, **parts)


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


def answer_html(answer: Answer, caption: str = "") -> Markup:
    """Return an answer as HTML; `lead_style` is its style sheet.

    Parameters
    ----------
    answer
    caption
        What the author says of the numbers.
    """
    more = len(answer.cards) - MOST_CARDS
    rest = f'<p class="lead-key">{more} more are in the table.</p>' if more > 0 else ""
    return lead_of_parts(answer, cards_html(answer.cards[:MOST_CARDS]) + rest, caption)


def lead_of_parts(answer: Answer, cards: str, caption: str, methods: Text = ()) -> Markup:
    """Return the HTML of an answer whose cards are HTML already.

    Above them stands what it holds for, how certain it is, and what was measured; below, what
    terms mean and what methods do.
    """
    held = joined(" ", [part for part in answer.scope if isinstance(part, Word)])
    measured = joined(" ", [part.strip() for part in answer.scope if isinstance(part, str)])
    sentence = f'<p class="lead-sentence">{html_of(answer.sentence)}</p>'
    facts = _facts_html(
        "facts", {"For whom": held, "How certain": answer.certainty, "Measured": measured}
    )
    words = _facts_html("words", {"Terms": (caption,) * bool(caption), "Methods": methods})
    return Markup(f'<div class="lead">{sentence}{facts}{cards}{words}</div>')


def _facts_html(name: str, facts: Mapping[str, Text]) -> str:
    items = "".join(
        f"<dt>{term}</dt><dd>{html_of(text)}</dd>" for term, text in facts.items() if text
    )
    return f'<dl class="lead-{name}">{items}</dl>' if items else ""


def cards_html(cards: Sequence[Card]) -> str:
    """Return cards side by side; nothing where there are none."""
    columns = len(cards) if len(cards) <= ONE_ROW else math.ceil(len(cards) / 2)
    inside = "".join(map(_card, cards))
    # the lines of all cards are as long and begin at the same place
    shown = [(card.rows, row) for card in cards if card.rows for row in card.rows.rows]
    names = min(max((len(row.name) for _, row in shown), default=0), _LONGEST)
    numbers = max((len(rows.number(row)) for rows, row in shown), default=0)
    style = f"--columns: {columns}; --names: {names}; --numbers: {numbers}"
    return f'<div class="lead-cards" style="{style}">{inside}</div>' if cards else ""


@cache
def lead_style() -> str:
    """Return the style sheet of leads."""
    return files("nodegraph_tables").joinpath("lead.css").read_text(encoding="utf-8")


def _card(card: Card) -> str:
    value = f"<b>{html_of(card.value)}</b> " if card.value else ""
    value += f"<small>{html_of(card.aside)}</small>" if card.aside else ""
    value = f'<span class="lead-value">{value}</span>' if value else ""
    facts = "".join(f"<dt>{escape(term)}</dt><dd>{html_of(text)}</dd>" for term, text in card.facts)
    return (
        '<article class="lead-card">'
        + (f'<h3 aria-level="2">{html_of(card.title)}</h3>' if card.title else "")
        + (
            f'<p class="lead-winner {card.kind}">{_headline(card.headline)} {value}</p>'
            if card.headline or value
            else ""
        )
        + (f'<p class="lead-status {card.kind}">{html_of(card.status)}</p>' if card.status else "")
        + card.picture
        + (_rows_html(card.rows, judged=card.kind != "rest") if card.rows else "")
        + (f"<dl>{facts}</dl>" if facts else "")
        + "</article>"
    )


def _headline(text: Text) -> Markup:
    """Return a headline in which, beside names, other words are small."""
    tag = "<small>{}</small>" if any(isinstance(part, Word) for part in text) else "{}"
    return Markup("").join(
        Markup(tag).format(part) if isinstance(part, str) else html_of((part,)) for part in text
    )


def _rows_html(rows: Rows, *, judged: bool) -> str:
    body = "".join(
        f"<tr{_of_method(row.name, row.does)}{_classes(row)}>"
        f'<th scope="row"{_titled(row.name)}>{escape(row.name)}</th>'
        f"<td>{_strip([row], rows)}</td><td>{escape(rows.number(row))}</td></tr>"
        + (f'<tr{_classes(row)}><td colspan="3">{html_of(row.note)}</td></tr>' if row.note else "")
        for row in rows.rows
    )
    if rows.others:
        body += (
            f'<tr><th scope="row">{len(rows.others)} others</th>'
            f"<td>{_strip(rows.others, rows)}</td><td></td></tr>"
        )
    # what the axis says is in the numbers
    axis = f'<tr aria-hidden="true"><td></td><td>{axis_html(rows)}</td><td></td></tr>'
    names = "lead-rows lead-judged" if judged else "lead-rows"
    return f'<table class="{names}"><tbody>{body}{axis}</tbody></table>'


def _titled(name: str) -> str:
    """Return the attribute that shows a name which its column cuts short, to hover."""
    return f' title="{escape(name)}"' if len(name) > _LONGEST else ""


def _classes(row: Row) -> str:
    names = [row.kind] * (row.kind == "best") + ["for-all"] * row.for_all
    return f' class="{" ".join(names)}"' if names else ""


def dots_html(rows: Rows) -> str:
    """Return the dots of all rows side by side."""
    return _strip(rows.every, rows)


def _strip(of: Sequence[Row], rows: Rows) -> str:
    """Return a dot with its interval, or several dots, and where 0 is, or the one multiple."""
    line = rows.line
    from_0 = not line.log and line.low <= 0.0
    parts = [_upright(line, line.one)] if from_0 or line.one else []
    for row in reversed(of):  # the first lies upon the others
        x, low, high = (_place(line, each) for each in (row.value, row.low, row.high))
        if len(of) == 1 and row.low < row.high:
            parts.append(f'<line class="reach" x1="{low}" x2="{high}" y1="8" y2="8"/>')
        radius = 4 if row.kind == "rest" or len(of) > 1 else 5
        name = escape(f"{row.name} {rows.number(row)}")
        of_method = _of_method(row.name, row.does) if len(of) > 1 else ""
        parts.append(
            f'<circle class="{row.kind}" cx="{x}" cy="8" r="{radius}"{of_method}>'
            f"<title>{name}</title></circle>"
        )
    return f'<svg class="lead-strip" height="16" aria-hidden="true">{"".join(parts)}</svg>'


def axis_html(rows: Rows) -> str:
    """Return the axis of the dots of rows: its ends, or ticks where it is logarithmic."""
    line, texts = rows.line, []
    ends, one = [line.low, line.high], line.one or 1.0
    if line.one:
        multiples = Line(line.low / one, line.high / one, log=True).ticks(_NARROW)
        ends = [one * each for each in multiples]
    elif line.log:
        ends = line.ticks(_NARROW)
    elif line.low < 0.0 < line.high:
        # no number stands too near to that at 0
        ends = [0.0, *(end for end in ends if abs(line.share(end) - line.share(0.0)) > _EDGE)]
    for tick in ends:
        share = line.share(tick)
        anchor = "" if share < _EDGE else "end" if share > 1.0 - _EDGE else "middle"
        anchor = "middle" if line.log else anchor
        with_unit = tick == ends[-1] and len(unit_text(rows.unit)) <= _SHORT_UNIT
        text = tick_text(tick, rows.unit, with_unit=with_unit)
        if line.one:
            text = f"{tick_text(tick / one, '')}\N{MULTIPLICATION SIGN}"
        texts.append(
            f'<text class="{anchor}" x="{_place(line, tick)}" y="15">{escape(text)}</text>'
            f'<line x1="{_place(line, tick)}" x2="{_place(line, tick)}" y1="0" y2="4"/>'
        )
    whole = f'<line x1="{_place(line, line.low)}" x2="{_place(line, line.high)}" y1="0" y2="0"/>'
    return f'<svg class="lead-strip" height="18" aria-hidden="true">{whole}{"".join(texts)}</svg>'


def _upright(line: Line, value: float) -> str:
    x = _place(line, value)
    return f'<line class="grid" x1="{x}" x2="{x}" y1="-3" y2="19"/>'


def _place(line: Line, value: float) -> str:
    """Return where a value lies on a strip of any width."""
    return "0" if math.isnan(value) else f"{2.0 + 96.0 * line.share(value):.1f}%"


def svg(name: str, height: float, parts: Iterable[str], width: float = _WIDE) -> str:
    """Return the picture of a card; classes of parts are those of `lead.css`.

    Parameters
    ----------
    name
        Description for a reader who does not see it.
    height, width
        In pixels.
    parts
        SVG elements.
    """
    wide = " wide" * (width > _WIDE)
    return (
        f'<svg class="lead-picture{wide}" viewBox="0 0 {width:g} {height:g}" role="img" '
        f'aria-label="{escape(name)}">{"".join(parts)}</svg>'
    )


def tick_text(value: float, unit: str, *, with_unit: bool = False) -> str:
    """Return the number at a tick in few digits, with its unit if wanted."""
    shown = scale_of(unit) * value
    is_plain = not shown or SMALLEST <= abs(shown) < LARGEST
    digits = ",.0f" if abs(shown) >= _PLAIN else ".3g"
    text = f"{shown:{digits}}".replace("-", MINUS) if is_plain else number_text(shown)
    return f"{text} {unit_text(unit)}".rstrip() if with_unit else text


def line_of(values: Sequence[float], ends: Iterable[float] = (), *, log: bool = True) -> Line:
    """Return the line on which all values lie, without any that makes them look far apart.

    It is logarithmic, if wanted, where values span a decade, and has 0 on it elsewhere. Its ends
    are round.

    Parameters
    ----------
    values
    ends
        Of intervals, which lie on it as well.
    log
    """
    known = [value for value in values if math.isfinite(value)] or [0.0]
    is_log = log and min(known) >= 0.0 and max(known) > _DECADE * min(known)
    if is_log:
        # above 0 such a line has a least number, which is no end of an interval
        least = 0.0 if min(known) > 0.0 else min(value for value in known if value > 0.0)
        values = [*known, *(end for end in ends if end > least)]
        return Line.through(values, log=True).to_rounds
    return Line.through([*known, *ends, 0.0], log=False).to_rounds


def dot(x: float, y: float, kind: str, name: str, radius: float = 4.0) -> str:
    """Return a dot with a name to hover.

    Parameters
    ----------
    x, y, radius
        In pixels.
    kind
        ``best``, ``tied``, ``before``, ``worse`` or ``rest``.
    name
    """
    return (
        f'<circle class="{kind}" cx="{x:g}" cy="{y:g}" r="{radius:g}">'
        f"<title>{escape(name)}</title></circle>"
    )
