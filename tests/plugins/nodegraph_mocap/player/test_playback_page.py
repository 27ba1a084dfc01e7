from __future__ import annotations

import base64
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest

from nodegraph_mocap import Playback
from nodegraph_mocap.player import page
from nodegraph_mocap.player.data import packed
from nodegraph_mocap.player.live import view_of_animations, view_of_markers
from nodegraph_mocap.player.page import render_playback
from nodegraph_mocap.specimens import animations, recordings
from tests.plugins.nodegraph_mocap.player.test_played import panel

HOSTILE = "</template><script>alert(1)</script><img src=x onerror=alert(2)>\"'&amp;"


def playback() -> Playback:
    face = recordings()["gaps"]
    names = (HOSTILE, *face.markers[1:])
    named = replace(face, markers=names, marker_set=None)
    panels = (panel(named, HOSTILE), panel(animations()["complete"], "head"))
    return Playback(panels=panels, notes=(HOSTILE,))


class Tags(HTMLParser):
    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.open: list[str] = []
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_markup_of_users_stays_text() -> None:
    rendered = render_playback(playback(), HOSTILE)
    tags = set(Tags(rendered.html).tags)
    assert tags == {"figure", "template", "details", "summary", "ul", "li", "p"}
    alone = rendered.files[".html"].decode()
    assert "<script>alert" not in alone
    assert "<img" not in alone


def test_the_fragment_holds_the_packed_data_and_says_what_it_is() -> None:
    whole = playback()
    html = render_playback(whole, "faces").html
    data = re.search("<template>(.*)</template>", html)
    assert data is not None
    assert base64.b64decode(data[1]) == packed(whole)
    assert "head: a head of 10 vertices, 3 morph targets, 40 frames at 60 Hz (0.67 s)" in html
    missing = int((~recordings()["gaps"].present).sum())
    counts = f"samples: {400 - missing} measured, {missing} missing"
    assert f"10 markers, 40 frames at 60 Hz (0.67 s); {counts}" in html
    assert "Positions are rounded to 0.01 mm." in html


def test_all_of_the_player_comes_once_and_with_no_way_out() -> None:
    first, other = (render_playback(playback(), title) for title in ("one", "other"))
    assert first.scripts == other.scripts
    assert first.styles == other.styles
    folder = Path(page.__file__).with_name("web")
    sources = {source.read_text(encoding="utf-8") for source in folder.glob("*.js")}
    streamed = {
        script for view in (view_of_markers(), view_of_animations()) for script in view.scripts
    }
    assert sources == {*first.scripts, *streamed}
    for text in (*first.scripts, *first.styles):
        assert not re.search(r"https?:|url\(|@import|fetch\(|innerHTML|eval\(", text)


@pytest.mark.parametrize("title", ["", "faces k=3"])
def test_the_page_beside_the_report_is_whole(title: str) -> None:
    alone = render_playback(playback(), title).files[".html"].decode()
    assert alone.startswith("<!DOCTYPE html>")
    assert f"<title>{title or 'Playback'}</title>" in alone
    assert render_playback(playback(), title).html in alone
