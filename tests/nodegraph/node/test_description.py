from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import pytest
from pydantic import Field

from nodegraph import InputFile, Unit, node
from nodegraph.node.decorator import Node, node_of
from nodegraph.node.description import (
    ShownSetting,
    describe_settings,
    meanings,
    setting_kind,
    value_text,
    without_parameters,
)


@node("describe.all")
def everything(
    recording: float,
    *,
    length: Annotated[int, Field(ge=1, le=9), Unit("frames")] = 5,
    size: Annotated[float, Field(gt=0, lt=1), Unit("mm")],
    way: Literal["up", "down"] = "up",
    name: str = "x",
    flag: bool = False,
    order: Annotated[int, Unit("frames")] | None = None,
    path: InputFile | None = None,
    lengths: tuple[int, ...] = (1, 2),
    either: Literal["all"] | int = "all",
    undocumented: float = 1e-3,
) -> float:
    """Do everything.

    Parameters
    ----------
    recording
        What is measured.
    length
        How long,
        in all.
    size, way
        Both of them.
    """
    return 0.0


def described() -> Node:
    node_ = node_of(everything)
    assert node_ is not None
    return node_


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("length", "whole number >= 1 and <= 9"),
        ("size", "number > 0 and < 1"),
        ("way", "one of up, down"),
        ("name", "text"),
        ("flag", "true or false"),
        ("order", "whole number or null"),
        ("path", "path or null"),
        ("lengths", "list of whole numbers"),
        ("either", "one of all or whole number"),
    ],
)
def test_a_setting_says_type_bounds_and_choices(name: str, kind: str) -> None:
    assert setting_kind(described(), name) == kind


def test_settings_come_with_unit_default_and_meaning() -> None:
    texts = {setting.name: setting for setting in describe_settings(described())}
    assert list(texts)[:3] == ["length", "size", "way"]
    assert texts["length"] == ShownSetting(
        "length", "whole number >= 1 and <= 9", "frames", 5, False, "How long, in all."
    )
    assert texts["length"].default_text == "5"
    assert (texts["size"].default_text, texts["size"].meaning) == ("required", "Both of them.")
    assert texts["way"].meaning == "Both of them."
    assert texts["undocumented"].meaning == ""
    assert (texts["order"].default_text, texts["order"].unit) == ("null", "frames")
    assert meanings(described())["recording"] == "What is measured."


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "null"),
        (True, "true"),
        ((1, "a", None), "[1, a, null]"),
        ([], "[]"),
        (0.5, "0.5"),
        (Path("a/b"), "a/b"),
    ],
)
def test_a_value_is_shown_as_a_graph_file_has_it(value: object, text: str) -> None:
    assert value_text(value) == text


def test_the_section_of_parameters_is_left_out_and_nothing_else() -> None:
    doc = "First.\n\nMore.\n\nParameters\n----------\na\n    One.\n\nReturns\n-------\nb\n    Two."
    assert without_parameters(doc) == "First.\n\nMore.\n\nReturns\n-------\nb\n    Two."
    assert without_parameters("First.\n\nParameters\n----------\na\n    One.") == "First."
    assert without_parameters("First.") == "First."


def test_a_docstring_is_shown_without_what_the_table_says() -> None:
    assert without_parameters(described().doc) == "Do everything."
    text = "Do.\n\nParameters\n----------\nx\n    Of it.\n\nReferences\n----------\nOne."
    assert without_parameters(text) == "Do.\n\nReferences\n----------\nOne."


def test_meanings_are_plain_words() -> None:
    @node("toy.quoted")
    def quoted(recording: float, *, path: str = "") -> float:
        """Read.

        Parameters
        ----------
        path
            A file, or ``sample:NAME``; see `recording`.
        """
        return recording

    described = node_of(quoted)
    assert described is not None
    assert describe_settings(described)[0].meaning == "A file, or sample:NAME; see recording."


def test_meanings_call_none_what_a_graph_file_calls_it() -> None:
    @node("toy.optional")
    def optional(
        recording: float,
        *,
        most: int | None = None,
        scale: Literal["none", "size"] | None = None,
        name: str = "",
    ) -> float:
        """Read.

        Parameters
        ----------
        most
            At most so many; none: any, of which none is lost.
        scale
            none: as it is.
        name
            none: not a name.
        """
        return recording

    described = node_of(optional)
    assert described is not None
    assert [setting.meaning for setting in describe_settings(described)] == [
        "At most so many; null: any, of which none is lost.",
        "none: as it is.",
        "none: not a name.",
    ]


class Odd:
    """A class that JSON knows nothing about."""


@node("odd.setting")
def odd(*, kind: Odd | None = None, size: int = 3) -> float:
    return size


def test_a_setting_of_any_class_can_be_shown() -> None:
    described = node_of(odd)
    assert described is not None
    assert [setting.kind for setting in describe_settings(described)] == [
        "value or null",
        "whole number",
    ]
