"""A participant's pages: questions about them, instructions, trials, completion code."""

from collections.abc import Mapping
from typing import Final

from flask import Blueprint, jsonify, redirect, render_template, request, url_for
from flask.typing import ResponseReturnValue
from pydantic import ValidationError

from studyapp.session.answers import Fields, skip_unplayable, store_answers
from studyapp.session.ending import screened_out_exit, withdraw, withdrawal_promise
from studyapp.session.form_answers import find_problems, start_trials, store_form_answers
from studyapp.session.participation import Situation, leave_break, load_situation
from studyapp.session.playback import record_watched
from studyapp.session.refusal import IneligibleError, UnacceptableError
from studyapp.session.trials import ShownTrial
from studyapp.session.watch_evidence import read_report
from studyapp.study.settings.questions import Stage
from studyapp.study.settings.study import Study
from studyapp.web.errors import note_and_explain, wants_json
from studyapp.web.language import say
from studyapp.web.participants.trial_page import frozen_words, trial_page
from studyapp.web.site import study_site

pages = Blueprint("participant", __name__)


@pages.get("/take/<token>")
def stand(token: str) -> ResponseReturnValue:
    """Show where the participant stands."""
    return current_page(token)


@pages.get("/take/<token>/<path:form>")
def turn_back(token: str, form: str) -> ResponseReturnValue:
    """Lead from the address of a form, which a browser may open anew, to the current page."""
    del form
    return redirect_to_current_page(token)


@pages.post("/take/<token>/form/<any(demographics, closing):stage>")
def form(token: str, stage: Stage) -> ResponseReturnValue:
    """Store answers about the participant."""
    site = study_site()
    form_answers = form_fields()
    try:
        store_form_answers(site.database, site.served, token, stage, form_answers, site.clock)
    except UnacceptableError as refusal:
        problem = note_and_explain(refusal)
        page = form_page(site.study, token, stage, problem=problem, form_answers=form_answers)
        return page, 422
    return redirect_to_current_page(token)


@pages.post("/take/<token>/begin")
def begin_trials(token: str) -> ResponseReturnValue:
    """Leave the instructions, if they were understood."""
    site = study_site()
    comprehension = form_fields()
    try:
        start_trials(
            site.database,
            site.served,
            token,
            site.clock,
            answers=comprehension,
            tries=request.form.get("tries", 0, type=int),
        )
    except UnacceptableError as refusal:
        problem = note_and_explain(refusal)
        return current_page(token, problem=problem, comprehension=comprehension), 422
    except IneligibleError:
        return screened_out_page(has_tried=True), 403
    return redirect_to_current_page(token)


@pages.post("/take/<token>/break")
def end_break(token: str) -> ResponseReturnValue:
    """Go on after a break; the form of an earlier break leads on too."""
    site = study_site()
    position = request.form.get("position", 0, type=int)
    leave_break(site.database, site.served, token, position, site.clock)
    return redirect_to_current_page(token)


@pages.post("/take/<token>/answers")
def answers(token: str) -> ResponseReturnValue:
    """Store the answers of the present trial."""
    site = study_site()
    fields = {name: values for name, values in request.form.lists() if name != "trial"}
    try:
        store_answers(
            site.database, site.served, token, request.form.get("trial", ""), fields, site.clock
        )
    except UnacceptableError as refusal:
        if wants_json():
            raise
        problem = note_and_explain(refusal)
        return current_page(token, problem=problem, trial_answers=fields), 422
    return redirect_to_current_page(token)


@pages.post("/take/<token>/unplayable")
def unplayable(token: str) -> ResponseReturnValue:
    """Go on without a video that does not play."""
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
        return current_page(token, problem=note_and_explain(refusal)), 422
    return redirect_to_current_page(token)


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
    watched_so_far = record_watched(
        site.database, site.served, token, video_token, report, site.clock
    )
    return jsonify(vars(watched_so_far))


@pages.get("/take/<token>/withdraw")
def ask_to_withdraw(token: str) -> ResponseReturnValue:
    """Ask whether the participant wants to stop, and say what happens to the answers."""
    site = study_site()
    promise = withdrawal_promise(site.database, token)
    if promise is None:
        return redirect_to_current_page(token)
    return render_template("withdraw.html", study=site.study, token=token, promise=promise)


@pages.post("/take/<token>/withdraw")
def withdraw_consent(token: str) -> ResponseReturnValue:
    """Withdraw the consent."""
    site = study_site()
    withdraw(site.database, token, site.clock)
    return redirect_to_current_page(token)


def redirect_to_current_page(token: str) -> ResponseReturnValue:
    """Lead to the participant's current page, by a redirect or in JSON."""
    address = url_for("participant.stand", token=token)
    if wants_json():
        return jsonify(next=address)
    return redirect(address, 303)


def current_page(
    token: str,
    *,
    problem: str = "",
    trial_answers: Fields | None = None,
    comprehension: Mapping[str, str] | None = None,
) -> str:
    """Return the participant's current page.

    Parameters
    ----------
    problem : str, optional
        Why the submitted answers cannot be accepted.
    trial_answers : mapping of field to values, optional
        The submitted answers of a trial.
    comprehension : mapping of question name to text, optional
        The submitted answers to the questions under the instructions.
    """
    site = study_site()
    situation = load_situation(site.database, site.served, token, site.clock)
    if situation.trial is not None:
        return _trial_page(token, situation.trial, problem, trial_answers or {})
    return situation_page(
        site.study, token, situation, problem=problem, comprehension=comprehension
    )


def situation_page(
    study: Study,
    token: str,
    situation: Situation,
    *,
    problem: str = "",
    comprehension: Mapping[str, str] | None = None,
) -> str:
    """Return the page of a situation other than a trial; see `current_page`."""
    if situation.form is not None:
        return form_page(study, token, situation.form)
    if situation.sound_tries is not None:
        page = "sound_check"
    else:
        page = "break" if situation.break_before is not None else situation.state
    return render_template(
        f"{page}.html",
        study=study,
        token=token,
        situation=situation,
        problem=problem,
        presentations=situation.presentations,
        practice=situation.practice,
        frozen=frozen_words(study),
        leaving=situation.exit,
        questions=study.form.comprehension,
        answers=comprehension or {},
        problems={} if comprehension is None else problems_of("comprehension", comprehension),
    )


def screened_out_page(*, has_tried: bool = False) -> str:
    """Return the page for people who cannot take part.

    Parameters
    ----------
    has_tried : bool
        Whether they failed the questions about the instructions.
    """
    study = study_site().study
    return render_template(
        "screened_out.html",
        study=study,
        named=study.recruitment.names_participants,
        has_tried=has_tried,
        leaving=screened_out_exit(study.recruitment),
    )


def _trial_page(token: str, trial: ShownTrial, problem: str, trial_answers: Fields) -> str:
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
        answers=trial_answers,
    )


FORM_FIELD: Final = "form:"
"""Prefix of fields with answers about the participant; no question's name holds a colon."""


def form_page(
    study: Study,
    token: str,
    stage: Stage,
    *,
    problem: str = "",
    form_answers: Mapping[str, str] | None = None,
) -> str:
    """Return the page that asks the questions of `stage`."""
    return render_template(
        "form.html",
        study=study,
        token=token,
        stage=stage,
        questions=study.form.questions_at(stage),
        problem=problem,
        problems=problems_of(stage, form_answers or {}) if problem else {},
        answers=form_answers or {},
    )


def problems_of(stage: Stage, form_answers: Mapping[str, str]) -> dict[str, str]:
    """Return in words why answers to questions of `stage` cannot be accepted, by question."""
    problems = find_problems(study_site().study, stage, form_answers)
    return {name: say(problem) for name, problem in problems.items()}


def form_fields() -> dict[str, str]:
    """Return the submitted answers about the participant, by question name."""
    return {
        name.removeprefix(FORM_FIELD): value.replace("\r\n", "\n")  # as the browser counts it
        for name, value in request.form.items()
        if name.startswith(FORM_FIELD)
    }
