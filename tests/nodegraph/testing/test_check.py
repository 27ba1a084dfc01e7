"""Deliberately broken nodes: the message names each fault, and a mended node passes."""

from __future__ import annotations

import os
import random
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import Field

import nodegraph_despike
import nodegraph_fill
import nodegraph_mocap
import nodegraph_score
import nodegraph_smooth
import nodegraph_tables
from nodegraph import (
    Across,
    Columns,
    Files,
    NodegraphError,
    Refusal,
    Tried,
    Truth,
    Unit,
    Value,
    hookimpl,
    node,
)
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.testing import check_node
from nodegraph_mocap import Figure, Mask, Origin, Table, Trajectories
from nodegraph_tables import TableInfo, with_info

Function = Callable[..., object]
Pair = tuple[Function, Function]
"""A broken node, and the mended one."""

PACKAGES = (
    nodegraph_despike,
    nodegraph_fill,
    nodegraph_mocap,
    nodegraph_score,
    nodegraph_smooth,
    nodegraph_tables,
)
REGISTRY = Registry(loaded=[Plugin(package.__name__, package) for package in PACKAGES])
PAIRS: dict[str, tuple[Callable[[], Pair], tuple[str, ...]]] = {}


def fault(*words: str) -> Callable[[Callable[[], Pair]], None]:
    """Register a function that makes a pair, with words of the message about the broken node."""

    def register(make: Callable[[], Pair]) -> None:
        PAIRS[make.__name__] = make, words

    return register


def broken_fill(*words: str) -> Callable[[Function], None]:
    """Register a fill that is broken, with words of the message about it."""

    def register(function: Function) -> None:
        PAIRS[function.__name__] = lambda: (node("fill.broken")(function), sound), words

    return register


def check(function: Function, **more: Any) -> None:
    check_node(function, registry=REGISTRY, **more)


def faults_of(function: Function, **more: object) -> str:
    with pytest.raises(AssertionError) as caught:
        check(function, **more)
    return " ".join(str(caught.value).split())


@pytest.fixture(autouse=True)
def _in_new_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", PAIRS)
def test_the_fault_of_a_broken_node_is_named(name: str) -> None:
    make, words = PAIRS[name]
    text = faults_of(make()[0])
    assert not [word for word in words if word not in text], text


@pytest.mark.parametrize("name", PAIRS)
def test_the_mended_node_passes(name: str) -> None:
    make, _ = PAIRS[name]
    check(make()[1])


def means(recording: Trajectories) -> NDArray[np.float64]:
    """Return the recording, each missing sample at the mean of its marker's present ones."""
    where = recording.present[..., None]
    count = np.maximum(recording.present.sum(axis=0), 1)[:, None]
    mean = np.where(where, recording.positions, 0.0).sum(axis=0) / count
    mean[~recording.present.any(axis=0)] = np.nan
    return np.where(where, recording.positions, mean)


def filled(recording: Trajectories, positions: NDArray[np.float64]) -> Trajectories:
    return recording.with_samples(positions, changed=~recording.present, origin=Origin.FILLED)


@node("fill.sound")
def sound(recording: Trajectories) -> Trajectories:
    """Fill with the mean position."""
    return filled(recording, means(recording))


@node("smooth.sound")
def untouched(recording: Trajectories) -> Trajectories:
    """Smooth nothing."""
    return recording


@broken_fill("modifies its inputs", "copy before you write")
def mutates(recording: Trajectories) -> Trajectories:
    """Fill in place."""
    recording.positions[~recording.present] = 0.0
    return recording


@fault("draws from the global random state", "numpy.random.default_rng(seed)")
def draws_from_a_global_state() -> Pair:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill with noise."""
        noise = np.random.normal(size=recording.positions.shape)  # noqa: NPY002
        gaps = ~recording.present[..., None]
        return filled(recording, means(recording) + noise * gaps)

    @node("fiddle.mended")
    def mended(recording: Trajectories, *, seed: int = 0) -> Trajectories:
        """Fill with noise.

        Parameters
        ----------
        seed
            Of the noise.
        """
        noise = np.random.default_rng(seed).normal(size=recording.positions.shape)
        gaps = ~recording.present[..., None]
        return filled(recording, means(recording) + noise * gaps)

    return broken, mended


@broken_fill("returns another result when it is called again", "`seed: int = 0`")
def draws_without_a_seed(recording: Trajectories) -> Trajectories:
    """Fill with noise."""
    noise = np.random.default_rng().normal(size=recording.positions.shape)
    gaps = ~recording.present[..., None]
    return filled(recording, means(recording) + noise * gaps)


@broken_fill("returned ndarray where its signature promises Trajectories", "change the annotation")
def returns_another_type(recording: Trajectories) -> Trajectories:
    """Fill."""
    return means(recording)  # type: ignore[return-value]


@fault("output 'output' has columns that it does not declare", "Columns(...)", "samples")
def declares_other_columns() -> Pair:
    def counted(recording: Trajectories) -> Table:
        from pandas import DataFrame

        return DataFrame(
            {"marker": recording.markers, "samples": recording.present.sum(axis=0).astype(float)}
        )

    @node("fiddle.broken")
    def broken(recording: Trajectories) -> Annotated[Table, Columns("marker", "sample")]:
        """Count samples."""
        return counted(recording)

    @node("fiddle.mended")
    def mended(recording: Trajectories) -> Annotated[Table, Columns("marker", "samples", "more")]:
        """Count samples."""
        return counted(recording)

    return broken, mended


@broken_fill("Give positions in millimetres", "0.001 times as far from the origin", "in metres?")
def fills_in_metres(recording: Trajectories) -> Trajectories:
    """Fill, in metres."""
    metres = np.where(recording.present[..., None], 1.0, 1e-3) * means(recording)
    return filled(recording, metres)


@fault("setting 'limit' is in m: let it be in mm", "a face twice as large")
def has_a_setting_in_metres() -> Pair:
    def limited(recording: Trajectories, limit: float) -> Trajectories:
        positions = means(recording)
        still = np.linalg.norm(positions - positions.mean(axis=0), axis=2).max(axis=0) < limit
        return filled(recording, np.where(still[:, None], positions, recording.positions))

    @node("fill.broken")
    def broken(
        recording: Trajectories, *, limit: Annotated[float, Unit("m")] = 0.003
    ) -> Trajectories:
        """Fill markers that move little.

        Parameters
        ----------
        limit
            How far they move at most.
        """
        return limited(recording, 1000.0 * limit)

    @node("fill.mended")
    def mended(
        recording: Trajectories, *, limit: Annotated[float, Unit("mm")] = 3.0
    ) -> Trajectories:
        """Fill markers that move little.

        Parameters
        ----------
        limit
            How far they move at most.
        """
        return limited(recording, limit)

    return broken, mended


@fault("Do at twice the rate, settings in Hz and s changed with it")
def has_a_cutoff_per_frame() -> Pair:
    def averaged(recording: Trajectories, share: float) -> Trajectories:
        positions = recording.positions.copy()
        positions[1:-1] += share * (positions[2:] - 2 * positions[1:-1] + positions[:-2])
        positions = np.where(np.isnan(positions), recording.positions, positions)
        return replace(recording, positions=positions, sigma=None)

    @node("smooth.broken")
    def broken(
        recording: Trajectories, *, cutoff: Annotated[float, Unit("Hz")] = 0.1
    ) -> Trajectories:
        """Smooth, for which the cutoff is taken as one per frame.

        Parameters
        ----------
        cutoff
            Where it begins.
        """
        return averaged(recording, cutoff)

    @node("smooth.mended")
    def mended(
        recording: Trajectories, *, cutoff: Annotated[float, Unit("Hz")] = 6.0
    ) -> Trajectories:
        """Smooth.

        Parameters
        ----------
        cutoff
            Where it begins.
        """
        return averaged(recording, cutoff / recording.rate)

    return broken, mended


@fault("Score an estimate that is off by a millimetre", "column 'error' has 0.001 mm")
def scores_in_metres() -> Pair:
    def scored(estimate: Trajectories, truth: Trajectories, factor: float) -> Table:
        from pandas import DataFrame

        apart = np.linalg.norm(estimate.positions - truth.positions, axis=2)
        table = DataFrame({"error": factor * np.nan_to_num(apart).max(axis=1)})
        table = with_info(table, TableInfo(units={"error": "mm"}))
        return table

    @node("score.broken")
    def broken(estimate: Trajectories, truth: Truth[Trajectories]) -> Table:
        """Score in metres."""
        return scored(estimate, truth, 1e-3)

    @node("score.mended")
    def mended(estimate: Trajectories, truth: Truth[Trajectories]) -> Table:
        """Score."""
        return scored(estimate, truth, 1.0)

    return broken, mended


@broken_fill("Leave present samples bit for bit as they are", "write where ~recording.present only")
def touches_measured_samples(recording: Trajectories) -> Trajectories:
    """Fill, and smooth on the way."""
    return filled(recording, means(recording) * (1.0 + 1e-15))


@fault("frame 0, marker 'brow_left'", "lost: smooth each run of present samples by itself")
def adds_gaps() -> Pair:
    @node("smooth.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Smooth by the mean of three frames, where there are three."""
        positions = np.full_like(recording.positions, np.nan)
        three = recording.positions[:-2] + recording.positions[1:-1] + recording.positions[2:]
        positions[1:-1] = three / 3.0
        nobody = np.zeros(recording.origin.shape, dtype=bool)
        return recording.with_samples(positions, changed=nobody, origin=Origin.MEASURED)

    return broken, untouched


@fault("give a recording with the same markers first", "markers went in as", "rate went in as 60")
def changes_order_and_rate() -> Pair:
    @node("smooth.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Smooth, and sort."""
        return replace(recording.keep(sorted(recording.markers)), rate=120.0)

    return broken, untouched


@fault("returns an array that it keeps between calls", "build a new result in every call")
def returns_its_own_cache() -> Pair:
    known: dict[bytes, Trajectories] = {}

    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill, and remember."""
        key = recording.positions.tobytes()
        if key not in known:
            known[key] = filled(recording, means(recording))
        return known[key]

    return broken, sound


@fault("keep no state")
def learns_from_call_to_call() -> Pair:
    calls: list[int] = []

    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill, every time a bit further off."""
        calls.append(1)
        gaps = ~recording.present[..., None]
        return filled(recording, means(recording) + 0.1 * len(calls) * gaps)

    return broken, sound


@fault("prints: nobody reads that", "warnings.warn", "'filling")
def prints() -> Pair:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill and talk."""
        print("filling", recording.frames)
        return filled(recording, means(recording))

    @node("fill.mended")
    def mended(recording: Trajectories) -> Trajectories:
        """Fill and warn."""
        warnings.warn(f"filling {recording.frames}", stacklevel=2)
        return filled(recording, means(recording))

    return broken, mended


CHANGES: dict[str, tuple[Callable[[], object], str, str]] = {
    "errors": (lambda: np.seterr(all="ignore"), "numpy's treatment of errors", "numpy.errstate"),
    "digits": (
        lambda: np.set_printoptions(precision=3),
        "numpy's print options",
        "numpy.printoptions",
    ),
    "warnings": (
        lambda: warnings.simplefilter("ignore"),
        "the filters of warnings",
        "warnings.catch_warnings()",
    ),
    "environment": (
        lambda: os.environ.update(OMP_NUM_THREADS="3"),
        "os.environ",
        "as an argument",
    ),
    "folder": (lambda: os.chdir(os.sep), "the working directory", "use whole paths"),
    "path": (lambda: sys.path.append("nowhere"), "sys.path", "installed packages"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_shared_state_must_not_change(change: str) -> None:
    act, what, instead = CHANGES[change]

    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill, and change shared state."""
        act()
        return filled(recording, means(recording))

    before = np.geterr(), np.get_printoptions(), dict(os.environ), Path.cwd(), list(sys.path)
    text = faults_of(broken)
    assert f"changes {what} for everything else in the process" in text
    assert instead in text
    after = np.geterr(), np.get_printoptions(), dict(os.environ), Path.cwd(), list(sys.path)
    assert before == after


def test_figures_and_settings_of_matplotlib() -> None:
    from matplotlib import pyplot

    @node("draw.broken")
    def broken(recording: Trajectories) -> Figure:
        """Draw."""
        pyplot.rcParams["lines.linewidth"] = 7.0
        return pyplot.figure(figsize=(1, 1))

    text = faults_of(broken)
    assert "changes matplotlib.rcParams for everything else" in text
    assert "leaves a figure open in pyplot" in text
    assert pyplot.rcParams["lines.linewidth"] != 7.0
    assert not pyplot.get_fignums()


@broken_fill("lets warnings of numpy out", "Mean of empty slice", "on 'a marker never seen'")
def lets_warnings_out(recording: Trajectories) -> Trajectories:
    """Fill with means, of nothing where there is nothing."""
    mean = np.nanmean(recording.positions, axis=0)
    return filled(recording, np.where(recording.present[..., None], recording.positions, mean))


@broken_fill("setting 'share' is not documented", "say under 'Parameters'")
def keeps_a_setting_to_itself(recording: Trajectories, *, share: float = 1.0) -> Trajectories:
    """Fill."""
    return filled(recording, means(recording))


@broken_fill("cannot be read as a node", "share has no annotation")
def has_a_setting_without_type(recording: Trajectories, *, share=1.0) -> Trajectories:  # type: ignore  # noqa: ANN001
    """Fill."""
    return filled(recording, means(recording))


@broken_fill(
    "setting 'most': the default 0 is not whole number >= 1", "change the value or the type"
)
def has_a_default_out_of_bounds(
    recording: Trajectories, *, most: Annotated[int, Field(ge=1)] = 0
) -> Trajectories:
    """Fill.

    Parameters
    ----------
    most
        Frames.
    """
    return filled(recording, means(recording))


@fault("cites 'nobody1999', which its plugin does not ship", "nodegraph_bibtex")
def cites_what_is_not_shipped() -> Pair:
    @node("fill.broken", cite="nobody1999")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill."""
        return filled(recording, means(recording))

    @node("fill.mended", cite="guenter1998")
    def mended(recording: Trajectories) -> Trajectories:
        """Fill."""
        return filled(recording, means(recording))

    return broken, mended


@broken_fill("Fill markers in another order alike", "differ, by up to")
def depends_on_the_order_of_markers(recording: Trajectories) -> Trajectories:
    """Fill with the first marker that is there, moved to the gap's mean."""
    first = np.nan_to_num(recording.positions[:, :1] - means(recording)[:, :1].mean(axis=0))
    gaps = ~recording.present[..., None]
    return filled(recording, means(recording) + gaps * first)


@fault("writes files itself", "nodegraph.Files", "filled.csv")
def writes_files() -> Pair:
    @node("export.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Write what is there."""
        Path("filled.csv").write_text("x")
        return recording

    @node("export.mended")
    def mended(recording: Trajectories) -> Files:
        """Give what is there."""
        return Files({"filled.csv": b"x"})

    return broken, mended


@fault("makes numbers that are infinite", "divides by zero", "on 'one frame'")
def divides_by_zero() -> Pair:
    @node("stretch.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Stretch."""
        with np.errstate(divide="ignore"):
            stretched = recording.positions * (1.0 + 1.0 / np.float64(recording.frames - 1))
        return replace(recording, positions=stretched)

    @node("stretch.mended")
    def mended(recording: Trajectories) -> Trajectories:
        """Stretch."""
        if recording.frames < 2:
            raise Refusal("needs two frames")
        return replace(recording, positions=recording.positions * recording.frames)

    return broken, mended


@fault("makes infinite numbers out of finite ones", "output['ratio'][0]")
def tells_infinity() -> Pair:
    def ratio(recording: Trajectories, least: float) -> Table:
        from pandas import DataFrame

        with np.errstate(divide="ignore"):
            return DataFrame({"ratio": [1.0 / np.float64(max(recording.frames - 1, least))]})

    @node("rate.broken")
    def broken(recording: Trajectories) -> Table:
        """Divide."""
        return ratio(recording, 0.0)

    @node("rate.mended")
    def mended(recording: Trajectories) -> Table:
        """Divide by something."""
        return ratio(recording, 1.0)

    return broken, mended


@broken_fill("written but not marked", "origin=Origin.FILLED")
def does_not_mark_what_it_fills(recording: Trajectories) -> Trajectories:
    """Fill and say nothing."""
    return recording.with_samples(
        means(recording), changed=~recording.present, origin=Origin.MEASURED
    )


@fault("raises IndexError on odd data", "nodegraph.Refusal", "on 'one frame'")
def fails_on_one_frame() -> Pair:
    def second_frame(recording: Trajectories) -> Trajectories:
        recording.positions[1]
        return filled(recording, means(recording))

    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill two frames and more."""
        return second_frame(recording)

    @node("fill.mended")
    def mended(recording: Trajectories) -> Trajectories:
        """Fill two frames and more."""
        if recording.frames < 2:
            raise Refusal("needs two frames")
        return second_frame(recording)

    return broken, mended


@fault("lets an error of a library, or of Python, out", "zero-size array to reduction operation")
def fails_when_all_is_missing() -> Pair:
    def highest(recording: Trajectories) -> Trajectories:
        np.maximum.reduce(recording.positions[recording.present])
        return filled(recording, means(recording))

    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill below the highest sample."""
        return highest(recording)

    @node("fill.mended")
    def mended(recording: Trajectories) -> Trajectories:
        """Fill below the highest sample."""
        if not recording.present.any():
            raise ValueError("every sample is missing; there must be one")
        return highest(recording)

    return broken, mended


@fault("lets an error of numpy out", "LinAlgError: Singular matrix")
def fails_without_a_gap() -> Pair:
    def solved(recording: Trajectories, least: int) -> Trajectories:
        gaps = int(np.count_nonzero(~recording.present))
        np.linalg.inv(np.eye(2) * max(gaps, least))
        return filled(recording, means(recording))

    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill what there is to fill."""
        return solved(recording, 0)

    @node("fill.mended")
    def mended(recording: Trajectories) -> Trajectories:
        """Fill what there is to fill, if anything."""
        return solved(recording, 1)

    return broken, mended


@broken_fill("raises SystemExit on odd data", "enough")
def exits(recording: Trajectories) -> Trajectories:
    """Fill, then leave."""
    sys.exit("enough")


def test_a_citation_is_looked_for_in_the_plugin_of_the_node() -> None:
    @node("fill.cites", cite=("mine2026", "guenter1998"))
    def cites(recording: Trajectories) -> Trajectories:
        """Fill."""
        return filled(recording, means(recording))

    class Mine:
        @staticmethod
        @hookimpl
        def nodegraph_bibtex() -> str:
            return "@misc{mine2026, author = {Me, A.}, title = {Mine}, year = {2026}}"

    registry = Registry.of([cites], plugin="mine")
    registry.loaded.extend([*REGISTRY.loaded, Plugin("mine", Mine)])
    with pytest.raises(AssertionError) as caught:
        check_node(cites, registry=registry)
    assert "cites 'guenter1998', which its plugin does not ship" in str(caught.value)
    assert "mine2026" not in str(caught.value).replace("there is: mine2026", "")


def test_what_a_library_does_once_while_it_is_imported_is_no_fault() -> None:
    calls: list[bool] = []

    @node("fill.late")
    def late(recording: Trajectories) -> Trajectories:
        """Import late."""
        if not calls:
            calls.append(True)
            print("building a cache")
            Path("cache").write_text("built")
            os.environ["A_LIBRARY"] = "here"
        return filled(recording, means(recording))

    check(late)


def test_a_file_that_a_library_needs_for_a_moment_is_no_fault(tmp_path: Path) -> None:
    @node("fill.through_a_file")
    def through(recording: Trajectories) -> Trajectories:
        """Fill by way of a file."""
        path = tmp_path / "moment"
        path.write_bytes(b"x")
        path.unlink()
        return filled(recording, means(recording))

    check(through)


def test_a_constant_that_inputs_share_is_no_cache() -> None:
    def parts(recording: Trajectories) -> Iterator[Any]:
        yield recording.positions
        yield recording.origin

    @node("hand.on")
    def on(recording: Trajectories) -> Trajectories:
        """Hand on parts of what came in."""
        positions, origin = parts(recording)
        return replace(recording, positions=positions, origin=origin)

    check(on)


def test_a_plain_function_is_not_a_node() -> None:
    assert "decorate it with @node" in faults_of(means)


def test_unlocking_an_input_and_writing() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill in place, whatever it takes."""
        recording.positions.flags.writeable = True
        recording.positions[...] += 1.0
        return recording

    text = faults_of(broken)
    assert "modifies its inputs" in text
    assert "recording.positions[0, 0, 0]" in text


def test_adding_a_column_to_a_table_that_came_in() -> None:
    @node("score.broken")
    def broken(table: Table) -> Table:
        """Add a column."""
        table["rank"] = 1
        return table

    text = faults_of(broken)
    assert "modifies its inputs" in text
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

    assert "modifies its inputs" in faults_of(broken, settings={"names": ["gap"]})


def test_the_global_states_are_left_as_they_were() -> None:
    random.seed(5)
    np.random.seed(5)  # noqa: NPY002
    expected = random.random(), np.random.random()  # noqa: NPY002
    random.seed(5)
    np.random.seed(5)  # noqa: NPY002
    check(sound)
    assert (random.random(), np.random.random()) == expected  # noqa: NPY002


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
        return filled(recording, means(recording) + noise * ~recording.present[..., None])

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
        return filled(recording, means(recording))

    assert "'random_state' is randomness by another name: call it seed" in faults_of(broken)


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
        return filled(recording, means(recording))

    assert "has no docstring" in faults_of(broken)


def test_marks_on_samples_that_were_not_written() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Call everything filled."""
        everything = np.ones(recording.origin.shape, bool)
        return recording.with_samples(means(recording), changed=everything, origin=Origin.FILLED)

    assert "not written but newly marked" in faults_of(broken)


def test_a_place_that_the_method_has_by_heart() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Put what is missing into the origin."""
        return filled(recording, np.nan_to_num(recording.positions, nan=0.0))

    assert "Do with a recording that is shifted as a whole" in faults_of(broken)


def test_a_fill_of_something_else() -> None:
    @node("fill.broken")
    def broken(table: Table) -> Table:
        """Return a table."""
        return table

    assert "name the recording `recording`" in faults_of(broken)


@pytest.mark.parametrize("error", [Refusal, ValueError, NodegraphError])
def test_declining_some_specimens_is_no_fault(error: type[Exception]) -> None:
    @node("fill.complete")
    def complete(recording: Trajectories) -> Trajectories:
        """Fill takes that have a complete frame."""
        if not recording.present.all(axis=1).any():
            raise error("needs one complete frame")
        return filled(recording, means(recording))

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
    def timed(function: Callable[..., object]) -> Callable[..., object]:
        @wraps(function)
        def call(**inputs: object) -> Any:
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


def test_all_faults_are_reported_at_once_and_each_once() -> None:
    @node("fill.broken")
    def broken(recording: Trajectories, *, most: int = 3) -> Trajectories:
        positions = means(recording) + 1.0
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
    assert {len(gathered) for gathered in seen} == {2}
    assert all(gathered.absent[0].kind == "refused" for gathered in seen)


def test_a_family_is_held_to_the_contracts_of_every_plugin() -> None:
    class Plugged:
        @staticmethod
        @hookimpl
        def nodegraph_contracts() -> object:
            def keeps_the_rate(tried: Tried) -> object:
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
