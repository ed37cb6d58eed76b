"""Bad submissions that a rehearsal tries on purpose: each must be refused and change nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import httpx

from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.forms import FormData
from studyapp.rehearsal.pages import BrokenPageError, Page
from studyapp.rehearsal.simulation.judgement import Judgement
from studyapp.rehearsal.simulation.sight import SeenTrial
from studyapp.rehearsal.visit import Visit
from studyapp.study.design.asking import AnswerKey
from studyapp.study.settings.study import Study


@dataclass(frozen=True, kw_only=True)
class Probe:
    """One bad submission, which changed nothing.

    Attributes
    ----------
    name : str
        What was wrong with it, in words for the researcher.
    status : int
        The server's answer.
    """

    name: str
    status: int


@dataclass(frozen=True, kw_only=True)
class Prober:
    """Sends what should be refused, and looks whether it was.

    Attributes
    ----------
    visit : Visit
        The participant's own visit.
    page : Page
        The page whose form is misused.
    target : str
        Where that form is sent to.
    stored : callable
        Returns everything that is stored of the participant.
    """

    visit: Visit
    page: Page
    target: str
    stored: Callable[[], object]

    def refused(self, name: str, data: FormData) -> Probe:
        """Send `data`, which must be refused with a client error and change nothing.

        Raises
        ------
        BrokenPageError
            If it was not refused, or stored.
        """
        return self._tried(name, data, harmless=False)

    def harmless(self, name: str, data: FormData) -> Probe:
        """Send `data`, which must be taken kindly and change nothing."""
        return self._tried(name, data, harmless=True)

    def refused_report(self, name: str, report: Mapping[str, object]) -> Probe:
        """Send a report of what was played, which must be refused and change nothing."""
        return self._sent(
            name, lambda: self.visit.client.post(self.target, json=report), harmless=False
        )

    def _tried(self, name: str, data: FormData, *, harmless: bool) -> Probe:
        return self._sent(
            name, lambda: self.visit.client.post(self.target, data=data), harmless=harmless
        )

    def _sent(self, name: str, send: Callable[[], httpx.Response], *, harmless: bool) -> Probe:
        before = self.stored()
        response = send()
        if self.stored() != before:
            raise BrokenPageError(self.page, f"was sent {name}, and stored it")
        if not (response.is_success if harmless else response.is_client_error):
            raise BrokenPageError(self.page, f"was sent {name}, answered {response.status_code}")
        return Probe(name=name, status=response.status_code)


def probe_trial(
    visit: Visit, page: Page, judgement: Judgement, *, study: Study, eyes: Eyes
) -> tuple[Page, tuple[Probe, ...]]:
    """Answer the trial of `page` well in the end, but try bad submissions before and after.

    Parameters
    ----------
    visit : Visit
        The participant's own visit.
    page : Page
        The page of a trial that is to be answered next, nothing of it watched yet.
    judgement : Judgement
        Good answers; each bad submission spoils something about them.
    study : Study
        Knows what goes together.
    eyes : Eyes
        Tells what is stored.

    Returns
    -------
    page : Page
        The page that follows.
    probes : tuple of Probe
        What was tried.

    Raises
    ------
    BrokenPageError
        If a bad submission was not refused, or changed what is stored.
    """
    form = page.answer_form
    good = page.filled(form, judgement.fields())
    trial = eyes.look(page).trial
    prober = Prober(
        visit=visit, page=page, target=page.target(form), stored=lambda: eyes.stored(page)
    )
    early = [*_unplayed(prober, page)]
    if study.watching.coverage > 0:
        early.append(prober.refused("answers before the videos were watched", good))
    for token in eyes.later_trials(page)[:1]:
        early.append(prober.refused("the trial that comes later", {**good, "trial": [token]}))
    visit.watch(page)
    refused = [prober.refused(name, data) for name, data in _spoilt(study, trial, judgement, good)]
    refused += _trouble(prober, page)
    following = visit.send(page, form, judgement.fields())
    other = {**good, **as_data(other_answers(judgement))}
    late = [
        prober.harmless("the same answers twice", good),
        prober.refused("other answers to an answered trial", other),
    ]
    return following, (*early, *refused, *late)


def _spoilt(
    study: Study, trial: SeenTrial, judgement: Judgement, good: FormData
) -> Iterator[tuple[str, FormData]]:
    """Yield what is wrong, and `good` spoilt so."""
    first = judgement.asks[0]
    yield "a value that is out of range", {**good, first.field: [str(max(first.values) + 1)]}
    yield "a value that is no number", {**good, first.field: ["A"]}
    yield "two values for one question", {**good, first.field: [str(v) for v in first.values[:2]]}
    for ask in {ask.question: ask for ask in judgement.asks}.values():
        without = {name: values for name, values in good.items() if name != ask.field}
        yield f"question {ask.question!r} without an answer", without
    yield "an answer that nobody asked for", {**good, f"{first.question}:99": ["1"]}
    reasoned = next((ask for ask in judgement.asks if ask.reasons), first)
    yield "a reason that is not offered", {**good, reasoned.reasons_field: ["no reason"]}
    second = dict.fromkeys(judgement.values, 2)
    if study.problem(trial, second):
        data = as_data(replace(judgement, values=second))
        yield "ranks that make no order", {**good, **data}
    yield "somebody else's trial", {**good, "trial": ["0" * len(good["trial"][0])]}


def _unplayed(prober: Prober, page: Page) -> Iterator[Probe]:
    """Report playing that makes no sense, or that is nobody's."""
    address = page.players[0].watched_address
    nobodys = address.rpartition("/")[0] + "/" + "0" * 32
    played = {"batch": 0, "intervals": [[0.0, 1.0]]}
    for name, target, report in (
        ("playing reported without intervals", address, {"batch": 0}),
        ("playing reported backwards", address, {"batch": 0, "intervals": [[1.0, 0.5]]}),
        ("playing reported under a number below 0", address, {**played, "batch": -1}),
        ("playing reported of nobody's video", nobodys, played),
    ):
        yield replace(prober, target=target).refused_report(name, report)


def _trouble(prober: Prober, page: Page) -> list[Probe]:
    """Say of videos that cannot be meant that they do not play; each one shown must offer it."""
    form = page.trouble_form
    offered = {value for name, value in form.buttons if name == "video"}
    if len(offered) != len(page.players):
        raise BrokenPageError(page, "does not let each of its videos be said not to play")
    prober = replace(prober, target=page.target(form))
    nobodys = "0" * len(form.trial)
    return [
        prober.refused("trouble with somebody else's trial", {"trial": [nobodys]}),
        prober.refused(
            "trouble with somebody else's video", {"trial": [form.trial], "video": [nobodys]}
        ),
    ]


def other_answers(judgement: Judgement) -> Judgement:
    """Return answers that are as good as those of `judgement`, and not the same."""
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


def as_data(judgement: Judgement) -> FormData:
    """Return the fields of answers as a browser would send them."""
    return {name: list(values) for name, values in judgement.fields().items()}
