"""Why a figure would mislead, in a sentence that stands in its place."""

from __future__ import annotations

NOTHING = "No answer is left to analyse, so no figure is drawn."
ALONE = (
    "The answers of one participant are analysed. Nothing tells how people differ, so there is "
    "neither an interval nor a figure; the tables hold what was answered."
)


def why_no_figure(*, answers: int, participants: int, tied: str = "") -> str:
    """Return why nothing is drawn; '' where there is something to see.

    Parameters
    ----------
    answers, participants : int
        How many are analysed.
    tied : str, optional
        What to say where all answers are alike; '' where they are not.
    """
    if not answers or not participants:
        return NOTHING
    return ALONE if participants == 1 else tied
