"""What a browser does for a simulated participant: open pages, play videos, send forms."""

from __future__ import annotations

import ssl
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from threading import Event
from typing import Final

import httpx

from studyapp.rehearsal.forms import Form, FormFields
from studyapp.rehearsal.pages import BrokenPageError, Page, Player

REQUEST_SECONDS: Final = 60.0


def study_client(server: str) -> httpx.Client:
    """Return a client for one participant of the server at address `server`.

    Every request opens a connection of its own. A server closes those that nobody has used for
    some seconds, as long as a participant may watch; a request on its way at that very moment
    would be lost, and only browsers send it again by themselves.
    """
    return httpx.Client(
        base_url=server,
        follow_redirects=True,
        timeout=REQUEST_SECONDS,
        limits=httpx.Limits(max_keepalive_connections=0),
        trust_env=False,
        # Certificates are not needed on the loopback, and loading them takes longer than a visit.
        verify=ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT),
        headers={"Accept": "text/html"},
    )


class Departure(Exception):  # noqa: N818 - it is no error
    """A participant has left.

    Attributes
    ----------
    returns : bool
        Whether to come back later.
    """

    def __init__(self, *, returns: bool) -> None:
        super().__init__()
        self.returns = returns


class InterruptedRehearsal(Exception):  # noqa: N818 - it is no error
    """The rehearsal is to stop; what was answered is kept."""


@dataclass(frozen=True, kw_only=True)
class Visit:
    """What stands for one browser window: its requests.

    Attributes
    ----------
    client : httpx.Client
        Follows redirects.
    stop : Event
        Set when the rehearsal is to stop.
    speed : float
        How fast the rehearsal's clock runs.
    watches : float
        Share of each video that is watched, in [0, 1].
    thinks : float
        Seconds on that clock between the last video and the answers.
    clicks_twice : bool
        Whether every button is pressed twice, as fast as that goes.
    """

    client: httpx.Client
    stop: Event
    speed: float
    watches: float = 1.0
    thinks: float = 0.0
    clicks_twice: bool = False

    def rest(self, seconds: float) -> None:
        """Let so much time pass on the rehearsal's clock."""
        if self.stop.wait(seconds / self.speed):
            raise InterruptedRehearsal

    def open(self, address: str) -> Page:
        """Return the page at `address`, after redirects."""
        return _page(self.client.get(address))

    def send(self, page: Page, form: Form, answers: FormFields) -> Page:
        """Send `form` of `page` with `answers` and return the page that follows.

        Raises
        ------
        BrokenPageError
            If it is not taken; from who clicks twice, both must be.
        """
        data = page.filled(form, answers)
        if self.stop.is_set():
            raise InterruptedRehearsal
        target = page.target(form)
        if not self.clicks_twice:
            return _page(self.client.post(target, data=data))
        with ThreadPoolExecutor(2) as clicks:
            sent = [clicks.submit(self.client.post, target, data=data) for _ in range(2)]
            return [_page(each.result()) for each in sent][-1]

    def watch(self, page: Page) -> None:
        """Play the videos on `page` on the rehearsal's clock, one after the other, and think.

        The reports say no more than the truth: the intervals that the clock let pass.
        """
        for player in page.players:
            self._stream(page, player.source, "video")
            self.rest(player.duration * self.watches)
            self._report(page, player)
        self.rest(self.thinks)

    def listen(self, page: Page) -> None:
        """Fetch what can be listened to on `page`."""
        for source in page.sounds:
            self._stream(page, source, "audio")

    def _stream(self, page: Page, source: str, kind: str) -> None:
        opening = self.client.get(source, headers={"Range": "bytes=0-1023"})
        found = opening.headers.get("content-type", "")
        if opening.status_code != httpx.codes.PARTIAL_CONTENT or not found.startswith(f"{kind}/"):
            raise BrokenPageError(
                page,
                f"has {'a video' if kind == 'video' else 'a sound'} that cannot be streamed "
                f"(status {opening.status_code}, {found or 'no'} content type)",
            )

    def _report(self, page: Page, player: Player) -> None:
        played = {"batch": 0, "intervals": [[0.0, player.duration * self.watches]]}
        told = self.client.post(player.watched_address, json=played)
        if told.is_error:
            raise BrokenPageError(
                page, f"does not accept what was watched (status {told.status_code})"
            )


def _page(response: httpx.Response) -> Page:
    page = Page(str(response.url), response.text)
    if response.is_error:
        raise BrokenPageError(page, f"answered with status {response.status_code}")
    return page
