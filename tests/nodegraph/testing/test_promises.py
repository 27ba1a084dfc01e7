"""One line tests every node of a plugin, with each choice of its settings."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Literal

import pytest
from pydantic import Field

from nodegraph import NodegraphError, hookimpl, node
from nodegraph.node.decorator import node_of
from nodegraph.plugin import loading
from nodegraph.plugin.loading import BrokenPlugin, Plugin
from nodegraph.plugin.registry import default_registry
from nodegraph.testing import promises_of
from nodegraph.testing.specimens import examples, variants

pytest_plugins = ["pytester"]
NODES = """
from typing import Annotated, Literal
from pydantic import Field
from nodegraph import node

@node("toy.number")
def number(*, start: float = 1.0, sign: Literal["plus", "minus"] = "plus") -> float:
    '''Give a number.

    Parameters
    ----------
    start
        The number.
    sign
        Its sign.
    '''
    return start if sign == "plus" else MINUS

@node("toy.power")
def power(*, of: Annotated[int, Field(ge=1, examples=[3])]) -> float:
    '''Give a power of two.

    Parameters
    ----------
    of
        Which.
    '''
    return 2.0**of
"""


@node("toy.choices")
def choices(
    *,
    kind: Literal["a", "b"] = "a",
    bend: bool = True,
    many: Annotated[int, Field(examples=[4])],
    most: Annotated[Literal[1, 2], Field()] | None = None,
) -> float:
    return 0.0


@pytest.fixture
def _installed(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    module = SimpleNamespace(nodegraph_nodes=hookimpl(lambda: [choices]))
    broken = [BrokenPlugin("torn", "torn: ImportError: no module")]
    monkeypatch.setattr(loading, "installed", lambda: ([Plugin("toys", module)], broken))
    default_registry.cache_clear()
    yield
    default_registry.cache_clear()


def test_each_choice_that_is_not_the_default_is_a_variant() -> None:
    described = node_of(choices)
    assert described is not None
    assert dict(variants(described)) == {
        "": {},
        "[kind=b]": {"kind": "b"},
        "[bend=False]": {"bend": False},
    }
    assert examples(described) == {"many": 4}


def test_every_node_of_a_file_is_tested_with_each_choice(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(toys=NODES.replace("MINUS", "-start"))
    pytester.makepyfile(
        test_toys="""
        from pathlib import Path
        from nodegraph.testing import promises_of

        test_promises = promises_of(Path(__file__).with_name("toys.py"))
        """
    )
    result = pytester.runpytest("-v", "-p", "no:cacheprovider")
    result.assert_outcomes(passed=3)
    result.stdout.fnmatch_lines(
        ["*::test_promises?toy.number? PASSED*", "*?toy.number?sign=minus?? PASSED*"]
    )


def test_the_node_and_the_choice_that_break_a_promise_are_named(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(toys=NODES.replace("MINUS", "'-' + str(start)"))
    pytester.makepyfile(
        test_toys="""
        from nodegraph.testing import promises_of

        test_promises = promises_of("toys.py")
        """
    )
    result = pytester.runpytest("-p", "no:cacheprovider")
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines(
        [
            "*toy.number does not keep its promises*",
            "*toy.number returned str where its signature promises float*",
            "FAILED *toy.number?sign=minus?*",
        ]
    )


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("toyz", "no plugin 'toyz' with nodes is installed; did you mean 'toys'"),
        ("torn", "plugin 'torn' is left out: torn: ImportError: no module"),
    ],
)
@pytest.mark.usefixtures("_installed")
def test_a_plugin_that_is_not_installed_is_named(name: str, message: str) -> None:
    with pytest.raises(NodegraphError, match=message):
        promises_of(name)


def test_a_missing_file_is_named() -> None:
    with pytest.raises(NodegraphError, match="no such plugin file"):
        promises_of(Path("nowhere.py"))
