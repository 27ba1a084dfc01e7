"""Results of a run: their digests, sketches and usual sizes."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from nodegraph import node
from nodegraph.execute import Run
from nodegraph.lock.results import Results, StoredValues, cells_of, scales

RunOf = Callable[..., Run]
PAIR = "nodes: {{a: {{use: read.number, with: {{start: {0}}}}}, b: {{use: strict.less, in: a}}}}"


@node("strict.less")
def less(x: float) -> float:
    return x - 0.999999 * x


@node("strict.draws")
def draws(x: float) -> float:
    return x + float(np.random.default_rng().normal())


def test_combinations_are_named_by_node_alternative_and_labels(frozen: tuple[Run, object]) -> None:
    names = [(cell.group, cell.at, cell.name) for cell in cells_of(frozen[0])]
    assert names[0] == ("a", "only", "a")
    assert ("fill=hold", "7", "fill(length=7, fill=hold)") in names


def test_a_reason_contains_no_path_of_this_machine(run_of: RunOf, tmp_path: Path) -> None:
    @node("strict.refuses")
    def refuses() -> float:
        from nodegraph import Refusal

        raise Refusal(f"{tmp_path}/deep/some.txt  is empty")

    run = run_of("nodes: {a: {use: strict.refuses}}", more=[refuses])
    assert Results(run).ending(0) == "refused: some.txt is empty"


def test_a_random_step_that_is_not_stored_runs_once(run_of: RunOf) -> None:
    text = (
        "nodes: {a: {use: read.number}, b: {use: strict.draws, in: a}, c: {use: fill.hold, in: b}}"
    )
    run = run_of(text, more=[draws])
    [cell] = [cell for cell in cells_of(run) if cell.node == "b"]
    results = Results(run)
    digest = results.digest(cell.index)
    assert results.sketch(cell.index) is not None
    assert Results(run).digest(cell.index) != digest  # computed again
    assert results.digest(cell.index) == digest


def test_stored_values_are_loaded_by_their_digest(run_of: RunOf, tmp_path: Path) -> None:
    store = tmp_path / "store"
    was, now = (run_of(PAIR.format(start), more=[less], store=store) for start in (2.0, 4.0))
    assert now.cache is not None
    stored = StoredValues(now.cache.store)
    digest = Results(was).digest(0)
    assert Results(now).value_pairs(0, digest, stored) == {"output": (2.0, 4.0)}
    assert Results(now).value_pairs(0, "0" * 10, stored) == {}


@node("strict.numbers")
def numbers(*, size: float = 1.0) -> np.ndarray:
    return np.full(2000, size)


def usual(run: Run) -> dict[str, dict[str, float]]:
    return scales(list(cells_of(run)), Results(run), run)


def test_values_below_the_rounding_of_their_inputs_have_its_size(
    run_of: RunOf,
) -> None:
    assert usual(run_of(PAIR.format(100.0), more=[less])) == {
        "a": {"output": 100.0},
        "b": {"output": 0.1},
    }


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1.5e308, sys.float_info.max])
def test_the_usual_size_of_the_largest_numbers_is_finite(run_of: RunOf, size: float) -> None:
    text = f"""
    axes: {{size: [{size!r}, {-0.9 * size!r}]}}
    nodes: {{a: {{use: strict.numbers, with: {{size: $size}}}}}}
    """
    median = usual(run_of(text, more=[numbers]))["a"]["output"]
    assert median == pytest.approx(0.95 * size, rel=1e-3)
