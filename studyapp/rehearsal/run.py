"""A whole rehearsal: the real server, and simulated participants who take the study through it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack, closing
from dataclasses import dataclass
from threading import Event
from typing import Final

from motion.errors import InputError
from studyapp.database.engine import Database, sqlite_url
from studyapp.rehearsal.browser import require_browser
from studyapp.rehearsal.crowd import Crowd
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.ledger import Ledger
from studyapp.rehearsal.participant import Participant
from studyapp.rehearsal.resumption import call_roster, let_time_pass, prepare
from studyapp.rehearsal.server import rehearsal_server
from studyapp.rehearsal.simulation.population import Population
from studyapp.session.served_study import ServedStudy
from studyapp.study.folder import StudyFolder
from studyapp.study.lock import held_alone
from studyapp.study.settings.study import Study

SPEED: Final = 100.0
"""How much faster than real a rehearsal's clock runs."""

WORKERS: Final = 8
"""How many simulated participants take part at the same time."""


@dataclass(frozen=True, kw_only=True)
class RehearsalResult:
    """What came of a rehearsal.

    Attributes
    ----------
    completed : int
        Participants who have their completion code, all runs of this rehearsal together.
    kept : int
        How many of them had it before this run.
    left : int
        Participants who left on the way, for good.
    note : str
        What became of an earlier rehearsal in the same folder; empty where there was none.
    """

    completed: int
    kept: int
    left: int
    note: str


def rehearse(
    folder: StudyFolder,
    *,
    participants: int | None = None,
    seed: int = 1,
    population: Population | None = None,
    speed: float = SPEED,
    workers: int = WORKERS,
    browsers: int = 0,
    on_done: Callable[[int, int], None] = lambda _done, _wanted: None,
) -> RehearsalResult:
    """Let simulated participants take the study over real HTTP.

    Their answers are kept in ``rehearsal.db``, their true preferences in ``rehearsal.json``.
    Interrupted and called again with the same study and seed, it goes on where it was.

    Parameters
    ----------
    folder : StudyFolder
        A study whose videos are rendered.
    participants : int, optional
        Of each arm: of each comparison with the reference, or of the study where everybody is
        asked about all conditions. As many as the study asks for by default, and no more.
    seed : int
        Decides the participants, what they prefer and every answer.
    population : Population, optional
        Whom to draw them from; `default_population` of the study by default.
    speed : float
        How much faster than real the rehearsal's clock runs; at least 1.
    workers : int
        How many take part at the same time; it changes no answer.
    browsers : int
        How many of those who come first take part in a real browser, in real time.
    on_done : callable
        Called with (finished participants, all participants).

    Raises
    ------
    InputError
        If the study is not ready or being rehearsed already, more participants are asked for
        than it has places, or a page lacks what a participant needs; or if a browser is
        wanted and there is none.
    """
    study = ServedStudy.read(folder.root).study
    count = _checked_count(folder, study, participants)
    if browsers:
        require_browser()
    busy = InputError(
        "this study is being rehearsed already",
        where=folder.root,
        remedy="Wait until the other 'motionjury rehearse' is done, or stop it",
    )
    with held_alone(folder.root, busy=busy), ExitStack() as opened:
        truth, note = prepare(folder, seed=seed, population=population)
        database = opened.enter_context(closing(Database.open(sqlite_url(folder.rehearsal))))
        roster = call_roster(database, count, truth)
        kept = len(roster.finished)
        on_done(roster.wanted - len(roster.remaining), roster.wanted)
        if roster.remaining:
            server = opened.enter_context(rehearsal_server(folder, speed=speed))
        # Who is excluded or leaves may open the place again, so that somebody else is awaited.
        while roster.remaining:
            let_time_pass(database, roster, study.lease_minutes)
            somebody = Participant(
                name="",
                study=study,
                population=truth.population,
                seed=truth.seed,
                eyes=Eyes(database),
                speed=speed,
                stop=Event(),
            )
            crowd = Crowd(
                like=somebody,
                ledger=Ledger(folder.acknowledged),
                server=server,
                in_browser=roster.remaining[:browsers],
            )
            crowd.take_part(roster, workers=workers, on_done=on_done)
            roster = call_roster(database, count, truth)
        let_time_pass(database, roster, study.lease_minutes)
    return RehearsalResult(
        completed=len(roster.finished),
        kept=kept,
        left=len(roster.gone),
        note=note,
    )


def _checked_count(folder: StudyFolder, study: Study, participants: int | None) -> int:
    """Return how many participants come in all, `participants` of them to each arm."""
    arms = study.arms
    if participants is None:
        return sum(arm.places for arm in arms)
    places = min(arm.places for arm in arms)
    if not 1 <= participants <= places:
        each = " of each comparison" if len(arms) > 1 else ""
        raise InputError(
            f"{participants} participants do not fit into the {places} places{each}",
            where=folder.definition,
            remedy="Ask for fewer, or raise the number of participants there",
        )
    return participants * len(arms)
