from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph import GraphError
from nodegraph.errors import Place
from nodegraph.graphfile.yaml_text import located, read_yaml, scalar
from tests.texts import any_text


def plain(text: str) -> Any:
    return read_yaml(text, "t.yaml").plain()


def mistake(text: str) -> str:
    with pytest.raises(GraphError) as caught:
        read_yaml(text, "t.yaml")
    return str(caught.value)


@pytest.mark.parametrize(
    ("word", "value"),
    [
        ("1e-3", 0.001),
        ("1.", 1.0),
        (".5", 0.5),
        ("-2.5E+3", -2500.0),
        ("1e400", math.inf),
        ("-.inf", -math.inf),
        ("+12", 12),
        ("007", 7),
        ("0o17", 15),
        ("0xFf", 255),
        ("true", True),
        ("False", False),
        ("no", "no"),
        ("yes", "yes"),
        ("on", "on"),
        ("y", "y"),
        ("1_000", "1_000"),
        ("12:30:45", "12:30:45"),
        ("2001-12-14", "2001-12-14"),
        ("0b11", "0b11"),
        ("<<", "<<"),
        ("=", "="),
        ("~", None),
        ("null", None),
        ("'no'", "no"),
        ('"1e-3"', "1e-3"),
        ("'~'", "~"),
        ('""', ""),
    ],
)
def test_words_mean_what_yaml_1_2_says(word: str, value: object) -> None:
    scalar = plain(f"key: {word}")["key"]
    assert scalar == value
    assert type(scalar) is type(value)


def test_not_a_number() -> None:
    assert math.isnan(scalar(".nan"))


@given(st.floats(allow_nan=False))
def test_a_float_is_read_as_it_was_written(number: float) -> None:
    if math.isfinite(number):
        assert scalar(repr(number)) == number


@given(st.integers())
def test_a_whole_number_is_read_as_it_was_written(number: int) -> None:
    assert scalar(str(number)) == number


@pytest.mark.parametrize("text", ["9" * 5000, "0x" + "f" * 5000, "0o" + "7" * 6000])
def test_a_number_too_long_to_be_shown_stays_a_word(text: str) -> None:
    assert scalar(text) == text


def test_every_value_and_key_has_its_place() -> None:
    root = read_yaml("a: 1\nb:\n  - x\n  - {c: 2}\n", "t.yaml")
    second = root.value["b"]
    assert root.keys["b"] == Place("t.yaml", 2, 1)
    assert root.value["a"].place == Place("t.yaml", 1, 4)
    assert second.value[0].place == Place("t.yaml", 3, 5)
    assert second.value[1].keys["c"] == Place("t.yaml", 4, 6)
    assert second.value[1].value["c"].place == Place("t.yaml", 4, 9)


@pytest.mark.parametrize("text", ["", "\n\n", "# nothing but words\n", "---\n", "---\n...\n"])
def test_an_empty_text_is_null(text: str) -> None:
    assert plain(text) is None


def test_a_duplicate_key_is_reported_with_the_first() -> None:
    assert mistake("a: 1\nb: {c: 1, c: 2}\na: 3\n").splitlines() == [
        "t.yaml:2:11: duplicate key 'c'; first in line 2",
        "t.yaml:3:1: duplicate key 'a'; first in line 1",
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: !!python/object:os.system x", "t.yaml:1:4: tag 'tag:yaml.org,2002:python/object"),
        ("a: !custom x", "t.yaml:1:4: tag '!custom'"),
        ("a: !!set {x}", "t.yaml:1:4: tag"),
        ("? [a]\n: b", "t.yaml:1:3: a key must be one word or number"),
        ("? {a: b}\n: c", "t.yaml:1:3: a key must be one word or number"),
        ("a: *b", "t.yaml:1:4: alias *b"),
        ("a: &a [1, *a]", "t.yaml:1:11: alias *a stands before, or inside"),
        ("a: &a {b: *a}", "t.yaml:1:11: alias *a"),
        ("a: 1\n---\nb: 2", "t.yaml:2:1: a second document"),
        ("b:\n  a: [1, 2\nc: 3", "t.yaml:2:6: this is not YAML: this [ is not closed"),
        ("a: {b: 1", "t.yaml:1:4: this is not YAML: this { is not closed"),
        ("a: *.c3d", "t.yaml:1:4: this is not YAML: a text that begins with * needs quotes"),
        ("a: 1\n\tb: 2", "t.yaml:2:1: this is not YAML: a tab; indent with spaces"),
        ("a:\n\tb: 2", "t.yaml:2:1: this is not YAML: a tab; indent with spaces"),
        ("a:\r\n\tb: 2", "t.yaml:2:1: this is not YAML: a tab; indent with spaces"),
        ("a:\n  b:\n \tc: 2", "t.yaml:3:2: this is not YAML: a tab; indent with spaces"),
        ("a: |\n\tb", "t.yaml:2:1: this is not YAML: a tab; indent with spaces"),
        ("a: b: c", "t.yaml:1:5: this is not YAML"),
        (f"a:\n  {'b' * 1100}: c", "t.yaml:2:1103: this is not YAML: a key of more than 1,024"),
        ("a: 'open", "t.yaml:1:4: this is not YAML: this quote is not closed, up to line 1"),
        ("a: \x00", "t.yaml:1:4: this is not YAML"),
        ("ab: 1\ncd: \x07", "t.yaml:2:5: this is not YAML"),
        ("a: \udcff", "t.yaml:1:4: this is not YAML"),
        ("%YAML 3.0\n---\na: 1", "t.yaml:1:1: this is not YAML"),
    ],
)
def test_what_is_refused_has_a_place(text: str, message: str) -> None:
    assert mistake(text).startswith(message)


def test_an_alias_repeats_a_value_at_its_own_place() -> None:
    root = read_yaml("a: &x {b: 1}\nc: *x\n", "t.yaml")
    assert root.plain() == {"a": {"b": 1}, "c": {"b": 1}}
    assert root.value["c"].place == Place("t.yaml", 2, 4)


def test_aliases_that_unfold_without_end_are_refused() -> None:
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]" for i in range(1, 9)]
    assert "aliases unfold to more than 1,000,000 values" in mistake("\n".join(lines))


def test_nesting_is_bounded() -> None:
    assert plain("[" * 100 + "]" * 100)
    assert mistake("[" * 101 + "]" * 101) == "t.yaml:1:101: nested more than 100 deep"
    assert mistake("[" * 100_000).endswith(": nested more than 100 deep")


def test_nesting_by_aliases_is_bounded_too() -> None:
    lines = ["a0: &a0 [1]"]
    lines += [f"a{i}: &a{i} {'[' * 50}*a{i - 1}{']' * 50}" for i in range(1, 40)]
    assert "nested more than 100 deep" in mistake("\n".join(lines))


@given(any_text(max_size=60))
def test_any_text_is_read_or_refused_with_a_place(text: str) -> None:
    try:
        read_yaml(text, "t.yaml").plain()
    except GraphError as error:
        places = [problem.place for problem in error.problems]
    else:
        places = []
    assert all(place.line >= 1 and place.column >= 1 for place in places)


DATA = st.recursive(
    st.none() | st.booleans() | st.integers() | any_text(),
    lambda inner: st.lists(inner) | st.dictionaries(any_text(), inner),
    max_leaves=10,
)


@given(DATA)
def test_plain_data_comes_back_from_located(data: object) -> None:
    assert located(data, Place("--set x")).plain() == data
