"""Results: before the end behind a page that says what looking costs, and asks why."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from typing import Final

from flask import abort, redirect, request, url_for
from flask.typing import ResponseReturnValue

from analysis.stats.multiple_testing import LEVEL, equally_spaced, false_positive_rate
from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.database.tables import Look
from studyapp.monitoring.counts import PlaceCounts
from studyapp.monitoring.overview import places_so_far
from studyapp.researchers.audit import looks, note_look
from studyapp.researchers.interim_figures import Document, kept_figures
from studyapp.researchers.logins import HOLDS, unblind, unblinded_because
from studyapp.session.intake import present_intake
from studyapp.session.served_study import ServedStudy
from studyapp.web.research.page import page, researcher, visitor_cookie
from studyapp.web.site import study_site

TABLED: Final = (1, 2, 3, 5, 10, 20)
"""Numbers of looks that the page tells the rate of false positives for."""


EVERYBODY: Final = "everybody has finished"
CLOSED: Final = "the study is closed"
"""Reasons to look that nobody has to give, for the log."""


def results() -> ResponseReturnValue:
    """Show results at the end, and before it to whoever has said why; log it; else ask why."""
    site, token = study_site(), visitor_cookie()
    over = over_because(site.database, site.served, site.clock.now())
    because = over or unblinded_because(site.database, token or "", site.clock.now())
    if not because:
        return _asking()
    kept = kept_figures(site.database, site.clock, "results", site.figures)
    awaited = kept.is_awaited and not kept.is_current
    document = None if awaited else Document.read(kept.document)
    if document is not None:
        with site.database.writing() as session:
            note_look(
                session,
                site.clock.now(),
                document.basis.state,
                way="page",
                by=researcher().name,
                reason=because,
            )
    return page(
        "results",
        kept=kept,
        awaited=awaited,
        found=document,
        looks=looks(site.database),
        because=because,
        is_final=bool(over),
    )


def over_because(database: Database, served: ServedStudy, now: datetime) -> str:
    """Return why nobody is awaited any more; empty where somebody is."""
    places = places_so_far(database, served, now)
    if not places.still_to_be_done:
        return EVERYBODY
    with database.reading() as session:
        closed = not served.study.open or present_intake(session).state == "closed"
    return CLOSED if closed and not places.active else ""


def ask_for_results() -> ResponseReturnValue:
    """Take the reason, and go on to the results."""
    site, token, reason = study_site(), visitor_cookie(), request.form.get("reason", "")
    if token is None:
        abort(403)
    try:
        unblind(site.database, site.clock, token, by=researcher().name, reason=reason)
    except InputError as error:
        return _asking(error, reason), 422
    return redirect(url_for("research.results"), 303)


def _asking(problem: InputError | None = None, reason: str = "") -> str:
    site = study_site()
    made = looks(site.database)
    places = places_so_far(site.database, site.served, site.clock.now())
    return page(
        "unblind",
        problem=problem,
        reason=reason,
        looks=made,
        places=places,
        level=LEVEL,
        rates=[(count, equally_spaced(count)) for count in TABLED],
        without=_rate(made, places, looking=False),
        looking=_rate(made, places, looking=True),
        minutes=round(HOLDS.total_seconds() / 60),
    )


def _rate(made: Sequence[Look], places: PlaceCounts, *, looking: bool) -> float:
    """Return the rate of false positives at the end, with a look now or without one."""
    seen = {look.finished for look in made if look.finished} | {places.wanted}
    if looking and places.done:
        seen.add(places.done)
    return false_positive_rate(sorted(seen - {0}))
