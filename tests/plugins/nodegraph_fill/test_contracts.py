"""What fills declare, and that what they declare of the ends of gaps is tested."""

from __future__ import annotations

import pytest

from nodegraph import node
from nodegraph.node.declaration import UNDECLARED
from nodegraph.node.decorator import node_of
from nodegraph.testing import check_node
from nodegraph_fill import nodegraph_nodes
from nodegraph_fill.muscle import muscle
from nodegraph_mocap import Trajectories


def test_every_fill_can_be_compared_on_equal_terms() -> None:
    for function in nodegraph_nodes():
        fill = node_of(function)
        assert fill is not None
        assert [port.name for port in fill.inputs] == ["recording"]
        assert not [setting.name for setting in fill.settings.values() if setting.required]
        assert fill.settings["ends"].default == "as_published"
        assert fill.settings["max_gap"].default is None
        assert fill.lookahead(fill.defaults) is not UNDECLARED
        assert fill.meets_ends({**fill.defaults, "ends": "met"}) is True


@pytest.mark.parametrize("ends", [True, False])
def test_a_jump_is_no_meeting_of_ends(ends: bool) -> None:
    @node("fill.jumping", lookahead=0, ends=ends)
    def jumping(recording: Trajectories) -> Trajectories:
        """Fill step by step, up to where the marker happens to come."""
        return muscle(recording)

    if not ends:
        check_node(jumping)
        return
    with pytest.raises(AssertionError, match="Meet the samples at both ends") as caught:
        check_node(jumping)
    assert "frames 20 to 27, marker 'cheek_left': jumps by" in str(caught.value)
