"""A whole rehearsal: the real server, and simulated participants who take the study through it."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack, closing
from dataclasses import dataclass
from functools import partial
from typing import Final

from motion.errors import InputError
from studyapp.database.engine import Database, sqlite_url
from studyapp.rehearsal.browser import require_browser
from studyapp.rehearsal.connection import study_client
from studyapp.rehearsal.crowd import Crowd
from studyapp.rehearsal.examiner import Examiners
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.late_probes import probe_finished
from studyapp.rehearsal.ledger import Ledger
from studyapp.rehearsal.probes import Probe
from studyapp.rehearsal.record import Truth
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
    probes : tuple of Probe
        Bad submissions that were tried in this run; they changed nothing.
    truth : Truth
        What the participants were given to prefer.
    note : str
        What became of an earlier rehearsal in the same folder; empty where there was none.
    seconds : float
        How long it took.
    """

    completed: int
    kept: int
    left: int
    probes: tuple[Probe, ...]
    truth: Truth
    note: str
    seconds: float


def rehearse(
    folder: StudyFolder,
    *,
    participants: int | None = None,
    seed: int = 1,
    population: Population | None = None,
    speed: float = SPEED,
    workers: int = WORKERS,
    browsers: int = 0,
    on_done: Callable[[int, int], None] | None = None,
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
    on_done : callable, optional
        Called with (finished participants, all participants).

    Raises
    ------
    InputError
        If the study is not ready or being rehearsed already, more participants are asked for
        than it has places, a page lacks what a participant needs, or something bad is not
        refused; or if a browser is wanted and there is none.
    """
    started = time.monotonic()
    study = ServedStudy.read(folder.root).study
    count = _checked_count(folder, study, participants)
    if browsers:
        require_browser()
    with only_rehearsal(folder), ExitStack() as opened:
        truth, note = prepare(folder, seed=seed, population=population)
        database = opened.enter_context(closing(Database.open(sqlite_url(folder.rehearsal))))
        roster = call_roster(database, count, truth)
        kept = len(roster.finished)
        show = on_done or _show_nothing
        show(roster.wanted - len(roster.remaining), roster.wanted)
        examiners = Examiners()
        came = bool(roster.remaining)
        if came:
            server = opened.enter_context(rehearsal_server(folder, speed=speed))
        # Who is excluded or leaves may open the place again, so that somebody else is awaited.
        while roster.remaining:
            let_time_pass(database, roster, study.lease_minutes)
            there = roster.wanted - len(roster.remaining)
            crowd = Crowd(
                study=study,
                truth=truth,
                eyes=Eyes(database),
                ledger=Ledger(folder.acknowledged),
                server=server,
                speed=speed,
                examiners=examiners,
                in_browser=frozenset(roster.remaining[:browsers]),
            )
            crowd.take_part(
                roster,
                workers=workers,
                on_done=partial(_show_more, show, there=there, wanted=roster.wanted),
            )
            roster = call_roster(database, count, truth)
        let_time_pass(database, roster, study.lease_minutes)
        if came:
            with study_client(server) as client:
                examiners.probes.extend(probe_finished(client, study, Eyes(database)))
    return RehearsalResult(
        completed=len(roster.finished),
        kept=kept,
        probes=tuple(examiners.probes),
        left=len(roster.gone),
        truth=truth,
        note=note,
        seconds=time.monotonic() - started,
    )


def _show_more(show: Callable[[int, int], None], done: int, *, there: int, wanted: int) -> None:
    """Show how many have finished, those who were there before included."""
    show(there + done, wanted)


def _show_nothing(_done: int, _total: int) -> None:
    """Take no notice of progress."""


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


def only_rehearsal(folder: StudyFolder) -> AbstractContextManager[None]:
    """Keep other rehearsals of `folder` away during the block.

    Raises
    ------
    InputError
        If the study is being rehearsed already.
    """
    return held_alone(
        folder.root,
        busy=InputError(
            "this study is being rehearsed already",
            where=folder.root,
            remedy="Wait until the other 'motionjury rehearse' is done, or stop it",
        ),
    )
