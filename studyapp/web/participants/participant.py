"""The participant's way: questions about them, instructions, trials, completion code."""

from __future__ import annotations

from typing import Annotated, Final, Self

from flask import Blueprint, jsonify, redirect, render_template, request, url_for
from flask.typing import ResponseReturnValue
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from studyapp.session.answers import Fields, answer, skip_unplayable
from studyapp.session.breaks import leave_break
from studyapp.session.form_answers import answer_form
from studyapp.session.participation import ShownTrial, begin, look
from studyapp.session.refusal import UnacceptableError
from studyapp.session.sound_check import TRIES_BEFORE_LEAVING
from studyapp.session.videos.watch_evidence import MOST_INTERVALS, MOST_REPORTS, Playback
from studyapp.session.videos.watch_reports import record_watched
from studyapp.session.withdrawal import promise_made, withdraw
from studyapp.study.settings.form import Stage
from studyapp.web.errors import note, told, wants_json
from studyapp.web.participants.about_participant import form_fields, form_page
from studyapp.web.participants.trial_page import trial_page
from studyapp.web.participants.wording import frozen_words
from studyapp.web.running import running

Second = Annotated[float, Field(ge=0, le=86_400, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0, le=10_000_000, strict=True)]


class WatchReport(BaseModel):
    """One numbered report.

    Attributes
    ----------
    batch : int
        Counts the reports of a video from 0.
    intervals : tuple of (float, float)
        Played parts of the video, from and to, in seconds.

    The others are those of `studyapp.session.videos.watch_evidence.Playback`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    batch: int = Field(ge=0, lt=MOST_REPORTS, strict=True)
    intervals: tuple[tuple[Second, Second], ...] = Field(max_length=MOST_INTERVALS)
    rate: float = Field(default=1.0, gt=0, le=100, allow_inf_nan=False)
    hidden_seconds: Second = 0.0
    silent_seconds: Second = 0.0
    stalls: Count = 0
    stalled_seconds: Second = 0.0
    frames: Count | None = None
    dropped_frames: Count | None = None

    @model_validator(mode="after")
    def _intervals_run_forward(self) -> Self:
        if any(start > end for start, end in self.intervals):
            raise ValueError("an interval ends before it begins")
        return self

    @property
    def playback(self) -> Playback:
        """How the intervals were played."""
        return Playback(**self.model_dump(exclude={"batch", "intervals"}))


pages = Blueprint("participant", __name__)

LONGEST_NUMBER: Final = 6


@pages.get("/take/<token>")
def stand(token: str) -> ResponseReturnValue:
    """Show where the participant stands."""
    return where_they_stand(token)


@pages.post("/take/<token>/form/<any(demographics, closing):stage>")
def form(token: str, stage: Stage) -> ResponseReturnValue:
    """Store what the participant says about themselves."""
    here = running()
    given = form_fields()
    try:
        answer_form(here.database, here.served, token, stage, given, here.clock)
    except UnacceptableError as refusal:
        note(refusal)
        problem = told(refusal)
        return form_page(token, stage, problem=problem, given=given), 422
    return to_where_they_stand(token)


@pages.post("/take/<token>/begin")
def begin_trials(token: str) -> ResponseReturnValue:
    """Leave the instructions."""
    here = running()
    begin(here.database, here.served, token, here.clock)
    return to_where_they_stand(token)


@pages.post("/take/<token>/break")
def end_break(token: str) -> ResponseReturnValue:
    """Go on after a break; the form of one that is over leads on too."""
    here = running()
    position = request.form.get("position", "")
    if not position.isdecimal() or len(position) > LONGEST_NUMBER:
        raise UnacceptableError(
            "This did not come from a break page.", "Please go on; nothing is lost."
        )
    leave_break(here.database, here.served, token, int(position), here.clock)
    return to_where_they_stand(token)


@pages.post("/take/<token>/answers")
def answers(token: str) -> ResponseReturnValue:
    """Store the answers of the present trial."""
    here = running()
    fields = {name: values for name, values in request.form.lists() if name != "trial"}
    try:
        answer(here.database, here.served, token, request.form.get("trial", ""), fields, here.clock)
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
    here = running()
    trial_token, video_token, media_error = (
        request.form.get(name, "") for name in ("trial", "video", "error")
    )
    try:
        skip_unplayable(
            here.database,
            here.served,
            token,
            trial_token,
            here.clock,
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
    here = running()
    try:
        report = WatchReport.model_validate_json(request.get_data())
    except ValidationError:
        raise UnacceptableError(
            "This is not a report of played intervals.", "Please reload the page."
        ) from None
    known = record_watched(
        here.database,
        here.served,
        token,
        video_token,
        batch=report.batch,
        intervals=report.intervals,
        clock=here.clock,
        playback=report.playback,
    )
    return jsonify(vars(known))


@pages.get("/take/<token>/withdraw")
def ask_to_withdraw(token: str) -> ResponseReturnValue:
    """Ask whether the participant really wants to stop, and say what becomes of the answers."""
    here = running()
    promise = promise_made(here.database, token)
    return render_template("withdraw.html", study=here.study, token=token, promise=promise)


@pages.post("/take/<token>/withdraw")
def withdraw_consent(token: str) -> ResponseReturnValue:
    """Take the consent back."""
    here = running()
    withdraw(here.database, token, here.clock)
    return to_where_they_stand(token)


def to_where_they_stand(token: str) -> ResponseReturnValue:
    """Lead to the page that shows where the participant stands, in the way that was asked for."""
    address = url_for("participant.stand", token=token)
    if wants_json():
        return jsonify(next=address)
    return redirect(address, 303)


def where_they_stand(token: str, *, problem: str = "", given: Fields | None = None) -> str:
    """Return the page of where the participant stands, with what cannot be accepted of it."""
    here = running()
    situation = look(here.database, here.served, token, here.clock)
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
        study=here.study,
        token=token,
        situation=situation,
        problem=problem,
        tries_before_leaving=TRIES_BEFORE_LEAVING,
        presentations=situation.presentations,
        practice=situation.practice,
        frozen=frozen_words(here.study),
        leaving=situation.leaving,
    )


def _trial_page(token: str, trial: ShownTrial, problem: str, given: Fields) -> str:
    here = running()
    here.record.require_unchanged()
    study = here.study
    return render_template(
        "trial.html",
        study=study,
        token=token,
        trial=trial,
        page=trial_page(study, trial),
        from_store=here.store is not None,
        problem=problem,
        given=given,
    )
