"""Preview: any trial as a participant sees it, marked, and storing nothing.

The page is the participants' own. It is rendered as if the address of the preview were the root of
a server, so that all its requests come here, and go no further.
"""

from flask import Response, abort, current_app, jsonify, redirect, render_template, request, url_for
from flask.typing import ResponseReturnValue

from studyapp.recruitment.invitations import (
    count_test_participations,
    erase_test_participations,
    make_test_participation,
)
from studyapp.session.trials import PREVIEW_TOKEN, previewed_trial
from studyapp.study.design.trial import PlannedTrial
from studyapp.study.media import VideoFile
from studyapp.web.errors import wants_json
from studyapp.web.media import send_video
from studyapp.web.mounting import path_to_try
from studyapp.web.participants.trial_page import trial_page
from studyapp.web.research.motion_scenes import (
    Scene,
    motion_page,
    scenes_of_trial,
    send_scene,
)
from studyapp.web.research.page import display_name, page, researcher
from studyapp.web.site import study_site

MOST_PLACES = 10_000


def preview() -> ResponseReturnValue:
    """List the trials of a place."""
    arms = [arm.name for arm in study_site().study.arms]
    arm_name, place = request.args.get("arm", ""), request.args.get("place", "")
    arm = arms.index(arm_name) if arm_name in arms else 0
    readable = place.isascii() and place.isdecimal() and len(place) < len(str(MOST_PLACES))
    number = max(1, int(place)) if readable else 1
    tries = count_test_participations(study_site().folder)
    trials = _trials(arm, number)
    return page("preview", arms=arms, arm=arm, place=number, trials=trials, tries=tries)


def try_study() -> ResponseReturnValue:
    """Let the researcher take part as a test."""
    site = study_site()
    token = make_test_participation(site.folder, site.served, site.clock, by=researcher().name)
    return redirect(request.script_root + path_to_try(token), 303)


def erase_tries() -> ResponseReturnValue:
    """Erase all test participations."""
    erase_test_participations(study_site().folder)
    return redirect(url_for("research.preview"), 303)


def previewed_page(arm: int, place: int, position: int) -> ResponseReturnValue:
    """Show one trial."""
    trials = _trials(arm, place)
    site = study_site()
    if not 1 <= position <= len(trials):
        abort(404)
    trial = previewed_trial(site.served, trials, position)
    links = {
        "listed": url_for("research.preview", arm=site.study.arms[arm].name, place=place),
        "motion": ""
        if site.study.only_finished
        else url_for("research.previewed_motion", arm=arm, place=place, position=position),
        "before": _address(arm, place, position - 1) if position > 1 else "",
        "after": _address(arm, place, position + 1) if position < len(trials) else "",
    }
    root = _address(arm, place, position).rstrip("/")
    with current_app.request_context({**request.environ, "SCRIPT_NAME": root, "PATH_INFO": "/"}):
        return render_template(
            "research/previewed_trial.html",
            study=site.study,
            token=PREVIEW_TOKEN,
            trial=trial,
            page=trial_page(site.study, trial),
            problem="",
            answers={},
            **links,
        )


def previewed_video(arm: int, place: int, position: int, number: int) -> Response:
    """Send a video of a previewed trial."""
    return send_video(_video(arm, place, position, number).file)


def previewed_motion(arm: int, place: int, position: int) -> ResponseReturnValue:
    """Show the motion of a previewed trial, to be turned around."""
    return motion_page(
        _scenes(arm, place, position),
        "research.previewed_scene",
        back=(_address(arm, place, position), f"Preview of trial {position}"),
        arm=arm,
        place=place,
        position=position,
    )


def previewed_scene(arm: int, place: int, position: int, scene: int) -> Response:
    """Send what a viewer plays of a previewed trial."""
    return send_scene(study_site().folder, _scenes(arm, place, position), scene)


def _scenes(arm: int, place: int, position: int) -> list[Scene]:
    players = _planned(arm, place, position).players
    return scenes_of_trial(
        players, lambda letter, shown: f"{letter}: {display_name(shown.condition)}"
    )


def previewed_file(arm: int, place: int, position: int, filename: str) -> Response:
    """Send a script or a style that the page asks for."""
    del arm, place, position
    return current_app.send_static_file(filename)


def previewed_report(arm: int, place: int, position: int, number: int) -> ResponseReturnValue:
    """Answer a report as if it were stored, and all of the video watched."""
    video = _video(arm, place, position, number)
    report = request.get_json(silent=True)
    batch = report.get("batch") if isinstance(report, dict) else 0
    next_batch = batch + 1 if isinstance(batch, int) else 0
    return jsonify(
        intervals=[(0.0, video.duration)], missing=0.0, next_batch=next_batch, stored=True
    )


def previewed_answers(arm: int, place: int, position: int, what: str) -> ResponseReturnValue:
    """Go on to the next trial, whatever was answered; after the last one, back to the list."""
    del what
    trials = _trials(arm, place)
    if position < len(trials):
        address = _address(arm, place, position + 1)
    else:
        address = url_for("research.preview", arm=study_site().study.arms[arm].name, place=place)
    return jsonify(next=address) if wants_json() else redirect(address, 303)


def _video(arm: int, place: int, position: int, number: int) -> VideoFile:
    content = _planned(arm, place, position).players.get(number)
    if content is None:
        abort(404)
    return study_site().served.videos[content]


def _planned(arm: int, place: int, position: int) -> PlannedTrial:
    trials = _trials(arm, place)
    if not 0 < position <= len(trials):
        abort(404)
    return trials[position - 1]


def _trials(arm: int, place: int) -> list[PlannedTrial]:
    site = study_site()
    if arm >= len(site.study.arms) or not 1 <= place < MOST_PLACES:
        abort(404)
    # Of an adaptive study, the trials before anybody has answered.
    return list(site.study.plan(site.study.arms[arm], place - 1, site.served.segments))


def _address(arm: int, place: int, position: int) -> str:
    return url_for("research.previewed_page", arm=arm, place=place, position=position)
