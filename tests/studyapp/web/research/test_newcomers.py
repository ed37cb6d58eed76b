from __future__ import annotations

from flask import Flask

from studyapp.database.engine import Database
from studyapp.session.arrival.intake_decisions import decided
from tests.studyapp.web.research.conftest import LogIn


def test_a_study_is_paused_resumed_extended_and_closed_with_reasons(
    app: Flask, log_in: LogIn, stored: Database
) -> None:
    analyst = log_in("analyst")
    newcomers = "/research/newcomers"
    start = {"visit": "v" * 32}
    assert "New participants are admitted" in analyst.get(newcomers).text

    unexplained = analyst.post(f"{newcomers}/state", state="paused")
    paused = analyst.post(f"{newcomers}/state", state="paused", reason="a video stalls <b>")
    refused = app.test_client().post("/", data=start)
    resumed = analyst.post(f"{newcomers}/state", state="open", reason="it plays")
    taken = app.test_client().post("/", data=start)
    extended = analyst.post(f"{newcomers}/more", more="2", reason="two were ill")
    odd = [analyst.post(f"{newcomers}/more", more=m, reason="r") for m in ("", "-1", "1e9", "٣")]
    nonsense = analyst.post(f"{newcomers}/state", state="nonsense", reason="r")
    closed = analyst.post(f"{newcomers}/state", state="closed", reason="enough")

    assert (unexplained.status_code, nonsense.status_code) == (422, 422)
    assert {each.status_code for each in odd} == {422}
    assert {each.status_code for each in (paused, resumed, extended, closed, taken)} == {303}
    assert refused.status_code == 409
    assert "closed to new participants" in analyst.get("/research/").text
    page = analyst.get(newcomers)
    assert "a video stalls <b>" in page.soup.get_text()
    assert [(each.state, each.more_places, each.researcher) for each in decided(stored)] == [
        ("closed", 2, "Charles"),
        ("open", 2, "Charles"),
        ("open", 0, "Charles"),
        ("paused", 0, "Charles"),
    ]
    assert "0 of 6 places done, 1 active" in " ".join(
        analyst.get("/research/").one(".truth").get_text().split()
    )
