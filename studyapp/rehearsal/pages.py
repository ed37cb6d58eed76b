"""Parsing a served page: its next form, its videos, its completion code."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from urllib.parse import urljoin, urlsplit

from bs4 import BeautifulSoup, Tag

from motion.errors import InputError
from studyapp.rehearsal.forms import Form, FormData, FormFields, IncompleteFormError, read_form


class BrokenPageError(InputError):
    """A served page lacks something that a participant needs."""

    def __init__(self, page: Page, problem: str) -> None:
        heading = page.heading
        super().__init__(
            f"the page {heading!r} {problem}" if heading else f"the page {problem}",
            where=urlsplit(page.address).path,
            remedy="Open the study in a browser and look at that page",
        )


@dataclass(frozen=True)
class Player:
    """A video on a page.

    Attributes
    ----------
    source : str
        Absolute address of the file.
    watched_address : str
        Absolute address for reports of the played parts.
    duration : float
        Seconds.
    """

    source: str
    watched_address: str
    duration: float

    @property
    def token_candidates(self) -> tuple[str, ...]:
        """Parts of the address that can be the media token."""
        return token_candidates(self.source)


def token_candidates(address: str) -> tuple[str, ...]:
    """Return the parts of an address that can be a token."""
    parts = urlsplit(address).path.split("/")
    return tuple(piece for part in parts if part for piece in {part, part.partition(".")[0]})


@dataclass(frozen=True)
class Page:
    """A served page.

    Attributes
    ----------
    address : str
        Its address after redirects.
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
    def is_trial(self) -> bool:
        """Whether it is the page of a trial."""
        return bool(self._soup.find("form", id="answers") or self._soup.find("video"))

    @property
    def next_form(self) -> Form:
        """The first form that is sent by POST."""
        for form in self._soup.find_all("form"):
            if str(form.get("method", "get")).lower() == "post":
                return read_form(self._soup, form)
        raise BrokenPageError(self, "has no form for the next step")

    @property
    def answer_form(self) -> Form:
        """The form of a trial, with the token of its presentation."""
        form = self._soup.find("form", id="answers")
        if not isinstance(form, Tag):
            raise BrokenPageError(self, "has no form with the id 'answers'")
        answer_form = read_form(self._soup, form)
        if not answer_form.trial:
            raise BrokenPageError(self, "has no hidden field 'trial'")
        return answer_form

    @property
    def players(self) -> tuple[Player, ...]:
        """The videos of a trial, in their order."""
        videos = self._soup.find_all("video")
        if not videos:
            raise BrokenPageError(self, "has no video")
        return tuple(self._player(video) for video in videos)

    def _player(self, video: Tag) -> Player:
        source = video.find("source")
        attributes = {
            "src": video.get("src") or (source.get("src") if source else None),
            "data-duration": video.get("data-duration"),
            "data-watched-url": video.get("data-watched-url"),
        }
        for name, value in attributes.items():
            if not value:
                raise BrokenPageError(self, f"has a video without {name}")
        return Player(
            source=urljoin(self.address, str(attributes["src"])),
            watched_address=urljoin(self.address, str(attributes["data-watched-url"])),
            duration=float(str(attributes["data-duration"])),
        )

    @property
    def sounds(self) -> tuple[str, ...]:
        """Absolute addresses of sounds outside the videos."""
        return tuple(
            urljoin(self.address, str(sound["src"]))
            for sound in self._soup.find_all(["audio", "source"])
            if sound.has_attr("src") and sound.find_parent("video") is None
        )

    def fill(self, form: Form, answers: FormFields) -> FormData:
        """Return the data that a browser would send for `form` with `answers`.

        Raises
        ------
        BrokenPageError
            If the form does not offer these answers.
        """
        try:
            return form.fill(answers)
        except IncompleteFormError as error:
            raise BrokenPageError(self, str(error)) from None

    def target(self, form: Form) -> str:
        """Return the absolute address of `form`."""
        return urljoin(self.address, form.action) if form.action else self.address
