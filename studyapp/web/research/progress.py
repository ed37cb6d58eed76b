"""How the study goes: its overview, its study sessions, and decisions on them and newcomers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from flask import Response, abort, redirect, request, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.monitoring.one_study_session import contents_shown, one_study_session
from studyapp.monitoring.overview import overview as overview_of
from studyapp.monitoring.study_sessions import (
    ORDERS,
    STANDINGS,
    Choice,
    chosen,
    page_of,
    pages_of,
)
from studyapp.researchers.account import Right
from studyapp.researchers.audit import LINES, LONGEST_REASON, logged_changes
from studyapp.researchers.exclusion_decisions import decide_exclusion
from studyapp.researchers.interim_figures import Document, Kept, kept_figures
from studyapp.researchers.pseudonyms import (
    PseudonymKey,
    number_called,
    number_recruited,
    pseudonyms_of,
)
from studyapp.session.ending import JUDGED
from studyapp.session.intake import MOST_MORE, STATES, decided, extend, steer
from studyapp.study.folder import StudyFolder
from studyapp.web.media import send_video
from studyapp.web.research.motion_scenes import (
    WantedScene,
    motion_page,
    scenes_of_trial,
    send_scene,
)
from studyapp.web.research.page import Data, is_rehearsed, looked_at, page, researcher
from studyapp.web.site import study_site


@dataclass(frozen=True, kw_only=True)
class Naming:
    """How a page may call participants.

    Attributes
    ----------
    key : PseudonymKey or None
    reason : str
        Why there are no pseudonyms, as a sentence; empty where there are, and where who asks may
        not see answers of single participants in any case.
    """

    key: PseudonymKey | None
    reason: str = ""


def naming() -> Naming:
    """Return how the page that is asked for may call participants; it draws no key."""
    if not researcher().may(Right.READ):
        return Naming(key=None)
    try:
        key = PseudonymKey.read(StudyFolder(study_site().folder).pseudonym_key)
    except InputError as error:
        return Naming(key=None, reason=f"Pseudonyms cannot be shown: {error.what}.")
    except OSError:
        return Naming(key=None, reason="Pseudonyms cannot be shown: the server may not read them.")
    return Naming(key=key, reason="" if key else "Pseudonyms are drawn at the first export.")


CHOOSING: Final = ("standing", "arm", "left_at", "check", "failed", "earlier", "excluded", "order")
"""What an address may say of which study sessions are listed."""

LARGEST: Final = 2**31 - 1
"""The largest number of a row."""


@dataclass(frozen=True, kw_only=True)
class AgreementSoFar:
    """What the overview shows of agreement; no document where none has been computed yet."""

    kept: Kept
    document: Document | None


def overview(data: Data) -> ResponseReturnValue:
    """Show how the study goes."""
    site = study_site()
    with looked_at(data) as database:
        found = overview_of(database, site.served, site.clock.now())
    return page(
        "overview",
        data=data,
        agreement=_agreement() if data == "study" else None,
        rehearsed=is_rehearsed(),
        found=found,
        refreshes=request.args.get("refresh") != "off",
    )


def _agreement() -> AgreementSoFar:
    """Return how far participants agree, as it was computed last."""
    site = study_site()
    kept = kept_figures(site.database, site.clock, "agreement", site.figures)
    return AgreementSoFar(kept=kept, document=Document.read(kept.document))


def study_sessions(data: Data) -> ResponseReturnValue:
    """List the study sessions that a number counts; or go to the one that is called for."""
    site = study_site()
    choice, names, called = _choice(), naming(), request.args.get("called", "")
    number = _number("page") or 1
    with looked_at(data) as database:
        with database.reading() as session:
            one = number_called(session, names.key, called) if called else None
            if one is None and called and researcher().may(Right.NAME):
                one = number_recruited(session, called)
        if one is not None:
            return redirect(url_for("research.study_session", data=data, number=one), 303)
        found = chosen(database, site.served, choice, site.clock.now())
        shown = page_of(found, number)
        pseudonyms = _pseudonyms(database, names, [each.progress.id for each in shown])
    return page(
        "study_sessions",
        data=data,
        choice=choice,
        called=called,
        count=len(found),
        shown=shown,
        naming=names,
        pseudonyms=pseudonyms,
        page_number=number,
        pages=pages_of(found),
        standings=STANDINGS,
        arms=[arm.name for arm in site.study.arms],
        asked={key: request.args[key] for key in CHOOSING if key in request.args},
    )


def study_session(
    data: Data, number: int, *, problem: InputError | None = None, reason: str = ""
) -> str:
    """Show one study session with everything that happened in it, and what a form lacked."""
    site, names = study_site(), naming()
    with looked_at(data) as database:
        found = one_study_session(database, site.served, number, site.clock.now())
        if found is None:
            abort(404)
        pseudonym = _pseudonyms(database, names, [number]).get(number, "")
    return page(
        "study_session",
        data=data,
        found=found,
        naming=names,
        pseudonym=pseudonym,
        rules=[each.to_rule().description for each in site.study.settled_exclusions],
        problem=problem,
        reason=reason,
        longest=LONGEST_REASON,
    )


def shown_video(data: Data, number: int, position: int, video: int) -> Response:
    """Send a video that was shown in a study session, as it is served now."""
    with looked_at(data) as database:
        content = contents_shown(database, number, position).get(video, ())
    found = study_site().served.videos.get(content)
    if found is None:
        abort(404)
    return send_video(found.file)


def shown_motion(data: Data, number: int, position: int) -> ResponseReturnValue:
    """Show the motion of a trial, to be turned around; which condition it is, is not told."""
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
    """Send what a viewer plays of a trial of a study session, as the files are now."""
    return send_scene(study_site().folder, _scenes(data, number, position), scene)


def _scenes(data: Data, number: int, position: int) -> list[WantedScene]:
    with looked_at(data) as database:
        players = contents_shown(database, number, position)
    return scenes_of_trial(players, lambda letter, _: letter)


def changes() -> ResponseReturnValue:
    """Show who changed what, when and why, the newest first."""
    before = _number("before")
    lines = logged_changes(study_site().database, before=before)
    older = lines[-1].id if len(lines) == LINES else None
    return page("changes", lines=lines, older=older)


def _choice() -> Choice:
    """Return which study sessions the address asks for."""
    standing = request.args.get("standing") or None
    if standing is not None and standing not in STANDINGS:
        abort(404)
    kind, count = request.args.get("check", ""), _number("failed")
    asked = request.args.get("order") or "-number"
    order = next((known for known in ORDERS if known == asked.removeprefix("-")), None)
    if order is None or (order == "recruiter" and not researcher().may(Right.NAME)):
        abort(404)
    return Choice(
        standing=standing,
        arm=request.args.get("arm") or None,
        left_at=_number("left_at"),
        failed=(kind, count) if kind in JUDGED and count is not None else None,
        earlier="earlier" in request.args,
        excluded="excluded" in request.args,
        order=order,
        rising=not asked.startswith("-"),
    )


def _pseudonyms(database: Database, names: Naming, numbers: Sequence[int]) -> Mapping[int, str]:
    return pseudonyms_of(database, names.key, numbers) if names.key else {}


def _number(name: str) -> int | None:
    """Return a number in the address, None where there is none."""
    text = request.args.get(name, "")
    if not (text.isascii() and text.isdecimal()):
        return None
    return int(text) if len(text) < len(str(LARGEST)) else None


DECISIONS = {"exclude": True, "reinstate": False}


def decide_about(number: int) -> ResponseReturnValue:
    """Leave the participant of a study session out of the analysis, or take them in again."""
    site, reason = study_site(), request.form.get("reason", "")
    try:
        excluded = DECISIONS.get(request.form.get("decision", ""))
        if excluded is None:
            raise InputError("nothing was chosen", remedy=f"Choose one of {', '.join(DECISIONS)}")
        by = researcher().name
        decide_exclusion(site.database, site.clock, number, excluded=excluded, by=by, reason=reason)
    except InputError as error:
        return study_session("study", number, problem=error, reason=reason), 422
    return redirect(url_for("research.study_session", data="study", number=number), 303)


def newcomers(problem: InputError | None = None, reason: str = "") -> str:
    """Show whether newcomers are let in, who decided so, and the forms to decide otherwise."""
    made = decided(study_site().database)
    state = made[0].state if made else "open"
    return page(
        "newcomers",
        made=made,
        state=state,
        problem=problem,
        reason=reason,
        most=MOST_MORE,
        link=study_site().study.recruitment.link(study_site().origin + url_for("entrance.arrive")),
    )


def steer_newcomers() -> ResponseReturnValue:
    """Let newcomers in, or no longer."""
    site, reason, sent = study_site(), request.form.get("reason", ""), request.form.get("state")
    state = next((known for known in STATES if known == sent), None)
    try:
        if state is None:
            raise InputError("nothing was chosen", remedy=f"Choose one of {', '.join(STATES)}")
        by = researcher().name
        steer(site.database, site.served, site.clock, state, by=by, reason=reason)
    except InputError as error:
        return newcomers(error, reason), 422
    return redirect(url_for("research.newcomers"), 303)


def want_more() -> ResponseReturnValue:
    """Open more places in every arm."""
    site, reason, sent = (
        study_site(),
        request.form.get("reason", ""),
        request.form.get("more", ""),
    )
    readable = sent.isascii() and sent.isdecimal() and len(sent) <= len(str(MOST_MORE))
    try:
        more, by = int(sent) if readable else 0, researcher().name
        extend(site.database, site.served, site.clock, more, by=by, reason=reason)
    except InputError as error:
        return newcomers(error, reason), 422
    return redirect(url_for("research.newcomers"), 303)
