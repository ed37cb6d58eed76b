"""A researcher's whole way in a real browser, while a crowd takes part in the study.

With ``SCREENSHOTS=folder`` in the environment each page is also taken in every size.
"""

from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import httpx
import pandas as pd
import pytest
from playwright.sync_api import Browser, Page, expect

from studyapp.database.engine import Database
from studyapp.session.form_answers import store_form_answers
from studyapp.session.served_study import ServedStudy
from tests.functional.browsing import IN_A_BROWSER, commanded, follow, press, watched_page
from tests.functional.joining import NAME, join
from tests.functional.page_checks import examination, photograph
from tests.functional.taking_part import answer
from tests.support.command_line import run
from tests.support.researcher_accounts import PASSWORD
from tests.support.studies.form_questions import CLOSING
from tests.support.studies.redefining import redefine
from tests.support.studies.taking_part_steps import Participant, SetClock

pytestmark = IN_A_BROWSER

PEOPLE = 10
TRIALS, QUESTIONS = 2, 2
REFRESHED_MS = 21_000
"""After this time the overview has reloaded itself."""

SCRIPT = "<script>document.title = 'taken'</script><img src=x onerror=alert(1)>"

LookAt = Callable[[str], None]


@pytest.fixture
def study(tiny_study: Path) -> Path:
    """Return a study with a place for each of `PEOPLE`, and `TRIALS` trials."""
    redefine(
        tiny_study,
        ("participants_per_comparison = 4", f"participants_per_comparison = {PEOPLE}"),
        ("trials = 4\npractice = 1", "trials = 1\npractice = 0"),
        added=CLOSING,
    )
    return tiny_study


def export(study: Path) -> pd.DataFrame:
    """Run `motionjury export`, and return its participants."""
    run("export", study, "--out", study / "out" / "answers.csv")
    people = pd.read_csv(study / "out" / "answers_participants.csv", keep_default_na=False)
    return people.set_index("study_session")


def go_to(page: Page, name: str) -> None:
    pages = page.get_by_role("navigation", name="Researchers' pages")
    follow(pages.get_by_role("link", name=name))


def send(page: Page, button: str, reason: str) -> None:
    form = page.locator("form").filter(has=page.get_by_role("button", name=button, exact=True))
    form.get_by_label("Reason").fill(reason)
    follow(form.get_by_role("button", name=button, exact=True))


def test_a_study_is_launched_watched_fixed_extended_closed_and_exported(
    browser: Browser, study: Path, database: Database
) -> None:
    with (
        examination("way") as examine,
        commanded("serve", study) as (address, link),
        watched_page(browser, address) as page,
    ):
        page.on("dialog", lambda _: pytest.fail("what a participant wrote was run"))

        def look_at(name: str) -> None:
            examine(page, name)

        page.clock.install()
        join_and_log_in(page, address, link, look_at)
        prepare(page, look_at)
        go_to(page, "Overview")
        crowd = [come(database, study, f"participant-{number}") for number in range(PEOPLE)]
        # The page reloads itself.
        page.clock.fast_forward(REFRESHED_MS)
        expect(page.locator(".truth")).to_contain_text(f"{PEOPLE} active")
        expect(page.locator("#live time").last).not_to_contain_text("UTC")
        look_at("arriving")
        go_to(page, "Results")
        expect(page.get_by_role("heading", level=1)).to_have_text("Results before the end")
        expect(page.locator("main")).not_to_contain_text("rule based")
        look_at("unblind")
        go_to(page, "Overview")
        for participant in crowd:
            finish(participant)
        page.clock.fast_forward(REFRESHED_MS)
        expect(page.locator(".truth")).to_contain_text(f"{PEOPLE} of {PEOPLE} places done")

        pseudonym = export(study).loc[3, "participant"]
        exclude(page, str(pseudonym), look_at)
        go_to(page, "Recruitment")
        page.get_by_label("More places in each arm").fill("1")
        send(page, "Extend", "one was asleep")
        finish(come(database, study, "one-more"))
        go_to(page, "Overview")
        expect(page.locator(".truth")).to_contain_text(f"{PEOPLE + 1} of {PEOPLE + 1} places done")
        expect(page.locator("main")).to_contain_text("1 is left out of the analysis")
        close(page, address, look_at)
        go_through_the_other_pages(page, look_at)

    people = export(study)
    answers = pd.read_csv(study / "out" / "answers.csv")
    assert len(answers) == (PEOPLE + 1) * TRIALS * QUESTIONS
    assert people["participant"].to_dict()[3] == pseudonym
    by_hand = people[people["exclusion_rule"] == "researcher"]
    assert by_hand.index.tolist() == [3]
    # The export that gave the pseudonym was a look.
    seen_before = "(decided after results had been looked at)"
    assert people.loc[3, "exclusion_reason"] == f"wrote that she fell asleep {seen_before}"
    form = pd.read_csv(study / "out" / "answers_form.csv")
    assert form["value"].tolist() == [SCRIPT] * (PEOPLE + 1)
    log = pd.read_csv(study / "out" / "answers_log.csv", keep_default_na=False)
    assert log.loc[log["researcher"] == NAME, "event"].tolist()[-7:] == [
        "newcomers_paused",
        "newcomers_let_in",
        "participant_excluded",
        "extended",
        "newcomers_closed",
        "results_looked_at",
        "invited",
    ]


def join_and_log_in(page: Page, address: str, link: str, look_at: LookAt) -> None:
    """Become the owner by the printed link, log out, and log in."""
    page.goto(link)
    look_at("join")
    join(page, link)
    expect(page.get_by_role("heading", level=1)).to_have_text("Progress")
    follow(page.get_by_role("button", name="Log out"))
    page.goto(f"{address}/research/changes")
    assert page.url.endswith("/research/log-in")
    look_at("log-in")
    page.get_by_label("Name").fill(NAME)
    page.get_by_label("Password").fill(PASSWORD)
    follow(page.get_by_role("button", name="Log in"))
    expect(page.locator(".truth")).to_contain_text(f"0 of {PEOPLE} places done")


def prepare(page: Page, look_at: LookAt) -> None:
    """Pause the intake, preview a trial, and resume."""
    go_to(page, "Recruitment")
    send(page, "Pause", "nobody before we have looked")
    expect(page.locator(".truth")).to_contain_text("No new participants are admitted")
    go_to(page, "Preview")
    look_at("preview")
    follow(page.get_by_role("link", name="1", exact=True))
    expect(page.locator("header")).to_contain_text("Preview: nothing is stored")
    photograph(page, "way-previewed-trial")
    page.locator("#play").click()
    answer(page)
    page.get_by_role("button", name="Next").click()
    expect(page.locator(".progress")).to_contain_text(f"Trial 2 of {TRIALS}")
    follow(page.get_by_role("link", name="All trials of this place"))
    go_to(page, "Recruitment")
    look_at("before-the-launch")
    send(page, "Resume", "all is well")
    expect(page.locator(".truth")).to_contain_text("New participants are admitted")


def exclude(page: Page, pseudonym: str, look_at: LookAt) -> None:
    """Find a participant by the pseudonym of an export, and leave them out of the analysis."""
    go_to(page, "Study sessions")
    look_at("study-sessions")
    page.get_by_role("searchbox").fill(pseudonym)
    follow(page.get_by_role("button", name="Find"))
    expect(page.get_by_role("heading", level=1)).to_have_text("Study session 3")
    expect(page.locator(".facts").first).to_contain_text(pseudonym)
    expect(page.locator("main")).to_contain_text(SCRIPT)
    look_at("before-the-exclusion")
    send(page, "Exclude from the analysis", "wrote that she fell asleep")
    expect(page.locator("main")).to_contain_text(f"Excluded by {NAME}: wrote that she fell")
    look_at("after-the-exclusion")


def close(page: Page, address: str, look_at: LookAt) -> None:
    """Close the study; a newcomer is told that it is over."""
    go_to(page, "Recruitment")
    send(page, "Close", "all we need")
    expect(page.locator(".truth")).to_contain_text("The study is closed to new participants")
    look_at("closed")
    late = httpx.post(address, data={"visit": "v" * 32})
    assert late.status_code == 409
    assert "The study is over" in late.text


def go_through_the_other_pages(page: Page, look_at: LookAt) -> None:
    """Look at the final results, and at the pages that nothing was decided on."""
    go_to(page, "Results")
    expect(page.get_by_role("note")).to_contain_text(f"All {PEOPLE + 1} participants have finished")
    expect(page.locator("main")).to_contain_text("rule based against mismatched")
    look_at("results")
    go_to(page, "Overview")
    agreement = page.get_by_role("region", name="Agreement between participants")
    while not agreement.count():
        page.reload()
    look_at("overview-with-agreement")
    follow(page.get_by_role("link", name="Keep it still"))
    expect(page.locator("footer")).to_contain_text("stays as it is")
    go_to(page, "Researchers")
    page.get_by_label("viewer").check()
    press(page, "Make a link")
    expect(page.locator("output.link")).to_contain_text("/research/join/")
    look_at("researchers")
    for name in ("Changes", NAME):
        go_to(page, name)
        expect(page.get_by_role("heading", level=1)).to_be_visible()
        look_at(name.lower().replace(" ", "-"))
    assert page.title() != "taken"


def come(database: Database, study: Path, name: str) -> Participant:
    """Bring somebody to the first trial, a minute ago: what they do then lies in the past."""
    clock = SetClock(moments=[datetime.now(UTC) - timedelta(minutes=1)])
    participant = Participant(database, ServedStudy.read(study), clock).enrol(name).begin()
    participant.trial()
    return participant


def finish(participant: Participant) -> None:
    """Answer all trials, and write a remark that a page must not run."""
    for trial in range(TRIALS):
        value = str((participant.stored().id + trial) % 5 - 2)
        participant.take_trial({"rhythm": value, "emotion": value})
    participant.do(store_form_answers, "closing", {"comment": SCRIPT})
    assert participant.look().completion_code
