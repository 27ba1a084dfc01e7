"""A lock's data of another form is told by its key."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import pytest

from nodegraph.execute import Run
from nodegraph.lock.lockfile import Lock, misfit

Frozen = tuple[Run, Lock]


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (("methods", "cut", "use"), ["gaps.cut"], "methods.cut.use: input should be a valid str"),
        (("methods", "cut"), 3, "methods.cut: input should be a valid dictionary"),
        (("methods", "cut", "in"), "a", "methods.cut.in: "),
        (("choices",), [], "choices: "),
        (("choices",), {"only": {"fill": 3}}, "choices.only.fill: "),
        (("removed",), {"fill": "hold"}, "removed.fill: "),
        (("axes", "length"), 3, "axes.length: "),
        (("axes", "length"), [[3]], "axes.length.0: "),
        (("versions",), {"numpy": "2.4"}, "versions.python: field required"),
        (("versions", "numpy"), 2.4, "versions.numpy: "),
        (("results", "cut", "steps"), {"3": 4}, "results.cut.steps.3: "),
        (("results", "cut", "scale"), {"gappy": 0.0}, "results.cut.scale.gappy: "),
        (("conclusions",), {"table": "a < b"}, "conclusions.table: "),
        (("text",), {}, "text: "),
        (("text",), {"toy.yaml": 3}, "text.toy.yaml: "),
        (("tolerance",), "little", "tolerance: "),
        (("tolerance",), -1e-9, "tolerance: "),
        (("tolerance",), float("nan"), "tolerance: "),
    ],
)
def test_what_has_another_form_is_named(
    frozen: Frozen, place: tuple[str, ...], value: Any, said: str
) -> None:
    data: Any = deepcopy(dict(frozen[1].data))
    assert misfit(data) == ""
    at = data
    for key in place[:-1]:
        at = at[key]
    at[place[-1]] = value
    assert misfit(data).startswith(said)


@pytest.mark.parametrize("data", [None, 3, [], "text"])
def test_what_is_no_mapping_has_no_form(data: Any) -> None:
    assert misfit(data) == "all of it: input should be a valid dictionary"
