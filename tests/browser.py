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
_KEY_CODES = {"Tab": 9, "Enter": 13, "Escape": 27}  # with which keys do what a browser does
# Chromium reads commands from file 3 and answers into file 4
_WITH_PIPES = (
    "import os, sys; os.dup2(int(sys.argv[1]), 3); os.dup2(int(sys.argv[2]), 4); "
    "os.execv(sys.argv[3], sys.argv[3:])"
)


class Tab:
    """A page: evaluates in it, presses keys, moves the mouse, and keeps what its console prints."""

    def __init__(self, commands: int, answers: int) -> None:
        self.console: list[str] = []
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
        command = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            command["sessionId"] = self._session
        os.write(self._commands, json.dumps(command).encode() + b"\0")
        while True:
            message = self._next()
            if message.get("id") == self._number:
                assert "error" not in message, message["error"]
                result: dict[str, Any] = message["result"]
                return result
            self._listen(message)

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
        media = [{"name": k.replace("_", "-"), "value": v} for k, v in features.items()]
        self.send("Emulation.setEmulatedMedia", features=media)

    def value(self, expression: str) -> Any:
        """Evaluate in the page; a promise is awaited."""
        answer = self.send(
            "Runtime.evaluate",
            **{"expression": expression, "awaitPromise": True, "returnByValue": True},
        )
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def press(self, key: str, *, shift: bool = False) -> None:
        """Press a key and let it go."""
        text = {"text": "\r"} if key == "Enter" else {"text": key} if len(key) == 1 else {}
        code = {"windowsVirtualKeyCode": _KEY_CODES[key]} if key in _KEY_CODES else {}
        event = {"key": key, "modifiers": 8 * shift, **code}
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
            points = [{"x": x + right, "y": y + down} for right, down in fingers]
            self.send("Input.dispatchTouchEvent", type=kind, touchPoints=points)
        self.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def mouse(self, kind: str, x: float, y: float) -> None:
        """Send the page an event of the mouse, such as ``mouseMoved``."""
        self.send(
            "Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1
        )

    def middle(self, selector: str) -> tuple[float, float]:
        """Scroll to an element; return the pixel in its middle."""
        box: Mapping[str, float] = self.value(_BOX % json.dumps(selector))
        return box["x"], box["y"]

    def picture(self, file: Path, *, whole: bool = False) -> None:
        """Save what is seen, or the whole page, as PNG."""
        answer = self.send("Page.captureScreenshot", captureBeyondViewport=whole)
        file.write_bytes(base64.b64decode(answer["data"]))

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._rest:
            ready, _, _ = select([self._answers], [], [], _PATIENCE)
            read = os.read(self._answers, 1 << 16) if ready else b""
            assert read, "the browser has ended, or hangs"
            self._rest += read
        message, _, self._rest = self._rest.partition(b"\0")
        decoded: dict[str, Any] = json.loads(message)
        return decoded

    def _listen(self, message: Mapping[str, Any]) -> None:
        if message.get("method") == "Runtime.exceptionThrown":
            self.console.append(str(message["params"]["exceptionDetails"]))
        elif message.get("method") == "Runtime.consoleAPICalled":
            self.console.append(str(message["params"]["args"]))
        elif message.get("method") == "Log.entryAdded":
            self.console.append(message["params"]["entry"]["text"])


_LOADED = """
new Promise((resolve) => {
  const look = () => {
    const figures = [...document.querySelectorAll("figure.playback")];
    const ready = (figure) => figure.playback || /cannot/.test(figure.textContent);
    if (document.readyState === "complete" && figures.every(ready)) resolve(true);
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
def open_tab(folder: Path) -> Iterator[Tab]:
    """Start a browser whose profile lies in a folder, and end it afterwards."""
    commands, answers = os.pipe(), os.pipe()
    chromium = [str(BROWSER), *_QUIET, f"--user-data-dir={folder}", "--remote-debugging-pipe"]
    command = [sys.executable, "-c", _WITH_PIPES, str(commands[0]), str(answers[1]), *chromium]
    with subprocess.Popen(
        command, pass_fds=(commands[0], answers[1]), stderr=subprocess.DEVNULL
    ) as process:
        os.close(commands[0])
        os.close(answers[1])
        try:
            tab = Tab(commands[1], answers[0])
            yield tab
            tab._session = ""
            tab.send("Browser.close")
        finally:
            for pipe in (commands[1], answers[0]):
                os.close(pipe)
            process.terminate()
