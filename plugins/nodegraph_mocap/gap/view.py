"""The view of one block of a comparison of recordings in a report."""

from __future__ import annotations

from nodegraph import Detail
from nodegraph_mocap.face_layout import layout
from nodegraph_mocap.gap.data import pack
from nodegraph_mocap.player.page import script_or_style

_SCRIPTS = ("packed", "curves", "closeup", "face", "gap")
_OF_PLAYER = ("camera", "markers", "gestures")


def detail() -> Detail:
    """Return how blocks are shown whose scores read recordings."""
    return Detail(
        pack,
        layout,
        module="mocap/gap",
        scripts=(
            *(script_or_style(f"{name}.js") for name in _OF_PLAYER),
            *(script_or_style(f"{name}.js", __package__) for name in _SCRIPTS),
        ),
        styles=(script_or_style("gap.css", __package__),),
    )
