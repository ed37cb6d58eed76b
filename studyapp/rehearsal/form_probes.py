"""Bad submissions of the pages around the trials: each must be refused and change nothing."""

from __future__ import annotations

from collections.abc import Iterator

from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.forms import FormData, FormFields
from studyapp.rehearsal.pages import Page
from studyapp.rehearsal.probes import Probe, Prober
from studyapp.rehearsal.visit import Visit
from studyapp.study.settings.form import LONGEST_TEXT, FormQuestion
from studyapp.study.settings.study import Study
from studyapp.web.participants.about_participant import FORM_FIELD


def probe_form(
    visit: Visit, page: Page, answers: FormFields, *, study: Study, eyes: Eyes, name: str
) -> tuple[Page, tuple[Probe, ...]]:
    """Send the form of `page` well in the end, but try bad submissions before, and it twice.

    Parameters
    ----------
    visit : Visit
        The participant's own visit.
    page : Page
        Any page that is not that of a trial.
    answers : mapping of field name to texts
        Good answers to what it asks.
    study : Study
        Knows what may be answered about the participant.
    eyes : Eyes
        Tells what is stored.
    name : str
        What the recruiter calls the participant.

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
    form = page.next_form
    good = page.filled(form, answers)
    prober = Prober(
        visit=visit, page=page, target=page.target(form), stored=lambda: eyes.told(name)
    )
    refused = [prober.refused(what, data) for what, data in _spoilt(study, page, good)]
    following = visit.send(page, form, answers)
    again = prober.harmless(f"the form of {page.heading!r} twice", good)
    return following, (*refused, again)


def _spoilt(study: Study, page: Page, good: FormData) -> Iterator[tuple[str, FormData]]:
    """Yield what is wrong, and `good` spoilt so."""
    for stage in study.form.stages():
        for question in study.form.asked(stage):
            field = f"{FORM_FIELD}{question.name}"
            if field not in good:
                continue
            for what, value in _wrong(question):
                yield f"{what} to the question {question.name!r}", {**good, field: [value]}
    if page.sounds:
        (field,) = page.next_form.asked
        others = "".join(str((int(digit) + 1) % 10) for digit in good[field][0])
        yield "digits that were not spoken", {**good, field: [others]}
        yield "no digits", {**good, field: [""]}


def _wrong(question: FormQuestion) -> Iterator[tuple[str, str]]:
    """Yield answers that cannot be accepted, or with which nobody can take part."""
    if question.required:
        yield "no answer", ""
    match question.kind:
        case "text":
            yield "too long an answer", "x" * (LONGEST_TEXT + 1)
        case "number":
            yield "too high a number", str(question.high + 1)
        case _:
            yield "an answer that is not offered", "no such answer"
    for choice in question.choices:
        if question.eligible and choice not in question.eligible:
            yield "an answer that excludes", choice
