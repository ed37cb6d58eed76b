"""A study's progress: its overview, its study sessions, and decisions on them and newcomers."""

from typing import Final

from flask import Response, abort, current_app, redirect, request, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.monitoring.one_study_session import contents_shown, one_study_session
from studyapp.monitoring.overview import over_because
from studyapp.monitoring.overview import overview as overview_of
from studyapp.monitoring.study_sessions import (
    ORDERS,
    STANDINGS,
    Selection,
    list_study_sessions,
    page_numbers,
    rows_on_page,
)
from studyapp.researchers.account import Right
from studyapp.researchers.audit import (
    MAX_LINES,
    detail_label,
    event_label,
    latest_changes,
)
from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.researchers.interim_figures import stored_figures
from studyapp.researchers.pseudonyms import (
    PseudonymKey,
    find_number_by_name,
    find_number_by_recruiter,
    pseudonyms_of,
)
from studyapp.session.ending import JUDGED
from studyapp.session.intake import (
    MAX_ADDED_PLACES,
    STATES,
    add_places,
    change_intake,
    intake_changes,
)
from studyapp.study.folder import StudyFolder
from studyapp.web.media import send_video
from studyapp.web.research.motion_scenes import (
    Scene,
    motion_page,
    scenes_of_trial,
    send_scene,
)
from studyapp.web.research.page import Data, is_rehearsed, open_data, page, researcher
from studyapp.web.site import study_site


def pseudonym_key() -> PseudonymKey | None:
    """Return the key of pseudonyms, if the researcher may see them; this draws none."""
    if not researcher().may(Right.READ):
        return None
    try:
        return PseudonymKey.read(StudyFolder(study_site().folder).pseudonym_key)
    except (InputError, OSError) as error:
        current_app.logger.error("Pseudonyms cannot be shown: %s", error)
        return None


FILTERS: Final = ("standing", "arm", "left_at", "check", "failed", "earlier", "excluded", "order")
"""Parameters of the address that select and sort study sessions."""

LARGEST_NUMBER: Final = 2**31 - 1
"""Of a row in the database."""


def overview(data: Data) -> ResponseReturnValue:
    """Show the study's progress."""
    site, agreement, over = study_site(), None, ""
    with open_data(data) as database:
        progress = overview_of(database, site.served, site.clock.now())
    if data == "study":
        agreement = stored_figures(site.database, site.clock, "agreement", site.figures)
        over = over_because(site.database, site.study, progress.places)
    return page(
        "overview",
        over=over,
        data=data,
        agreement=agreement,
        rehearsed=is_rehearsed(),
        overview=progress,
        refreshes=request.args.get("refresh") != "off",
    )


def study_sessions(data: Data) -> ResponseReturnValue:
    """List study sessions, or go to the one with the given name or number."""
    site = study_site()
    selection, key, called = _selection(), pseudonym_key(), request.args.get("called", "")
    number = _number("page") or 1
    with open_data(data) as database:
        with database.reading() as session:
            match = find_number_by_name(session, key, called) if called else None
            if match is None and called and researcher().may(Right.NAME):
                match = find_number_by_recruiter(session, called)
        if match is not None:
            return redirect(url_for("research.study_session", data=data, number=match), 303)
        listed = list_study_sessions(database, site.served, selection, site.clock.now())
        shown = rows_on_page(listed, number)
        pseudonyms = pseudonyms_of(database, key, [each.id for each in shown]) if key else {}
    return page(
        "study_sessions",
        data=data,
        selection=selection,
        called=called,
        count=len(listed),
        shown=shown,
        has_pseudonyms=key is not None,
        pseudonyms=pseudonyms,
        page_number=number,
        pages=page_numbers(listed),
        standings=STANDINGS,
        arms=[arm.name for arm in site.study.arms],
        filters={key: request.args[key] for key in FILTERS if key in request.args},
    )


def study_session(data: Data, number: int) -> str:
    """Show one study session."""
    site, key = study_site(), pseudonym_key()
    with open_data(data) as database:
        details = one_study_session(database, site.served, number, site.clock.now())
        if details is None:
            abort(404)
        pseudonym = pseudonyms_of(database, key, [number]).get(number, "") if key else ""
    return page(
        "study_session",
        data=data,
        study_session=details,
        pseudonym=pseudonym,
        rules=[rule.to_rule().description for rule in site.study.settled_exclusions],
    )


def shown_video(data: Data, number: int, position: int, video: int) -> Response:
    """Send a video that was shown in a study session, as it is served now."""
    with open_data(data) as database:
        content = contents_shown(database, number, position).get(video, ())
    video_file = study_site().served.videos.get(content)
    if video_file is None:
        abort(404)
    return send_video(video_file.file)


def shown_motion(data: Data, number: int, position: int) -> ResponseReturnValue:
    """Show the motion of a trial, to be turned around, without its conditions."""
    scenes = _scenes(data, number, position)
    if not scenes:
        abort(404)
    return motion_page(
        scenes,
        "research.shown_scene",
        back=(
            url_for("research.study_session", data=data, number=number),
            f"Study session {number}",
        ),
        data=data,
        number=number,
        position=position,
    )


def shown_scene(data: Data, number: int, position: int, scene: int) -> Response:
    """Send the scene of a trial of a study session, from the files as they are now."""
    return send_scene(study_site().folder, _scenes(data, number, position), scene)


def _scenes(data: Data, number: int, position: int) -> list[Scene]:
    with open_data(data) as database:
        players = contents_shown(database, number, position)
    return scenes_of_trial(players, lambda letter, _: letter)


def changes() -> ResponseReturnValue:
    """Show who changed what, when and why, newest first."""
    lines = latest_changes(study_site().database, before=_number("before"))
    older = lines[-1].id if len(lines) == MAX_LINES else None
    return page(
        "changes", lines=lines, older=older, event_label=event_label, detail_label=detail_label
    )


def _selection() -> Selection:
    """Return the selection and order in the address."""
    standing = request.args.get("standing") or None
    if standing is not None and standing not in STANDINGS:
        abort(404)
    kind, count = request.args.get("check", ""), _number("failed")
    sorting = request.args.get("order") or "-number"
    order = next((name for name in ORDERS if name == sorting.removeprefix("-")), None)
    if order is None or (order == "recruiter" and not researcher().may(Right.NAME)):
        abort(404)
    return Selection(
        standing=standing,
        arm=request.args.get("arm") or None,
        left_at=_number("left_at"),
        failed=(kind, count) if kind in JUDGED and count is not None else None,
        earlier="earlier" in request.args,
        excluded="excluded" in request.args,
        order=order,
        rising=not sorting.startswith("-"),
    )


def _number(name: str) -> int | None:
    """Return a number in the address, None if there is none."""
    return _read_number(request.args.get(name, ""))


def _read_number(text: str) -> int | None:
    is_number = text.isascii() and text.isdecimal() and len(text) < len(str(LARGEST_NUMBER))
    return int(text) if is_number else None


DECISIONS = {"exclude": True, "reinstate": False}


def decide_about(number: int) -> ResponseReturnValue:
    """Exclude the participant of a study session from the analysis, or reinstate them."""
    site = study_site()
    excluded = DECISIONS.get(request.form.get("decision", ""))
    if excluded is None:
        raise InputError("nothing was chosen", remedy=f"Choose one of {', '.join(DECISIONS)}")
    decide_exclusion(site.database, site.clock, number, excluded=excluded, **_stated())
    return redirect(url_for("research.study_session", data="study", number=number), 303)


def _stated() -> dict[str, str]:
    """Return who decides, and the reason given."""
    return {"by": researcher().name, "reason": request.form.get("reason", "")}


def newcomers() -> str:
    """Show whether newcomers are admitted, who decided so, and the forms to decide otherwise."""
    site = study_site()
    decisions = intake_changes(site.database)
    return page(
        "newcomers",
        decisions=decisions,
        state=decisions[0].state if decisions else "open",
        most=MAX_ADDED_PLACES,
        link=site.study.recruitment.link(site.origin + url_for("entrance.arrive")),
    )


def steer_newcomers() -> ResponseReturnValue:
    """Admit newcomers, or stop admitting them."""
    site = study_site()
    state = next((name for name in STATES if name == request.form.get("state")), None)
    if state is None:
        raise InputError("nothing was chosen", remedy=f"Choose one of {', '.join(STATES)}")
    change_intake(site.database, site.served, site.clock, state, **_stated())
    return redirect(url_for("research.newcomers"), 303)


def want_more() -> ResponseReturnValue:
    """Open more places in every arm."""
    site, more = study_site(), _read_number(request.form.get("more", "")) or 0
    add_places(site.database, site.served, site.clock, more, **_stated())
    return redirect(url_for("research.newcomers"), 303)
