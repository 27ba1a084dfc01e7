"""A node that breaks a promise is caught, and the message names the fault."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import wraps
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import Field

import nodegraph_fill
import nodegraph_mocap
from nodegraph import Across, NodegraphError, Refusal, Tried, Truth, Unit, Value, hookimpl, node
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.testing import check_node
from nodegraph_mocap import Mask, Origin, Table, Trajectories

REGISTRY = Registry(
    loaded=[Plugin("mocap", nodegraph_mocap), Plugin("fill", nodegraph_fill)],
)


def check(function: Callable[..., Any], **more: Any) -> None:
    check_node(function, registry=REGISTRY, **more)


def faults_of(function: Callable[..., Any], **more: Any) -> str:
    with pytest.raises(AssertionError) as caught:
        check(function, **more)
    return str(caught.value)


@node("fill.hold")
def hold(
    recording: Trajectories, *, max_gap: Annotated[int, Field(ge=1), Unit("frames")] = 30
) -> Trajectories:
    """Repeat the last measured position over each gap.

    Parameters
    ----------
    max_gap
        Frames that a position is repeated at most.
    """
    positions = held(recording, max_gap)
    return recording.with_samples(positions, changed=~recording.present, origin=Origin.FILLED)


def held(recording: Trajectories, most: int = 30) -> NDArray[np.float64]:
    frame = np.arange(recording.frames)[:, None]
    last = np.maximum.accumulate(np.where(recording.present, frame, -1), axis=0)
    reach = ~recording.present & (last >= 0) & (frame - last <= most)
    positions = recording.positions.copy()
    where = np.nonzero(reach)
    positions[where] = recording.positions[last[where], where[1]]
    return positions


def filled(recording: Trajectories, positions: NDArray[np.float64]) -> Trajectories:
    return recording.with_samples(positions, changed=~recording.present, origin=Origin.FILLED)


def test_a_good_node_passes() -> None:
    check(hold)
    check(hold, settings={"max_gap": 2})


def test_what_is_no_node_is_named() -> None:
    assert "decorate it with @node" in faults_of(held)


def test_writing_into_the_arrays_of_an_input() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill in place."""
        recording.positions[~recording.present] = 0.0
        return recording

    text = faults_of(broken)
    assert "fill.broken does not keep its promises" in text
    assert "changes its inputs" in text
    assert "recording.positions.copy()" in text


def test_unlocking_an_input_and_writing() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill in place, whatever it takes."""
        recording.positions.flags.writeable = True
        recording.positions[...] += 1.0
        return recording

    text = faults_of(broken)
    assert "changes its inputs" in text
    assert "recording.positions[0, 0, 0]" in text


def test_adding_a_column_to_a_table_that_came_in() -> None:
    @node("score.broken")
    def broken(table: Table) -> Table:
        """Add a column."""
        table["rank"] = 1
        return table

    text = faults_of(broken)
    assert "changes its inputs" in text
    assert "table['rank']" in text


def test_changing_a_setting() -> None:
    @node("score.broken")
    def broken(table: Table, *, names: list[str]) -> Table:
        """Collect names.

        Parameters
        ----------
        names
            Columns.
        """
        names.append("rmse")
        return table

    assert "changes its inputs" in faults_of(broken, settings={"names": ["gap"]})


@pytest.mark.parametrize("draw", [np.random.normal, random.random], ids=["numpy", "python"])
def test_drawing_from_a_global_state(draw: Callable[[], float]) -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill with noise."""
        return filled(recording, held(recording) + draw() * ~recording.present[..., None])

    text = faults_of(broken)
    assert "global random state" in text
    assert "numpy.random.default_rng(seed)" in text


def test_the_global_states_are_left_as_they_were() -> None:
    random.seed(5)
    np.random.seed(5)  # noqa: NPY002
    expected = random.random(), np.random.random()  # noqa: NPY002
    random.seed(5)
    np.random.seed(5)  # noqa: NPY002
    check(hold)
    assert (random.random(), np.random.random()) == expected  # noqa: NPY002


def test_random_without_a_seed() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill with noise."""
        noise = np.random.default_rng().normal(size=recording.positions.shape)
        return filled(recording, held(recording) + noise * ~recording.present[..., None])

    text = faults_of(broken)
    assert "gives another answer when it is called again" in text
    assert "`seed: int = 0`" in text


def test_a_seed_that_is_not_used() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories, *, seed: int = 0) -> Trajectories:
        """Fill with noise.

        Parameters
        ----------
        seed
            Of the noise.
        """
        noise = np.random.default_rng().normal(size=recording.positions.shape)
        return filled(recording, held(recording) + noise * ~recording.present[..., None])

    assert "with the same seed" in faults_of(broken)


def test_a_seed_by_another_name() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories, *, random_state: int = 0) -> Trajectories:
        """Fill.

        Parameters
        ----------
        random_state
            Of nothing.
        """
        return filled(recording, held(recording))

    assert "'random_state' is randomness by another name: call it seed" in faults_of(broken)


def test_a_state_that_survives_the_call() -> None:
    calls = []

    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill, once."""
        calls.append(1)
        return filled(recording, held(recording, most=len(calls)))

    assert "keep no state" in faults_of(broken)


def test_another_type_than_the_annotation_says() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill."""
        return held(recording)  # type: ignore[return-value]

    text = faults_of(broken)
    assert "returned ndarray where its signature promises Trajectories" in text


class Cut(NamedTuple):
    gappy: Trajectories
    truth: Truth[Trajectories]
    hidden: Mask


def test_each_of_several_outputs_has_its_type() -> None:
    @node("cuts.broken")
    def broken(recording: Trajectories) -> Cut:
        """Hide nothing."""
        return Cut(recording, recording, np.zeros(3, bool))  # type: ignore[arg-type]

    assert "returned ndarray where its signature promises Mask (hidden)" in faults_of(broken)


def test_no_docstring() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        return filled(recording, held(recording))

    assert "has no docstring" in faults_of(broken)


def test_a_setting_without_a_word() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories, *, most: int = 3) -> Trajectories:
        """Fill."""
        return filled(recording, held(recording, most))

    text = faults_of(broken)
    assert "setting 'most' is not documented" in text
    assert "'Parameters'" in text


def test_a_default_beyond_its_own_bounds() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories, *, most: Annotated[int, Field(ge=1)] = 0) -> Trajectories:
        """Fill.

        Parameters
        ----------
        most
            Frames.
        """
        return filled(recording, held(recording, most))

    text = faults_of(broken)
    assert "setting 'most': the default 0 is not whole number >= 1" in text


def test_touching_measured_samples() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Smooth, which a fill must not."""
        return filled(recording, held(recording) + 1e-12)

    text = faults_of(broken)
    assert "Leave present samples bit for bit as they are" in text
    assert "frame 0, marker 'brow_left'" in text


def test_written_samples_without_a_mark() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill and say nothing."""
        return recording.with_samples(
            held(recording), changed=~recording.present, origin=Origin.MEASURED
        )

    text = faults_of(broken)
    assert "Mark each sample that is written as filled" in text
    assert "origin=Origin.FILLED" in text


def test_marks_on_samples_that_were_not_written() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Call everything filled."""
        everything = np.ones(recording.origin.shape, bool)
        return recording.with_samples(held(recording), changed=everything, origin=Origin.FILLED)

    assert "not written but marked anew" in faults_of(broken)


def test_a_place_that_the_method_has_by_heart() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Put what is missing into the origin."""
        return filled(recording, np.nan_to_num(recording.positions, nan=0.0))

    assert "Do with a recording that is shifted as a whole" in faults_of(broken)


def test_the_order_of_markers() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Copy the first marker that is there."""
        positions = recording.positions.copy()
        for frame in np.flatnonzero(recording.present.any(axis=1)):
            donor = recording.present[frame].argmax()
            positions[frame, ~recording.present[frame]] = positions[frame, donor]
        return filled(recording, positions)

    assert "Fill markers in another order alike" in faults_of(broken)


def test_a_fill_of_something_else() -> None:
    @node("fill.broken")
    def broken(table: Table) -> Table:
        """Return a table."""
        return table

    assert "name the recording `recording`" in faults_of(broken)


def test_an_error_that_is_neither_refusal_nor_value_error() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill, if somebody is there."""
        if not recording.present.any():
            raise TypeError("cannot sort None")
        return filled(recording, held(recording))

    text = faults_of(broken)
    assert "raises TypeError on odd data" in text
    assert "nodegraph.errors.Refusal" in text
    assert "on 'all missing': TypeError: cannot sort None (test_testing.py:" in text


@pytest.mark.parametrize("error", [Refusal, ValueError, NodegraphError])
def test_declining_some_specimens_is_no_fault(error: type[Exception]) -> None:
    @node("fill.complete")
    def complete(recording: Trajectories) -> Trajectories:
        """Fill takes that have a complete frame."""
        if not recording.present.all(axis=1).any():
            raise error("needs one complete frame")
        return filled(recording, held(recording))

    check(complete)


def test_declining_every_specimen_is_a_fault() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill nothing."""
        raise Refusal("needs two cameras")

    text = faults_of(broken)
    assert "declines every specimen" in text
    assert "Refusal: needs two cameras" in text


def test_a_signature_that_cannot_be_read() -> None:
    @node("copies.broken")
    def broken(**recordings: Trajectories) -> Trajectories:
        """Return one of them."""
        return recordings["recording"]

    assert "*recordings is neither a port nor a setting" in faults_of(broken)


def test_ports_are_arguments_by_position_too() -> None:
    def timed(function: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(function)
        def call(**inputs: Any) -> Any:
            return function(**inputs)

        return call

    @node("copies.broken")
    @timed
    def broken(recording: Trajectories) -> Trajectories:
        """Return the recording."""
        return recording

    text = faults_of(broken)
    assert "with its ports by position" in text
    assert "takes 0 positional arguments but 1 was given" in text


def test_all_faults_are_told_at_once_and_each_once() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories, *, most: int = 3) -> Trajectories:
        positions = held(recording, most) + 1.0
        return Trajectories(positions=positions, markers=recording.markers, rate=recording.rate)

    text = faults_of(broken)
    assert text.count("has no docstring") == 1
    assert text.count("is not documented") == 1
    assert text.count("Leave present samples") == 1
    assert text.count("Mark each sample") == 1
    assert "also on 'several markers missing at once'" in text


def test_a_setting_without_a_default_must_be_given() -> None:
    @node("markers.first")
    def first(recording: Trajectories, *, count: int) -> Trajectories:
        """Keep the first markers.

        Parameters
        ----------
        count
            How many.
        """
        return recording.keep(recording.markers[:count])

    assert "check_node(..., settings={'count': ...})" in faults_of(first)
    assert "there is no setting 'many'; there is count" in faults_of(
        first, settings={"many": 1, "count": 1}
    )
    check(first, settings={"count": 1})


@dataclass(frozen=True)
class Skull(Value):
    length: float


def test_a_type_without_specimens_must_be_given() -> None:
    @node("skulls.measure")
    def measure(skull: Skull, recording: Trajectories | None = None) -> Skull:
        """Return the skull."""
        return skull

    assert "no installed plugin ships a specimen of Skull" in faults_of(measure)
    assert "there is no port 'head'; there is skull, recording" in faults_of(
        measure, inputs={"head": 1}
    )
    check(measure, inputs={"skull": Skull(190.0)})


def test_an_optional_port_is_tried_open_and_fed() -> None:
    seen = []

    @node("scores.distance")
    def distance(recording: Trajectories, truth: Truth[Trajectories] | None = None) -> Table:
        """Return the distance to the truth."""
        from pandas import DataFrame

        seen.append(truth is None)
        return DataFrame({"mm": [0.0]})

    check(distance)
    assert {True, False} == set(seen)


def test_a_gathering_port_gets_several_values_and_one_that_is_absent() -> None:
    seen: list[Across[Trajectories]] = []

    @node("combine.first")
    def first(recordings: Across[Trajectories]) -> Trajectories:
        """Return the first."""
        seen.append(recordings)
        return recordings.values()[0]

    check(first)
    assert {len(one) for one in seen} == {2}
    assert all(one.absent[0].kind == "refused" for one in seen)


def test_a_family_is_held_to_the_contracts_of_every_plugin() -> None:
    class Plugged:
        @staticmethod
        @hookimpl
        def nodegraph_contracts() -> Any:
            def keeps_the_rate(tried: Tried) -> Any:
                """Keep the rate."""
                if tried.outputs["output"].rate != tried.inputs["recording"].rate:
                    yield f"{tried.outputs['output'].rate} Hz"

            return {"resample": [keeps_the_rate]}

    @node("resample.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Call it slower."""
        return replace(recording, rate=30.0)

    registry = Registry(loaded=[*REGISTRY.loaded, Plugin("rates", Plugged)])
    with pytest.raises(AssertionError, match=r"every resample\.\* node promises: Keep the rate"):
        check_node(broken, registry=registry)


def test_a_library_that_draws_while_it_is_imported_is_no_fault() -> None:
    imported: list[float] = []

    @node("fill.late")
    def late(x: float) -> float:
        """Import late."""
        if not imported:
            imported.append(random.random())
        return x

    check_node(late, inputs={"x": 1.0}, registry=Registry.of([]))
