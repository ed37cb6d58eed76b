"""Bad submissions that a rehearsal tries on purpose: each must be refused and change nothing."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import httpx

from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.participant import Visit


@dataclass(frozen=True, kw_only=True)
class Probe:
    """One bad submission.

    Attributes
    ----------
    name : str
        What is wrong with it, in words for the researcher.
    status : int
        The server's answer to it.
    """

    name: str
    status: int


def probe_trial(
    visit: Visit, page: Page, answers: Mapping[str, str], eyes: Eyes
) -> tuple[Probe, ...]:
    """Try bad submissions on the trial of `page`, which has not been watched yet.

    Parameters
    ----------
    visit : Visit
        The participant's own visit.
    page : Page
        The page of the trial that is next to be answered.
    answers : mapping of question to value
        Good answers; each submission spoils something about them.
    eyes : Eyes
        Tells what is stored.

    Returns
    -------
    tuple of Probe
        One for every submission; all were refused.

    Raises
    ------
    BrokenPageError
        If one of them was not refused, or changed what is stored.
    """
    form = page.answer_form()
    good = form.filled(answers)
    question = next(iter(answers))

    def send(data: Mapping[str, str]) -> httpx.Response:
        return visit.client.post(form.action, data=dict(data))

    def tried(name: str, data: Mapping[str, str]) -> Probe:
        return _refused(name, lambda: send(data), page, eyes)

    probes = [tried("answers before the video was watched", good)]
    visit.watch(page)
    without = {name: value for name, value in good.items() if name != question}
    return (
        *probes,
        tried("a value that is out of range", {**good, question: "3"}),
        tried("a value that is no number", {**good, question: "A"}),
        tried("a question left unanswered", without),
        tried("a trial that is not the participant's", {**good, "trial": "0" * len(form.trial)}),
    )


def _refused(name: str, send: Callable[[], httpx.Response], page: Page, eyes: Eyes) -> Probe:
    """Send something bad and make sure that it was refused and changed nothing."""
    before = eyes.stored(page)
    response = send()
    if eyes.stored(page) != before:
        raise BrokenPageError(page, f"stored {name}")
    if not response.is_client_error:
        raise BrokenPageError(page, f"answered {name} with status {response.status_code}")
    return Probe(name=name, status=response.status_code)
