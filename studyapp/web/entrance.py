"""The entrance: what the study is, who may take part, consent."""

from __future__ import annotations

import re
import secrets
from collections.abc import Mapping
from typing import Final

from flask import Blueprint, render_template, request
from flask.typing import ResponseReturnValue

from studyapp.services.enrolment import Arrival, enrol
from studyapp.services.refusal import UnacceptableError
from studyapp.web.about_participant import form_fields
from studyapp.web.errors import told
from studyapp.web.participant import to_where_they_stand
from studyapp.web.running import running

pages = Blueprint("entrance", __name__)

RECRUITER_NAMES: Final = ("PROLIFIC_PID", "STUDY_ID", "SESSION_ID")
RECRUITER_NAME: Final = re.compile(r"[\x21-\x7e]{1,200}")
VISIT: Final = re.compile(r"[A-Za-z0-9_-]{22,64}")


@pages.get("/")
def consent() -> ResponseReturnValue:
    """Say what the study is and ask for consent; nothing is stored."""
    return _consent_page(secrets.token_urlsafe(24), _recruiter(request.args))


@pages.post("/")
def start() -> ResponseReturnValue:
    """Enrol the participant, or bring them back to where they were."""
    here = running()
    recruiter = _recruiter(request.form)
    visit = request.form.get("visit", "")
    if not recruiter and not VISIT.fullmatch(visit):
        raise UnacceptableError(
            "The start did not come from the start page.", "Please open the study's link again."
        )
    arrival = Arrival(
        visit=None if recruiter else visit,
        recruiter_participant=recruiter.get("PROLIFIC_PID"),
        recruiter_study=recruiter.get("STUDY_ID", ""),
        recruiter_session=recruiter.get("SESSION_ID", ""),
        form=form_fields(),
    )
    try:
        token = enrol(here.database, here.served, arrival, here.clock)
    except UnacceptableError as refusal:
        problem = told(refusal)
        return _consent_page(visit, recruiter, problem=problem, given=arrival.form), 422
    return to_where_they_stand(token)


def _consent_page(
    visit: str,
    recruiter: Mapping[str, str],
    *,
    problem: str = "",
    given: Mapping[str, str] | None = None,
) -> str:
    study = running().study
    return render_template(
        "consent.html",
        study=study,
        paragraphs=[text for text in study.page.consent.split("\n\n") if text.strip()],
        visit=visit,
        recruiter=recruiter,
        problem=problem,
        given=given or {},
    )


def _recruiter(values: Mapping[str, str]) -> dict[str, str]:
    """Return the recruiter's names; none at all where it did not name the participant."""
    names = {name: values[name] for name in RECRUITER_NAMES if values.get(name)}
    if any(not RECRUITER_NAME.fullmatch(value) for value in names.values()):
        raise UnacceptableError(
            "The link holds a participant name that cannot be used.",
            "Please open the study once more from the page that sent you here.",
        )
    return names if "PROLIFIC_PID" in names else {}
