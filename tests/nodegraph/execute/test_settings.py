"""The command of a run has the settings of the run, whatever their values are."""

from __future__ import annotations

import re
import shlex
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph.errors import NodegraphError
from nodegraph.execute.settings import RunSettings
from nodegraph.graph.option_text import read_axis, read_value

SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(allow_nan=False, allow_infinity=False),
    st.text(st.characters(exclude_categories=["C"])),
    st.sampled_from(
        [
            "count:3",
            "1",
            "1e-3",
            "no",
            "true",
            "",
            "a,b",
            "[x",
            "{",
            "a: b",
            "#",
            "'",
            " x",
            "*.c3d",
        ]
    ),
)
VALUES = st.recursive(
    SCALARS,
    lambda parts: st.lists(parts) | st.dictionaries(st.text("ab", min_size=1), parts),
    max_leaves=8,
)
LABELS = st.one_of(
    st.lists(SCALARS.filter(lambda label: label is not None), min_size=1),
    st.dictionaries(st.text("ab", min_size=1), VALUES, min_size=1, max_size=4),
)


def option(settings: RunSettings) -> str:
    """Return what follows the equals sign of the only option of a command."""
    *_, words = shlex.split(settings.command)
    return words.partition("=")[2]


@given(VALUES)
def test_an_input_keeps_its_value(value: object) -> None:
    text = option(RunSettings("g.yaml", set={"start": value}))
    assert repr(read_value("--set start", text)) == repr(value)


@given(LABELS)
def test_an_axis_keeps_its_labels(labels: object) -> None:
    text = option(RunSettings("g.yaml", axis={"k": labels}))
    assert repr(read_axis("--axis k", text)) == repr(labels)


@pytest.mark.parametrize(
    ("text", "instead"),
    [
        ("count:3", "k={count: 3}"),
        ("count: 3", "k={count: 3}"),
        ("count=3", "k={count: 3}"),
        ("{count:3}", "k={count: 3}"),
        ("range:5,60,5", "k={range: [5,60,5]}"),
        ("range:[5, 60, 5]", "k={range: [5, 60, 5]}"),
        ("files:takes/*.c3d", 'k={files: "takes/*.c3d"}'),
        ("{files: {actor}/*.c3d}", 'k={files: "{actor}/*.c3d"}'),
    ],
)
def test_a_generator_without_braces_or_quotes_is_no_label(text: str, instead: str) -> None:
    with pytest.raises(NodegraphError, match=f"write --axis '{re.escape(instead)}'") as caught:
        read_axis("--axis k", text)
    word = shlex.split(str(caught.value).partition("write ")[2])[1]
    assert set(read_axis("--axis k", word.partition("=")[2])) == {text.strip("{")[:5]}


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"set": {"take": "a b.c3d", "n": 3}}, "--set 'take=a b.c3d' --set n=3"),
        ({"axis": {"k": [1, 2], "x": {"count": 3}}}, "--axis k=1,2 --axis 'x={\"count\": 3}'"),
        ({"only": {"fill": ["hold", "lin"]}}, "--only fill=hold,lin"),
        ({"until": ["a", "b"], "plugins": ["p.py"]}, "--until a --until b --plugin p.py"),
        ({"store": "kept", "executor": "serial"}, "--store kept --executor serial"),
        ({"cache": False, "jobs": 2, "executor": "threads"}, ""),
    ],
)
def test_options_are_written_as_a_user_writes_them(settings: dict[str, Any], words: str) -> None:
    assert RunSettings("g.yaml", **settings).command == f"nodegraph run g.yaml {words}".rstrip()
