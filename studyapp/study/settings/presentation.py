"""How a study is shown: its texts and messages, its videos, and what counts as watched."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Final, Literal, TypeAlias

from pydantic import Field

from motion.errors import listed
from studyapp.study.settings.sections import Section

Device = Literal["computer", "tablet", "phone"]

Language = Literal["en", "de", "ja"]

Framing = Literal["upper_body", "full_body", "face", "hands"]

_REACHABLE: Final = re.compile(r"\S@\S+\.\S|https?://|www\.|(\d[\s()/.-]*){6}")
"""An e-mail address, the address of a page, or a telephone number."""


def reaches_somebody(contact: str) -> bool:
    """Tell whether `contact` says how to reach somebody, as far as a program can see."""
    return _REACHABLE.search(contact) is not None


class Page(Section):
    """What participants are told before they agree, and how they are led around the trials.

    Attributes
    ----------
    organisation, contact, payment, ethics : str
        Who runs the study, how they are reached, what participants get, and who approved it.
    minutes : int or None
        How long it takes; None where participants are not told.
    language : {'en', 'de', 'ja'}
        The language of the pages' own words; what the study file says is shown as it is.
    devices : tuple of {'computer', 'tablet', 'phone'}
        What one may take part on; whoever comes with another is asked to open the study there.
    sound_check : bool
        Whether spoken digits must be typed before the instructions. A study that is all without
        sound has no such check.
    break_every : int
        Trials after which a break is offered; 0 for none.
    withdrawn : {'deleted', 'kept'}
        What becomes of the answers of a participant who withdraws. They are never analysed.
    """

    language: Language = "en"
    organisation: str = Field("", max_length=200)
    contact: str = Field("", max_length=200)
    minutes: int | None = Field(None, ge=1, le=240)
    payment: str = Field("", max_length=200)
    ethics: str = Field("", max_length=300)
    consent: str = Field(min_length=1, max_length=4000)
    devices: tuple[Device, ...] = Field(("computer", "tablet"), min_length=1, strict=False)
    sound_check: bool = False
    break_every: int = Field(0, ge=0, le=500)
    withdrawn: Literal["deleted", "kept"] = "deleted"

    def break_after(self, done: int, presentations: int) -> bool:
        """Tell whether a break comes after `done` of `presentations` trials.

        There is none shortly before the end: at least half as many trials as between two breaks,
        and no fewer than two, must remain.
        """
        if self.break_every == 0 or done == 0 or done % self.break_every:
            return False
        return presentations - done >= max(2, self.break_every // 2)


class Video(Section):
    """How all stimuli of the study look.

    Attributes
    ----------
    framing : {'upper_body', 'full_body', 'face', 'hands'}
        What of the body the picture shows.
    view : {'front', 'three_quarter'}
        From where.
    background : str
        sRGB of what is behind the speaker.
    size : int
        Pixels along each side of one clip; a pair is twice as wide.
    avatar : str
        Who is shown, the same for all conditions: a name in `renderer.look.AVATARS`.
    body : str or None
        A licensed SMPL-X model file (``.npz``) to show instead of an avatar.
    expression_matrix : str or None
        A file (``.npz``, ``.npy`` or ``.csv``) of 100 SMPL-X expression coefficients by 52 ARKit
        actions, which turns the one into the other where the body shows only that.
    """

    framing: Framing = "upper_body"
    view: Literal["front", "three_quarter"] = "front"
    background: str = Field("#ececee", pattern="^#[0-9a-fA-F]{6}$")
    size: int = Field(720, ge=64, le=1440, multiple_of=2)
    frame_rate: int = Field(30, ge=10, le=60)
    avatar: Literal["alex", "maya", "jonas", "amara", "henry", "grey", "mannequin", "skeleton"] = (
        "alex"
    )
    body: str | None = None
    expression_matrix: str | None = None


class Watching(Section):
    """What counts as having watched, and how much there may be to load for it.

    Attributes
    ----------
    coverage : float
        The share of each video that must really have played.
    megabytes_per_page : float
        What one page may load at most: its own videos, and those fetched ahead for the next one.
    """

    coverage: float = Field(0.95, ge=0, le=1, strict=False)
    megabytes_per_page: float = Field(60, gt=0, le=10_000, strict=False)


Value: TypeAlias = "int | str | Message | tuple[Value, ...]"
"""What stands in a place of a message; a tuple is said as a list: a, b and c."""


class Message:
    """An English text with named places, ``{so}``, and what stands in them.

    The text is a literal wherever a message is made, so that it can be found and translated.

    Parameters
    ----------
    text : str
        Whole sentences, or the words of a label.
    **values : int, str, Message or tuple of them
        By the names of the places.
    """

    def __init__(self, text: str, /, **values: Value) -> None:
        self.text: Final = text
        self.values: Final = values

    def render(self, translate: Callable[[str], str], join: Callable[[Sequence[str]], str]) -> str:
        """Return the message in another language.

        Parameters
        ----------
        translate : callable
            Gives a text in that language, with the same places.
        join : callable
            Makes a list of words there.
        """

        def filled(value: Value) -> str:
            if isinstance(value, Message):
                return value.render(translate, join)
            if isinstance(value, tuple):
                return join([filled(each) for each in value])
            return str(value)

        text = translate(self.text)
        return text.format_map({name: filled(value) for name, value in self.values.items()})

    def __str__(self) -> str:
        """Return the message in English."""
        return self.render(str, listed)

    def __repr__(self) -> str:
        return f"Message({str(self)!r})"
