"""How a study looks to participants: texts, messages, videos, and what counts as watched."""

import re
from collections.abc import Callable, Sequence
from typing import Final, Literal, TypeAlias

from pydantic import Field

from motion.errors import listed
from studyapp.study.settings.sections import COLOUR, Section

Device = Literal["computer", "tablet", "phone"]

Language = Literal["en", "de", "ja"]

FrozenChannel = Literal["face", "hands", "lower_body", "root"]

Framing = Literal["upper_body", "full_body", "face", "hands"]

Avatar = Literal["alex", "maya", "jonas", "amara", "henry", "grey", "mannequin", "skeleton"]

_REACHABLE: Final = re.compile(r"\S@\S+\.\S|https?://|www\.|(\d[\s()/.-]*){6}")
"""An e-mail address, the address of a page, or a telephone number."""


def reaches_somebody(contact: str) -> bool:
    """Tell whether `contact` looks like a way to reach somebody."""
    return _REACHABLE.search(contact) is not None


class Page(Section):
    """What participants read before they consent, and what surrounds the trials.

    Attributes
    ----------
    organisation, contact, payment, ethics : str
        Who runs the study, how to reach them, what participants get, and who approved it.
    minutes : int or None
        Duration of the study; None if participants are not told.
    language : {'en', 'de', 'ja'}
        Language of the pages; texts of the study file are shown as they are.
    devices : tuple of {'computer', 'tablet', 'phone'}
        Allowed devices; participants with another are asked to switch.
    sound_check : bool
        Whether participants must type spoken digits before the instructions. A study without
        sound has no such check.
    break_every : int
        Trials between two breaks; 0 for no breaks.
    withdrawn : {'deleted', 'kept'}
        What happens to the answers of participants who withdraw. They are never analysed.
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

        At least half as many trials as between two breaks, and at least two, must remain.
        """
        if self.break_every == 0 or done == 0 or done % self.break_every:
            return False
        return presentations - done >= max(2, self.break_every // 2)


class Video(Section):
    """How all stimuli look.

    Attributes
    ----------
    framing : {'upper_body', 'full_body', 'face', 'hands'}
        The visible part of the body.
    view : {'front', 'three_quarter'}
        Camera angle.
    background : str
        Background colour in sRGB.
    size : int
        Width and height of one clip in pixels; a pair is twice as wide.
    avatar : str
        The avatar of all conditions: a name in `renderer.look.AVATARS`.
    body : str or None
        A licensed SMPL-X model file (``.npz``) that replaces the avatar.
    expression_matrix : str or None
        A file (``.npy``) of 100 SMPL-X expression coefficients by 52 ARKit
        actions, which converts between them where the body supports only one.
    """

    framing: Framing = "upper_body"
    view: Literal["front", "three_quarter"] = "front"
    background: str = Field("#ececee", pattern=COLOUR)
    size: int = Field(720, ge=64, le=1440, multiple_of=2)
    frame_rate: int = Field(30, ge=10, le=60)
    avatar: Avatar = "alex"
    body: str | None = None
    expression_matrix: str | None = None


class Watching(Section):
    """What counts as watched, and how much a page may load.

    Attributes
    ----------
    coverage : float
        The share of each video that must have played.
    megabytes_per_page : float
        The most that one page may load: its own videos, and those prefetched for the next one.
    """

    coverage: float = Field(0.95, ge=0, le=1, strict=False)
    megabytes_per_page: float = Field(60, gt=0, le=10_000, strict=False)


Value: TypeAlias = "int | str | Message | tuple[Value, ...]"
"""The value of a placeholder; a tuple becomes a list: a, b and c."""


class Message:
    """An English text with named placeholders, and their values.

    The text is always a literal, so that it can be extracted and translated.

    Parameters
    ----------
    text : str
        Whole sentences, or a label.
    **values : int, str, Message or tuple of them
        Values of the placeholders.
    """

    def __init__(self, text: str, /, **values: Value) -> None:
        self.text: Final = text
        self.values: Final = values

    def render(self, translate: Callable[[str], str], join: Callable[[Sequence[str]], str]) -> str:
        """Return the message in another language.

        Parameters
        ----------
        translate : callable
            Translates a text and keeps its placeholders.
        join : callable
            Joins words to a list in that language.
        """

        def render_value(value: Value) -> str:
            if isinstance(value, Message):
                return value.render(translate, join)
            if isinstance(value, tuple):
                return join([render_value(item) for item in value])
            return str(value)

        values = {name: render_value(value) for name, value in self.values.items()}
        return translate(self.text).format_map(values)

    def __str__(self) -> str:
        """Return the message in English."""
        return self.render(str, listed)

    def __repr__(self) -> str:
        return f"Message({str(self)!r})"
