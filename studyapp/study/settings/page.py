"""What a study tells its participants, and how it leads them around the trials."""

from __future__ import annotations

import re
from typing import Final, Literal

from pydantic import Field

from studyapp.study.settings.section import Section

Language = Literal["en", "de", "ja"]

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
    phones : {'refused', 'usable'}
        Whether who comes with a phone is asked to open the study on a computer instead.
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
    phones: Literal["refused", "usable"] = "refused"
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
