"""Places match the ledger after any sequence of participants' actions."""

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)

from studyapp.database.engine import Database
from studyapp.session.refusal import ConflictError, StudyFullError
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from tests.studyapp.session.ledger import Ledger, Person, good_value, stored_sessions
from tests.support.studies.emptying import empty
from tests.support.studies.taking_part_steps import Participant, SetClock
from tests.support.studies.three_arms import PRESENTATIONS, three_arms

WHO = st.integers(min_value=0, max_value=100)


class Schedule(RuleBasedStateMachine):
    """Arrivals, answers, pauses, returns, withdrawals, and changes of the number of places."""

    database: Database

    def __init__(self) -> None:
        super().__init__()
        empty(self.database)
        self.clock = SetClock()
        self.people: list[Person] = []
        self.arrivals = 0

    @initialize(places=st.integers(1, 3), withdrawn=st.sampled_from(["kept", "deleted"]))
    def open(self, places: int, withdrawn: str) -> None:
        self.withdrawn = withdrawn
        self.ledger = Ledger(arms=(), places=places)
        self.want(places)

    def want(self, places: int) -> None:
        self.served: ServedStudy = three_arms(places, withdrawn=self.withdrawn)
        open_study(self.database, self.served, self.clock)
        self.ledger.arms = [arm for arm, _ in self.served.arms]
        self.ledger.places = places

    @rule()
    def arrive(self) -> None:
        """A newcomer gets a place in a least filled arm, not counting inactive participants."""
        self.arrivals += 1
        name, ledger = f"person {self.arrivals}", self.ledger
        silent = ledger.silent(self.clock.now())
        counts = ledger.counts(without=silent)
        fills = [count for count in counts.values() if count < ledger.places]
        if not fills:
            with pytest.raises(StudyFullError):
                self.enrol(name)
            return
        token = self.enrol(name)
        stored = stored_sessions(self.database)[name]
        person = Person(
            name=name,
            token=token,
            place=stored.planned,
            trials=list(stored.answers),
            catch=stored.catch,
            last_active=stored.last_active,
        )
        for place in silent:
            del ledger.holders[place]
        arm, number = person.place
        assert counts[arm] == min(fills)
        assert number == next(n for n in range(100) if (arm, n) not in ledger.holders)
        ledger.holders[person.place] = person
        self.people.append(person)

    def enrol(self, name: str) -> str:
        return Participant(self.database, self.served, self.clock).enrol(name).token

    def browser(self, person: Person) -> Participant:
        return Participant(self.database, self.served, self.clock, person.token)

    @precondition(lambda self: self.people)
    @rule(who=WHO)
    def arrive_again(self, who: int) -> None:
        person = self.person(who)

        assert self.enrol(person.name) == person.token

    def person(self, who: int) -> Person:
        return self.people[who % len(self.people)]

    @precondition(lambda self: self.people)
    @rule(who=WHO)
    def return_and_look(self, who: int) -> None:
        self.look(self.person(who))

    def look(self, person: Person) -> bool:
        """View the page of `person`, and return whether they may continue."""
        situation = self.browser(person).look()
        if person.withdrawn:
            assert situation.state == "withdrawn"
        elif person.over:
            assert situation.state == "completed"
            assert situation.completion_code == person.code
        elif not self.ledger.come_back(person):
            assert situation.state == "lapsed"
            assert situation.trial is None
        else:
            person.last_active = self.clock.now()
            assert situation.state == ("started" if person.begun else "instructed")
            if person.begun:
                assert situation.trial is not None
                assert situation.trial.token == person.trials[len(person.answers)]
                assert situation.trial.position == len(person.answers) + 1
                person.shown = len(person.answers) + 1
            return True
        return False

    @precondition(lambda self: self.people)
    @rule(who=WHO, careless=st.booleans(), trials=st.integers(1, PRESENTATIONS))
    def take_trials(self, who: int, careless: bool, trials: int) -> None:
        for _ in range(trials):
            self.take(self.person(who), careless=careless)

    def take(self, person: Person, *, careless: bool) -> None:
        if not self.look(person):
            return
        if not person.begun:
            self.browser(person).begin()
            person.begun = True
            self.look(person)
        self.send_answer(person, careless=careless)

    @precondition(lambda self: self.people)
    @rule(who=WHO)
    def answer_an_old_page(self, who: int) -> None:
        """An answer after a pause keeps the place if it is free; otherwise nothing is stored."""
        person = self.person(who)
        if person.over or person.shown <= len(person.answers):
            return
        if self.ledger.come_back(person):
            self.send_answer(person, careless=False)
        else:
            with pytest.raises(ConflictError):
                self.send(person, len(person.answers), 1)

    def send_answer(self, person: Person, *, careless: bool) -> None:
        trial = person.trials[len(person.answers)]
        value = good_value(person.catch.get(trial, 2))
        self.send(person, len(person.answers), -value if careless else value)
        person.answers.append(-value if careless else value)
        person.last_active = self.clock.now()
        if person.over:
            person.code = self.browser(person).look().completion_code
            assert person.code
            if person.excluded:
                self.ledger.leave(person)

    def send(self, person: Person, trial: int, value: int) -> None:
        answers = {"rhythm": str(value), "emotion": str(value)}
        self.browser(person).answer(person.trials[trial], answers)

    @precondition(lambda self: self.people)
    @rule(who=WHO, changed=st.booleans())
    def send_the_last_answer_again(self, who: int, changed: bool) -> None:
        person = self.person(who)
        if not person.answers:
            return
        last = len(person.answers) - 1
        if changed:
            with pytest.raises(ConflictError, match="already answered"):
                self.send(person, last, -person.answers[last])
        else:
            self.send(person, last, person.answers[last])

    @precondition(lambda self: self.people)
    @rule(who=WHO)
    def withdraw(self, who: int) -> None:
        person = self.person(who)
        if person.over and not person.withdrawn:
            with pytest.raises(ConflictError, match="already finished"):
                self.browser(person).withdraw()
            return
        self.browser(person).withdraw()
        self.ledger.leave(person)
        person.withdrawn = True
        if self.withdrawn == "deleted":
            person.answers = []

    @rule(minutes=st.sampled_from([1, 20, 46]))
    def time_passes(self, minutes: int) -> None:
        self.clock.advance(minutes=minutes)

    @precondition(lambda self: self.people)
    @rule(who=WHO, newcomers=st.integers(1, 3))
    def pause_while_others_come(self, who: int, newcomers: int) -> None:
        person = self.person(who)
        self.time_passes(46)
        for _ in range(newcomers):
            self.arrive()
        self.look(person)

    @rule(places=st.integers(1, 3))
    def other_numbers_are_wanted(self, places: int) -> None:
        self.want(places)

    @invariant()
    def the_database_says_what_the_ledger_says(self) -> None:
        stored = stored_sessions(self.database).values()
        held = {place: person.token for place, person in self.ledger.holders.items()}
        assert {each.place: each.token for each in stored if each.place} == held
        assert {
            each.token: [value for values in each.answers.values() for value in values]
            for each in stored
        } == {person.token: person.answers for person in self.people}
        assert {each.token: each.code for each in stored} == {
            person.token: person.code for person in self.people
        }

    def teardown(self) -> None:
        """While there is demand, the arms come to differ by no more than one, and fill."""
        counts = self.ledger.counts(without=self.ledger.silent(self.clock.now()))
        uneven = sum(max(counts.values()) - count for count in counts.values())
        most = max(self.ledger.places, max(counts.values()))
        for newcomer in range(1 + sum(most - count for count in counts.values())):
            self.arrive()
            counts = self.ledger.counts()
            wanting = [count for count in counts.values() if count < self.ledger.places]
            if newcomer + 1 >= uneven and wanting:
                assert max(counts.values()) - min(counts.values()) <= 1
        assert min(self.ledger.counts().values()) >= self.ledger.places
        self.the_database_says_what_the_ledger_says()


@pytest.mark.slow
def test_places_and_answers_match_any_sequence_of_actions(database: Database) -> None:
    schedule = type("Schedule", (Schedule,), {"database": database})
    run_state_machine_as_test(schedule, settings=settings(max_examples=10, stateful_step_count=30))
