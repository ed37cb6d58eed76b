"""The entrance: eligibility, what the study is, consent.

Newcomers who cannot be admitted are told so on the first page they reach. Nothing is stored before
consent, except how many were screened out, and that somebody named by a recruiter was.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal

from flask import Blueprint, Response, make_response, render_template, request
from flask.typing import ResponseReturnValue

from studyapp.session.ending import return_address
from studyapp.session.enrolment import Arrival, enrol, require_admission, resume
from studyapp.session.form_answers import (
    check_eligibility,
    note_screen_out,
    was_screened_out,
)
from studyapp.session.refusal import (
    IneligibleError,
    StudyFullError,
    TakenPartError,
    UnacceptableError,
)
from studyapp.session.trials import new_token
from studyapp.study.settings.presentation import Device, Message
from studyapp.study.settings.questions import Stage
from studyapp.study.settings.study import Study
from studyapp.web.errors import note_and_explain, status_of
from studyapp.web.language import page_language, say
from studyapp.web.participants.participant import (
    form_fields,
    problems_of,
    redirect_to_current_page,
    screened_out_page,
)
from studyapp.web.participants.recruiter_names import (
    COOKIE,
    VISIT,
    arrival_of,
    is_preview,
    read_names,
)
from studyapp.web.site import study_site

pages = Blueprint("entrance", __name__)


@dataclass(frozen=True, kw_only=True)
class Entrant:
    """A person at the entrance, as its pages pass them along.

    Attributes
    ----------
    visit : str
        Drawn when the first page was opened.
    recruiter : mapping of str to str
        The recruiter's names for them; empty if nobody named them.
    answers : mapping of question name to text
        So far.
    """

    visit: str
    recruiter: Mapping[str, str]
    answers: Mapping[str, str]

    @property
    def arrival(self) -> Arrival:
        """The same, as the study knows them."""
        return arrival_of(self.recruiter, visit=self.visit, form=self.answers)

    def page(self, name: Stage | Literal["preview"], *, problem: str = "") -> str:
        """Return the page of a stage, with the problem of the submitted answers; or the preview."""
        site = study_site()
        study = site.study
        return entrance_page(
            name,
            study,
            self,
            has_sound=site.served.has_sound,
            problem=problem,
            problems={} if name == "preview" or not problem else problems_of(name, self.answers),
            refused=_stated_device() not in study.page.devices,
        )


def entrance_page(
    name: Stage | Literal["preview"],
    study: Study,
    entrant: Entrant,
    *,
    has_sound: bool,
    problem: str = "",
    problems: Mapping[str, str] | None = None,
    refused: bool = False,
) -> str:
    """Return a page of the entrance to `study`, for a device that may be `refused`."""
    return render_template(
        f"{name}.html",
        study=study,
        sound=has_sound,
        paragraphs=[text for text in study.page.consent.split("\n\n") if text.strip()],
        visit=entrant.visit,
        recruiter=entrant.recruiter,
        answers=entrant.answers,
        problem=problem,
        problems=problems or {},
        devices=_devices_needed(study),
        refused=refused,
    )


@pages.get("/consent")
@pages.get("/")
def arrive() -> ResponseReturnValue:
    """Ask for eligibility, or describe the study; nothing is stored."""
    visit = new_token()
    if is_preview(request.args):
        return Entrant(visit=visit, recruiter={}, answers={}).page("preview")
    entrant = Entrant(visit=visit, recruiter=read_names(request.args), answers={})
    if _was_screened_out(entrant):
        return screened_out_page(), 403
    _require_welcome(entrant)
    return entrant.page("eligibility" if study_site().study.form.eligibility else "consent")


@pages.post("/consent")
def consent() -> ResponseReturnValue:
    """Describe the study and ask for consent, if they are eligible; nothing is stored.

    Participants who have a study session already are led back to it.
    """
    entrant = _entrant()
    site = study_site()
    token = resume(site.database, site.served, entrant.arrival, site.clock)
    if token is not None:
        return _redirect(token)
    if _was_screened_out(entrant):
        return screened_out_page(), 403
    _require_welcome(entrant)
    try:
        check_eligibility(site.study, entrant.answers)
    except UnacceptableError as refusal:
        return entrant.page("eligibility", problem=note_and_explain(refusal)), 422
    except IneligibleError as error:
        return _screen_out(entrant, error.stage)
    return entrant.page("consent")


@pages.post("/")
def start() -> ResponseReturnValue:
    """Enrol the participant, or lead them back to where they were."""
    site = study_site()
    site.record.require_unchanged()
    entrant = _entrant()
    if _was_screened_out(entrant):
        return screened_out_page(), 403
    try:
        token = enrol(site.database, site.served, entrant.arrival, site.clock)
    except UnacceptableError as refusal:
        stage: Stage = "eligibility" if problems_of("eligibility", entrant.answers) else "consent"
        return entrant.page(stage, problem=note_and_explain(refusal)), 422
    except IneligibleError as error:
        return _screen_out(entrant, error.stage)
    return _redirect(token)


@pages.errorhandler(StudyFullError)
@pages.errorhandler(TakenPartError)
def turn_away(refusal: StudyFullError | TakenPartError) -> ResponseReturnValue:
    """Say why they are not admitted, with the ways back to a recruiter or a begun session."""
    site = study_site()
    what, remedy = refusal.messages
    recruitment = site.study.recruitment
    page = render_template(
        "turned_away.html",
        study=site.study,
        what=say(what),
        remedy=say(remedy),
        # By an open link, somebody who has taken part may have come with the same submission.
        may_return_place=recruitment.channel != "invitations"
        and not (isinstance(refusal, TakenPartError) and recruitment.channel == "link"),
        back=return_address(recruitment),
        # Without names, only the window knows whether it was here before.
        may_have_begun=recruitment.channel == "link"
        and request.method != "POST"
        and not read_names(request.args),
    )
    return page, status_of(refusal)


def _redirect(token: str) -> Response:
    """Lead to the participant's current page, and have the browser remember the participant."""
    response = make_response(redirect_to_current_page(token))
    COOKIE.send(response, study_site().study.name, token)
    return response


def _require_welcome(entrant: Entrant) -> None:
    site = study_site()
    site.record.require_unchanged()
    require_admission(site.database, site.served, entrant.arrival, site.clock)


def _was_screened_out(entrant: Entrant) -> bool:
    site = study_site()
    if not site.study.recruitment.names_participants:
        return False
    return was_screened_out(site.database, entrant.arrival.name)


def _screen_out(entrant: Entrant, stage: Stage) -> ResponseReturnValue:
    """Count them; people named by the recruiter stay screened out, and only then get a code."""
    site = study_site()
    name = entrant.arrival.name if site.study.recruitment.names_participants else None
    note_screen_out(site.database, name, stage, site.clock)
    return screened_out_page(), 403


def _entrant() -> Entrant:
    """Return who sent a form of the entrance."""
    recruiter = read_names(request.form)
    visit = request.form.get("visit", "")
    if not recruiter and not VISIT.fullmatch(visit):
        raise UnacceptableError(
            "The start did not come from the start page.", "Please open the study's link again."
        )
    return Entrant(visit=visit, recruiter=recruiter, answers=form_fields())


DEVICES: Final[Mapping[Device, Message]] = {
    "computer": Message("a computer"),
    "tablet": Message("a tablet"),
    "phone": Message("a phone"),
}
"""The words for each kind of device."""


def _devices_needed(study: Study) -> str:
    """Return in words on which devices one can take part; empty if on all."""
    allowed = [device for device in DEVICES if device in study.page.devices]
    if len(allowed) == len(DEVICES):
        return ""
    return page_language().either([say(DEVICES[device]) for device in allowed])


def _stated_device() -> Device:
    """Return the device that the browser claims to run on, until the script has measured."""
    agent, hint = request.headers.get("User-Agent", ""), request.headers.get("Sec-CH-UA-Mobile")
    if hint == "?1" or (hint is None and "Mobi" in agent and "iPad" not in agent):
        return "phone"
    return "tablet" if "iPad" in agent or "Android" in agent else "computer"
