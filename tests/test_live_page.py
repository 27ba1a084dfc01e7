"""``nodegraph live --open``: the page of the shipped study, while a test feeds the stream."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from http.client import HTTPConnection
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from playwright.sync_api import Page

from tests.browser import assert_all_can_read_it, drag, needs_axe, until
from tests.studies import ROOT

SOURCE = '''
import struct
import sys
from dataclasses import replace

from nodegraph import Frame, Kind, LiveView, get_node, hookimpl
from nodegraph_mocap import HeadMotion, MarkerFrame, Weights


class Fed:
    """Sends frames by their numbers, which are lines of standard input.

    x is a packet of garbage, ! a connection that is lost until the next line, ? a failure.
    """

    def __init__(self, address):
        self.take = get_node("read.recording")(path=address)
        self.is_lost = False

    def open(self):
        if self.is_lost:
            sys.stdin.readline()
        return replace(self.take, positions=self.take.positions[:0], origin=self.take.origin[:0])

    def packets(self):
        for line in sys.stdin:
            word = line.strip()
            if word == "?":
                raise RuntimeError("out of order")
            if word == "!":
                self.is_lost = True
                raise ConnectionResetError("gone")
            first, _, last = word.partition("-")
            for number in range(int(first), int(last or first) + 1) if word != "x" else ():
                yield struct.pack("<q", number)
            if word == "x":
                yield b"garbage"

    def frames(self, packet, arrived, header):
        if len(packet) != 8:
            raise ValueError("garbage")
        (number,) = struct.unpack("<q", packet)
        yield Frame(
            number, 0, arrived, MarkerFrame(self.take.positions[number], self.take.origin[number])
        )

    def close(self):
        pass


SCRIPT = """
nodegraph.define("fed/weights", [], () => ({ show: async (element, begun, labels) => ({
  draw: (frames) => { element.textContent = begun + labels + new Float64Array(frames[2]).length; },
  close: () => {},
}) }));
"""


@hookimpl
def nodegraph_kinds():
    view = LiveView(
        lambda values: [type(value).__name__ for value in values.values()],
        lambda weights: weights.tobytes(),
        "fed/weights",
        scripts=(SCRIPT,),
    )
    broken = LiveView(lambda values: 1 / 0, lambda pose: b"", "fed/weights")
    return [Kind(Weights, live_view=lambda: view), Kind(HeadMotion, live_view=lambda: broken)]


@hookimpl
def nodegraph_sources():
    return {"fed": Fed}
'''
FILLS = ["muscle", "guenter", "lin_ouhyoung", "linear"]
PICTURES = "[...document.querySelectorAll('.playback')].map((figure) => figure.playback.state)"
DRAWN = f"""({PICTURES}).every(({{ panels }}) =>
    panels.every(({{ dots }}) => dots.some(Number.isFinite)))"""
COUNTS = """Object.fromEntries([...document.querySelectorAll("[data-count]")]
  .map((row) => [row.dataset.count, Number(row.querySelector("td").textContent)]))"""
LINES = """[...document.querySelectorAll("svg.lines .line")]
  .map((line) => line.getAttribute("d").split("L").length)"""
STATE = "document.querySelector('.stream-state [role=status]').textContent"


class Fed:
    """The command at work, and what feeds it."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        assert process.stderr is not None
        self.address = next(line for line in process.stderr if line.startswith("http")).strip()

    def feed(self, *lines: str) -> None:
        """Have the source send this."""
        assert self.process.stdin is not None
        self.process.stdin.write("".join(f"{line}\n" for line in lines))
        self.process.stdin.flush()

    def end(self) -> dict[str, Any]:
        """End the page of a stream that has ended; return the counts that were printed."""
        self.process.send_signal(signal.SIGINT)
        out, _ = self.process.communicate()
        assert self.process.returncode == 0
        printed: dict[str, object] = json.loads(out)
        return printed


@contextmanager
def fed(folder: Path) -> Iterator[Fed]:
    """Start the command with a source that a test feeds."""
    plugin = folder / "fed.py"
    plugin.write_text(SOURCE)
    words = ("live", str(ROOT / "graphs" / "live.yaml"), "--source", "recording=fed:sample:face")
    with subprocess.Popen(
        [
            *(sys.executable, "-m", "nodegraph.cli.main", *words),
            *("--plugin", str(plugin), "--only", "trial=0", "--only", "delay=15_frames", "--open"),
            "--json",
        ],
        text=True,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:
        try:
            yield Fed(process)
        finally:
            process.kill()


def visit(tab: Page, address: str) -> None:
    """Open an address, which leads to the page."""
    tab.goto(address)
    tab.wait_for_selector(".stream-state")


def refusals(address: str) -> list[int]:
    """Return how a request without a cookie is answered, and one of a foreign name."""
    place = urlsplit(address)
    statuses = []
    for headers in ({}, {"Host": "example.com"}):
        connection = HTTPConnection(place.netloc)
        connection.request("GET", "/stream", headers=headers)
        statuses.append(connection.getresponse().status)
        connection.close()
    return statuses


def test_a_page_shows_a_stream_until_it_ends(tab: Page, tmp_path: Path) -> None:
    with fed(tmp_path) as stream:
        assert refusals(stream.address) == [403, 421]
        visit(tab, stream.address)
        until(tab, f"{STATE} === 'Waiting for frames'")
        stream.feed("0-119")
        until(tab, f"({COUNTS}).received === 120 && document.querySelectorAll('.stage').length > 1")
        heads, markers = tab.evaluate(PICTURES)
        heading = tab.locator("h2", has_text="animation").text_content()
        assert heading == "animation 17 frames behind"
        of_plugin = tab.locator(".stream-host", has_text="Weights,Weights")
        assert of_plugin.text_content() == "Weights," * 3 + f"Weights{','.join(FILLS)}26"
        assert [panel["label"] for panel in heads["panels"]] == FILLS
        assert [panel["label"] for panel in markers["panels"]] == ["capture", *FILLS]
        assert all(len(panel["dots"]) == 180 for panel in markers["panels"])

        stream.feed("120-299")
        until(tab, f"({COUNTS}).received === 300 && ({LINES}).every((points) => points > 1)")
        moved = tab.evaluate(PICTURES)
        for before, after in zip([heads, markers], moved, strict=True):
            assert before["panels"] != after["panels"]
        assert len(tab.evaluate(LINES)) == len(FILLS)
        names = tab.locator("svg.lines .name").all_text_contents()
        assert [name.split()[0] for name in names] == FILLS

        stream.feed("x", "300", "299", "305", "302")
        until(tab, f"({COUNTS}).late === 1")
        odd = {"missing": 4, "late": 1, "repeated": 1, "undecodable": 1}
        assert odd.items() <= tab.evaluate(COUNTS).items()

        stream.feed("!")
        until(tab, f"/is lost/.test({STATE})")
        stream.feed("", "400-449")
        until(tab, f"({COUNTS}).reconnected === 1 && ({COUNTS}).computed === 356")

        again = tab.context.new_page()  # gets the present state, whenever it comes
        visit(again, tab.url)
        until(again, f"({COUNTS}).computed === 356 && ({LINES}).every((points) => points > 1)")
        again.get_by_label("Output that is shown").select_option("tracks")
        until(again, "document.querySelectorAll('.stage').length > 1")
        until(again, f"({PICTURES})[1].panels.length === 2")

        assert stream.process.stdin is not None
        stream.process.stdin.close()
        stream.process.stdin = None
        for page in (tab, again):
            until(page, f"{STATE} === 'The stream has ended'")
        tab.reload()
        until(tab, f"({COUNTS}).computed === 356 && document.querySelectorAll('.stage').length > 1")
        shown = tab.evaluate(COUNTS)
        errors = tab.evaluate("""Object.fromEntries([...document.querySelectorAll("[data-step]")]
          .map((row) => [row.dataset.step, row.querySelector("td").textContent]))""")
        printed = stream.end()
        assert shown == {name: printed[name] for name in shown}
        assert errors == {step: f"{now['gaps']:g}" for step, now in printed["running"].items()}
        assert tab.evaluate(STATE) == "The stream has ended"


@needs_axe
def test_axe_finds_nothing_and_all_can_be_done_by_keys(tab: Page, tmp_path: Path) -> None:
    with fed(tmp_path) as stream:
        tab.emulate_media(reduced_motion="reduce")
        visit(tab, stream.address)
        stream.feed("0-99")
        until(tab, f"({COUNTS}).received === 100 && document.querySelectorAll('.stage').length > 1")
        until(tab, DRAWN)
        still = tab.evaluate(PICTURES)
        stream.feed("100-199")
        until(tab, f"({COUNTS}).received === 200")
        assert tab.evaluate(PICTURES) == still  # who wants little motion asks for it
        tab.focus("#pause")
        tab.keyboard.press("Enter")
        stream.feed("200-249")
        until(tab, f"JSON.stringify({PICTURES}) !== {json.dumps(json.dumps(still))}")
        front = tab.evaluate(PICTURES)
        tab.focus(".stage")
        tab.keyboard.press("Shift+ArrowLeft")
        turned = tab.evaluate(PICTURES)
        assert all(before != after for before, after in zip(front, turned, strict=True))
        drag(tab, ".stage canvas", 40, 0)
        assert tab.evaluate(PICTURES) != turned
        assert_all_can_read_it(tab)
        stream.feed("?")
        until(tab, f"/failed: .*out of order/.test({STATE})")
        _, errors = stream.process.communicate()
        assert stream.process.returncode == 2
        assert "still.head_motion is not shown: plugin 'fed'" in errors
