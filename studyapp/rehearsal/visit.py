"""What a browser does for a simulated participant: open pages, play videos, send forms."""

from __future__ import annotations

from dataclasses import dataclass
from threading import Event

import httpx

from studyapp.rehearsal.forms import Form, FormFields
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.players import Player


class InterruptedRehearsal(Exception):  # noqa: N818 - it is no error
    """The rehearsal is to stop; what was answered is kept."""


@dataclass(frozen=True, kw_only=True)
class Visit:
    """One browser window.

    Attributes
    ----------
    client : httpx.Client
        Follows redirects.
    stop : Event
        Set when the rehearsal is to stop.
    speed : float
        How fast the rehearsal's clock runs; videos are played in that time.
    """

    client: httpx.Client
    stop: Event
    speed: float

    def open(self, address: str) -> Page:
        """Return the page at `address`, after redirects."""
        return _page(self.client.get(address))

    def send(self, page: Page, form: Form, answers: FormFields | None = None) -> Page:
        """Send `form` of `page` with `answers` and return the page that follows."""
        data = page.filled(form, answers or {})
        if self.stop.is_set():
            raise InterruptedRehearsal
        return _page(self.client.post(page.target(form), data=data))

    def watch(self, page: Page) -> None:
        """Play each video on `page` to its end on the rehearsal's clock, one after the other.

        The reports say no more than the truth: the intervals that the clock let pass.
        """
        for player in page.players:
            self._stream(page, player.source, "video")
            if self.stop.wait(player.duration / self.speed):
                raise InterruptedRehearsal
            self._report(page, player)

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
        played = {"batch": 0, "intervals": [[0.0, player.duration]]}
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
