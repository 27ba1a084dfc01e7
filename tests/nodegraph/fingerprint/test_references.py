"""Which names a function takes from its module, and which are its own."""

from __future__ import annotations

import ast
import textwrap

import pytest

from nodegraph.fingerprint.source import references


def references_in(text: str) -> set[str]:
    (statement,) = ast.parse(textwrap.dedent(text)).body
    return set(references(statement, lambda name: name == "node"))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def f(): return np.linalg.norm(x)", {"np.linalg.norm", "x"}),
        ("def f(x): return x.walk()", set()),
        ("def f(): walk = 1; return walk", set()),
        ("def f():\n walk(1)\n def walk(x): return x", set()),
        ("def f(a: A, *b: B, c: C = d, **e: E) -> G: pass", {"A", "B", "C", "d", "E", "G"}),
        ("def f(a: 'list[A]', b: Literal['walk'], c: Annotated['B', 'walk']): pass",
         {"A", "B", "Literal", "Annotated", "list"}),
        ("def f(a: 'not a type'): pass", set()),
        ("@deco(k)\ndef f(): pass", {"deco", "k"}),
        ("@node(k)\ndef f(): pass", set()),
        ("class A(B, metaclass=M):\n x: T = v\n def m(self): return helper(x)",
         {"B", "M", "T", "v", "helper", "x"}),
        ("class A:\n import a.b\n from c import d", {"a:", "c:d"}),
        ("def f(): return [walk for walk in walks if test(walk)]", {"walks", "test"}),
        ("def f(): return [walk for walk in walk]", {"walk"}),
        ("def f():\n y = [walk for walk in z]\n return walk", {"z", "walk"}),
        ("def f():\n [(walk := i) for i in z]\n return walk", {"z"}),
        ("def f(): return {k: v for k, v in a.items() for w in v}", {"a.items"}),
        ("f = lambda x, y=z: x + y + w", {"z", "w"}),
        ("def f():\n def g(): return walk\n walk = 1\n return g", set()),
        ("def f():\n def g():\n  walk = 1\n return walk", {"walk"}),
        ("def f():\n global walk\n walk = 1", {"walk"}),
        ("def f():\n walk = 1\n def g():\n  nonlocal walk\n  walk = 2", set()),
        ("def f():\n import a.b\n return a.b.walk", {"a:b.walk"}),
        ("def f():\n import a.b as c\n return c.walk", {"a.b:walk"}),
        ("def f():\n import a.b as c\n return c", {"a.b:"}),
        ("def f():\n import a.b", {"a:"}),
        ("def f():\n from . import a\n return a.walk", {".:a.walk"}),
        ("def f():\n from ..b import a as c\n def g(): return c(1)", {"..b:a"}),
        ("def f():\n from b import a", {"b:a"}),
        ("def f():\n try: pass\n except Wrong as e: print(e)", {"Wrong", "print"}),
        ("def f():\n with lock as held: held", {"lock"}),
        ("def f(x):\n match x:\n  case A(y) | B.C as z: return y, z\n  case {'k': v, **r}: r\n"
         "  case [*s]: return s", {"A", "B.C"}),
        ("def f(x): return f'{walk(x)!r:{width}}'", {"walk", "width"}),
        ("def f(): return import_module('a.b')", {"import_module", "a.b:"}),
        ("def f(x): x.y = z; w.y = 1; v[u] = 2", {"z", "w.y", "v", "u"}),
        ("async def f():\n async for x in y: await x", {"y"}),
        ("x.y = z", {"x.y", "z"}),
        ("a, b = c", {"c"}),
        ("a: T = c", {"T", "c"}),
        ("del a", {"a"}),
    ],
)  # fmt: skip
def test_references(text: str, expected: set[str]) -> None:
    assert references_in(text) == expected


def test_a_long_sum_is_read_without_recursion() -> None:
    text = "f = " + " + ".join(f"a{number}" for number in range(600))
    assert len(references_in(text)) == 600
