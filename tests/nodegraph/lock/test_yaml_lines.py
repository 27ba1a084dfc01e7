"""Data written as YAML reads back."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph.graphfile.yaml_text import read_yaml
from nodegraph.lock.yaml_lines import yaml_lines

TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=30) | st.sampled_from(
    ["no", "1e-3", "null", "~", "- a", "a: b", "a #b", "a\nb\n", "\n", " a\n", "{", "0x1", "1_000",
     "---", "...\n", "\ta\n", "é", "\u2028", "\x85", "a,b", "[a]", "'", '"', "2001-01-01", "1:30"]
)  # fmt: skip
SCALARS = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | TEXTS
DATA = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXTS, inner, max_size=4),
    max_leaves=12,
)


def back(data: dict[str, object]) -> Any:
    return read_yaml("".join(f"{line}\n" for line in yaml_lines(data)), "data").plain()


def with_text_keys(data: object) -> object:
    if isinstance(data, dict):
        return {str(key): with_text_keys(item) for key, item in data.items()}
    return [with_text_keys(item) for item in data] if isinstance(data, list) else data


@given(st.dictionaries(TEXTS, DATA, min_size=1, max_size=5))
def test_data_reads_back(data: dict[str, object]) -> None:
    assert with_text_keys(back(data)) == data


def test_nan_and_infinity_read_back() -> None:
    assert math.isnan(back({"a": math.nan})["a"])
    assert back({"a": [math.inf, -math.inf]}) == {"a": [math.inf, -math.inf]}


@pytest.mark.parametrize(
    ("data", "lines"),
    [
        ({"a": 1, "b": "two words"}, ["a: 1", "b: two words"]),
        ({"a": {"b": {}, "c": []}}, ["a:", "  b: {}", "  c: []"]),
        ({"axes": ["x", 2, None]}, ["axes: [x, 2, null]"]),
        ({"long": ["x" * 50, "y"]}, ["long:", f"  - {'x' * 50}", "  - y"]),
        ({"text": "one\n\n two\n"}, ["text: |", "  one", "", "   two"]),
        ({"0, 5": "null"}, ['0, 5: "null"']),
        ({"12": 1e-9}, ["12: 1e-09"]),
    ],
)
def test_a_key_has_a_line(data: dict[str, object], lines: list[str]) -> None:
    assert list(yaml_lines(data)) == lines
