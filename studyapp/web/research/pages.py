"""All pages of researchers, with the right that each needs, which one guard asks for."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Final, Literal

from flask import Blueprint, abort, redirect, request, url_for
from flask.typing import ResponseReturnValue
from werkzeug.exceptions import HTTPException

from motion.errors import InputError
from studyapp.researchers.account import Right
from studyapp.web.research import accounts, motion_scenes, preview, progress, results
from studyapp.web.research.page import (
    PREFIX,
    PREFIXES,
    came_from_our_page,
    keep_visitor,
    problem_page,
    recognise,
    refusal_page,
    visitor,
    visitor_cookie,
)
from studyapp.web.site import study_site

READING: Final = ("GET", "HEAD", "OPTIONS")


def guard(
    needed: Mapping[str, Right | None], harmless: Collection[str] = ()
) -> Callable[[], ResponseReturnValue | None]:
    """Return what lets a request through, or answers it before its view is called.

    Parameters
    ----------
    needed : mapping of endpoint to Right or None
        The right that each page needs; None for pages that need no login. A page that is missing
        here is shown to nobody.
    harmless : collection of str
        Endpoints that change nothing, so that their forms need no code.
    """

    def check_visitor() -> ResponseReturnValue | None:
        recognise()
        endpoint = request.endpoint or ""
        is_harmless = request.method in READING or endpoint in harmless
        if not is_harmless and not came_from_our_page(visitor_cookie()):
            return problem_page(
                "This form did not come from a page of this server, or the page was too old",
                "Open the page again and fill the form in once more. The browser must accept "
                "this server's cookie.",
                403,
            )
        right = needed.get(endpoint)
        if right is None and endpoint in needed:
            return None
        account = visitor()
        if account is None:
            return redirect(url_for("research.login"), 303)
        if right is None or not account.may(right):
            return problem_page(
                "This page is not for your role", "An owner can give you another.", 403
            )
        return None

    return check_visitor


NAME: Final = "research"


@dataclass(frozen=True)
class Page:
    """One page.

    Attributes
    ----------
    method : {'GET', 'POST'}
    rule : str
        Its address below `PREFIX`.
    view : callable
        Answers requests; its name is the endpoint's.
    needs : Right or None
        The right that opens it; None for everybody.
    """

    method: Literal["GET", "POST"]
    rule: str
    view: Callable[..., ResponseReturnValue]
    needs: Right | None

    @property
    def endpoint(self) -> str:
        """The name by which addresses of the page are made."""
        return f"{NAME}.{self.view.__name__}"


def nowhere(rest: str) -> ResponseReturnValue:
    """Say that there is no such page, to researchers alone."""
    del rest
    abort(404)


NOWHERE: Final = Page("GET", "/<path:rest>", nowhere, Right.KEEP_ACCOUNT)

ROW: Final = "<int(max=2147483647)"
SECOND_FACTOR: Final = "/account/second-factor"
RESEARCHER: Final = f"/researchers/{ROW}:researcher_id>"
VIEWER: Final = "/viewer/<any('three.min.js', 'viewer.js', 'viewer.css'):filename>"
SESSION: Final = f"/study-sessions/{ROW}:number>"
SHOWN_TRIAL: Final = f"{SESSION}/{ROW}:position>"
TRIAL: Final = f"/preview/{ROW}:arm>/{ROW}:place>/{ROW}:position>"
TAKE: Final = f"{TRIAL}/take/preview"

OWN_PAGES: Final = (
    Page("GET", "/log-in", accounts.login, None),
    Page("POST", "/log-in", accounts.enter, None),
    Page("GET", "/join/<token>", accounts.link, None),
    Page("POST", "/join/<token>", accounts.use_link, None),
    Page("POST", "/log-out", accounts.log_out, Right.KEEP_ACCOUNT),
    Page("GET", "/account", accounts.own_account, Right.KEEP_ACCOUNT),
    Page("POST", "/account", accounts.change_own_password, Right.KEEP_ACCOUNT),
    Page("GET", SECOND_FACTOR, accounts.second_factor, Right.KEEP_ACCOUNT),
    Page("POST", SECOND_FACTOR, accounts.turn_on_second_factor, Right.KEEP_ACCOUNT),
    Page("POST", f"{SECOND_FACTOR}/off", accounts.turn_off_second_factor, Right.KEEP_ACCOUNT),
)
"""Logging in, links, and one's own account."""

RESEARCHERS_PAGES: Final = (
    Page("GET", "/researchers", accounts.researchers, Right.MANAGE),
    Page("POST", "/researchers/invite", accounts.invite_researcher, Right.MANAGE),
    Page("POST", f"/links/{ROW}:link_id>/take-back", accounts.take_link_back, Right.MANAGE),
    Page("POST", f"{RESEARCHER}/password", accounts.offer_password, Right.MANAGE),
    Page("POST", f"{RESEARCHER}/role", accounts.give_role, Right.MANAGE),
    Page("POST", f"{RESEARCHER}/shut-out", accounts.shut_researcher_out, Right.MANAGE),
    Page("POST", f"{RESEARCHER}/let-in", accounts.let_researcher_in, Right.MANAGE),
)
"""The researchers of a study or a desk."""

VIEWER_FILES: Final = (
    Page("GET", VIEWER, motion_scenes.viewer_file, Right.KEEP_ACCOUNT),
    Page("GET", "/viewer/avatars/<avatar>", motion_scenes.viewer_avatar, Right.KEEP_ACCOUNT),
)
"""Files for pages on which motion is turned around."""

REHEARSED_PAGES: Final = (
    Page("GET", "/", progress.overview, Right.WATCH),
    Page("GET", "/study-sessions", progress.study_sessions, Right.WATCH),
    Page("GET", SESSION, progress.study_session, Right.WATCH),
    Page("GET", f"{SHOWN_TRIAL}/{ROW}:video>.mp4", progress.shown_video, Right.WATCH),
    Page("GET", f"{SHOWN_TRIAL}/motion", progress.shown_motion, Right.WATCH),
    Page("GET", f"{SHOWN_TRIAL}/motion/{ROW}:scene>", progress.shown_scene, Right.WATCH),
)
"""Pages of the participants' data, and again of the rehearsal's."""

HARMLESS_PAGES: Final = (
    Page("POST", f"{TAKE}/watched/{ROW}:number>", preview.previewed_report, Right.WATCH),
    Page("POST", f"{TAKE}/<any(answers, unplayable):what>", preview.previewed_answers, Right.WATCH),
)
"""Pages that change nothing, so that their forms need no code."""

PAGES: Final = (
    *OWN_PAGES,
    *RESEARCHERS_PAGES,
    *VIEWER_FILES,
    *HARMLESS_PAGES,
    Page("POST", f"{SESSION}/exclusion", progress.decide_about, Right.STEER),
    Page("GET", "/changes", progress.changes, Right.READ),
    Page("GET", "/preview", preview.preview, Right.WATCH),
    Page("GET", f"{TRIAL}/", preview.previewed_page, Right.WATCH),
    Page("GET", f"{TRIAL}/media/{ROW}:number>.mp4", preview.previewed_video, Right.WATCH),
    Page("GET", f"{TRIAL}/motion", preview.previewed_motion, Right.WATCH),
    Page("GET", f"{TRIAL}/motion/{ROW}:scene>", preview.previewed_scene, Right.WATCH),
    Page("GET", f"{TRIAL}/static/<path:filename>", preview.previewed_file, Right.WATCH),
    Page("POST", "/try", preview.try_study, Right.WATCH),
    Page("POST", "/try/erase", preview.erase_tries, Right.STEER),
    Page("GET", "/newcomers", progress.newcomers, Right.STEER),
    Page("POST", "/newcomers/state", progress.steer_newcomers, Right.STEER),
    Page("POST", "/newcomers/more", progress.want_more, Right.STEER),
    Page("GET", "/results", results.results, Right.UNBLIND),
    Page("POST", "/results", results.ask_for_results, Right.UNBLIND),
    NOWHERE,
)


def research_pages() -> Blueprint:
    """Return the pages, each behind the guard."""
    pages = Blueprint(NAME, __name__, url_prefix=PREFIX)
    for page in PAGES:
        pages.add_url_rule(page.rule, view_func=page.view, methods=[page.method])
    for page, (data, prefix) in product(REHEARSED_PAGES, PREFIXES.items()):
        pages.add_url_rule(
            prefix + page.rule,
            view_func=page.view,
            methods=[page.method],
            defaults={"data": data},
        )
    needed = {page.endpoint: page.needs for page in (*PAGES, *REHEARSED_PAGES)}
    pages.before_request(guard(needed, {page.endpoint for page in HARMLESS_PAGES}))
    pages.after_request(keep_visitor)
    pages.context_processor(lambda: {"study": study_site().study})
    pages.register_error_handler(InputError, refuse)
    pages.register_error_handler(HTTPException, fail)
    return pages


def refuse(error: InputError) -> ResponseReturnValue:
    """Return the page that says why something cannot be done."""
    return refusal_page(error, 409)


def fail(error: HTTPException) -> ResponseReturnValue:
    """Return the page for what the server, or a browser, does not do."""
    if visitor_cookie() is None:
        # The guard may not have been asked yet, and no login may be replaced.
        recognise()
    status = error.code or 500
    if status == 404:
        return problem_page(
            "There is no such page", "Check the address, or go on from the overview.", status
        )
    return problem_page(
        error.name, "Open the page again; if this comes again, look at the server's log.", status
    )
