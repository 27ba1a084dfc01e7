"""What families have in common exempts what is stated: settings, the axes, the look-ahead."""

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


def test_a_length_may_be_a_setting_in_mm() -> None:
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


def test_one_axis_need_not_be_like_another_where_that_is_stated() -> None:
    @node("toy.honest")
    def honest(recording: Trajectories) -> Trajectories:
        """Move each coordinate towards its mean; it depends on the axes, of course."""
        return moved(recording, _towards(recording))

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


def test_who_declares_no_look_ahead_may_see_every_frame() -> None:
    @node("toy.honest", lookahead=None)
    def honest(recording: Trajectories) -> Trajectories:
        """Move every sample by a share of how far the marker has come in the end."""
        return moved(recording, 0.1 * (recording.positions[-1] - recording.positions[0]))

    check(honest)
