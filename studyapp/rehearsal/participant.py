"""A simulated participant: takes the study as served, page by page, without a browser."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from threading import Event
from typing import Final

import httpx

from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.forms import FormFields
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.simulation.judgement import Conduct, Judgement, judge
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.raters import Rater, Sight
from studyapp.rehearsal.visit import Departure, Visit
from studyapp.study.settings.study import Study
from studyapp.web.participants.participant import FORM_FIELD

SAME_PAGE_AT_MOST: Final = 3
"""A page that comes back this often, though it was answered, leads nowhere."""


@dataclass(frozen=True, kw_only=True)
class Participant:
    """One simulated participant.

    Attributes
    ----------
    name : str
        What the recruiter calls it.
    study : Study
        What it takes part in.
    population, seed
        Whom it is drawn from; the place it gets decides which rater it is.
    eyes : Eyes
        How it sees through the blinding.
    speed : float
        How fast the rehearsal's clock runs; it watches in that time.
    stop : Event
        Set when the rehearsal is to stop.
    ledger : Ledger or None
        Where it notes what it was told is stored.
    """

    name: str
    study: Study
    population: Population
    seed: int
    eyes: Eyes
    speed: float
    stop: Event
    ledger: Ledger | None = None

    @property
    def entrance(self) -> str:
        """The link it was given."""
        return f"/?PROLIFIC_PID={self.name}&STUDY_ID=rehearsal&SESSION_ID={self.name}"

    @cached_property
    def about(self) -> FormFields:
        """What it says of itself wherever a page asks for it."""
        return {
            f"{FORM_FIELD}{question.name}": (question.example,)
            for stage in self.study.form.stages()
            for question in self.study.form.questions_at(stage)
        }

    def take_part(self, client: httpx.Client, *, is_back: bool = False) -> str:
        """Go from the link to the end and return the completion code.

        A study session that was begun earlier is gone on with, if the server knows the link.

        Parameters
        ----------
        is_back : bool
            Whether it has been away already, so that it stays now.

        Raises
        ------
        Departure
            If it leaves on the way.
        BrokenPageError
            If a page lacks what a person would need, or leads nowhere.
        InterruptedRehearsal
            If the rehearsal was stopped.
        """
        visit = Visit(client=client, stop=self.stop, speed=self.speed)
        page = visit.open(self.entrance)
        before: tuple[str, str] | None = None
        same = 0
        came_once_more = False
        while (code := page.completion_code) is None:
            trial = page.answer_form.trial if page.asks else ""
            step = (page.address, trial or page.next_form.action)
            same = same + 1 if step == before else 1
            if same > SAME_PAGE_AT_MOST:
                raise BrokenPageError(page, "comes back though it was filled in as it asks")
            before = step
            if not page.asks:
                page = self.fill(visit, page, self.say(visit, page))
                continue
            sight = self.eyes.look(page)
            position = sight.trial.position
            conduct = self.conduct(sight)
            if conduct.leaves_at == position and not is_back:
                raise Departure(returns=conduct.returns)
            if conduct.clicks_twice and not came_once_more:
                page, came_once_more = visit.open(self.entrance), True
                continue
            visit = replace(
                visit,
                watches=conduct.watches,
                thinks=conduct.thinks(position),
                clicks_twice=conduct.clicks_twice,
            )
            judgement = self.judged(sight)
            page = self.answer(visit, page, judgement)
            if self.ledger is not None:
                self.ledger.answered(self.name, trial, judgement.values)
        if self.ledger is not None:
            self.ledger.completed(self.name, code)
        return code

    def answer(self, visit: Visit, page: Page, judgement: Judgement) -> Page:
        """Watch the videos on `page`, send the answers, and return the page that follows."""
        visit.watch(page)
        return visit.send(page, page.answer_form, judgement.fields())

    def fill(self, visit: Visit, page: Page, answers: FormFields) -> Page:
        """Send the form of `page` and return the page that follows."""
        return visit.send(page, page.next_form, answers)

    def say(self, visit: Visit, page: Page) -> FormFields:
        """Return what this participant answers of what the form of `page` asks, having listened."""
        visit.listen(page)
        asked = page.next_form.asked
        known = {name: said for name, said in self.about.items() if name in asked}
        if not page.sounds:
            return known
        return known | dict.fromkeys(sorted(asked - set(known)), (self.eyes.hear(page),))

    def judged(self, sight: Sight) -> Judgement:
        """Return this participant's answers to a trial that it has seen."""
        return judge(self.study, self._rater(sight), sight.trial)

    def conduct(self, sight: Sight) -> Conduct:
        """Return how this participant takes part, as far as it is known once it sees a trial."""
        return Conduct(
            rater=self._rater(sight), trials=sight.trials, coverage=self.study.watching.coverage
        )

    def _rater(self, sight: Sight) -> Rater:
        return Rater(population=self.population, seed=self.seed, name=sight.rater)
