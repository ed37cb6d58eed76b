"""What a simulated participant needs of a page, found without parsing it.

A rehearsal reads pages as a person would and says what they lack, which takes 5 ms a page, longer
than the server needs to make it. Where the server is measured, 0.06 ms must do: only the next step
counts.
"""

import html
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

TAG: Final = re.compile(r"<(input|video|link|script)\b([^>]*)>")
ATTRIBUTE: Final = re.compile(r'([a-z-]+)(?:="([^"]*)")?')
FORM: Final = re.compile(r"<form\b([^>]*)>")
FORM_END: Final = "</form>"


@dataclass(frozen=True, kw_only=True)
class SeenVideo:
    """A player: the addresses of its file and of its watch reports, and its length."""

    source: str
    watched_address: str
    duration: float


@dataclass(frozen=True, kw_only=True)
class SeenForm:
    """The form that leads on.

    Attributes
    ----------
    hidden : mapping of str to str
        Fields that are sent as they are.
    choices : mapping of str to tuple of str
        For every group of choices its values.
    """

    action: str
    is_trial: bool
    hidden: Mapping[str, str]
    choices: Mapping[str, tuple[str, ...]]


def seen_videos(page: str) -> tuple[SeenVideo, ...]:
    """Return the players on `page`."""
    videos = [_attributes(text) for kind, text in TAG.findall(page) if kind == "video"]
    return tuple(
        SeenVideo(
            source=video["src"],
            watched_address=video["data-watched-url"],
            duration=float(video["data-duration"]),
        )
        for video in videos
    )


def seen_files(page: str) -> tuple[str, ...]:
    """Return the addresses of the style and the scripts of `page`."""
    tags = [_attributes(text) for kind, text in TAG.findall(page) if kind in ("link", "script")]
    return tuple(tag.get("src") or tag["href"] for tag in tags if "src" in tag or "href" in tag)


def seen_form(page: str) -> SeenForm | None:
    """Return the form that leads on from `page`, if there is one.

    On a trial's page that is the one with the answers; elsewhere the first one that is sent.
    """
    forms = [(_attributes(match.group(1)), match) for match in FORM.finditer(page)]
    forms.sort(key=lambda form: form[0].get("id") != "answers")
    for form, match in forms:
        if form.get("method") != "post":
            continue
        inner = page[match.end() : page.index(FORM_END, match.end())]
        controls = [_attributes(text) for kind, text in TAG.findall(inner) if kind == "input"]
        choices: dict[str, tuple[str, ...]] = {}
        for control in controls:
            if control.get("type") == "radio":
                name = control["name"]
                choices[name] = (*choices.get(name, ()), control["value"])
        return SeenForm(
            action=form["action"],
            is_trial=form.get("id") == "answers",
            hidden={
                control["name"]: control["value"]
                for control in controls
                if control.get("type") == "hidden"
            },
            choices=choices,
        )
    return None


def _attributes(text: str) -> dict[str, str]:
    return {name: html.unescape(value) for name, value in ATTRIBUTE.findall(text)}
