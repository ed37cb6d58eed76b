"""The family of tests that decide, which a study may declare, and Holm's correction over it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from analysis.stats.holm import holm
from motion.errors import InputError

if TYPE_CHECKING:
    # Serving a study reads families, and need not wait for pandas.
    from analysis.results.grouping import Place

FORMS = "all, by question, against=CONDITION, primary=CONDITION,CONDITION[,QUESTION]"


@dataclass(frozen=True, kw_only=True)
class Family:
    """Which tests decide, and over which of them p values are corrected together.

    Attributes
    ----------
    text : str
        As it was declared.
    conditions : tuple of str
        Only tests about all of these decide: one for comparisons with a reference, two for a
        primary comparison; none for every test.
    question : str
        The only question whose tests decide; empty for all.
    by_question : bool
        Whether the tests of each question are corrected by themselves.
    """

    text: str = "all"
    conditions: tuple[str, ...] = ()
    question: str = ""
    by_question: bool = False

    def holds(self, place: Place) -> bool:
        """Tell whether a test of this is a member."""
        return set(self.conditions) <= set(place.names) and self.question in ("", place.question)

    def corrected(self, places: Sequence[Place], p_values: Sequence[float]) -> tuple[float, ...]:
        """Return p values corrected by Holm's method; NaN of tests that are no members.

        Parameters
        ----------
        places : sequence of Place
            What each test is about.
        p_values : sequence of float
            Of the tests.
        """
        corrected = np.full(len(places), np.nan)
        inside = [number for number, place in enumerate(places) if self.holds(place)]
        for question in dict.fromkeys(places[number].question for number in inside):
            own = [n for n in inside if not self.by_question or places[n].question == question]
            corrected[own] = holm([p_values[number] for number in own])
        return tuple(corrected.tolist())


EVERYTHING = Family()


def read_family(
    text: str, conditions: Sequence[str], questions: Sequence[str], *, where: str = "family"
) -> Family:
    """Return the family that `text` declares.

    Raises
    ------
    InputError
        If it is of no form, or names a condition or question that there is not.
    """
    words = text.strip()
    if words in ("all", "by question"):
        return Family(text=words, by_question=words == "by question")
    form, _, names = words.partition("=")
    parts = tuple(part.strip() for part in names.split(","))
    wanted = {"against": (1,), "primary": (2, 3)}.get(form.strip(), ())
    if len(parts) not in wanted or not all(parts):
        raise InputError(
            f"{text!r} is not a family of tests", where=where, remedy=f"Write one of: {FORMS}"
        )
    about, question = parts[:2] if form.strip() == "primary" else parts, "".join(parts[2:])
    for name, known in ((about, conditions), ((question,) if question else (), questions)):
        unknown = [one for one in name if one not in known]
        if unknown:
            raise InputError(
                f"the family names {unknown[0]}, which is not among {', '.join(known)}",
                where=where,
                remedy="Write the name as the study does",
            )
    return Family(text=words, conditions=about, question=question)
