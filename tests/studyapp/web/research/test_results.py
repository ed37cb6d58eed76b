"""Results before the end: asked for with a reason, logged, and shown as interim."""

import math
from typing import cast

import pytest
from flask import Flask

from analysis.report.wording import number, share
from studyapp.researchers.audit import event_label, latest_changes, latest_looks
from studyapp.web.research.page import figure, interval
from studyapp.web.site import site_of
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.support.in_process_figures import InProcessFigures
from tests.support.studies.taking_part_steps import Participant

RESULTS = "/research/results"


@pytest.fixture
def figures(app: Flask) -> InProcessFigures:
    return cast(InProcessFigures, site_of(app).figures)


def let_finish(log_in: LogIn, *names: str) -> Participant:
    """Let participants finish with different answers, and return the last one."""
    site = site_of(log_in.app)
    for person, name in enumerate(names):
        participant = Participant(site.database, site.served, log_in.clock).enrol(name).begin()
        for trial in range(6):
            rhythm, emotion = (person + trial) % 5 - 2, (person * 2 + trial) % 5 - 2
            participant.take_trial({"rhythm": str(rhythm), "emotion": str(emotion)})
        assert participant.look().completion_code
    return participant


def test_results_are_shown_once_a_reason_is_given_and_each_look_is_logged(
    log_in: LogIn, figures: InProcessFigures
) -> None:
    let_finish(log_in, "one", "two")
    analyst = log_in("analyst")
    elsewhere = ResearchBrowser(log_in.app)
    elsewhere.log_in("Charles")

    before = analyst.get(RESULTS).text
    assert "rule based" not in before
    assert "does not exist more often" in before
    assert analyst.post(RESULTS, reason="  ").status_code == 409
    assert latest_looks(log_in.stored) == []
    assert analyst.post(RESULTS, reason="a video <b>broke</b>").status_code == 303
    waiting = analyst.get(RESULTS).text
    assert "being computed" in waiting and "rule based" not in waiting
    figures.work()
    shown = analyst.get(RESULTS).words()
    assert "Interim: 2 of 4 participants had finished" in shown
    assert "rule based against mismatched" in shown
    assert "a video <b>broke</b>" in shown
    (look,) = latest_looks(log_in.stored)
    by = (look.at, look.way, look.researcher, look.reason)
    assert by == (log_in.clock.now(), "page", "Charles", "a video <b>broke</b>")
    assert (look.finished, look.planned, look.answers) == (2, 4, 24)

    # The reason holds for an hour, in one browser alone; each look is logged.
    assert "Interim" not in elsewhere.get(RESULTS).text
    log_in.clock.advance(minutes=40)
    assert "Interim" in analyst.get(RESULTS).text
    log_in.clock.advance(minutes=21)
    assert "Interim" not in analyst.get(RESULTS).text
    events = [event_label(line) for line in latest_changes(log_in.stored)][:3]
    assert events == ["results looked at", "results looked at", "results unblinded"]


def test_at_the_end_results_need_no_reason(log_in: LogIn, figures: InProcessFigures) -> None:
    last = let_finish(log_in, "one", "two", "three").another().enrol("four").begin()
    analyst = log_in("analyst")
    analyst.post("/research/newcomers/state", state="closed", reason="enough")
    assert "The study is closed, and 1 still takes part." in analyst.get(RESULTS).words()
    assert "anyone who looks" in analyst.get("/research/").text
    log_in.clock.advance(minutes=last.served.study.lease_minutes + 1)

    assert "being computed" in analyst.get(RESULTS).text
    figures.work()
    closed = analyst.get(RESULTS).words()
    assert "The study is closed: 3 of 4 participants finished. These are the final" in closed
    assert "Interim" not in closed and "You look because" not in closed
    assert "the study is closed. What they prefer is on" in analyst.get("/research/").words()
    last.take_all()
    # Numbers from before the last participant are no final ones.
    assert "being computed" in analyst.get(RESULTS).text
    log_in.clock.advance(minutes=2)
    analyst.get(RESULTS)
    figures.work()
    everybody = analyst.get(RESULTS).words()

    assert "All 4 participants have finished" in everybody and "Interim" not in everybody
    looks = [(each.finished, each.reason) for each in latest_looks(log_in.stored)]
    assert looks == [(4, "everybody has finished"), (3, "the study is closed")]


def test_without_answers_nothing_is_computed_and_no_look_is_logged(
    log_in: LogIn, figures: InProcessFigures
) -> None:
    owner = log_in("owner")
    owner.post(RESULTS, reason="curious")

    assert "Nobody has answered yet" in owner.get(RESULTS).text
    assert "Nobody has answered yet" in owner.get("/research/").text
    owner.post("/research/newcomers/state", state="closed", reason="until Monday")
    assert "No more participants are expected" not in owner.get("/research/").text
    assert (figures.work(), latest_looks(log_in.stored)) == (0, [])


@pytest.mark.parametrize("value", [0.634, 1.0, -0.21, -0.001, 3.6])
def test_numbers_match_the_report(value: float) -> None:
    assert (figure(value), figure(value, "mean_rating")) == (share(value), number(value))
    assert interval(value, None) == figure(None) == share(math.nan)
