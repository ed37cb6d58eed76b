"""A simulated participant: takes the study as served, page by page, without a browser."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from threading import Event
from typing import Final

import httpx

from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.pages import BrokenPageError, Form, Page
from studyapp.rehearsal.population import Population
from studyapp.rehearsal.raters import Rater

SAME_PAGE_AT_MOST: Final = 3
"""A page that comes back this often, though it was answered, leads nowhere."""


class InterruptedRehearsal(Exception):  # noqa: N818 - it is no error
    """The rehearsal is to stop; what was answered is kept."""


@dataclass(frozen=True, kw_only=True)
class Visit:
    """What a browser would do for a participant: open, watch and send."""

    client: httpx.Client
    stop: Event
    speed: float

    def open(self, address: str) -> Page:
        """Return the page at `address`, after redirects."""
        return self._page(self.client.get(address))

    def send(self, form: Form, answers: dict[str, str] | None = None) -> Page:
        """Send `form` with `answers` and return the page that follows."""
        data = form.filled(answers)
        if self.stop.is_set():
            raise InterruptedRehearsal
        return self._page(self.client.post(form.action, data=data))

    def watch(self, page: Page) -> None:
        """Play the pair on `page` to its end on the rehearsal's clock, and report it.

        The report says no more than the truth: the interval that the clock let pass.
        """
        player = page.player()
        opening = self.client.get(player.source, headers={"Range": "bytes=0-1023"})
        kind = opening.headers.get("content-type", "")
        if opening.status_code != httpx.codes.PARTIAL_CONTENT or not kind.startswith("video/"):
            raise BrokenPageError(
                page,
                f"has a video that cannot be streamed (status {opening.status_code}, "
                f"{kind or 'no'} content type)",
            )
        if self.stop.wait(player.duration / self.speed):
            raise InterruptedRehearsal
        played = {"batch": 0, "intervals": [[0.0, player.duration]]}
        told = self.client.post(player.watched_address, json=played)
        if told.is_error:
            raise BrokenPageError(
                page, f"does not accept what was watched (status {told.status_code})"
            )

    def _page(self, response: httpx.Response) -> Page:
        page = Page(str(response.url), response.text)
        if response.is_error:
            raise BrokenPageError(page, f"answered with status {response.status_code}")
        return page


AnswerTrial = Callable[[Visit, Page, dict[str, str]], Page]
"""Answers the trial of a page and returns the page that follows."""


def answer_trial(visit: Visit, page: Page, answers: dict[str, str]) -> Page:
    """Watch the pair on `page`, send `answers`, and return the page that follows."""
    visit.watch(page)
    return visit.send(page.answer_form(), answers)


@dataclass(frozen=True, kw_only=True)
class Participant:
    """One simulated participant.

    Attributes
    ----------
    entrance : str
        The link it was given.
    questions : tuple of str
        What the study asks in every trial.
    about : mapping of field name to text
        What it says of itself wherever a page asks for it.
    population, seed
        Whom it is drawn from; the place it gets decides which rater it is.
    eyes : Eyes
        How it sees through the blinding.
    speed : float
        How fast the rehearsal's clock runs; it watches in that time.
    stop : Event
        Set when the rehearsal is to stop.
    answer_first : callable
        How it answers the first trial it comes to; by default as every other.
    """

    entrance: str
    questions: tuple[str, ...]
    about: Mapping[str, str]
    population: Population
    seed: int
    eyes: Eyes
    speed: float
    stop: Event
    answer_first: AnswerTrial = answer_trial

    def take_part(self, client: httpx.Client) -> str:
        """Go from the link to the end and return the completion code.

        A study session that was begun earlier is gone on with, if the server knows the link.

        Raises
        ------
        BrokenPageError
            If a page lacks what a person would need, or leads nowhere.
        InterruptedRehearsal
            If the rehearsal was stopped.
        """
        visit = Visit(client=client, stop=self.stop, speed=self.speed)
        page = visit.open(self.entrance)
        before: tuple[str, str] | None = None
        same = 0
        answer = self.answer_first
        while (code := page.completion_code) is None:
            step = (page.address, page.answer_form().trial if page.asks else "")
            same = same + 1 if step == before else 1
            if same > SAME_PAGE_AT_MOST:
                raise BrokenPageError(page, "comes back though it was filled in as it asks")
            before = step
            if not page.asks:
                page = visit.send(*self._about(page.next_form()))
                continue
            page = answer(visit, page, self._answers(page))
            answer = answer_trial
        return code

    def _about(self, form: Form) -> tuple[Form, dict[str, str]]:
        """Return `form` and what this participant answers of what it asks."""
        asked = {*form.choices, *form.lines}
        return form, {name: value for name, value in self.about.items() if name in asked}

    def _answers(self, page: Page) -> dict[str, str]:
        """Return this participant's answers to the pair on `page`."""
        sight = self.eyes.look(page)
        rater = Rater(population=self.population, seed=self.seed, name=sight.rater)
        return {name: str(rater.answer(sight.pair, name)) for name in self.questions}
