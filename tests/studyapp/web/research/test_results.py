"""Results before the end: asked for with a reason, logged, and shown as interim."""

from __future__ import annotations

from typing import cast

import pytest
from flask import Flask

from studyapp.researchers.audit import latest_changes, latest_looks
from studyapp.web.research.page import figure, interval
from studyapp.web.site import site_of
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.support.figures_at_hand import FiguresAtHand
from tests.support.studies.taking_part_steps import Participant, SetClock

RESULTS = "/research/results"


@pytest.fixture
def figures(app: Flask, monkeypatch: pytest.MonkeyPatch) -> FiguresAtHand:
    monkeypatch.delenv("DATABASE_URL", raising=False)
    return cast(FiguresAtHand, site_of(app).figures)


def let_finish(app: Flask, clock: SetClock, *names: str) -> None:
    """Let participants finish who do not answer all alike."""
    site = site_of(app)
    for person, name in enumerate(names):
        participant = Participant(site.database, site.served, clock).enrol(name).begin()
        for trial in range(6):
            if participant.look().trial is None:
                break
            rhythm, emotion = (person + trial) % 5 - 2, (person * 2 + trial) % 5 - 2
            participant.take_trial({"rhythm": str(rhythm), "emotion": str(emotion)})
        assert participant.look().completion_code


def unblinded(log_in: LogIn, figures: FiguresAtHand, reason: str = "a video broke") -> str:
    """Return the page with results, of an analyst who has given a reason."""
    analyst = log_in("analyst")
    assert analyst.post(RESULTS, reason=reason).status_code == 303
    assert "being computed" in analyst.get(RESULTS).text
    figures.work()
    return analyst.get(RESULTS).text


def test_results_are_shown_once_a_reason_is_given_and_each_look_is_logged(
    log_in: LogIn, figures: FiguresAtHand
) -> None:
    let_finish(log_in.app, log_in.clock, "one", "two")
    analyst = log_in("analyst")

    before = analyst.get(RESULTS)
    unexplained = analyst.post(RESULTS, reason="  ")
    assert latest_looks(log_in.stored) == []
    explained = analyst.post(RESULTS, reason="a video <b>broke</b>")
    waiting = analyst.get(RESULTS)
    figures.work()
    shown = analyst.get(RESULTS)
    analyst.get(RESULTS)

    assert "rule based" not in before.text and "False positives" in before.text
    assert (unexplained.status_code, explained.status_code) == (422, 303)
    assert "being computed" in waiting.text and "rule based" not in waiting.text
    assert "Interim: 2 of 4 participants had finished" in " ".join(shown.text.split())
    assert "rule based against mismatched" in shown.words()
    assert "a video <b>broke</b>" in shown.soup.get_text()
    logged = [
        (each.at, each.way, each.researcher, each.reason) for each in latest_looks(log_in.stored)
    ]
    assert logged == [(log_in.clock.now(), "page", "Charles", "a video <b>broke</b>")] * 2
    so_far = [(each.finished, each.planned, each.answers) for each in latest_looks(log_in.stored)]
    assert so_far == [(2, 4, 24)] * 2
    events = [line.event for line in latest_changes(log_in.stored)][:3]
    assert events == ["results looked at", "results looked at", "results unblinded"]


def test_a_reason_holds_for_an_hour_in_one_browser_alone(
    log_in: LogIn, figures: FiguresAtHand
) -> None:
    let_finish(log_in.app, log_in.clock, "one", "two")
    analyst = log_in("analyst")
    elsewhere = ResearchBrowser(log_in.app)
    elsewhere.log_in("Charles")
    analyst.post(RESULTS, reason="a video broke")
    analyst.get(RESULTS)
    figures.work()

    assert "Interim" in analyst.get(RESULTS).text
    assert "Interim" not in elsewhere.get(RESULTS).text
    log_in.clock.advance(minutes=40)
    assert "Interim" in analyst.get(RESULTS).text
    log_in.clock.advance(minutes=21)
    assert "Interim" not in analyst.get(RESULTS).text


def test_at_the_end_results_are_final_and_nobody_is_asked_why(
    log_in: LogIn, figures: FiguresAtHand
) -> None:
    let_finish(log_in.app, log_in.clock, "one", "two", "three")
    analyst = log_in("analyst")
    site = site_of(log_in.app)
    participant = Participant(site.database, site.served, log_in.clock).enrol("four").begin()
    analyst.post("/research/newcomers/state", state="closed", reason="enough")
    assert "Results before the end" in analyst.get(RESULTS).text
    log_in.clock.advance(minutes=site.served.study.lease_minutes + 1)

    assert "being computed" in analyst.get(RESULTS).text
    figures.work()
    closed = analyst.get(RESULTS).words()
    assert "The study is closed: 3 of 4 participants finished. These are the final" in closed
    assert "Interim" not in closed and "You look because" not in closed
    for _ in range(6):
        participant.take_trial({"rhythm": "1", "emotion": "-1"})
    log_in.clock.advance(minutes=2)
    analyst.get(RESULTS)
    figures.work()
    everybody = analyst.get(RESULTS).words()

    assert "All 4 participants have finished" in everybody and "Interim" not in everybody
    logged = [(each.finished, each.reason) for each in latest_looks(log_in.stored)]
    assert logged == [(4, "everybody has finished"), (3, "the study is closed")]


def test_without_answers_nothing_is_computed_and_no_look_is_logged(
    log_in: LogIn, figures: FiguresAtHand
) -> None:
    owner = log_in("owner")
    owner.post(RESULTS, reason="curious")

    assert "Nobody has answered yet" in owner.get(RESULTS).text
    assert "Nobody has answered yet" in owner.get("/research/").text
    assert (figures.work(), latest_looks(log_in.stored)) == (0, [])


@pytest.mark.parametrize(
    ("value", "measure", "text"),
    [
        (0.634, "win_share", ".63"),
        (1.0, "own_speech", "1.00"),
        (-0.21, "", "−.21"),
        (-0.001, "", ".00"),
        (0.6, "mean_rating", "0.60"),
        (0.083, "rate", "8.3%"),
        (None, "win_share", "–"),
    ],
)
def test_numbers_are_written_as_in_the_report(value: float | None, measure: str, text: str) -> None:
    assert figure(value, measure) == text
    assert interval(value, value, measure) == ("–" if value is None else f"[{text}, {text}]")
