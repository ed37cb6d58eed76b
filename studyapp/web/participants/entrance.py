"""The entrance: who may take part, what the study is, consent.

Newcomers who cannot be let in are told so on whatever page they come to first. Nothing is stored
before consent, except that somebody whom a recruiter named was screened out.
"""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from flask import Blueprint, Response, make_response, render_template, request
from flask.typing import ResponseReturnValue

from studyapp.session.arrivals import Arrival, note_screen_out, was_screened_out
from studyapp.session.ending import way_back
from studyapp.session.enrolment import enrol, enrolled, require_welcome
from studyapp.session.form_answers import check_eligibility
from studyapp.session.refusal import IneligibleError, StudyFullError, UnacceptableError
from studyapp.study.settings.presentation import Device, Message
from studyapp.study.settings.questions import Stage
from studyapp.study.settings.study import Study
from studyapp.web.errors import STATUS, told
from studyapp.web.language import say, spoken
from studyapp.web.participants.participant import (
    form_fields,
    problems_of,
    screened_out_page,
    to_where_they_stand,
)
from studyapp.web.participants.sent_by import COOKIE, VISIT, arrival_of, is_preview, names_in
from studyapp.web.site import study_site

pages = Blueprint("entrance", __name__)


@dataclass(frozen=True, kw_only=True)
class Entrant:
    """Who stands at the entrance, as far as the pages there carry it along.

    Attributes
    ----------
    visit : str
        Drawn when the first page was opened.
    recruiter : mapping of str to str
        By what they were sent; nothing at all where nobody named them.
    given : mapping of question name to text
        What was answered so far.
    """

    visit: str
    recruiter: Mapping[str, str]
    given: Mapping[str, str]

    @property
    def arrival(self) -> Arrival:
        """Who they are to the study."""
        return arrival_of(self.recruiter, visit=self.visit, given=self.given)

    def page(self, stage: Stage, *, problem: str = "") -> str:
        """Return the page of one stage; with a problem, it says what cannot be accepted."""
        site = study_site()
        study = site.study
        return render_template(
            f"{stage}.html",
            study=study,
            sound=site.served.has_sound,
            paragraphs=_paragraphs(study),
            visit=self.visit,
            recruiter=self.recruiter,
            given=self.given,
            problem=problem,
            problems=problems_of(stage, self.given) if problem else {},
            devices=_devices_needed(study),
            refused=_calls_itself() not in study.page.devices,
        )

    def first_page(self) -> str:
        """Return the page that comes first."""
        return self.page("eligibility" if study_site().study.form.eligibility else "consent")

    def preview(self) -> str:
        """Return what the study is, for somebody who cannot begin yet."""
        site = study_site()
        return render_template(
            "preview.html",
            study=site.study,
            sound=site.served.has_sound,
            paragraphs=_paragraphs(site.study),
            devices=_devices_needed(site.study),
        )


@pages.get("/consent")
@pages.get("/")
def arrive() -> ResponseReturnValue:
    """Ask whether they may take part, or say what the study is; nothing is stored."""
    visit = secrets.token_urlsafe(24)
    if is_preview(request.args):
        return Entrant(visit=visit, recruiter={}, given={}).preview()
    entrant = Entrant(visit=visit, recruiter=names_in(request.args), given={})
    if _was_screened_out(entrant):
        return _screened_out(entrant)
    _require_welcome(entrant)
    return entrant.first_page()


@pages.post("/consent")
def consent() -> ResponseReturnValue:
    """Say what the study is and ask for consent, if they may take part; nothing is stored.

    Who has a study session already is brought back to it.
    """
    entrant = _entrant()
    site = study_site()
    token = enrolled(site.database, site.served, entrant.arrival, site.clock)
    if token is not None:
        return _to_their_page(token)
    if _was_screened_out(entrant):
        return _screened_out(entrant)
    _require_welcome(entrant)
    try:
        check_eligibility(study_site().study, entrant.given)
    except UnacceptableError as refusal:
        return entrant.page("eligibility", problem=told(refusal)), 422
    except IneligibleError:
        return _screened_out(entrant)
    return entrant.page("consent")


@pages.post("/")
def start() -> ResponseReturnValue:
    """Enrol the participant, or bring them back to where they were."""
    site = study_site()
    site.record.require_unchanged()
    entrant = _entrant()
    if _was_screened_out(entrant):
        return _screened_out(entrant)
    try:
        token = enrol(site.database, site.served, entrant.arrival, site.clock)
    except UnacceptableError as refusal:
        unclear = problems_of("eligibility", entrant.given)
        stage: Stage = "eligibility" if unclear else "consent"
        return entrant.page(stage, problem=told(refusal)), 422
    except IneligibleError:
        return _screened_out(entrant)
    return _to_their_page(token)


@pages.errorhandler(StudyFullError)
def turn_away(refusal: StudyFullError) -> ResponseReturnValue:
    """Say why nobody new is let in, and lead back whoever came from elsewhere, or has begun."""
    site = study_site()
    what, remedy = refusal.messages
    recruitment = site.study.recruitment
    page = render_template(
        "turned_away.html",
        study=site.study,
        what=say(what),
        remedy=say(remedy),
        invited=recruitment.channel == "invitations",
        back=way_back(recruitment),
        # Only the window knows whether it was here before, where nobody is named.
        may_have_begun=recruitment.channel == "link"
        and request.method != "POST"
        and not names_in(request.args),
    )
    return page, STATUS[type(refusal)]


def _to_their_page(token: str) -> Response:
    """Lead to where the participant stands, and have the browser know it again."""
    response = make_response(to_where_they_stand(token))
    COOKIE.send(response, study_site().study.name, token)
    return response


def _require_welcome(entrant: Entrant) -> None:
    site = study_site()
    site.record.require_unchanged()
    require_welcome(site.database, site.served, entrant.arrival, site.clock)


def _was_screened_out(entrant: Entrant) -> bool:
    site = study_site()
    if not site.study.recruitment.names_participants:
        return False
    return was_screened_out(site.database, entrant.arrival)


def _screened_out(entrant: Entrant) -> ResponseReturnValue:
    """Say so; whom the recruiter named stays screened out, and only then is told a code."""
    site = study_site()
    named = site.study.recruitment.names_participants
    if named:
        note_screen_out(site.database, entrant.arrival, site.clock)
    return screened_out_page(named=named, was_sent=bool(entrant.recruiter)), 403


def _entrant() -> Entrant:
    """Return who sent the form of one of the entrance's pages."""
    recruiter = names_in(request.form)
    visit = request.form.get("visit", "")
    if not recruiter and not VISIT.fullmatch(visit):
        raise UnacceptableError(
            "The start did not come from the start page.", "Please open the study's link again."
        )
    return Entrant(visit=visit, recruiter=recruiter, given=form_fields())


def _paragraphs(study: Study) -> list[str]:
    return [text for text in study.page.consent.split("\n\n") if text.strip()]


DEVICES: Final[Mapping[Device, Message]] = MappingProxyType(
    {
        "computer": Message("a computer"),
        "tablet": Message("a tablet"),
        "phone": Message("a phone"),
    }
)
"""What one needs, of every kind of device."""


def _devices_needed(study: Study) -> str:
    """Return on which devices one can take part, in words; empty where any will do."""
    allowed = [device for device in DEVICES if device in study.page.devices]
    if len(allowed) == len(DEVICES):
        return ""
    return spoken().either([say(DEVICES[device]) for device in allowed])


def _calls_itself() -> Device:
    """Return what the browser says it runs on: a first guess, until the script has measured."""
    agent, hint = request.headers.get("User-Agent", ""), request.headers.get("Sec-CH-UA-Mobile")
    if hint == "?1" or (hint is None and "Mobi" in agent and "iPad" not in agent):
        return "phone"
    return "tablet" if "iPad" in agent or "Android" in agent else "computer"
