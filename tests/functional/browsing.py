"""A real browser, and the real server it asks."""

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Locator, Page, Request, expect, sync_playwright

from studyapp.rehearsal.server import free_port
from tests.functional.page_checks import LAPTOP

HEADLESS_SHELL = Path("/usr/bin/chromium-headless-shell")
"""Chromium without its own windows and menus: pages take much less processor time."""
CHROMIUM = HEADLESS_SHELL if HEADLESS_SHELL.exists() else Path("/usr/bin/chromium")
PATIENCE_MS = 120_000
"""Longest wait for a page on a busy machine: waiting ends as soon as the page is done."""
expect.set_options(timeout=PATIENCE_MS)

ARGUMENTS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--autoplay-policy=document-user-activation-required",
)

SOFTWARE_GRAPHICS = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""Further arguments for pages that draw motion on a machine without a graphics card."""

IMPATIENT = (
    "const { timeout } = AbortSignal; AbortSignal.timeout = () => timeout.call(AbortSignal, 1000);"
)
"""A script by which a page gives up a dead connection after one second."""

IN_A_BROWSER = [
    pytest.mark.browser,
    pytest.mark.slow,
    pytest.mark.skipif(not CHROMIUM.exists(), reason="Chromium is not installed"),
]
"""Marks of a module whose tests need Chromium."""


@contextmanager
def commanded(command: str, folder: Path, *options: str) -> Iterator[tuple[str, str]]:
    """Run `motionjury serve` or `desk`; give the address, and the first owner's link it prints.

    An option may hold ``{port}``.
    """
    port = free_port()
    motionjury = str(Path(sys.executable).with_name("motionjury"))
    started = [motionjury, command, str(folder), "--port", str(port)]
    started += [option.format(port=port) for option in options]
    with subprocess.Popen(started, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        try:
            line = ""
            while "/research/join/" not in line:
                line = server.stdout.readline()
                assert line, "the server ended before it printed a link"
            (link,) = re.findall(r"http\S+/research/join/\S+", line)
            yield f"http://127.0.0.1:{port}", link
        finally:
            server.send_signal(signal.SIGTERM)
            try:
                server.wait(timeout=PATIENCE_MS / 1000)
            except subprocess.TimeoutExpired:
                server.kill()
                raise


@contextmanager
def serving(study: Path, *options: str) -> Iterator[str]:
    """Run `motionjury serve` for a study that has no owner yet; give the server's address."""
    with commanded("serve", study, *options) as (address, _link):
        yield address


@contextmanager
def launched(*arguments: str) -> Iterator[Browser]:
    """Give a separate browser, started with `arguments` in addition to the usual ones."""
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(
            executable_path=CHROMIUM, args=[*ARGUMENTS, *arguments]
        )
        yield chromium
        chromium.close()


@contextmanager
def watched_page(browser: Browser, address: str, *, refused: int = 0) -> Iterator[Page]:
    """Give an empty page that may send requests only to the study, and must log no error.

    Parameters
    ----------
    refused : int
        A status with which the server is to answer something; browsers complain about it.
    """
    context = browser.new_context(viewport=LAPTOP)
    context.set_default_timeout(PATIENCE_MS)
    opened = context.new_page()
    complaints: list[str] = []
    strangers: list[str] = []

    def look_at(request: Request) -> None:
        if not request.url.startswith(address):
            strangers.append(request.url)

    opened.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
    opened.on("pageerror", lambda error: complaints.append(str(error)))
    opened.on("request", look_at)
    yield opened
    # What a test answers in place of the server may still be under way.
    opened.unroute_all(behavior="ignoreErrors")
    context.close()
    assert strangers == []
    expected = ("ERR_INTERNET_DISCONNECTED", f"status of {refused} ")
    assert [c for c in complaints if not any(words in c for words in expected)] == []


def follow(link: Locator) -> None:
    """Press what leads to another page, and wait until all of that page is there."""
    with link.page.expect_navigation():
        link.click()


def press(page: Page, name: str) -> None:
    """Press the button `name`, which leads to another page."""
    follow(page.get_by_role("button", name=name, exact=True))


def wait_until(page: Page, condition: Callable[[], object]) -> None:
    """Wait for conditions that no locator covers: the pages forbid scripts that Playwright would
    wait with."""
    deadline = time.monotonic() + PATIENCE_MS / 1000
    while not condition():
        assert time.monotonic() < deadline
        page.wait_for_timeout(50)
