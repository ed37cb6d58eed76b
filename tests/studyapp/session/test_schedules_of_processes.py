"""Several server processes at once give no place twice and lose no answer."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sqlalchemy import select

from studyapp.database.engine import Database
from studyapp.database.tables import StudySession
from studyapp.session.versions import open_study
from tests.studyapp.session.crowd_process import Crowd, Deed, Done, Round, Step
from tests.studyapp.session.ledger import PlaceKey
from tests.support.studies.emptying import empty
from tests.support.studies.taking_part_steps import SetClock
from tests.support.studies.three_arms import LEASE_MINUTES, three_arms

PROCESSES = 4
PEOPLE = 14
PLACES = 3
ARMS = 3
ARRIVALS: tuple[Deed, ...] = ("arrive",)
ANYTHING: tuple[Deed, ...] = ("arrive", "look", "take trial", "take trial", "withdraw")

Plan = tuple[int, list[list[Step]]]
"""How many minutes pass, and what each process does then."""


def rounds(deeds: Sequence[Deed]) -> st.SearchStrategy[Plan]:
    steps = st.builds(
        Step,
        name=st.integers(1, PEOPLE).map("person {}".format),
        deed=st.sampled_from(deeds),
    )
    shares = st.lists(
        st.lists(steps, min_size=2, max_size=6), min_size=PROCESSES, max_size=PROCESSES
    )
    return st.tuples(st.sampled_from([1, LEASE_MINUTES + 1]), shares)


@dataclass(frozen=True, kw_only=True)
class Known:
    """A study session as it is stored."""

    token: str
    planned: PlaceKey
    place: PlaceKey | None
    unfinished: bool
    withdrawn: bool
    last_active: datetime
    answers: dict[str, list[int]]


def read(database: Database) -> dict[str, Known]:
    """Return every study session by its name."""
    with database.reading() as session:
        return {
            str(known.visit): Known(
                token=known.token,
                planned=(known.arm, known.number or 0),
                place=(known.place.arm, known.place.number) if known.place else None,
                unfinished=known.completed_at is None and known.withdrawn_at is None,
                withdrawn=known.withdrawn_at is not None,
                last_active=known.last_active_at,
                answers={
                    trial.token: [
                        given.value for given in trial.responses if given.question == "rhythm"
                    ]
                    for trial in known.trials
                },
            )
            for known in session.scalars(select(StudySession))
        }


def fills(people: dict[str, Known], *, since: datetime | None = None) -> list[int]:
    """Return how many places of each arm are held, the fewest first.

    With `since`, the places of the unfinished who have done nothing since then are left out.
    """
    counts = Counter(
        known.place[0]
        for known in people.values()
        if known.place
        and not (since is not None and known.unfinished and known.last_active < since)
    )
    return sorted([*counts.values(), *[0] * (ARMS - len(counts))])


def filled_up(counts: Sequence[int], newcomers: int) -> list[int]:
    """Return what becomes of `counts` when each newcomer goes where there are fewest."""
    filled = list(counts)
    for _ in range(newcomers):
        filled[filled.index(min(filled))] += 1
    return sorted(filled)


def check(before: dict[str, Known], after: dict[str, Known], done: list[Done]) -> None:
    """Check what must be so after any round."""
    held = [known.place for known in after.values() if known.place]
    assert len(held) == len(set(held))
    for name, known in after.items():
        assert known.place in (None, known.planned)
        assert known.place is None or not known.withdrawn
        if not known.unfinished and not known.withdrawn:
            assert known.place is not None
        answered = list(known.answers.values())
        assert all(len(values) <= 1 for values in answered)
        given = [bool(values) for values in answered]
        assert given == sorted(given, reverse=True)
        if name in before:
            assert known.planned == before[name].planned
            assert list(known.answers) == list(before[name].answers)
            stored = {t: values for t, values in before[name].answers.items() if values}
            assert stored.items() <= known.answers.items()
    for deed in done:
        who = after.get(deed.step.name)
        if deed.token:
            assert who is not None
            assert who.token == deed.token
        if who is not None and deed.outcome == "answered":
            assert who.answers[deed.trial] == [deed.value]
        if who is not None and deed.outcome in ("answered", "going on"):
            # They were there in this round: nobody took their place for silent.
            assert who.place is not None or who.withdrawn
    if any(deed.outcome == "full" for deed in done):
        left = sum(deed.outcome == "withdrawn" for deed in done)
        assert len(held) + left >= ARMS * PLACES


@pytest.fixture(scope="module")
def crowd() -> Iterator[Crowd]:
    with Crowd(PROCESSES) as started:
        yield started


@pytest.mark.slow
def test_no_place_is_given_twice_and_no_answer_lost_by_several_processes(
    crowd: Crowd, database: Database, database_url: str
) -> None:
    served, clock = three_arms(PLACES), SetClock()

    @settings(max_examples=6)
    @given(plans=st.lists(rounds(ARRIVALS) | rounds(ANYTHING), min_size=3, max_size=5))
    def run(plans: list[Plan]) -> None:
        empty(database)
        open_study(database, served, clock)
        after = read(database)
        for minutes, shares in plans:
            clock.advance(minutes=minutes)
            before, since = after, clock.now() - timedelta(minutes=LEASE_MINUTES)
            done = crowd.do(
                [
                    Round(url=database_url, places=PLACES, moment=clock.now(), steps=tuple(steps))
                    for steps in shares
                ]
            )
            after = read(database)
            check(before, after, done)
            newcomers = len(after) - len(before)
            if newcomers and all(deed.step.deed == "arrive" for deed in done):
                assert fills(after) == filled_up(fills(before, since=since), newcomers)

    run()
