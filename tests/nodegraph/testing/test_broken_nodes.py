"""Deliberately broken nodes: each is told what is wrong with it, and passes once it is mended."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import Field

import nodegraph_despike
import nodegraph_fill
import nodegraph_mocap
import nodegraph_score
import nodegraph_smooth
from nodegraph import Columns, Refusal, Truth, Unit, hookimpl, node
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.testing import check_node
from nodegraph_mocap import Figure, Files, Origin, Table, Trajectories

Function = Callable[..., Any]
Pair = tuple[Function, Function, tuple[str, ...]]
"""A broken node, the mended one, and words that the message about the first holds."""

PACKAGES = (nodegraph_despike, nodegraph_fill, nodegraph_mocap, nodegraph_score, nodegraph_smooth)
REGISTRY = Registry(loaded=[Plugin(one.__name__, one) for one in PACKAGES])
PAIRS: dict[str, Callable[[], Pair]] = {}


def told(*words: str) -> Callable[[Callable[[], tuple[Function, Function]]], None]:
    """Add a broken node and the mended one, made anew for each test, to the pairs."""

    def add(make: Callable[[], tuple[Function, Function]]) -> None:
        PAIRS[make.__name__] = lambda: (*make(), words)

    return add


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", PAIRS)
def test_a_broken_node_is_told_what_is_wrong(name: str) -> None:
    broken, _, words = PAIRS[name]()
    with pytest.raises(AssertionError) as caught:
        check_node(broken, registry=REGISTRY)
    text = " ".join(str(caught.value).split())
    assert not [word for word in words if word not in text], text


@pytest.mark.parametrize("name", PAIRS)
def test_the_mended_node_passes(name: str) -> None:
    _, mended, _ = PAIRS[name]()
    check_node(mended, registry=REGISTRY)


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


@told("changes its inputs", "copy before you write")
def mutates() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill in place."""
        recording.positions[~recording.present] = 0.0
        return recording

    return broken, sound


@told("draws from the global random state", "numpy.random.default_rng(seed)")
def draws_from_a_global_state() -> tuple[Function, Function]:
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


@told("gives another answer when it is called again", "`seed: int = 0`")
def draws_without_a_seed() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill with noise."""
        noise = np.random.default_rng().normal(size=recording.positions.shape)
        gaps = ~recording.present[..., None]
        return filled(recording, means(recording) + noise * gaps)

    return broken, sound


@told("returned ndarray where its signature promises Trajectories", "change the annotation")
def returns_another_type() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill."""
        return means(recording)  # type: ignore[return-value]

    return broken, sound


@told("output 'output' has columns that it does not declare", "Columns(...)", "samples")
def declares_other_columns() -> tuple[Function, Function]:
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


@told("Give positions in millimetres", "0.001 times as far from the origin", "in metres?")
def fills_in_metres() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill, in metres."""
        metres = np.where(recording.present[..., None], 1.0, 1e-3) * means(recording)
        return filled(recording, metres)

    return broken, sound


@told("setting 'limit' is in m: let it be in mm", "a face twice as large")
def has_a_setting_in_metres() -> tuple[Function, Function]:
    def limited(recording: Trajectories, limit: float) -> Trajectories:
        made = means(recording)
        still = np.linalg.norm(made - made.mean(axis=0), axis=2).max(axis=0) < limit
        return filled(recording, np.where(still[:, None], made, recording.positions))

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


@told("Do at twice the rate, settings in Hz and s changed with it")
def has_a_cutoff_per_frame() -> tuple[Function, Function]:
    def averaged(recording: Trajectories, share: float) -> Trajectories:
        made = recording.positions.copy()
        made[1:-1] += share * (made[2:] - 2 * made[1:-1] + made[:-2])
        made = np.where(np.isnan(made), recording.positions, made)
        return replace(recording, positions=made, sigma=None)

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


@told("Score an estimate that is off by a millimetre", "column 'error' has 0.001 mm")
def scores_in_metres() -> tuple[Function, Function]:
    def scored(estimate: Trajectories, truth: Trajectories, factor: float) -> Table:
        from pandas import DataFrame

        apart = np.linalg.norm(estimate.positions - truth.positions, axis=2)
        table = DataFrame({"error": factor * np.nan_to_num(apart).max(axis=1)})
        table.attrs["units"] = {"error": "mm"}
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


@told("Leave present samples bit for bit as they are", "write where ~recording.present only")
def touches_measured_samples() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill, and smooth on the way."""
        return filled(recording, means(recording) * (1.0 + 1e-15))

    return broken, sound


@told("frame 0, marker 'brow_left'", "lost: smooth each run of present samples by itself")
def adds_gaps() -> tuple[Function, Function]:
    @node("smooth.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Smooth by the mean of three frames, where there are three."""
        made = np.full_like(recording.positions, np.nan)
        three = recording.positions[:-2] + recording.positions[1:-1] + recording.positions[2:]
        made[1:-1] = three / 3.0
        nobody = np.zeros(recording.origin.shape, dtype=bool)
        return recording.with_samples(made, changed=nobody, origin=Origin.MEASURED)

    return broken, untouched


@told("give a recording with the same markers first", "markers went in as", "rate went in as 60")
def changes_order_and_rate() -> tuple[Function, Function]:
    @node("smooth.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Smooth, and sort."""
        return replace(recording.keep(sorted(recording.markers)), rate=120.0)

    return broken, untouched


@told("returns what it keeps between calls", "make the answer anew in every call")
def returns_its_own_cache() -> tuple[Function, Function]:
    known: dict[bytes, Trajectories] = {}

    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill, and remember."""
        key = recording.positions.tobytes()
        if key not in known:
            known[key] = filled(recording, means(recording))
        return known[key]

    return broken, sound


@told("keep no state")
def learns_from_call_to_call() -> tuple[Function, Function]:
    calls: list[int] = []

    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill, every time a bit further off."""
        calls.append(1)
        gaps = ~recording.present[..., None]
        return filled(recording, means(recording) + 0.1 * len(calls) * gaps)

    return broken, sound


@told("prints: nobody reads that", "warnings.warn", "'filling")
def prints() -> tuple[Function, Function]:
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
        lambda: os.environ.update(OMP_NUM_THREADS="1"),
        "os.environ",
        "as an argument",
    ),
    "folder": (lambda: os.chdir(os.sep), "the working directory", "use whole paths"),
    "path": (lambda: sys.path.append("elsewhere"), "sys.path", "installed packages"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_what_is_everybodys_is_left_alone(change: str) -> None:
    act, what, instead = CHANGES[change]

    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill, and change what is everybody's."""
        act()
        return filled(recording, means(recording))

    before = np.geterr(), np.get_printoptions(), dict(os.environ), Path.cwd(), list(sys.path)
    with pytest.raises(AssertionError) as caught:
        check_node(broken, registry=REGISTRY)
    assert f"changes {what} for everybody else" in str(caught.value)
    assert instead in str(caught.value)
    after = np.geterr(), np.get_printoptions(), dict(os.environ), Path.cwd(), list(sys.path)
    assert before == after


def test_figures_and_settings_of_matplotlib() -> None:
    from matplotlib import pyplot

    @node("draw.broken")
    def broken(recording: Trajectories) -> Figure:
        """Draw."""
        pyplot.rcParams["lines.linewidth"] = 7.0
        return pyplot.figure(figsize=(1, 1))

    with pytest.raises(AssertionError) as caught:
        check_node(broken, registry=REGISTRY)
    assert "changes matplotlib.rcParams for everybody else" in str(caught.value)
    assert "leaves a figure open in pyplot" in str(caught.value)
    assert pyplot.rcParams["lines.linewidth"] != 7.0
    assert not pyplot.get_fignums()


@told("lets warnings of numpy out", "Mean of empty slice", "on 'a marker never seen'")
def lets_warnings_out() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill with means, of nothing where there is nothing."""
        mean = np.nanmean(recording.positions, axis=0)
        return filled(recording, np.where(recording.present[..., None], recording.positions, mean))

    return broken, sound


@told("setting 'share' is not documented", "say under 'Parameters'")
def keeps_a_setting_to_itself() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories, *, share: float = 1.0) -> Trajectories:
        """Fill."""
        return filled(recording, means(recording))

    return broken, sound


@told("cannot be read as a node", "share has no annotation")
def has_a_setting_without_type() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories, *, share=1.0) -> Trajectories:  # type: ignore  # noqa: ANN001
        """Fill."""
        return filled(recording, means(recording))

    return broken, sound


@told("setting 'most': the default 0 is not whole number >= 1", "change the value or the type")
def has_a_default_out_of_bounds() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories, *, most: Annotated[int, Field(ge=1)] = 0) -> Trajectories:
        """Fill.

        Parameters
        ----------
        most
            Frames.
        """
        return filled(recording, means(recording))

    return broken, sound


@told("cites 'nobody1999', which its plugin does not ship", "nodegraph_bibtex")
def cites_what_is_not_shipped() -> tuple[Function, Function]:
    @node("fill.broken", cite="nobody1999")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill."""
        return filled(recording, means(recording))

    @node("fill.mended", cite="guenter1998")
    def mended(recording: Trajectories) -> Trajectories:
        """Fill."""
        return filled(recording, means(recording))

    return broken, mended


@told("Fill markers in another order alike", "differ, by up to")
def depends_on_the_order_of_markers() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill with the first marker that is there, moved to the gap's mean."""
        first = np.nan_to_num(recording.positions[:, :1] - means(recording)[:, :1].mean(axis=0))
        gaps = ~recording.present[..., None]
        return filled(recording, means(recording) + gaps * first)

    return broken, sound


@told("writes files itself", "nodegraph.node.values.Files", "filled.csv")
def writes_files() -> tuple[Function, Function]:
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


@told("makes numbers that are infinite", "divides by zero", "on 'one frame'")
def divides_by_zero() -> tuple[Function, Function]:
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


@told("makes infinite numbers out of finite ones", "output['ratio'][0]")
def tells_infinity() -> tuple[Function, Function]:
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


@told("written but not marked", "origin=Origin.FILLED")
def does_not_mark_what_it_fills() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill and say nothing."""
        return recording.with_samples(
            means(recording), changed=~recording.present, origin=Origin.MEASURED
        )

    return broken, sound


@told("raises IndexError on odd data", "nodegraph.errors.Refusal", "on 'one frame'")
def fails_on_one_frame() -> tuple[Function, Function]:
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


@told("lets an error of a library, or of Python, out", "zero-size array to reduction operation")
def fails_when_all_is_missing() -> tuple[Function, Function]:
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


@told("lets an error of numpy out", "LinAlgError: Singular matrix")
def fails_without_a_gap() -> tuple[Function, Function]:
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


@told("raises SystemExit on odd data", "enough")
def exits() -> tuple[Function, Function]:
    @node("fill.broken")
    def broken(recording: Trajectories) -> Trajectories:
        """Fill, then leave."""
        sys.exit("enough")

    return broken, sound


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
    done: list[bool] = []

    @node("fill.late")
    def late(recording: Trajectories) -> Trajectories:
        """Import late."""
        if not done:
            done.append(True)
            print("building a cache")
            Path("cache").write_text("built")
            os.environ["A_LIBRARY"] = "here"
        return filled(recording, means(recording))

    check_node(late, registry=REGISTRY)


def test_a_file_that_a_library_needs_for_a_moment_is_no_fault(tmp_path: Path) -> None:
    @node("fill.through_a_file")
    def through(recording: Trajectories) -> Trajectories:
        """Fill by way of a file."""
        path = tmp_path / "moment"
        path.write_bytes(b"x")
        path.unlink()
        return filled(recording, means(recording))

    check_node(through, registry=REGISTRY)


def test_a_constant_that_inputs_share_is_no_cache() -> None:
    def parts(recording: Trajectories) -> Iterator[Any]:
        yield recording.positions
        yield recording.origin

    @node("hand.on")
    def on(recording: Trajectories) -> Trajectories:
        """Hand on parts of what came in."""
        positions, origin = parts(recording)
        return replace(recording, positions=positions, origin=origin)

    check_node(on, registry=REGISTRY)
