"""Reading a page as it was really served: its next step, its videos, its code."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from urllib.parse import urljoin, urlsplit

from bs4 import BeautifulSoup, Tag

from motion.errors import InputError
from studyapp.rehearsal.forms import Form, FormData, FormFields, IncompleteFormError, read_form


class BrokenPageError(InputError):
    """A page was served without something that a person would need to go on."""

    def __init__(self, page: Page, what: str) -> None:
        heading = page.heading
        super().__init__(
            f"the page {heading!r} {what}" if heading else f"the page {what}",
            where=urlsplit(page.address).path,
            remedy="Open the study in a browser and look at that page",
        )


@dataclass(frozen=True)
class Player:
    """One video as the page plays it.

    Attributes
    ----------
    source : str
        Absolute address of the file.
    watched_address : str
        Absolute address that is told which parts were played.
    duration : float
        Seconds.
    """

    source: str
    watched_address: str
    duration: float

    @property
    def token_candidates(self) -> tuple[str, ...]:
        """Parts of the address that can be the media token; nothing else tells what is shown."""
        return token_candidates(self.source)


def token_candidates(address: str) -> tuple[str, ...]:
    """Return the parts of an address that can be a token."""
    parts = urlsplit(address).path.split("/")
    return tuple(piece for part in parts if part for piece in {part, part.partition(".")[0]})


@dataclass(frozen=True)
class Page:
    """One page as served.

    Attributes
    ----------
    address : str
        Where it came from, after redirects.
    html : str
        Its source.
    """

    address: str
    html: str = field(repr=False)

    @cached_property
    def _soup(self) -> BeautifulSoup:
        return BeautifulSoup(self.html, "html.parser")

    @property
    def heading(self) -> str:
        """Its first heading; empty if there is none."""
        heading = self._soup.find("h1")
        return heading.get_text(" ", strip=True) if heading else ""

    @property
    def completion_code(self) -> str | None:
        """The completion code, on the page that shows it."""
        output = self._soup.find("output", id="completion-code")
        if output is None:
            return None
        code = output.get_text(strip=True)
        if not code:
            raise BrokenPageError(self, "shows an empty completion code")
        return code

    @property
    def asks(self) -> bool:
        """Whether it is the page of a trial, as its form or its videos tell."""
        return bool(self._soup.find("form", id="answers") or self._soup.find("video"))

    @property
    def next_form(self) -> Form:
        """The form of the page's next step: its first that is sent by POST."""
        for form in self._soup.find_all("form"):
            if str(form.get("method", "get")).lower() == "post":
                return read_form(self._soup, form)
        raise BrokenPageError(self, "has no form that leads on")

    @property
    def answer_form(self) -> Form:
        """The form of a trial; it holds the token of the presentation it is for."""
        form = self._soup.find("form", id="answers")
        if not isinstance(form, Tag):
            raise BrokenPageError(self, "has no form with the id 'answers'")
        read = read_form(self._soup, form)
        if not read.trial:
            raise BrokenPageError(self, "does not say in a hidden field 'trial' what it asks about")
        return read

    @property
    def players(self) -> tuple[Player, ...]:
        """The videos of a trial, in their order."""
        videos = self._soup.find_all("video")
        if not videos:
            raise BrokenPageError(self, "has no video")
        return tuple(self._player(video) for video in videos)

    def _player(self, video: Tag) -> Player:
        inner = video.find("source")
        found = {
            "src": video.get("src") or (inner.get("src") if inner else None),
            "data-duration": video.get("data-duration"),
            "data-watched-url": video.get("data-watched-url"),
        }
        for name, value in found.items():
            if not value:
                raise BrokenPageError(self, f"has a video without {name}")
        return Player(
            source=urljoin(self.address, str(found["src"])),
            watched_address=urljoin(self.address, str(found["data-watched-url"])),
            duration=float(str(found["data-duration"])),
        )

    @property
    def sounds(self) -> tuple[str, ...]:
        """Absolute addresses of what can be listened to apart from the videos."""
        return tuple(
            urljoin(self.address, str(sound["src"]))
            for sound in self._soup.find_all(["audio", "source"])
            if sound.has_attr("src") and sound.find_parent("video") is None
        )

    def filled(self, form: Form, answers: FormFields) -> FormData:
        """Return what a browser would send of `form` with `answers` chosen.

        Raises
        ------
        BrokenPageError
            If the form does not offer that.
        """
        try:
            return form.filled(answers)
        except IncompleteFormError as error:
            raise BrokenPageError(self, str(error)) from None

    def target(self, form: Form) -> str:
        """Return the absolute address that `form` is sent to."""
        return urljoin(self.address, form.action) if form.action else self.address
