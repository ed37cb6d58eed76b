"""Simulated participants in a real browser: they press what people press and see videos play."""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Final

from motion.errors import InputError
from studyapp.rehearsal.forms import Form, FormFields
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.participant import Participant
from studyapp.rehearsal.visit import InterruptedRehearsal, Visit

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Locator, Playwright
    from playwright.sync_api import Page as Tab

ARGUMENTS: Final = ("--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync")
INSTALLED: Final = ("chromium", "chromium-browser", "google-chrome")
WINDOW: Final = {"width": 1366, "height": 768}
LOOKS_AGAIN: Final = 50
"""Milliseconds between two looks at a page."""

PATIENCE: Final = 60.0
"""Seconds that a page may take for anything but the videos themselves."""

REPLAYS: Final = 3
SEES_WITHIN: Final = 5.0
"""Seconds within which a page counts what was played."""

SEEN: Final = "#watched.complete"
"""What a page shows once enough of its videos was played."""

REMEDY: Final = (
    "Install both with: pip install 'motionjury[browser]' && playwright install chromium"
)


def require_browser() -> None:
    """Start a browser and close it again.

    Raises
    ------
    InputError
        If Playwright, or a browser for it, is missing; says what to install.
    """
    with _browser():
        pass


def by_browser(participant: Participant, server: str, is_back: bool) -> None:
    """Let `participant` take part in a browser of its own."""
    from playwright.sync_api import Error

    with _browser() as browser:
        tab = browser.new_page(base_url=server, viewport=WINDOW)  # type: ignore[arg-type]
        tab.set_default_timeout(1000 * PATIENCE)
        visit = _Window(stop=participant.stop, speed=participant.speed, tab=tab)
        tab.on("pageerror", lambda error: visit.complaints.append(str(error)))
        try:
            participant.go_through(visit, is_back=is_back)
        except Error as error:
            raise BrokenPageError(
                Page(tab.url, tab.content()),
                f"cannot be used in a browser ({' '.join(str(error).split()[:40])})",
            ) from error


@contextmanager
def _browser() -> Iterator[Browser]:
    try:
        from playwright.sync_api import Error, sync_playwright
    except ImportError:
        raise InputError("Playwright, which drives a browser, is missing", remedy=REMEDY) from None
    with sync_playwright() as playwright:
        try:
            browser = _launched(playwright)
        except Error as error:
            raise InputError(
                f"no browser could be started ({str(error).splitlines()[0]})", remedy=REMEDY
            ) from error
        try:
            yield browser
        finally:
            browser.close()


def _launched(playwright: Playwright) -> Browser:
    """Return the system's own Chromium where there is one, else Playwright's."""
    found = next(filter(None, map(shutil.which, INSTALLED)), None)
    return playwright.chromium.launch(executable_path=found, args=ARGUMENTS)


@dataclass(frozen=True, kw_only=True)
class _Window(Visit):
    """One participant's browser window.

    Attributes
    ----------
    tab : playwright.sync_api.Page
        What it shows.
    complaints : list of str
        What its scripts have failed with.
    """

    tab: Tab
    complaints: list[str] = field(default_factory=list)

    def open(self, address: str) -> Page:
        """Return the page at `address`, after redirects."""
        self.tab.goto(address)
        return self._page()

    def send(self, page: Page, form: Form, answers: FormFields) -> Page:
        """Fill in the form of `page`, press its button, and return the page that follows."""
        state = self._state()
        if page.asks:
            self._fill(self.tab.locator("#answers"), answers)
            self._wait("say that everything is done", lambda: self._has("#needed.complete"))
            button = self.tab.locator("#next")
        else:
            self._fill(self.tab.locator("main"), answers)
            button = self.tab.locator("main form[method=post] [type=submit]").first
        if self.clicks_twice:
            button.dblclick()
        else:
            button.click()
        self._wait("lead on", lambda: self._state() not in ("", state))
        if self.complaints:
            raise BrokenPageError(page, f"has a script that fails ({self.complaints[0]})")
        return self._page()

    def listen(self, page: Page) -> None:
        """Hear nothing: what is said is known."""

    def watch(self, page: Page) -> None:
        """Play each video to its end, and once more where a busy machine has left parts out."""
        self._play_all(page)
        self.rest(self.thinks)

    def _play_all(self, page: Page) -> None:
        buttons = self.tab.locator("main button.play")
        self._wait("show a button to play each video", lambda: _shown(buttons, len(page.players)))
        for number, player in enumerate(page.players):
            self._play(buttons.nth(number), number, player.duration)
        for _ in range(REPLAYS):
            deadline = time.monotonic() + SEES_WITHIN
            while time.monotonic() < deadline:
                if self._has(SEEN):
                    return
                self.tab.wait_for_timeout(LOOKS_AGAIN)
            for number, player in enumerate(page.players):
                self._play(
                    self.tab.locator("main button.replay").nth(number), number, player.duration
                )
        self._wait("see that its videos were played", lambda: self._has(SEEN))

    def _play(self, button: Locator, number: int, seconds: float) -> None:
        """Press a button that plays video `number`, and wait until it has ended."""
        video = f"document.querySelectorAll('main video')[{number}]"
        button.click()
        self._wait("start its video", partial(self.tab.evaluate, f"{video}.played.length > 0"))
        self.tab.wait_for_timeout(500 * seconds)
        self._wait(
            "play its video to the end", partial(self.tab.evaluate, f"{video}.ended"), seconds
        )

    def _fill(self, form: Locator, answers: FormFields) -> None:
        """Enter `answers` as a person does, the best of a ranking first."""

        def by_rank(item: tuple[str, Sequence[str]]) -> tuple[str, Sequence[str]]:
            name, values = item
            return name.rpartition(":")[0], values

        for name, values in sorted(answers.items(), key=by_rank):
            for value in values:
                self._enter(form, name, value)

    def _enter(self, form: Locator, name: str, value: str) -> None:
        named = f'[name="{name}"]'
        field = form.locator(named).first
        kind = field.evaluate("field => field.type")
        if kind in ("radio", "checkbox"):
            form.locator(f'label:has({named}[value="{value}"])').click()
        elif kind == "select-one" and field.is_visible():
            field.select_option(value)
        elif kind == "select-one":
            cards = form.locator(f"fieldset:has({named}) .card")
            cards.get_by_text(field.get_attribute("data-label") or "", exact=True).press(value)
        else:
            field.fill(value)
            field.blur()

    def _page(self) -> Page:
        self._wait("load", lambda: self._state() != "")
        return Page(self.tab.url, self.tab.content())

    def _state(self) -> str:
        """Return what tells one step of the way from the next; empty while a page is loading."""
        from playwright.sync_api import Error

        try:
            return str(
                self.tab.evaluate(
                    "document.readyState !== 'complete' ? '' : [document.title,"
                    " document.querySelector('h1')?.textContent,"
                    " document.querySelector('[name=trial]')?.value, location.pathname].join('|')"
                )
            )
        except Error:
            # The page was left while it was looked at.
            return ""

    def _has(self, selector: str) -> bool:
        return self.tab.locator(selector).count() > 0

    def _wait(self, what: str, happened: Callable[[], object], seconds: float = 0.0) -> None:
        deadline = time.monotonic() + seconds + PATIENCE
        while not happened():
            if self.stop.is_set():
                raise InterruptedRehearsal
            if time.monotonic() > deadline:
                page = Page(self.tab.url, self.tab.content())
                said = self.tab.locator("[role=alert]:visible").all_inner_texts()
                shown = f" (it says: {' '.join(said)})" if any(said) else ""
                raise BrokenPageError(page, f"does not {what} in a browser{shown}")
            self.tab.wait_for_timeout(LOOKS_AGAIN)


def _shown(buttons: Locator, count: int) -> bool:
    return buttons.count() >= count and buttons.first.is_visible()
