"""Every protocol's server refuses what no page offers, and stores none of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path

import httpx
import pytest
from bs4 import BeautifulSoup, Tag
from sqlalchemy import select

from studyapp.database.tables import Trial
from studyapp.rehearsal.pages import FormData, FormFields, Page, read_form
from studyapp.rehearsal.participant import Participant, Visit
from studyapp.rehearsal.simulation.raters import Judgement, SeenTrial
from studyapp.study.design.trial import AnswerKey
from studyapp.study.settings.questions import MAX_TEXT_LENGTH, FormQuestion
from studyapp.web.app import create_app
from studyapp.web.participants.participant import FORM_FIELD
from studyapp.web.site import EXTENSION
from tests.studyapp.rehearsal.protocol_studies import STUDIES, write_study
from tests.studyapp.rehearsal.steps import SPEED, browser, participant_of
from tests.support.studies.finished_study import write_short_video
from tests.support.studies.stored import everything_stored, opened

PLAYED = {"batch": 0, "intervals": [[0.0, 1.0]]}
LATER = {**PLAYED, "batch": 999}
FORMS = {
    "no answer to the question 'adult'",
    "an answer that excludes to the question 'adult'",
    "an answer that excludes to the question 'watched'",
    "too high a number to the question 'age'",
    "too long an answer to the question 'work'",
    "an answer that is not offered to the question 'often'",
    "digits that were not spoken",
}
"""What every study's forms give an occasion for."""


@dataclass(frozen=True, kw_only=True)
class Attacker(Participant):
    """Takes part as others do, and tries improper submissions on every kind of page.

    Of the trials, the first of each part of the study is attacked.

    Attributes
    ----------
    attempts : set of str
        What was tried.
    trials : list of (Page, Judgement)
        The trials that were answered.
    attacked : set of str
        Parts of the study.
    """

    attempts: set[str] = field(default_factory=set)
    trials: list[tuple[Page, Judgement]] = field(default_factory=list)
    attacked: set[str] = field(default_factory=set)

    def answer(self, visit: Visit, page: Page, judgement: Judgement) -> Page:
        """Answer the trial of `page`; before and after, try improper submissions."""
        self.trials.append((page, judgement))
        trial = self.eyes.look(page)
        if trial.part in self.attacked:
            return super().answer(visit, page, judgement)
        self.attacked.add(trial.part)
        client, target = visit.client, page.target(page.answer_form)
        good = page.fill(page.answer_form, judgement.fields())
        self._report_nonsense(client, page)
        self.send(422, "answers before the videos were watched", client, target, good)
        for later in self._later_trials(good["trial"][0])[:1]:
            # Trials of another part ask for other answers.
            status = 409 if later.part == trial.part else 422
            self.send(status, "a later trial", client, target, {**good, "trial": [later.token]})
        visit.watch(page)
        for status, attempt, spoilt in self._spoilt_answers(trial, judgement, good):
            self.send(status, attempt, client, target, spoilt)
        self._report_trouble(client, page)
        following = visit.send(page, page.answer_form, judgement.fields())
        self.send(200, "the same answers twice", client, target, good)
        other = {**good, **_data(other_answers(judgement))}
        self.send(409, "other answers to an answered trial", client, target, other)
        return following

    def fill(self, visit: Visit, page: Page, answers: FormFields) -> Page:
        """Fill in the form of `page`; before it, try improper answers, and afterwards it again."""
        good, target = page.fill(page.next_form, answers), page.target(page.next_form)
        for status, attempt, spoilt in self._spoilt_forms(page, good):
            self.send(status, attempt, visit.client, target, spoilt)
        following = visit.send(page, page.next_form, answers)
        self.send(200, f"the form of {page.heading!r} twice", visit.client, target, good)
        return following

    def attack_after_the_end(self, client: httpx.Client) -> None:
        """Send late submissions under one's own token."""
        page, judgement = self.trials[-1]
        answers = page.target(page.answer_form)
        session = answers.rpartition("/")[0]
        good = page.fill(page.answer_form, judgement.fields())
        trouble = {"trial": good["trial"], "video": [_videos_that_may_not_play(page)[0]]}
        other = {**good, **_data(other_answers(judgement))}
        nobodys = session.rpartition("/")[0] + "/" + "0" * 32 + "/answers"
        watched = page.players[0].watched_address
        self.send(200, "the last answers again after the end", client, answers, good)
        self.send(409, "other answers after the end", client, answers, other)
        self.send(409, "trouble after the end", client, f"{session}/unplayable", trouble)
        self.report(409, "playing reported after the end", client, watched, LATER)
        self.send(200, "beginning after the end", client, f"{session}/begin", {})
        self.send(409, "withdrawing after the end", client, f"{session}/withdraw", {})
        self.send(404, "answers of nobody", client, nobodys, good)

    def attack(self, other: Attacker, client: httpx.Client) -> None:
        """Mix what belongs to oneself with what belongs to `other`."""
        (page, judgement), (their_page, _) = self.trials[-1], other.trials[-1]
        own_address, theirs = (each.target(each.answer_form) for each in (page, their_page))
        good = page.fill(page.answer_form, judgement.fields())
        foreign = {**good, "trial": [their_page.answer_form.trial]}
        trouble = {"trial": good["trial"], "video": [_videos_that_may_not_play(their_page)[0]]}
        watched = their_page.players[0].watched_address.rpartition("/")[2]
        session = own_address.rpartition("/")[0]
        address = f"{session}/watched/{watched}"
        self.send(403, "answers at another's address", client, theirs, good)
        self.send(403, "answers to another's trial", client, own_address, foreign)
        self.send(409, "trouble with another's video", client, f"{session}/unplayable", trouble)
        self.report(403, "playing reported of another's video", client, address, LATER)

    def send(
        self, status: int, attempt: str, client: httpx.Client, address: str, data: FormData
    ) -> None:
        """Require that `data` is answered with a status, and changes nothing."""
        self._require(status, attempt, lambda: client.post(address, data=data))

    def report(
        self,
        status: int,
        attempt: str,
        client: httpx.Client,
        address: str,
        report: Mapping[str, object],
    ) -> None:
        """Require the same of a watch report."""
        self._require(status, attempt, lambda: client.post(address, json=report))

    def _require(self, status: int, attempt: str, post: Callable[[], httpx.Response]) -> None:
        before = everything_stored(self.eyes.database)
        self.attempts.add(attempt)
        assert post().status_code == status, attempt
        assert everything_stored(self.eyes.database) == before, f"{attempt} was stored"

    def _later_trials(self, token: str) -> list[Trial]:
        """Return the trials that come after the one with `token`."""
        with self.eyes.database.reading() as session:
            shown = session.scalars(select(Trial).where(Trial.token == token)).one()
            trials = shown.study_session.trials
            return [trial for trial in trials if trial.position > shown.position]

    def _spoilt_answers(
        self, trial: SeenTrial, judgement: Judgement, good: FormData
    ) -> Iterator[tuple[int, str, FormData]]:
        """Yield the expected status, the fault, and `good` with that fault."""
        first = judgement.asks[0]
        out_of_range = str(max(first.values) + 1)
        yield 422, "a value that is out of range", {**good, first.field: [out_of_range]}
        yield 422, "a value that is not a number", {**good, first.field: ["A"]}
        two = [str(value) for value in first.values[:2]]
        yield 422, "two values for one question", {**good, first.field: two}
        for ask in {ask.question: ask for ask in judgement.asks}.values():
            without = {name: values for name, values in good.items() if name != ask.field}
            yield 422, f"question {ask.question!r} without an answer", without
        yield 422, "an answer that nobody asked for", {**good, f"{first.question}:99": ["1"]}
        reasoned = next((ask for ask in judgement.asks if ask.reasons), first)
        yield 422, "a reason that is not offered", {**good, reasoned.reasons_field: ["no reason"]}
        second = dict.fromkeys(judgement.values, 2)
        if self.study.problem(trial, second):
            yield (
                422,
                "ranks that make no order",
                {**good, **_data(replace(judgement, values=second))},
            )
        yield 403, "somebody else's trial", {**good, "trial": ["0" * len(good["trial"][0])]}

    def _spoilt_forms(self, page: Page, good: FormData) -> Iterator[tuple[int, str, FormData]]:
        for stage in self.study.form.stages():
            for question in self.study.form.questions_at(stage):
                name = f"{FORM_FIELD}{question.name}"
                for status, attempt, value in _wrong(question) if name in good else ():
                    what = f"{attempt} to the question {question.name!r}"
                    yield status, what, {**good, name: [value]}
        if page.sounds:
            (name,) = page.next_form.questions
            others = "".join(str((int(digit) + 1) % 10) for digit in good[name][0])
            yield 422, "digits that were not spoken", {**good, name: [others]}
            yield 422, "no digits", {**good, name: [""]}

    def _report_nonsense(self, client: httpx.Client, page: Page) -> None:
        address = page.players[0].watched_address
        nobodys = address.rpartition("/")[0] + "/" + "0" * 32
        for status, attempt, target, report in (
            (422, "playing reported without intervals", address, {"batch": 0}),
            (422, "playing reported backwards", address, {"batch": 0, "intervals": [[1.0, 0.5]]}),
            (422, "playing reported under a number below 0", address, {**PLAYED, "batch": -1}),
            (403, "playing reported of nobody's video", nobodys, PLAYED),
        ):
            self.report(status, attempt, client, target, report)

    def _report_trouble(self, client: httpx.Client, page: Page) -> None:
        token = page.answer_form.trial
        target = page.target(page.answer_form).rpartition("/")[0] + "/unplayable"
        nobodys = "0" * len(token)
        assert len(_videos_that_may_not_play(page)) == len(page.players)
        strange = {"trial": [token], "video": [nobodys]}
        foreign = {"trial": [nobodys]}
        self.send(403, "trouble with somebody else's trial", client, target, foreign)
        self.send(422, "trouble with somebody else's video", client, target, strange)


def other_answers(judgement: Judgement) -> Judgement:
    """Return valid answers that differ from those of `judgement`."""
    up: dict[AnswerKey, int] = {}
    down: dict[AnswerKey, int] = {}
    for question in dict.fromkeys(ask.question for ask in judgement.asks):
        asks = [ask for ask in judgement.asks if ask.question == question]
        values = asks[0].values
        # Where these are ranks, both ways they make a whole order.
        rising = [values[index % len(values)] for index in range(max(2, len(asks)))]
        up.update({ask.key: value for ask, value in zip(asks, rising, strict=False)})
        down.update({ask.key: value for ask, value in zip(asks, rising[::-1], strict=False)})
    return replace(judgement, values=down if dict(judgement.values) == up else up)


def _wrong(question: FormQuestion) -> Iterator[tuple[int, str, str]]:
    """Yield answers that are invalid or screen the person out."""
    if question.required:
        yield 422, "no answer", ""
    match question.kind:
        case "text":
            yield 422, "too long an answer", "x" * (MAX_TEXT_LENGTH + 1)
        case "number":
            yield 422, "too high a number", str(question.high + 1)
        case _:
            yield 422, "an answer that is not offered", "no such answer"
    for choice in question.choices:
        if question.eligible and choice not in question.eligible:
            yield 403, "an answer that excludes", choice


def _videos_that_may_not_play(page: Page) -> list[str]:
    """Return the videos that can be reported on `page` as not playing."""
    soup = BeautifulSoup(page.html, "html.parser")
    form = soup.find("form", id="unplayable")
    assert isinstance(form, Tag)
    offered = read_form(soup, form).buttons
    return list(dict.fromkeys(value for name, value in offered if name == "video"))


def _data(judgement: Judgement) -> FormData:
    return {name: list(values) for name, values in judgement.fields().items()}


@pytest.mark.parametrize("name", STUDIES)
def test_improper_submissions_are_refused_on_every_kind_of_page_and_change_nothing(
    name: str, tmp_path: Path
) -> None:
    write_short_video(tmp_path / "short.mp4", seconds=1.0)
    folder = write_study(tmp_path / "study", name, tmp_path / "short.mp4")
    app = create_app(folder.root, rehearsal_speed=SPEED)
    with (
        closing(app.extensions[EXTENSION].database),
        opened(folder.rehearsal) as database,
    ):
        first = Attacker(**vars(participant_of(folder, database, "first")))
        second = replace(first, name="second", trials=[])
        with browser(app) as client:
            assert first.take_part(client)
            first.attack_after_the_end(client)
        with browser(app) as client:
            assert second.take_part(client)
            first.attack(second, client)
        with database.reading() as session:
            assert first.attacked == set(session.scalars(select(Trial.part)))
    assert first.attempts >= FORMS | {"a later trial", "a reason that is not offered"}
