"""A simulated participant and its browser, which take the served study page by page."""

import ssl
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from threading import Event
from typing import Final

import httpx

from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.pages import BrokenPageError, Form, FormFields, Page
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.raters import Rater, judge
from studyapp.study.settings.study import Study
from studyapp.web.participants.participant import FORM_FIELD

REQUEST_SECONDS: Final = 60.0


def study_client(server: str) -> httpx.Client:
    """Return a client for one participant of the server at address `server`.

    Every request opens a new connection. A server closes idle connections after some seconds, as
    long as a participant may watch. A request sent at that moment would be lost, and only browsers
    retry it.
    """
    return httpx.Client(
        base_url=server,
        follow_redirects=True,
        timeout=REQUEST_SECONDS,
        limits=httpx.Limits(max_keepalive_connections=0),
        trust_env=False,
        # The loopback needs no certificates, and loading them takes longer than a visit.
        verify=ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT),
        headers={"Accept": "text/html"},
    )


class Departure(Exception):  # noqa: N818 - not an error
    """A participant has left.

    Attributes
    ----------
    returns : bool
        Whether the participant comes back later.
    """

    def __init__(self, *, returns: bool) -> None:
        super().__init__()
        self.returns = returns


class InterruptedRehearsal(Exception):  # noqa: N818 - not an error
    """The rehearsal stops; stored answers are kept."""


@dataclass(frozen=True, kw_only=True)
class Visit:
    """A browser window of a participant.

    Attributes
    ----------
    client : httpx.Client
        Follows redirects.
    stop : Event
        Set when the rehearsal stops.
    speed : float
        Speed of the rehearsal's clock.
    """

    client: httpx.Client
    stop: Event
    speed: float

    def wait(self, seconds: float) -> None:
        """Wait for `seconds` on the rehearsal's clock."""
        if self.stop.wait(seconds / self.speed):
            raise InterruptedRehearsal

    def open(self, address: str) -> Page:
        """Return the page at `address`, after redirects."""
        return _page(self.client.get(address))

    def send(self, page: Page, form: Form, answers: FormFields, *, twice: bool) -> Page:
        """Send `form` of `page` with `answers` and return the page that follows.

        Parameters
        ----------
        twice : bool
            Whether the button is pressed twice at once.

        Raises
        ------
        BrokenPageError
            If it is not accepted; of two clicks, both must be.
        """
        data = page.fill(form, answers)
        if self.stop.is_set():
            raise InterruptedRehearsal
        target = page.target(form)
        if not twice:
            return _page(self.client.post(target, data=data))
        with ThreadPoolExecutor(2) as pool:
            clicks = [pool.submit(self.client.post, target, data=data) for _ in range(2)]
            return [_page(click.result()) for click in clicks][-1]

    def watch(self, page: Page, *, share: float, thinks: float) -> None:
        """Play a share of the videos on `page` one after the other on the rehearsal's clock.

        Then think for so many seconds.
        """
        for player in page.players:
            self._stream(page, player.source, "video")
            self.wait(player.duration * share)
            played = {"batch": 0, "intervals": [[0.0, player.duration * share]]}
            response = self.client.post(player.watched_address, json=played)
            if response.is_error:
                raise BrokenPageError(
                    page, f"does not accept a report of watching (status {response.status_code})"
                )
        self.wait(thinks)

    def listen(self, page: Page) -> None:
        """Fetch the sounds on `page`."""
        for source in page.sounds:
            self._stream(page, source, "audio")

    def _stream(self, page: Page, source: str, kind: str) -> None:
        partial = self.client.get(source, headers={"Range": "bytes=0-1023"})
        content_type = partial.headers.get("content-type", "")
        is_kind = content_type.startswith(f"{kind}/")
        if partial.status_code != httpx.codes.PARTIAL_CONTENT or not is_kind:
            raise BrokenPageError(
                page,
                f"has {'a video' if kind == 'video' else 'a sound'} that cannot be streamed "
                f"(status {partial.status_code}, {content_type or 'no'} content type)",
            )


def _page(response: httpx.Response) -> Page:
    page = Page(str(response.url), response.text)
    if response.is_error:
        raise BrokenPageError(page, f"answered with status {response.status_code}")
    return page


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
    ledger : Ledger
        The record of what was acknowledged to participants.
    """

    name: str
    study: Study
    population: Population
    seed: int
    eyes: Eyes
    speed: float
    stop: Event
    ledger: Ledger

    @property
    def _entrance(self) -> str:
        """Its link to the study."""
        return f"/?PROLIFIC_PID={self.name}&STUDY_ID=rehearsal&SESSION_ID={self.name}"

    @cached_property
    def _about(self) -> FormFields:
        """Its answers to all forms."""
        return {
            f"{FORM_FIELD}{question.name}": (question.example,)
            for _, question in self.study.form.asked()
        }

    def take_part(self, client: httpx.Client, *, is_back: bool = False) -> str:
        """Take part from the link to the end, and return the completion code.

        An earlier study session is continued if the server knows the link. The ledger records
        each acknowledgement.

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
        if is_back:
            self.ledger.note(self.name, returned=True)
        visit = Visit(client=client, stop=self.stop, speed=self.speed)
        page = visit.open(self._entrance)
        before: tuple[str, str] | None = None
        same = 0
        reopened = twice = False
        while (code := page.completion_code) is None:
            trial = page.answer_form.trial if page.is_trial else ""
            step = (page.address, trial or page.next_form.action)
            same = same + 1 if step == before else 1
            if same > MAX_REPEATS:
                raise BrokenPageError(page, "comes back although it was answered")
            before = step
            if not page.is_trial:
                form = page.next_form
                page = visit.send(page, form, self._form_answers(visit, page), twice=twice)
                continue
            sight = self.eyes.look(page)
            position = sight.position
            rater = Rater(population=self.population, seed=self.seed, name=sight.rater)
            if rater.leaves_at(sight.trials) == position and not is_back:
                if rater.returns:
                    self.ledger.note(self.name, left=True)
                raise Departure(returns=rater.returns)
            twice = rater.kind == "double_clicking"
            if twice and not reopened:
                page, reopened = visit.open(self._entrance), True
                continue
            judgement = judge(self.study, rater, sight)
            share = rater.watches(self.study.watching.coverage)
            visit.watch(page, share=share, thinks=rater.thinks(position))
            page = visit.send(page, page.answer_form, judgement.fields(), twice=twice)
            self.ledger.answered(self.name, trial, judgement.values)
        self.ledger.note(self.name, code=code)
        return code

    def _form_answers(self, visit: Visit, page: Page) -> FormFields:
        """Listen to the sounds of `page`, and return this participant's answers to its form."""
        visit.listen(page)
        questions = page.next_form.questions
        known = {name: answer for name, answer in self._about.items() if name in questions}
        if not page.sounds:
            return known
        return known | dict.fromkeys(questions - set(known), (self.eyes.hear(page),))
