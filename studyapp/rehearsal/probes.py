"""Bad submissions that a rehearsal tries on purpose: each must be refused and change nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.participant import Visit


@dataclass(frozen=True, kw_only=True)
class Probe:
    """One bad submission, which changed nothing.

    Attributes
    ----------
    name : str
        What was wrong with it, in words for the researcher.
    status : int
        The server's answer.
    """

    name: str
    status: int


def probe_trial(
    visit: Visit, page: Page, answers: dict[str, str], eyes: Eyes, *, gated: bool
) -> tuple[Page, tuple[Probe, ...]]:
    """Answer the trial of `page` well in the end, but try bad submissions before and after.

    Parameters
    ----------
    visit : Visit
        The participant's own visit.
    page : Page
        The page of a trial that is to be answered next, nothing of it watched yet.
    answers : mapping of question to value
        Good answers; each bad submission spoils something about them.
    eyes : Eyes
        Tells what is stored.
    gated : bool
        Whether the study takes answers only once the videos were watched.

    Returns
    -------
    page : Page
        The page that follows.
    probes : tuple of Probe
        What was tried.

    Raises
    ------
    BrokenPageError
        If a bad submission was not refused, or changed what is stored.
    """
    form = page.answer_form()
    good = form.filled(answers)
    question, value = next(iter(answers.items()))

    def tried(name: str, data: Mapping[str, str], *, harmless: bool = False) -> Probe:
        before = eyes.stored(page)
        response = visit.client.post(form.action, data=dict(data))
        if eyes.stored(page) != before:
            raise BrokenPageError(page, f"was sent {name}, and stored it")
        if not (response.is_success if harmless else response.is_client_error):
            raise BrokenPageError(page, f"was sent {name}, answered {response.status_code}")
        return Probe(name=name, status=response.status_code)

    unwatched = [tried("answers before the videos were watched", good)] if gated else []
    visit.watch(page)
    without = {name: value for name, value in good.items() if name != question}
    refused = [
        tried("a value that is out of range", {**good, question: "3"}),
        tried("a value that is no number", {**good, question: "A"}),
        tried("a question without an answer", without),
        tried("somebody else's trial", {**good, "trial": "0" * len(form.trial)}),
    ]
    following = visit.send(form, answers)
    other = "0" if value != "0" else "1"
    repeated = [
        tried("the same answers twice", good, harmless=True),
        tried("other answers to an answered trial", {**good, question: other}),
    ]
    return following, (*unwatched, *refused, *repeated)
