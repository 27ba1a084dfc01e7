"""A playback in the report, as a page of its own beside it, and as the view of files.

The player is written here, in plain JavaScript on 2D canvases, and needs no library: dots, lines
and one shaded mesh are all there is to draw. Each file in ``web`` is a module of the page, and its
first lines say what it is for.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from html import escape
from importlib.resources import files

from nodegraph import Rendered, standalone_page
from nodegraph_mocap.playback import Panel, Playback
from nodegraph_mocap.recording import Origin, Trajectories

_ORIGINS = (Origin.MEASURED, Origin.FILLED, Origin.REPAIRED, Origin.MISSING)
_SCRIPTS = (
    "data",
    "camera",
    "markers",
    "mesh",
    "rows",
    "curves",
    "marks",
    "strip",
    "spectrum",
    "hand",
    "controls",
    "gestures",
    "player",
)


def render_playback(playback: Playback, title: str) -> Rendered:
    """Return the player with its data, and the same as a page to be sent or shown alone.

    Every word that came from users is escaped, or lies in the packed data, from which the script
    takes it as text and never as markup.
    """
    contents = [_content(panel) for panel in playback.with_truth]
    notes = [*contents, *playback.notes, _rounding(playback)]
    where = "This playback runs in the report (report.html), with JavaScript."
    html = (
        _figure(playback, title, where)
        + f"<details><summary>What is played</summary><ul>{_tagged('li', notes)}</ul></details>"
        + _tagged("p", playback.notes)
    )
    rendered = replace(_rendered(html), kind="figure")
    alone = standalone_page(rendered, title or "Playback")
    return replace(rendered, files={".html": alone.encode()})


def render_view(playback: Playback, title: str) -> Rendered:
    """Return the player with its data and notes, for a page that itself says what is played."""
    figure = _figure(
        playback, title, "The playback is loading; it needs JavaScript.", "playback viewed"
    )
    notes = [*playback.notes, *[_rounding(playback)] * bool(playback.panels)]
    rendered = _rendered(f"{figure}{_tagged('p', notes)}")
    return replace(rendered, styles=(*rendered.styles, script_or_style("view.css")))


def _rendered(html: str) -> Rendered:
    return Rendered(html, scripts=_scripts(), styles=(script_or_style("player.css"),))


def _figure(playback: Playback, title: str, without: str, kinds: str = "playback") -> str:
    """Return the element that the script fills, and what it says without the script."""
    from nodegraph_mocap.player.data import packed

    data = base64.b64encode(packed(playback)).decode()
    return (
        f'<figure class="{kinds}" aria-label="{escape(title, quote=True)}">'
        f'<p class="unplayed">{without}</p><template>{data}</template></figure>'
    )


def _rounding(playback: Playback) -> str:
    from nodegraph_mocap.player.data import step_of

    return f"Positions are rounded to {step_of(playback.with_truth):g} mm."


def _tagged(tag: str, notes: Iterable[str]) -> str:
    quiet = ' class="quiet"' if tag == "p" else ""
    return "".join(f"<{tag}{quiet}>{escape(note)}</{tag}>" for note in notes)


def _content(panel: Panel) -> str:
    shown = panel.shown
    what = (
        f"{len(shown.markers)} markers"
        if isinstance(shown, Trajectories)
        else f"a head of {len(shown.head.vertices)} vertices, {len(shown.head.names)} morph targets"
    )
    name = panel.label or "without a label"
    origins = f"; samples: {_origins(shown)}" if isinstance(shown, Trajectories) else ""
    length = f"{shown.frames} frames at {shown.rate:g} Hz ({panel.seconds:.2f} s)"
    return f"{name}: {what}, {length}{origins}"


def _origins(recording: Trajectories) -> str:
    """Return the number of samples by origin: ``1,200 measured, 40 filled, 3 missing``."""
    counts = {origin: int((recording.origin == origin).sum()) for origin in _ORIGINS}
    return ", ".join(f"{count:,} {each.name.lower()}" for each, count in counts.items() if count)


@cache
def _scripts() -> tuple[str, ...]:
    return tuple(script_or_style(f"{name}.js") for name in _SCRIPTS)


def script_or_style(name: str, package: str = "nodegraph_mocap.player") -> str:
    """Return a file of the folder ``web`` of the player, or of another package."""
    return files(package).joinpath("web", name).read_text(encoding="utf-8")
