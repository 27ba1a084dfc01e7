"""Results as few words: how a step ended, and what it gave."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from nodegraph import node
from nodegraph.execute import Run
from nodegraph.lock.results import Kept, Results, cells_of

RunOf = Callable[..., Run]
PAIR = "nodes: {{a: {{use: read.number, with: {{start: {0}}}}}, b: {{use: strict.less, in: a}}}}"


@node("strict.less")
def less(x: float) -> float:
    return x - 0.999999 * x


@node("strict.draws")
def draws(x: float) -> float:
    return x + float(np.random.default_rng().normal())


def test_combinations_are_named_by_node_alternative_and_labels(frozen: tuple[Run, object]) -> None:
    names = [(one.group, one.at, one.name) for one in cells_of(frozen[0])]
    assert names[0] == ("a", "only", "a")
    assert ("fill=hold", "7", "fill(length=7, fill=hold)") in names


def test_a_reason_holds_no_place_of_this_machine(run_of: RunOf, tmp_path: Path) -> None:
    @node("strict.refuses")
    def refuses() -> float:
        from nodegraph import Refusal

        raise Refusal(f"{tmp_path}/deep/some.txt  is empty")

    run = run_of("nodes: {a: {use: strict.refuses}}", more=[refuses])
    assert Results(run).ended(0) == "refused: some.txt is empty"


def test_a_step_that_is_not_stored_is_asked_once(run_of: RunOf) -> None:
    text = (
        "nodes: {a: {use: read.number}, b: {use: strict.draws, in: a}, c: {use: fill.hold, in: b}}"
    )
    run = run_of(text, more=[draws])
    [cell] = [one for one in cells_of(run) if one.node == "b"]
    results = Results(run)
    digest = results.digest(cell.index)
    sketched = results.sketch(cell.index)
    assert sketched is not None
    again = Results(run)
    assert again.digest(cell.index) != digest  # each asks for itself
    assert results.digest(cell.index) == digest


def test_what_a_digest_stood_for_is_found_where_it_is_kept(run_of: RunOf, tmp_path: Path) -> None:
    store = tmp_path / "store"
    was, now = (run_of(PAIR.format(one), more=[less], store=store) for one in (2.0, 4.0))
    assert now.cache is not None
    kept = Kept(now.cache.store)
    digest = Results(was).digest(0)
    assert Results(now).beside(0, digest, kept) == {"output": (2.0, 4.0)}
    assert Results(now).beside(0, "0" * 10, kept) == {}
