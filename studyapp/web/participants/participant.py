"""The participant's way: questions about them, instructions, trials, completion code."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from flask import Blueprint, jsonify, redirect, render_template, request, url_for
from flask.typing import ResponseReturnValue
from pydantic import ValidationError

from studyapp.session.answers import Fields, answer, skip_unplayable
from studyapp.session.comprehension import begin
from studyapp.session.ending import leaving_at_once, promise_made, withdraw
from studyapp.session.form_answers import answer_form
from studyapp.session.participation import TRIES_BEFORE_LEAVING, leave_break, look
from studyapp.session.refusal import IneligibleError, UnacceptableError
from studyapp.session.shown_trials import ShownTrial
from studyapp.session.watch_evidence import read_report
from studyapp.session.watch_reports import record_watched
from studyapp.study.settings.questions import Stage
from studyapp.web.errors import note, told, wants_json
from studyapp.web.language import say
from studyapp.web.participants.trial_page import frozen_words, trial_page
from studyapp.web.site import study_site

pages = Blueprint("participant", __name__)

LONGEST_NUMBER: Final = 6


@pages.get("/take/<token>")
def stand(token: str) -> ResponseReturnValue:
    """Show where the participant stands."""
    return where_they_stand(token)


@pages.post("/take/<token>/form/<any(demographics, closing):stage>")
def form(token: str, stage: Stage) -> ResponseReturnValue:
    """Store what the participant says about themselves."""
    site = study_site()
    given = form_fields()
    try:
        answer_form(site.database, site.served, token, stage, given, site.clock)
    except UnacceptableError as refusal:
        note(refusal)
        problem = told(refusal)
        return form_page(token, stage, problem=problem, given=given), 422
    return to_where_they_stand(token)


@pages.post("/take/<token>/begin")
def begin_trials(token: str) -> ResponseReturnValue:
    """Leave the instructions, if they were understood."""
    site = study_site()
    given = form_fields()
    try:
        begin(site.database, site.served, token, site.clock, answers=given)
    except UnacceptableError as refusal:
        note(refusal)
        return where_they_stand(token, problem=told(refusal), about=given), 422
    except IneligibleError:
        named = site.study.recruitment.names_participants
        return screened_out_page(named=named, was_sent=named, has_tried=True), 403
    return to_where_they_stand(token)


@pages.post("/take/<token>/break")
def end_break(token: str) -> ResponseReturnValue:
    """Go on after a break; the form of one that is over leads on too."""
    site = study_site()
    position = request.form.get("position", "")
    if not position.isdecimal() or len(position) > LONGEST_NUMBER:
        raise UnacceptableError(
            "This did not come from a break page.", "Please go on; nothing is lost."
        )
    leave_break(site.database, site.served, token, int(position), site.clock)
    return to_where_they_stand(token)


@pages.post("/take/<token>/answers")
def answers(token: str) -> ResponseReturnValue:
    """Store the answers of the present trial."""
    site = study_site()
    fields = {name: values for name, values in request.form.lists() if name != "trial"}
    try:
        answer(site.database, site.served, token, request.form.get("trial", ""), fields, site.clock)
    except UnacceptableError as refusal:
        if wants_json():
            raise
        note(refusal)
        problem = told(refusal)
        return where_they_stand(token, problem=problem, given=fields), 422
    return to_where_they_stand(token)


@pages.post("/take/<token>/unplayable")
def unplayable(token: str) -> ResponseReturnValue:
    """Go on without the video that does not play."""
    site = study_site()
    trial_token, video_token, media_error = (
        request.form.get(name, "") for name in ("trial", "video", "error")
    )
    try:
        skip_unplayable(
            site.database,
            site.served,
            token,
            trial_token,
            site.clock,
            video_token=video_token,
            media_error=media_error,
        )
    except UnacceptableError as refusal:
        if wants_json():
            raise
        note(refusal)
        return where_they_stand(token, problem=told(refusal)), 422
    return to_where_they_stand(token)


@pages.post("/take/<token>/watched/<video_token>")
def watched(token: str, video_token: str) -> ResponseReturnValue:
    """Store a report of played intervals."""
    site = study_site()
    try:
        report = read_report(request.get_data())
    except ValidationError:
        raise UnacceptableError(
            "This is not a report of played intervals.", "Please reload the page."
        ) from None
    known = record_watched(
        site.database,
        site.served,
        token,
        video_token,
        report,
        site.clock,
    )
    return jsonify(vars(known))


@pages.get("/take/<token>/withdraw")
def ask_to_withdraw(token: str) -> ResponseReturnValue:
    """Ask whether the participant really wants to stop, and say what becomes of the answers."""
    site = study_site()
    promise = promise_made(site.database, token)
    return render_template("withdraw.html", study=site.study, token=token, promise=promise)


@pages.post("/take/<token>/withdraw")
def withdraw_consent(token: str) -> ResponseReturnValue:
    """Take the consent back."""
    site = study_site()
    withdraw(site.database, token, site.clock)
    return to_where_they_stand(token)


def to_where_they_stand(token: str) -> ResponseReturnValue:
    """Lead to the page that shows where the participant stands, in the way that was asked for."""
    address = url_for("participant.stand", token=token)
    if wants_json():
        return jsonify(next=address)
    return redirect(address, 303)


def where_they_stand(
    token: str,
    *,
    problem: str = "",
    given: Fields | None = None,
    about: Mapping[str, str] | None = None,
) -> str:
    """Return the page of where the participant stands, with what cannot be accepted of it.

    Parameters
    ----------
    problem : str, optional
        What cannot be accepted.
    given : mapping of field to values, optional
        What was answered to a trial.
    about : mapping of question name to text, optional
        What was answered to the questions under the instructions.
    """
    site = study_site()
    situation = look(site.database, site.served, token, site.clock)
    if situation.form is not None:
        return form_page(token, situation.form)
    if situation.trial is not None:
        return _trial_page(token, situation.trial, problem, given or {})
    if situation.sound_tries is not None:
        page = "sound_check"
    else:
        page = "break" if situation.rest is not None else situation.state
    return render_template(
        f"{page}.html",
        study=site.study,
        token=token,
        situation=situation,
        problem=problem,
        tries_before_leaving=TRIES_BEFORE_LEAVING,
        presentations=situation.presentations,
        practice=situation.practice,
        frozen=frozen_words(site.study),
        leaving=situation.leaving,
        questions=site.study.form.comprehension,
        given=about or {},
        problems=problems_of("comprehension", about) if about is not None else {},
    )


def screened_out_page(*, named: bool, was_sent: bool, has_tried: bool = False) -> str:
    """Return the page for whom the study does not look.

    Parameters
    ----------
    named : bool
        Whether it is stored, under their recruiter's name for them, that they were here.
    was_sent : bool
        Whether a recruiter sent them.
    has_tried : bool
        Whether they have read the instructions, and did not understand them.
    """
    study = study_site().study
    return render_template(
        "screened_out.html",
        study=study,
        named=named,
        was_sent=was_sent,
        has_tried=has_tried,
        leaving=leaving_at_once(study.recruitment),
    )


def _trial_page(token: str, trial: ShownTrial, problem: str, given: Fields) -> str:
    site = study_site()
    site.record.require_unchanged()
    study = site.study
    return render_template(
        "trial.html",
        study=study,
        token=token,
        trial=trial,
        page=trial_page(study, trial),
        from_store=site.store is not None,
        problem=problem,
        given=given,
    )


FORM_FIELD: Final = "form:"
"""Stands before the names of questions about the participant; no question's name holds a colon."""


def form_page(
    token: str, stage: Stage, *, problem: str = "", given: Mapping[str, str] | None = None
) -> str:
    """Return the page that asks the questions of `stage`."""
    study = study_site().study
    return render_template(
        "form.html",
        study=study,
        token=token,
        stage=stage,
        questions=study.form.questions_at(stage),
        problem=problem,
        problems=problems_of(stage, given or {}) if problem else {},
        given=given or {},
    )


def problems_of(stage: Stage, given: Mapping[str, str]) -> dict[str, str]:
    """Return what cannot be accepted of the answers to the questions of `stage`, by question."""
    found = {
        question.name: question.problem(given.get(question.name, "").strip(), number)
        for number, question in enumerate(study_site().study.form.questions_at(stage), start=1)
    }
    return {name: say(problem) for name, problem in found.items() if problem is not None}


def form_fields() -> dict[str, str]:
    """Return the answers about the participant that were sent, under their questions' names."""
    return {
        name.removeprefix(FORM_FIELD): value.replace("\r\n", "\n")  # as the browser counts it
        for name, value in request.form.items()
        if name.startswith(FORM_FIELD)
    }
