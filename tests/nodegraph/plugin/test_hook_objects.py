"""What hooks return is refused at once where it is of another type than is due."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from nodegraph.plugin.hook_types import Comparison, Conclusion, Rendered, Renderer, Storage


def nothing(*given: Any) -> tuple[str, ...]:
    return ()


WRONG: dict[str, tuple[Callable[..., Any], dict[str, Any], str]] = {
    "a text for a type": (
        Conclusion,
        {"type": "int", "conclude": nothing, "numbers": nothing},
        "^Conclusion: type must be a type, not 'int'$",
    ),
    "numbers themselves": (
        Conclusion,
        {"type": int, "conclude": nothing, "numbers": 4},
        "^Conclusion: numbers must be a function, not 4$",
    ),
    "the other way round": (
        Renderer,
        {"type": nothing, "render": int},
        "^Renderer: type must be a type, not <function nothing",
    ),
    "parts that are none": (
        Comparison,
        {"type": int, "compare": nothing, "parts": ()},
        r"^Comparison: parts must be a function or None, not \(\)$",
    ),
    "half a storage": (
        Storage,
        {"type": int, "take_apart": nothing, "put_together": None},
        "^Storage: put_together must be a function, not None$",
    ),
    "a third function for a truth": (
        Storage,
        {"type": int, "take_apart": nothing, "put_together": nothing, "faithful": nothing},
        "^Storage: faithful must be true or false, not <function nothing",
    ),
    "bytes for HTML": (Rendered, {"html": b"<p>"}, "^Rendered: html must be a text, not b'<p>'$"),
    "one text for scripts": (
        Rendered,
        {"html": "", "scripts": "let a = 1"},
        "^Rendered: scripts must be a tuple, not 'let a = 1'$",
    ),
    "scripts of bytes": (
        Rendered,
        {"html": "", "scripts": (b"let a = 1",)},
        "^Rendered: each of the scripts must be a text$",
    ),
    "files of text": (
        Rendered,
        {"html": "", "files": {".csv": "a,b"}},
        "^Rendered: of files, '.csv' is not a suffix with its bytes$",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_another_type_than_is_due_is_refused(name: str) -> None:
    make, given, said = WRONG[name]
    with pytest.raises(TypeError, match=said):
        make(**given)


def test_what_is_due_is_taken() -> None:
    assert Storage(int, nothing, nothing, lend=nothing).faithful
    assert Comparison(int, nothing).parts is None
    assert Rendered("", files={".csv": b"a"}, styles=("p {}",)).text == ""
