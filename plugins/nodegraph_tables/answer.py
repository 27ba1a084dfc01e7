"""The answer of a table: words, a card for each part of it, and what it holds for.

It is one value, from which a page and a terminal draw what they show.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Literal, TypeVar, cast

from nodegraph import Label, Value
from nodegraph_tables.line import Line
from nodegraph_tables.numbers import number_text, shares_text
from nodegraph_tables.style import SHARE, bare_unit
from nodegraph_tables.text import HERE, Text, Word, joined, plain, say

_T = TypeVar("_T")

MOST_CARDS = 8
"""Cards that a reader sees at once."""

ONE_ROW = 4
"""Cards that stand in one row."""

MOST_ROWS = 9
"""Of a card that stands beside no more than three others."""

MAY_BE = "may be as good"
"""Said of what is not certain to be worse than the best."""

Kind = Literal["best", "tied", "open", "before", "worse", "rest"]


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
