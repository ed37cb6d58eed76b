"""Reading a page as it was really served: its form, its fields, its video, its code."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from urllib.parse import urljoin, urlsplit

from bs4 import BeautifulSoup, Tag

from motion.errors import InputError

Fields = tuple[tuple[str, str], ...]


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
class Form:
    """A form that is sent by POST, with exactly what its page offers.

    Attributes
    ----------
    page : Page
        Where it was found.
    action : str
        Absolute address it is sent to.
    hidden : tuple of (name, value)
        What is sent along unseen.
    required_ticks : tuple of (name, value)
        Tick boxes without which a browser would not send it.
    choices : mapping of name to tuple of str
        Values that each radio group offers.
    lines : tuple of str
        Names of fields that take a line of text or a number.
    buttons : tuple of (name, value)
        Submit buttons; the name is empty where a button sends nothing itself.
    """

    page: Page
    action: str
    hidden: Fields
    required_ticks: Fields
    choices: Mapping[str, tuple[str, ...]]
    lines: tuple[str, ...]
    buttons: Fields

    @property
    def trial(self) -> str:
        """Token of the presentation it is for; empty outside a trial."""
        return dict(self.hidden).get("trial", "")

    def filled(self, answers: Mapping[str, str] | None = None) -> dict[str, str]:
        """Return the data a browser would send with `answers` chosen.

        Raises
        ------
        BrokenPageError
            If a question or a value is not offered, a question is left over, or there is no
            button to send the form with.
        """
        answers = answers or {}
        if not self.buttons:
            raise BrokenPageError(self.page, "has no button to send its form with")
        for question, value in answers.items():
            if question in self.lines:
                continue
            if question not in self.choices:
                raise BrokenPageError(self.page, f"does not ask the question {question!r}")
            if value not in self.choices[question]:
                offered = ", ".join(self.choices[question])
                raise BrokenPageError(
                    self.page, f"offers no {value!r} for {question!r} (only {offered})"
                )
        unknown = sorted({*self.choices, *self.lines} - set(answers))
        if unknown:
            raise BrokenPageError(
                self.page, f"asks {', '.join(unknown)}, which the study does not know"
            )
        data = dict((*self.hidden, *self.required_ticks))
        name, value = self.buttons[0]
        return {**data, **({name: value} if name else {}), **answers}


@dataclass(frozen=True)
class PairPlayer:
    """The video of a pair as the page plays it.

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
        parts = urlsplit(self.source).path.split("/")
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
        """Whether it is the page of a trial, as its form or its video tells."""
        return bool(self._soup.find("form", id="answers") or self._soup.find("video", id="pair"))

    def next_form(self) -> Form:
        """Return the form of the page's next step: its first that is sent by POST."""
        for form in self._soup.find_all("form"):
            if str(form.get("method", "get")).lower() == "post":
                return self._form(form)
        raise BrokenPageError(self, "has no form that leads on")

    def answer_form(self) -> Form:
        """Return the form of a trial; it holds the token of the presentation it is for."""
        form = self._soup.find("form", id="answers")
        if form is None:
            raise BrokenPageError(self, "has no form with the id 'answers'")
        read = self._form(form)
        if not read.trial:
            raise BrokenPageError(self, "does not say in a hidden field 'trial' what it asks about")
        return read

    def player(self) -> PairPlayer:
        """Return the video of a trial."""
        video = self._soup.find("video", id="pair")
        if video is None:
            raise BrokenPageError(self, "has no video with the id 'pair'")
        inner = video.find("source")
        source = video.get("src") or (inner.get("src") if inner else None)
        found = {
            "src": source,
            "data-duration": video.get("data-duration"),
            "data-watched-url": video.get("data-watched-url"),
        }
        for name, value in found.items():
            if not value:
                raise BrokenPageError(self, f"has a video without {name}")
        return PairPlayer(
            source=urljoin(self.address, str(found["src"])),
            watched_address=urljoin(self.address, str(found["data-watched-url"])),
            duration=float(str(found["data-duration"])),
        )

    def _form(self, form: Tag) -> Form:
        hidden: list[tuple[str, str]] = []
        ticks: list[tuple[str, str]] = []
        choices: dict[str, tuple[str, ...]] = {}
        lines: list[str] = []
        buttons: list[tuple[str, str]] = []
        for control in self._controls(form):
            name, value = str(control.get("name", "")), str(control.get("value", ""))
            if control.has_attr("disabled"):
                continue
            match _kind(control):
                case "hidden":
                    hidden.append((name, value))
                case "checkbox" if control.has_attr("required"):
                    ticks.append((name, value or "on"))
                case "radio":
                    choices[name] = (*choices.get(name, ()), value)
                case "text" | "number":
                    lines.append(name)
                case "submit":
                    buttons.append((name, value))
        return Form(
            page=self,
            action=urljoin(self.address, str(form.get("action") or self.address)),
            hidden=tuple(hidden),
            required_ticks=tuple(ticks),
            choices=choices,
            lines=tuple(lines),
            buttons=tuple(buttons),
        )

    def _controls(self, form: Tag) -> list[Tag]:
        """Return the form's inputs and buttons; one may name its form and lie elsewhere."""
        controls = self._soup.find_all(["input", "button"])
        return [
            control
            for control in controls
            if (
                control["form"] == form.get("id")
                if control.has_attr("form")
                else control.find_parent("form") is form
            )
        ]


def _kind(control: Tag) -> str:
    """Return the type of a control; a button without one sends its form."""
    default = "submit" if control.name == "button" else "text"
    return str(control.get("type", default)).lower()
