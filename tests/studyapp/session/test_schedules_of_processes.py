"""Several server processes at once give no place twice and lose no answer."""

from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from datetime import datetime, timedelta
from itertools import repeat

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studyapp.database.engine import Database
from studyapp.session.versions import open_study
from tests.studyapp.session.crowd_process import PLACES, Deed, Done, Step, crowd, do_round
from tests.studyapp.session.ledger import StoredSession, stored_sessions
from tests.support.studies.emptying import empty
from tests.support.studies.taking_part_steps import SetClock
from tests.support.studies.three_arms import LEASE_MINUTES, three_arms

PROCESSES = 4
PEOPLE = 14
ARMS = 3
ARRIVALS: tuple[Deed, ...] = ("arrive",)
ANYTHING: tuple[Deed, ...] = ("arrive", "look", "take trial", "take trial", "withdraw")

Sessions = dict[str, StoredSession]
Plan = tuple[int, list[list[Step]]]
"""How many minutes pass, and what each process does then."""


def rounds(deeds: Sequence[Deed]) -> st.SearchStrategy[Plan]:
    names = st.integers(1, PEOPLE).map("person {}".format)
    steps = st.tuples(names, st.sampled_from(deeds))
    shares = st.lists(
        st.lists(steps, min_size=2, max_size=6), min_size=PROCESSES, max_size=PROCESSES
    )
    return st.tuples(st.sampled_from([1, LEASE_MINUTES + 1]), shares)


def fills(sessions: Sessions, *, since: datetime | None = None) -> list[int]:
    """Return how many places of each arm are held, the fewest first.

    With `since`, places of unfinished participants who were inactive since then are left out.
    """
    counts = Counter(
        each.place[0]
        for each in sessions.values()
        if each.place
        and not (since is not None and each.is_unfinished and each.last_active < since)
    )
    return sorted([*counts.values(), *[0] * (ARMS - len(counts))])


def filled_up(counts: Sequence[int], newcomers: int) -> list[int]:
    """Return `counts` after each newcomer has gone where there are fewest."""
    filled = list(counts)
    for _ in range(newcomers):
        filled[filled.index(min(filled))] += 1
    return sorted(filled)


def check(before: Sessions, after: Sessions, done: list[Done]) -> None:
    """Check what must be so after any round."""
    held = [each.place for each in after.values() if each.place]
    assert len(held) == len(set(held))
    for name, stored in after.items():
        assert stored.place in (None, stored.planned)
        assert (stored.code is None or stored.place) and not (stored.is_withdrawn and stored.place)
        assert all(len(values) <= 1 for values in stored.answers.values())
        answered = [bool(values) for values in stored.answers.values()]
        assert answered == sorted(answered, reverse=True)
        if name in before:
            assert stored.planned == before[name].planned
            assert list(stored.answers) == list(before[name].answers)
            earlier = {t: values for t, values in before[name].answers.items() if values}
            assert earlier.items() <= stored.answers.items()
    for deed in done:
        who = after.get(deed.name)
        if deed.token:
            assert who is not None
            assert who.token == deed.token
        if who is not None and deed.outcome == "answered":
            assert who.answers[deed.trial] == [deed.value]
        if who is not None and deed.outcome in ("answered", "going on"):
            # They were there in this round: their place did not count as inactive.
            assert who.place is not None or who.is_withdrawn
    if any(deed.outcome == "full" for deed in done):
        left = sum(deed.outcome == "withdrawn" for deed in done)
        assert len(held) + left >= ARMS * PLACES


@pytest.fixture(scope="module")
def processes() -> Iterator[ProcessPoolExecutor]:
    with crowd(PROCESSES) as started:
        yield started


@pytest.mark.slow
def test_several_processes_never_share_a_place_or_lose_an_answer(
    processes: ProcessPoolExecutor, database: Database, database_url: str
) -> None:
    served, clock = three_arms(PLACES), SetClock()

    @settings(max_examples=6)
    @given(plans=st.lists(rounds(ARRIVALS) | rounds(ANYTHING), min_size=3, max_size=5))
    def run(plans: list[Plan]) -> None:
        empty(database)
        open_study(database, served, clock)
        after = stored_sessions(database)
        for minutes, shares in plans:
            clock.advance(minutes=minutes)
            before, since = after, clock.now() - timedelta(minutes=LEASE_MINUTES)
            rest = repeat(database_url), repeat(clock.now()), shares
            done = [each for share in processes.map(do_round, *rest) for each in share]
            after = stored_sessions(database)
            check(before, after, done)
            newcomers = len(after) - len(before)
            if newcomers and all(deed.deed == "arrive" for deed in done):
                assert fills(after) == filled_up(fills(before, since=since), newcomers)

    run()
