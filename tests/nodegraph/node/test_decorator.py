from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

import pytest
from pydantic import Field, ValidationError

from nodegraph import Across, InputFile, NodeError, Truth, Unit, Value, node
from nodegraph.node.declaration import UNDECLARED
from nodegraph.node.decorator import Node, node_of
from nodegraph.node.description import describe_declaration
from nodegraph.node.ports import Port


class Parts(NamedTuple):
    first: float
    answer: Truth[int]


@dataclass(frozen=True)
class Record:
    first: float
    second: str


@dataclass(frozen=True)
class Whole(Value):
    first: float


class Empty(NamedTuple):
    pass


def described(function: Callable[..., object]) -> Node:
    definition = node_of(function)
    assert definition is not None
    return definition.check()


@node("toy.every", cite=("one2001", "two2002"))
def every(
    recording: float,
    scores: Across[int],
    answer: Truth[str],
    drawn: Truth[float] | None = None,
    marked: Truth[float | None] = None,
    floor: Across[int] | None = None,
    *,
    length: Annotated[int, Field(ge=1), Unit("frames")] = 5,
    path: InputFile,
    model: InputFile | None = None,
    way: Literal["up", "down"] = "up",
) -> Parts:
    """Do everything.

    At length.
    """
    return Parts(recording, length)


def test_arguments_before_the_star_are_ports() -> None:
    assert described(every).inputs == (
        Port("recording", float),
        Port("scores", int, across=True),
        Port("answer", str, truth=True),
        Port("drawn", float, truth=True, optional=True),
        Port("marked", float, truth=True, optional=True),
        Port("floor", int, across=True, optional=True),
    )


def test_arguments_after_the_star_are_settings() -> None:
    settings = described(every).settings
    assert list(settings) == ["length", "path", "model", "way"]
    assert [setting.unit for setting in settings.values()] == ["frames", "", "", ""]
    assert [setting.is_file for setting in settings.values()] == [False, True, True, False]
    assert [setting.required for setting in settings.values()] == [False, True, False, False]


def test_a_named_tuple_is_several_outputs() -> None:
    definition = described(every)
    assert definition.outputs == (Port("first", float), Port("answer", int, truth=True))
    assert definition.splits


def test_name_doc_and_citations() -> None:
    definition = described(every)
    assert (definition.family, definition.method, definition.summary) == (
        "toy",
        "every",
        "Do everything.",
    )
    assert definition.doc.endswith("At length.")
    assert definition.cite == ("one2001", "two2002")


def test_a_dataclass_is_taken_apart_and_a_value_is_not() -> None:
    @node("toy.record")
    def record() -> Record:
        return Record(1.0, "")

    @node("toy.whole")
    def whole() -> Whole:
        return Whole(1.0)

    assert [port.name for port in described(record).outputs] == ["first", "second"]
    assert described(whole).outputs == (Port("output", Whole),)
    assert not described(whole).splits


def test_one_output_may_be_the_truth() -> None:
    @node("toy.answer")
    def answer() -> Truth[float]:
        return 1.0

    assert described(answer).outputs == (Port("output", float, truth=True),)


def test_truth_inside_a_gathering_port_is_truth() -> None:
    @node("toy.gather")
    def gather(answers: Across[Truth[float]]) -> float:
        return 0.0

    assert described(gather).inputs == (Port("answers", float, truth=True, across=True),)


def test_the_function_stays_as_it_is() -> None:
    @node("toy.double")
    def double(x: float, *, by: float = 2.0) -> float:
        return x * by

    assert double(3.0) == 6.0
    assert double(3.0, by=3.0) == 9.0
    assert double.__name__ == "double"


def test_cite_none_is_no_key() -> None:
    @node("toy.plain", cite="none")
    def plain() -> float:
        return 0.0

    assert described(plain).cite == ()


def test_settings_are_not_converted_in_silence() -> None:
    model = described(every).model
    good = model.model_validate_json('{"path": "a.c3d", "length": 3}')
    assert good.length == 3  # type: ignore[attr-defined]
    for bad in ('{"path": "a", "length": "3"}', '{"path": "a", "length": 3.0}', '{"path": "a"'):
        with pytest.raises(ValidationError):
            model.model_validate_json(bad)


def test_any_word_can_name_a_setting() -> None:
    @node("toy.words")
    def words(*, copy: int = 1, json: int = 2, model_path: str = "", schema: str = "") -> float:
        return 0.0

    settings = described(words).model.model_validate_json('{"copy": 4, "schema": "x"}')
    assert (settings.copy, settings.json, settings.model_path, settings.schema) == (4, 2, "", "x")  # type: ignore[comparison-overlap, attr-defined]


@pytest.mark.parametrize(
    "name", ["hold", "fill.Hold", "fill.", ".hold", "a.b.c", "fill hold", "1.a"]
)
def test_a_name_is_family_and_method(name: str) -> None:
    with pytest.raises(NodeError, match=r"write family\.method"):
        node(name)


def untyped(x) -> float:  # type: ignore[no-untyped-def]  # noqa: ANN001
    return 0.0


def unanswered(x: float):  # type: ignore[no-untyped-def]  # noqa: ANN201
    return x


def two_types(x: float | int) -> float:
    return x


def anything(x: Any) -> float:
    return 0.0


def any_output(x: float) -> Any:
    return x


def many(*x: float) -> float:
    return 0.0


def words(x: float, **more: float) -> float:
    return x


def defaulted(x: float = 1.0) -> float:
    return x


def undefaulted(x: float | None) -> float:
    return x or 0.0


def positional(x: float, /) -> float:
    return x


def unknown_type(x: Missing) -> float:  # type: ignore[name-defined]  # noqa: F821
    return 0.0


def empty_record(x: float) -> Empty:
    return Empty()


def maybe(x: float) -> float | None:
    return x


def hidden_setting(x: float, *, _secret: int = 1) -> float:
    return x


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (untyped, "x has no annotation"),
        (unanswered, "return has no annotation"),
        (two_types, "port 'x' needs one type"),
        (anything, "port 'x' needs one type"),
        (any_output, "output 'output' needs one type"),
        (many, "name each one"),
        (words, "name each one"),
        (defaulted, r"'x' is a setting: write it after '\*', \*, x: float = 1\.0"),
        (undefaulted, r"written x: float \| None = None"),
        (positional, "'x'"),
        (unknown_type, "cannot be read: name 'Missing'"),
        (empty_record, "has no field"),
        (maybe, "output 'output' needs one type"),
        (hidden_setting, "_secret"),
    ],
)
def test_what_a_signature_lacks_is_named_with_the_node(
    function: Callable[..., object], message: str
) -> None:
    marked = node("toy.bad")(function)
    with pytest.raises(NodeError, match=rf"toy\.bad: .*{message}"):
        described(marked)


def test_an_undecorated_function_is_no_node() -> None:
    assert node_of(len) is None


def test_what_is_declared_depends_on_the_settings() -> None:
    @node(
        "toy.window",
        cite="one2001",
        adapted="from One 2001: two-sided",
        lookahead=lambda settings: settings["reach"],
        ends=True,
    )
    def window(x: float, *, reach: int | None = 3) -> float:
        return x

    definition = described(window)
    assert definition.lookahead({"reach": 5}) == 5
    assert definition.lookahead({"reach": None}) is None
    assert definition.meets_ends({"reach": 5}) is True
    assert describe_declaration(definition) == (
        "adapted from One 2001: two-sided",
        "look-ahead 3 frames by default",
        "ends of gaps met",
    )
    used: list[dict[str, int | None]] = [{"reach": 1}, {"reach": None}]
    assert "look-ahead 1 frame or unbounded" in describe_declaration(definition, used)


def test_a_node_that_declares_nothing_is_no_method() -> None:
    definition = described(every)
    assert definition.lookahead({}) is UNDECLARED
    assert definition.meets_ends({}) is None
    assert describe_declaration(definition) == ()


@pytest.mark.parametrize(
    ("declared", "named"),
    [
        ({"lookahead": -1}, "lookahead is -1"),
        ({"lookahead": lambda settings: 0.5}, "lookahead is 0.5"),
        ({"lookahead": lambda settings: settings["order"]}, "lookahead failed: KeyError: 'order'"),
        ({"ends": lambda settings: "met"}, "ends is 'met'"),
        ({"requires": lambda y, reach: None}, "takes 'y', which is neither .* there is: x, reach"),
    ],
)
def test_a_wrong_declaration_is_named(declared: dict[str, Any], named: str) -> None:
    @node("toy.wrong", **declared)
    def wrong(x: float, *, reach: int = 1) -> float:
        return x

    with pytest.raises(NodeError, match=named):
        described(wrong)
