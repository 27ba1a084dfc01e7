"""What families have in common is asked of each: other faces, other axes, other sizes."""

from __future__ import annotations

import types
from collections.abc import Callable, Iterable, Mapping
from typing import Annotated, Any

import numpy as np
import pytest

from nodegraph import Contract, Kind, Unit, hookimpl, node
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.testing import check_node
from nodegraph_mocap import Origin, Trajectories, contracts
from nodegraph_mocap.kinds import kinds

COMMON = (
    contracts.takes_and_gives_a_recording,
    contracts.moves_with_the_face,
    contracts.turns_with_the_face,
    contracts.scales_with_the_face,
    contracts.looks_ahead_as_declared,
    contracts.does_not_depend_on_the_order_of_markers,
)


def moved(recording: Trajectories, by: Any) -> Trajectories:
    there = recording.present
    positions = recording.positions + np.where(there[..., None], by, 0.0)
    return recording.with_samples(positions, changed=there, origin=Origin.REPAIRED)


def broken_promises(function: Callable[..., Trajectories]) -> str:
    with pytest.raises(AssertionError) as caught:
        check(function)
    return str(caught.value)


def check(function: Callable[..., Trajectories]) -> None:
    check_node(function, registry=registry())


def registry() -> Registry:
    """Nothing but specimens, and the common promises as those of a family."""
    module = types.ModuleType("common")

    @hookimpl
    def nodegraph_kinds() -> tuple[Kind, ...]:
        return kinds()

    @hookimpl
    def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:
        return {"toy": COMMON}

    module.nodegraph_kinds = nodegraph_kinds  # type: ignore[attr-defined]
    module.nodegraph_contracts = nodegraph_contracts  # type: ignore[attr-defined]
    result = Registry()
    result.loaded.append(Plugin("common", module))
    return result


def test_a_length_that_is_no_setting_is_found() -> None:
    @node("toy.constant")
    def constant(recording: Trajectories) -> Trajectories:
        """Push every sample away from the centre by a millimetre."""
        away = recording.positions - np.nanmean(recording.positions, axis=(0, 1))
        return moved(recording, away / np.linalg.norm(away, axis=2, keepdims=True))

    assert "settings in mm twice as large" in broken_promises(constant)


def test_as_a_setting_in_mm_it_is_none() -> None:
    @node("toy.setting")
    def setting(
        recording: Trajectories, *, size: Annotated[float, Unit("mm")] = 1.0
    ) -> Trajectories:
        """Push every sample away from the centre.

        Parameters
        ----------
        recording
            Any.
        size
            How far.
        """
        if not recording.present.any():
            return recording
        away = recording.positions - np.nanmean(recording.positions, axis=(0, 1))
        return moved(recording, size * away / np.linalg.norm(away, axis=2, keepdims=True))

    check(setting)


def test_one_axis_is_not_like_another_unless_it_is_stated() -> None:
    @node("toy.rounded")
    def rounded(recording: Trajectories) -> Trajectories:
        """Move each coordinate towards its mean, the largest deviations more."""
        return moved(recording, _towards(recording))

    @node("toy.honest")
    def honest(recording: Trajectories) -> Trajectories:
        """Move each coordinate towards its mean; it depends on the axes, of course."""
        return moved(recording, _towards(recording))

    assert 'or say "depends on the axes"' in broken_promises(rounded)
    check(honest)


def _towards(recording: Trajectories) -> object:
    """A share of each coordinate's deviation that grows with it, whatever the unit."""
    if not recording.present.any():
        return 0.0
    off = recording.positions - np.nanmean(recording.positions, axis=(0, 1))
    return -off * np.abs(off) / np.nanmax(np.linalg.norm(off, axis=2)) / 9.0


@pytest.mark.parametrize(("unit", "power"), [("mm", 1), ("mm^2", 2), ("mm/s", 1), ("frames", 0)])
def test_settings_are_scaled_by_their_unit(unit: str, power: int) -> None:
    seen: list[float] = []

    def watch(recording: Trajectories, *, size: float = 3.0) -> Trajectories:
        """Hand on.

        Parameters
        ----------
        recording
            Any.
        size
            Noted.
        """
        seen.append(size)
        return recording

    watch.__annotations__["size"] = Annotated[float, Unit(unit)]
    check(node("toy.seen")(watch))
    assert set(seen) == {3.0, 3.0 * 2.0**power}


def test_more_frames_ahead_than_are_declared_are_found() -> None:
    def later(recording: Trajectories, frames: int) -> Trajectories:
        return moved(recording, 0.1 * (recording.positions[-1] - recording.positions[0]) * frames)

    @node("toy.causal", lookahead=0)
    def causal(recording: Trajectories) -> Trajectories:
        """Move every sample by a share of how far the marker has come in the end."""
        return later(recording, 1)

    @node("toy.honest", lookahead=None)
    def honest(recording: Trajectories) -> Trajectories:
        """Move every sample by a share of how far the marker has come in the end."""
        return later(recording, 1)

    assert "declare a look-ahead of more than 0, or None" in broken_promises(causal)
    check(honest)
