"""Results of a run: their digests, sketches and usual sizes."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nodegraph import node
from nodegraph.execute.results import Run
from nodegraph.lock.results import Results
from nodegraph.runs.record import record
from nodegraph.runs.recorded_value import StoredValues

RunOf = Callable[..., Run]
PAIR = "nodes: {{a: {{use: read.number, with: {{start: {0}}}}}, b: {{use: strict.less, in: a}}}}"


@node("strict.less")
def less(x: float) -> float:
    return x - 0.999999 * x


@node("strict.draws")
def draws(x: float) -> float:
    return x + float(np.random.default_rng().normal())


def test_a_random_step_that_is_not_stored_runs_once(run_of: RunOf) -> None:
    text = (
        "nodes: {a: {use: read.number}, b: {use: strict.draws, in: a}, c: {use: fill.hold, in: b}}"
    )
    run = run_of(text, more=[draws])
    [index] = [step.index for step in run.plan.steps if step.node == "b"]
    results = Results(run)
    digests = results.digests(index)
    assert results.sketch(index) is not None
    assert Results(run).digests(index) != digests  # computed again
    assert results.digests(index) == digests


def test_stored_values_are_loaded_by_their_digest(run_of: RunOf, tmp_path: Path) -> None:
    store = tmp_path / "store"
    run = run_of(PAIR.format(2.0), more=[less], store=store)
    assert run.cache is not None
    step, other = record(run).steps
    values = StoredValues(run.cache.store)
    assert values.of(step) == (2.0,)
    locked = replace(step, key="", digests=[digest[:10] for digest in step.digests])
    assert values.of(locked) == (2.0,)
    assert values.of(replace(locked, digests=["0" * 10])) == ()
    assert values.of(replace(locked, use=other.use)) == ()
    assert values.of(replace(locked, digests=[""])) == ()


@node("strict.numbers")
def numbers(*, size: float = 1.0) -> np.ndarray:
    return np.full(2000, size)


def test_the_sketch_of_a_stored_value_is_that_of_the_value_though_it_is_damaged(
    run_of: RunOf, tmp_path: Path
) -> None:
    text, store = "nodes: {a: {use: strict.numbers}}", tmp_path / "store"
    whole = Results(run_of(text, more=[numbers])).sketch(0)
    run = run_of(text, more=[numbers], store=store)
    stored = Results(run).sketch(0)
    [blob] = (path for path in store.glob("*/blobs/**/*") if path.is_file())
    blob.write_bytes(b"damaged")
    damaged = Results(run).sketch(0)
    assert whole is not None
    assert stored is not None
    assert damaged is not None
    assert stored.text({}) == damaged.text({}) == whole.text({})


def usual(run: Run) -> dict[str, dict[str, float]]:
    return Results(run).usual_sizes(record(run).steps)


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
