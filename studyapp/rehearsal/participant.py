"""A simulated participant, who takes the served study page by page."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from threading import Event
from typing import Final

import httpx

from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.pages import BrokenPageError, FormFields, Page
from studyapp.rehearsal.simulation.judgement import Conduct, Judgement, judge
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.raters import Rater, Sight
from studyapp.rehearsal.visit import Departure, Visit
from studyapp.study.settings.study import Study
from studyapp.web.participants.participant import FORM_FIELD

MAX_REPEATS: Final = 3
"""How often an answered page may come back."""


@dataclass(frozen=True, kw_only=True)
class Participant:
    """A simulated participant.

    Attributes
    ----------
    name : str
        Its id at the recruiter.
    study : Study
        The study.
    population, seed
        Determine the raters; its place decides which one it is.
    eyes : Eyes
        Look up what its pages show.
    speed : float
        Speed of the rehearsal's clock.
    stop : Event
        Set when the rehearsal stops.
    ledger : Ledger or None
        The record of acknowledged answers.
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
        """Its link to the study."""
        return f"/?PROLIFIC_PID={self.name}&STUDY_ID=rehearsal&SESSION_ID={self.name}"

    @cached_property
    def about(self) -> FormFields:
        """Its answers to all forms."""
        return {
            f"{FORM_FIELD}{question.name}": (question.example,)
            for stage in self.study.form.stages()
            for question in self.study.form.questions_at(stage)
        }

    def take_part(self, client: httpx.Client, *, is_back: bool = False) -> str:
        """Take part from the link to the end, and return the completion code.

        An earlier study session is continued if the server knows the link.

        Parameters
        ----------
        is_back : bool
            Whether it has come back, and does not leave again.

        Raises
        ------
        Departure
            If it leaves.
        BrokenPageError
            If a page lacks something that a participant needs, or comes back repeatedly.
        InterruptedRehearsal
            If the rehearsal was stopped.
        """
        visit = Visit(client=client, stop=self.stop, speed=self.speed)
        page = visit.open(self.entrance)
        before: tuple[str, str] | None = None
        same = 0
        reopened = False
        while (code := page.completion_code) is None:
            trial = page.answer_form.trial if page.is_trial else ""
            step = (page.address, trial or page.next_form.action)
            same = same + 1 if step == before else 1
            if same > MAX_REPEATS:
                raise BrokenPageError(page, "comes back although it was answered")
            before = step
            if not page.is_trial:
                page = self.fill(visit, page, self.form_answers(visit, page))
                continue
            sight = self.eyes.look(page)
            position = sight.trial.position
            conduct = self.conduct(sight)
            if conduct.leaves_at == position and not is_back:
                raise Departure(returns=conduct.returns)
            if conduct.clicks_twice and not reopened:
                page, reopened = visit.open(self.entrance), True
                continue
            visit = replace(
                visit,
                watches=conduct.watches,
                thinks=conduct.thinks(position),
                clicks_twice=conduct.clicks_twice,
            )
            judgement = self.judgement(sight)
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

    def form_answers(self, visit: Visit, page: Page) -> FormFields:
        """Listen to the sounds of `page`, and return this participant's answers to its form."""
        visit.listen(page)
        questions = page.next_form.questions
        known = {name: answer for name, answer in self.about.items() if name in questions}
        if not page.sounds:
            return known
        return known | dict.fromkeys(sorted(questions - set(known)), (self.eyes.hear(page),))

    def judgement(self, sight: Sight) -> Judgement:
        """Return this participant's answers to a trial."""
        return judge(self.study, self._rater(sight), sight.trial)

    def conduct(self, sight: Sight) -> Conduct:
        """Return how this participant takes part, given a trial."""
        return Conduct(
            rater=self._rater(sight), trials=sight.trials, coverage=self.study.watching.coverage
        )

    def _rater(self, sight: Sight) -> Rater:
        return Rater(population=self.population, seed=self.seed, name=sight.rater)
