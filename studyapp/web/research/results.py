"""Results; before the end, behind a page that says what looking costs and asks for a reason."""

from collections.abc import Sequence

from flask import abort, redirect, request, url_for
from flask.typing import ResponseReturnValue

from analysis.stats.multiple_testing import LEVEL, false_positive_rate
from studyapp.database.tables.researchers import Look
from studyapp.monitoring.counts import PlaceCounts
from studyapp.monitoring.overview import over_because, places_so_far
from studyapp.researchers.audit import latest_looks, log_look
from studyapp.researchers.interim_figures import stored_figures
from studyapp.researchers.logins import UNBLINDED_FOR, unblind, unblinding_reason
from studyapp.session.intake import is_closed
from studyapp.web.research.page import page, researcher, visitor_cookie
from studyapp.web.site import study_site


def results() -> ResponseReturnValue:
    """Show the results, and log the look; before the end, ask for a reason first."""
    site, token = study_site(), visitor_cookie()
    places = places_so_far(site.database, site.served, site.clock.now())
    over = over_because(site.database, site.study, places)
    reason = over or unblinding_reason(site.database, token or "", site.clock.now())
    if not reason:
        return _reason_page(places)
    figures = stored_figures(site.database, site.clock, "results", site.figures)
    # At the end, only numbers of all answers are shown; they may be due in a minute.
    is_due = bool(over and figures.answers and not figures.problem)
    awaited = not figures.is_current and (figures.is_computing or is_due)
    document = None if awaited else figures.contents
    if document is not None:
        with site.database.writing() as session:
            log_look(
                session,
                site.clock.now(),
                document.state,
                way="page",
                by=researcher().name,
                reason=reason,
            )
    return page(
        "results",
        figures=figures,
        awaited=awaited,
        document=document,
        looks=latest_looks(site.database),
        reason=reason,
        is_final=bool(over) and figures.is_current,
    )


def ask_for_results() -> ResponseReturnValue:
    """Log the reason, and go on to the results."""
    site, token, reason = study_site(), visitor_cookie(), request.form.get("reason", "")
    if token is None:
        abort(403)
    unblind(site.database, site.clock, token, by=researcher().name, reason=reason)
    return redirect(url_for("research.results"), 303)


def _reason_page(places: PlaceCounts) -> str:
    site = study_site()
    earlier_looks = latest_looks(site.database)
    return page(
        "unblind",
        looks=earlier_looks,
        places=places,
        is_closed=is_closed(site.database, site.study),
        level=LEVEL,
        without=_rate(earlier_looks, places, looking=False),
        looking=_rate(earlier_looks, places, looking=True),
        minutes=round(UNBLINDED_FOR.total_seconds() / 60),
    )


def _rate(earlier_looks: Sequence[Look], places: PlaceCounts, *, looking: bool) -> float:
    """Return the rate of false positives at the end, with a look now or without one."""
    sizes = {look.finished for look in earlier_looks if look.finished} | {places.wanted}
    if looking:
        sizes.add(places.done)
    return false_positive_rate(sorted(sizes - {0}))
