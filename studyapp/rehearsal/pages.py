"""Parsing a served page: its forms with their fields, its videos, its completion code."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from urllib.parse import urljoin, urlsplit

from bs4 import BeautifulSoup, Tag

from motion.errors import InputError

Fields = list[tuple[str, str]]

FormFields = Mapping[str, Sequence[str]]
"""The answered values of each field."""

FormData = dict[str, list[str]]
"""The values of every name, as a browser sends them."""


@dataclass(frozen=True, kw_only=True)
class Form:
    """A form that is sent by POST.

    Attributes
    ----------
    action : str
        Its address, as in the page; empty for the page itself.
    hidden : list of (name, value)
        Hidden fields.
    required_ticks : list of (name, value)
        Required tick boxes.
    questions : set of str
        Names of the fields that need an answer: radio groups, menus, and lines of text or numbers.
    offered : dict of name to list of str
        Values of each radio group, menu, and group of optional tick boxes.
    buttons : list of (name, value)
        Submit buttons; the name is empty if a button sends no value.
    """

    action: str
    hidden: Fields = field(default_factory=list)
    required_ticks: Fields = field(default_factory=list)
    questions: set[str] = field(default_factory=set)
    offered: defaultdict[str, list[str]] = field(default_factory=lambda: defaultdict(list))
    buttons: Fields = field(default_factory=list)

    @property
    def trial(self) -> str:
        """Token of its presentation; empty outside a trial."""
        return dict(self.hidden).get("trial", "")

    def problem(self, answers: FormFields) -> str:
        """Return what the form lacks for a participant with `answers`; empty if nothing."""
        if not self.buttons:
            return "has no submit button"
        for name, values in answers.items():
            if name not in self.offered:
                if name not in self.questions:
                    return f"does not ask the question {name!r}"
                continue
            for value in set(values).difference(self.offered[name]):
                only = ", ".join(self.offered[name])
                return f"does not offer {value!r} for {name!r} (only {only})"
        unknown = sorted(self.questions - set(answers))
        return f"asks {', '.join(unknown)}, which the study does not define" if unknown else ""


def read_form(soup: BeautifulSoup, tag: Tag) -> Form:
    """Return the form `tag` of the page `soup`."""
    form = Form(action=str(tag.get("action") or ""))
    for control in _controls(soup, tag):
        name, value = str(control.get("name", "")), str(control.get("value", ""))
        kind = _kind(control)
        if kind in ("radio", "select", "text", "textarea", "number"):
            form.questions.add(name)
        match kind:
            case "hidden":
                form.hidden.append((name, value))
            case "checkbox" if control.has_attr("required"):
                form.required_ticks.append((name, value or "on"))
            case "checkbox" | "radio":
                form.offered[name].append(value or "on")
            case "select":
                form.offered[name].extend(_options(control))
            case "submit":
                form.buttons.append((name, value))
    return form


def _controls(soup: BeautifulSoup, form: Tag) -> Iterator[Tag]:
    """Yield the form's enabled controls, which may be outside the form and refer to it."""
    for control in soup.find_all(["input", "button", "select", "textarea"]):
        belongs = (
            control["form"] == form.get("id")
            if control.has_attr("form")
            else control.find_parent("form") is form
        )
        if belongs and not control.has_attr("disabled"):
            yield control


def _options(menu: Tag) -> tuple[str, ...]:
    """Return the values of a menu; its empty entry means no answer."""
    values = [
        str(option.get("value", option.get_text(strip=True))) for option in menu.find_all("option")
    ]
    return tuple(value for value in values if value)


def _kind(control: Tag) -> str:
    """Return the type of a control; the default of a button is submit."""
    if control.name in ("select", "textarea"):
        return str(control.name)
    default = "submit" if control.name == "button" else "text"
    return str(control.get("type", default)).lower()


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
            If a question or a value is not offered, a question has no answer, or there is no submit
            button.
        """
        if problem := form.problem(answers):
            raise BrokenPageError(self, problem)
        data: FormData = {}
        button = [(name, value) for name, value in form.buttons[:1] if name]
        for name, value in (*form.hidden, *form.required_ticks, *button):
            data.setdefault(name, []).append(value)
        return data | {name: list(values) for name, values in answers.items()}

    def target(self, form: Form) -> str:
        """Return the absolute address of `form`."""
        return urljoin(self.address, form.action) if form.action else self.address
