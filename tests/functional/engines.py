"""Firefox and WebKit as Debian packages them: Playwright drives only builds of its own.

Both take the commands of WebDriver: WebKit's driver over HTTP, Firefox by its Marionette protocol
(JSON with its length before it), since Debian has no geckodriver.
"""

import base64
import json
import os
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, Final

import httpx

from studyapp.rehearsal.server import free_port
from tests.functional.browsing import PATIENCE_MS

ELEMENT: Final = "element-6066-11e4-a52e-4f735466cecf"
"""Under which WebDriver names an element."""

PATIENCE: Final = PATIENCE_MS / 1000
PAUSE: Final = 0.1
PAINTED: Final = """
    const [done] = arguments;
    let frames = 0;
    requestAnimationFrame(function count() {
        frames += 1;
        if (frames < 10) { requestAnimationFrame(count); } else { done(null); }
    });
"""
"""Ends after ten frames: WebKit paints a window's new size some frames after the page knows it."""

MINI_BROWSER: Final = "/usr/lib/x86_64-linux-gnu/webkit2gtk-4.1/MiniBrowser"

PROGRAMS: Final = {"firefox": ("firefox-esr",), "webkit": ("WebKitWebDriver", "Xvfb", MINI_BROWSER)}
"""The programs that each engine needs."""


class Marionette:
    """A connection to Firefox."""

    def __init__(self, port: int) -> None:
        self._socket = _connected(port)
        self._file = self._socket.makefile("rb")
        self._receive()  # Firefox greets first.
        self._number = 0
        self.send("NewSession", {"capabilities": {"alwaysMatch": {}}})

    def send(self, command: str, parameters: dict[str, Any]) -> Any:
        """Send a command of WebDriver, by its name in Marionette, and return the answer."""
        self._number += 1
        sent = json.dumps([0, self._number, f"WebDriver:{command}", parameters]).encode()
        self._socket.sendall(b"%d:%s" % (len(sent), sent))
        _, number, error, result = self._receive()
        assert number == self._number
        assert error is None, error
        return result["value"] if set(result or {}) == {"value"} else result

    def close(self) -> None:
        """End the session."""
        self.send("DeleteSession", {})
        self._file.close()
        self._socket.close()

    def _receive(self) -> Any:
        length = b""
        while (digit := self._file.read(1)) != b":":
            assert digit, "Firefox has ended"
            length += digit
        return json.loads(self._file.read(int(length)))


class WebKitDriver:
    """A connection to WebKit's driver."""

    _PATHS: Final = {
        "Navigate": ("POST", "/url"),
        "ExecuteScript": ("POST", "/execute/sync"),
        "ExecuteAsyncScript": ("POST", "/execute/async"),
        "FindElement": ("POST", "/element"),
        "ElementClick": ("POST", "/element/{id}/click"),
        "ElementSendKeys": ("POST", "/element/{id}/value"),
        "TakeScreenshot": ("GET", "/screenshot"),
        "SetWindowRect": ("POST", "/window/rect"),
    }

    def __init__(self, port: int) -> None:
        _connected(port).close()
        self._client = httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=PATIENCE)
        options = {"binary": MINI_BROWSER, "args": ["--automation"]}
        asked = {"alwaysMatch": {"webkitgtk:browserOptions": options}}
        self._session = f"/session/{self._post('/session', {'capabilities': asked})['sessionId']}"

    def send(self, command: str, parameters: dict[str, Any]) -> Any:
        """Send a command of WebDriver, by its name in Marionette, and return the answer."""
        method, path = self._PATHS[command]
        address = self._session + path.format(id=parameters.get("id"))
        if method == "POST":
            return self._post(address, parameters)
        return _value(self._client.request(method, address))

    def close(self) -> None:
        """End the session."""
        self._client.delete(self._session)
        self._client.close()

    def _post(self, address: str, parameters: dict[str, Any]) -> Any:
        return _value(self._client.post(address, json=parameters))


def _value(answer: httpx.Response) -> Any:
    value = answer.json()["value"]
    assert answer.is_success, value
    return value


class Window:
    """One window of an engine."""

    def __init__(self, wire: Marionette | WebKitDriver) -> None:
        self._wire = wire

    def resize(self, width: int, height: int) -> None:
        """Give the window this size; neither engine draws a frame beside the page."""
        self._wire.send("SetWindowRect", {"width": width, "height": height})
        self.wait(f"innerWidth === {width}")

    def go(self, address: str) -> None:
        """Open a page."""
        self._wire.send("Navigate", {"url": address})

    def run(self, script: str) -> Any:
        """Run a script in the page, and return its result."""
        return self._wire.send("ExecuteScript", {"script": script, "args": []})

    def wait(self, condition: str) -> None:
        """Wait until an expression of the page is true."""
        until = time.monotonic() + PATIENCE
        while not self.run(f"return Boolean({condition})"):
            shown = self.run("return document.body?.innerText")
            assert time.monotonic() < until, f"not true: {condition}\n{shown}"
            time.sleep(PAUSE)

    def see(self, selector: str) -> None:
        """Wait until something is there and has a size."""
        self.wait(f"document.querySelector({json.dumps(selector)})?.getClientRects().length")

    def read(self, words: str) -> None:
        """Wait until the page's heading holds these words."""
        self.wait(f"document.querySelector('h1')?.innerText.includes({json.dumps(words)})")

    def click(self, selector: str) -> None:
        """Click in the middle of an element, as a person does."""
        self.see(selector)
        self._wire.send("ElementClick", {"id": self._find(selector)})

    def write(self, selector: str, text: str) -> None:
        """Type a text into a field."""
        self.see(selector)
        self._wire.send("ElementSendKeys", {"id": self._find(selector), "text": text})

    def photograph(self, name: str) -> None:
        """Save a screenshot if screenshots are requested."""
        if "SCREENSHOTS" in os.environ:
            self._wire.send("ExecuteAsyncScript", {"script": PAINTED, "args": []})
            picture = self._wire.send("TakeScreenshot", {"full": False})
            folder = Path(os.environ["SCREENSHOTS"])
            folder.mkdir(parents=True, exist_ok=True)
            (folder / f"{name}.png").write_bytes(base64.b64decode(picture))

    def _find(self, selector: str) -> str:
        element = self._wire.send("FindElement", {"using": "css selector", "value": selector})
        return str(element[ELEMENT])


def missing(engine: str) -> list[str]:
    """Return the programs of `engine` that are not installed."""
    return [program for program in PROGRAMS[engine] if shutil.which(program) is None]


@contextmanager
def window(engine: str, folder: Path) -> Iterator[Window]:
    """Give a window of a new browser with its profile in `folder`."""
    port = free_port()
    with ExitStack() as running:
        wire: Marionette | WebKitDriver
        if engine == "firefox":
            (folder / "user.js").write_text(f'user_pref("marionette.port", {port});\n')
            started = ["firefox-esr", "--headless", "--marionette", "--profile", str(folder)]
            _start(running, started, HOME=str(folder))
            wire = Marionette(port)
        else:
            reading, writing = os.pipe()
            screen = ["Xvfb", "-displayfd", str(writing), "-screen", "0", "1600x1200x24"]
            _start(running, screen, pass_fds=(writing,))
            os.close(writing)
            with os.fdopen(reading) as displays:
                display = f":{displays.readline().strip()}"
            driver = ["WebKitWebDriver", f"--port={port}"]
            _start(running, driver, DISPLAY=display, HOME=str(folder))
            wire = WebKitDriver(port)
        running.callback(wire.close)
        yield Window(wire)


def _start(
    running: ExitStack, command: list[str], *, pass_fds: tuple[int, ...] = (), **environment: str
) -> None:
    """Start a program that ends with `running`."""
    process = subprocess.Popen(
        command,
        env=os.environ | environment,
        pass_fds=pass_fds,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    running.callback(process.wait, PATIENCE)
    running.callback(process.terminate)


def _connected(port: int) -> socket.socket:
    """Return a connection to a program of this machine that may only just have been started."""
    until = time.monotonic() + PATIENCE
    while True:
        try:
            return socket.create_connection(("127.0.0.1", port), timeout=PATIENCE)
        except ConnectionRefusedError:
            assert time.monotonic() < until, f"nothing answers at port {port}"
            time.sleep(PAUSE)
