"""A page in headless Chromium, driven over the DevTools protocol on a pipe."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from select import select
from typing import Any

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
_QUIET = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update", "--hide-scrollbars"),
)
_PATIENCE = 120
# Chromium reads commands from file 3 and answers into file 4
_WITH_PIPES = (
    "import os, sys; os.dup2(int(sys.argv[1]), 3); os.dup2(int(sys.argv[2]), 4); "
    "os.execv(sys.argv[3], sys.argv[3:])"
)


class Tab:
    """One page: what is evaluated in it, pressed, dragged, and what its console says."""

    def __init__(self, commands: int, answers: int) -> None:
        self.said: list[str] = []
        self._commands, self._answers = commands, answers
        self._rest = b""
        self._number = 0
        self._session = ""
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        attached = self.send("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.send(f"{domain}.enable")

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command and return its answer."""
        self._number += 1
        asked = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            asked["sessionId"] = self._session
        os.write(self._commands, json.dumps(asked).encode() + b"\0")
        while True:
            told = self._next()
            if told.get("id") == self._number:
                assert "error" not in told, told["error"]
                result: dict[str, Any] = told["result"]
                return result
            self._listen(told)

    def show(
        self, file: Path, *, width: int = 1200, height: int = 900, touch: bool = False
    ) -> None:
        """Load a file in a window of that size, and wait until its playbacks are there."""
        self.size(width, height)
        if touch:
            self.send("Emulation.setTouchEmulationEnabled", enabled=True)
        self.send("Page.navigate", url=file.as_uri())
        self.value(_LOADED)

    def size(self, width: int, height: int) -> None:
        """Give the window another size, in pixels of the page."""
        self.send(
            "Emulation.setDeviceMetricsOverride",
            **{"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False},
        )

    def prefer(self, **features: str) -> None:
        """Set what a reader prefers: ``prefers_color_scheme="dark"``."""
        chosen = [{"name": k.replace("_", "-"), "value": v} for k, v in features.items()]
        self.send("Emulation.setEmulatedMedia", features=chosen)

    def value(self, expression: str) -> Any:
        """Evaluate in the page; a promise is awaited."""
        told = self.send(
            "Runtime.evaluate",
            **{"expression": expression, "awaitPromise": True, "returnByValue": True},
        )
        assert "exceptionDetails" not in told, told["exceptionDetails"]
        return told["result"].get("value")

    def press(self, key: str, *, shift: bool = False) -> None:
        """Press a key and let it go."""
        text = {"text": key} if len(key) == 1 else {}
        event = {"key": key, "modifiers": 8 * shift}
        self.send("Input.dispatchKeyEvent", type="keyDown", **event, **text)
        self.send("Input.dispatchKeyEvent", type="keyUp", **event)

    def click(self, selector: str) -> None:
        """Click on the middle of an element."""
        x, y = self.middle(selector)
        for kind in ("mousePressed", "mouseReleased"):
            self.mouse(kind, x, y)

    def drag(self, selector: str, right: float, down: float) -> None:
        """Press in the middle of an element, move by so many pixels, let go."""
        x, y = self.middle(selector)
        self.mouse("mousePressed", x, y)
        self.mouse("mouseMoved", x + right, y + down)
        self.mouse("mouseReleased", x + right, y + down)

    def swipe(self, selector: str, steps: Iterator[list[tuple[float, float]]]) -> None:
        """Touch an element with fingers at offsets from its middle, step by step."""
        x, y = self.middle(selector)
        for number, fingers in enumerate(steps):
            kind = "touchMove" if number else "touchStart"
            points = [{"x": x + one, "y": y + two} for one, two in fingers]
            self.send("Input.dispatchTouchEvent", type=kind, touchPoints=points)
        self.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def mouse(self, kind: str, x: float, y: float) -> None:
        """Tell the page that the mouse did something."""
        self.send(
            "Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1
        )

    def middle(self, selector: str) -> tuple[float, float]:
        """Scroll to an element; return the pixel in its middle."""
        box: Mapping[str, float] = self.value(_BOX % json.dumps(selector))
        return box["x"], box["y"]

    def picture(self, file: Path, *, whole: bool = False) -> None:
        """Save what is seen, or the whole page, as PNG."""
        told = self.send("Page.captureScreenshot", captureBeyondViewport=whole)
        file.write_bytes(base64.b64decode(told["data"]))

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._rest:
            ready, _, _ = select([self._answers], [], [], _PATIENCE)
            read = os.read(self._answers, 1 << 16) if ready else b""
            assert read, "the browser has ended, or hangs"
            self._rest += read
        message, _, self._rest = self._rest.partition(b"\0")
        told: dict[str, Any] = json.loads(message)
        return told

    def _listen(self, told: Mapping[str, Any]) -> None:
        if told.get("method") == "Runtime.exceptionThrown":
            self.said.append(str(told["params"]["exceptionDetails"]))
        elif told.get("method") == "Runtime.consoleAPICalled":
            self.said.append(str(told["params"]["args"]))
        elif told.get("method") == "Log.entryAdded":
            self.said.append(told["params"]["entry"]["text"])


_LOADED = """
new Promise((done) => {
  const look = () => {
    const all = [...document.querySelectorAll("figure.playback")];
    const ready = (one) => one.playback || /cannot/.test(one.textContent);
    if (document.readyState === "complete" && all.every(ready)) done(true);
    else setTimeout(look, 20);
  };
  look();
})
"""
_BOX = """
(() => {
  const element = document.querySelector(%s);
  element.scrollIntoView({ block: "center" });
  const box = element.getBoundingClientRect();
  return { x: box.x + box.width / 2, y: box.y + box.height / 2 };
})()
"""


@contextmanager
def opened(folder: Path) -> Iterator[Tab]:
    """Start a browser whose profile lies in a folder; end it afterwards."""
    commands, to_us = os.pipe(), os.pipe()
    chromium = [str(BROWSER), *_QUIET, f"--user-data-dir={folder}", "--remote-debugging-pipe"]
    wrapped = [sys.executable, "-c", _WITH_PIPES, str(commands[0]), str(to_us[1]), *chromium]
    with subprocess.Popen(
        wrapped, pass_fds=(commands[0], to_us[1]), stderr=subprocess.DEVNULL
    ) as process:
        os.close(commands[0])
        os.close(to_us[1])
        try:
            tab = Tab(commands[1], to_us[0])
            yield tab
            tab._session = ""
            tab.send("Browser.close")
        finally:
            for end in (commands[1], to_us[0]):
                os.close(end)
            process.terminate()
