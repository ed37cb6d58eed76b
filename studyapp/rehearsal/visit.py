"""A simulated participant's browser: opening pages, playing videos, sending forms."""

from __future__ import annotations

import ssl
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from threading import Event
from typing import Final

import httpx

from studyapp.rehearsal.pages import BrokenPageError, Form, FormFields, Page, Player

REQUEST_SECONDS: Final = 60.0


def study_client(server: str) -> httpx.Client:
    """Return a client for one participant of the server at address `server`.

    Every request opens a new connection. A server closes idle connections after some seconds, as
    long as a participant may watch. A request sent at that moment would be lost, and only browsers
    retry it.
    """
    return httpx.Client(
        base_url=server,
        follow_redirects=True,
        timeout=REQUEST_SECONDS,
        limits=httpx.Limits(max_keepalive_connections=0),
        trust_env=False,
        # The loopback needs no certificates, and loading them takes longer than a visit.
        verify=ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT),
        headers={"Accept": "text/html"},
    )


class Departure(Exception):  # noqa: N818 - not an error
    """A participant has left.

    Attributes
    ----------
    returns : bool
        Whether the participant comes back later.
    """

    def __init__(self, *, returns: bool) -> None:
        super().__init__()
        self.returns = returns


class InterruptedRehearsal(Exception):  # noqa: N818 - not an error
    """The rehearsal stops; stored answers are kept."""


@dataclass(frozen=True, kw_only=True)
class Visit:
    """A browser window of a participant.

    Attributes
    ----------
    client : httpx.Client
        Follows redirects.
    stop : Event
        Set when the rehearsal stops.
    speed : float
        Speed of the rehearsal's clock.
    watches : float
        Watched share of each video, in [0, 1].
    thinks : float
        Seconds on that clock between the last video and the answers.
    clicks_twice : bool
        Whether every button is pressed twice at once.
    """

    client: httpx.Client
    stop: Event
    speed: float
    watches: float = 1.0
    thinks: float = 0.0
    clicks_twice: bool = False

    def wait(self, seconds: float) -> None:
        """Wait for `seconds` on the rehearsal's clock."""
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
            If it is not accepted; of two clicks, both must be.
        """
        data = page.fill(form, answers)
        if self.stop.is_set():
            raise InterruptedRehearsal
        target = page.target(form)
        if not self.clicks_twice:
            return _page(self.client.post(target, data=data))
        with ThreadPoolExecutor(2) as pool:
            clicks = [pool.submit(self.client.post, target, data=data) for _ in range(2)]
            return [_page(click.result()) for click in clicks][-1]

    def watch(self, page: Page) -> None:
        """Play the videos on `page` one after the other on the rehearsal's clock, and think."""
        for player in page.players:
            self._stream(page, player.source, "video")
            self.wait(player.duration * self.watches)
            self._report(page, player)
        self.wait(self.thinks)

    def listen(self, page: Page) -> None:
        """Fetch the sounds on `page`."""
        for source in page.sounds:
            self._stream(page, source, "audio")

    def _stream(self, page: Page, source: str, kind: str) -> None:
        partial = self.client.get(source, headers={"Range": "bytes=0-1023"})
        content_type = partial.headers.get("content-type", "")
        is_kind = content_type.startswith(f"{kind}/")
        if partial.status_code != httpx.codes.PARTIAL_CONTENT or not is_kind:
            raise BrokenPageError(
                page,
                f"has {'a video' if kind == 'video' else 'a sound'} that cannot be streamed "
                f"(status {partial.status_code}, {content_type or 'no'} content type)",
            )

    def _report(self, page: Page, player: Player) -> None:
        played = {"batch": 0, "intervals": [[0.0, player.duration * self.watches]]}
        response = self.client.post(player.watched_address, json=played)
        if response.is_error:
            raise BrokenPageError(
                page, f"does not accept a report of watching (status {response.status_code})"
            )


def _page(response: httpx.Response) -> Page:
    page = Page(str(response.url), response.text)
    if response.is_error:
        raise BrokenPageError(page, f"answered with status {response.status_code}")
    return page
