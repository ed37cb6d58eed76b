"""A study file edited in the browser: checked as everywhere, and never written over unseen."""

import shutil
from pathlib import Path

import pytest

from studyapp.desk.lab import Lab, LabStudy
from tests.studyapp.desk.conftest import Joined, changes, first_question
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.research.research_browser import ResearchBrowser

TINY = "/research/studies/tiny/"
SETTINGS = f"{TINY}settings"


@pytest.fixture
def file(lab: Lab) -> Path:
    return lab.folder / "tiny" / "study.toml"


def digest_of(page: PageReader) -> str:
    return page.value("[name=seen]", "value")


def test_the_file_is_saved_as_typed(tiny: LabStudy, ada: ResearchBrowser, file: Path) -> None:
    page = ada.get(SETTINGS)
    text = file.read_text("utf-8").replace("Gestures and speech", "Gestures – once more")
    answer = ada.post(SETTINGS, text=text.replace("\n", "\r\n"), seen=digest_of(page))
    assert answer.status_code == 303
    assert file.read_text("utf-8") == text.rstrip() + "\n"
    assert "Gestures – once more" in ada.get("/research/").text
    assert changes(tiny)[0][:2] == ("Ada", "study file edited")


def test_an_invalid_file_is_not_saved_and_its_line_is_shown(
    ada: ResearchBrowser, file: Path
) -> None:
    page, before = ada.get(SETTINGS), file.read_text("utf-8")
    text = "seeed = 3\n" + before
    answer = ada.post(SETTINGS, text=text, seen=digest_of(page))
    assert answer.status_code == 422
    again = PageReader(answer.text)
    assert again.soup.select("[data-line='1']")
    assert "did you mean" in answer.text
    assert "seeed = 3" in again.words("textarea")
    assert file.read_text("utf-8") == before
    # A file that somebody breaks on the server does not hide its study.
    file.write_text(text, "utf-8")
    assert "tiny" in ada.get("/research/").text


def test_a_colleagues_concurrent_change_is_shown_and_kept(ada: ResearchBrowser, file: Path) -> None:
    page, before = ada.get(SETTINGS), file.read_text("utf-8")
    others = before + "# of somebody else\n"
    file.write_text(others, "utf-8")
    mine = before + "# of mine\n"
    answer = ada.post(SETTINGS, text=mine, seen=digest_of(page))
    assert answer.status_code == 409
    assert "-# of somebody else" in answer.text
    assert file.read_text("utf-8") == others
    assert ada.post(SETTINGS, text=mine, seen=digest_of(PageReader(answer.text))).status_code == 303
    assert file.read_text("utf-8") == mine


def test_changing_the_design_while_people_take_part_makes_a_new_version(
    taken: LabStudy, ada: ResearchBrowser, joined: Joined, file: Path
) -> None:
    page, before = ada.get(SETTINGS), file.read_text("utf-8")
    text = before.replace("fit the rhythm of the speech better", "follow the speech better")
    fields = {"text": text, "seen": digest_of(page)}
    answer = ada.post(SETTINGS, **fields)
    assert answer.status_code == 422
    assert "questions may not change under them" in answer.text
    by_analyst = joined("analyst").post(SETTINGS, **fields, new_version="")
    assert "only owners begin a new version" in by_analyst.text
    assert file.read_text("utf-8") == before
    assert ada.post(SETTINGS, **fields, new_version="").status_code == 303
    assert first_question(taken).endswith("follow the speech better?")
    assert taken.standing().problem is None
    assert changes(taken)[0][:2] == ("Ada", "new version")


def test_a_study_whose_alarms_cannot_be_sent_is_not_served_and_says_why(
    ada: ResearchBrowser, file: Path
) -> None:
    file.write_text(file.read_text("utf-8") + '\n[alarms]\nmail = ["ada@example.org"]\n', "utf-8")
    assert "no mail server is named" in ada.get(TINY).text


def test_texts_are_shown_as_participants_see_them_as_far_as_the_material_allows(
    lab: Lab, joined: Joined
) -> None:
    viewer = joined("viewer")
    shutil.rmtree(lab.folder / "tiny" / "videos")
    (lab.folder / "tiny" / "stimuli.json").unlink()
    frames = viewer.get(f"{TINY}texts").soup.select("iframe[sandbox='allow-same-origin']")
    texts = {str(frame["title"]): str(frame["srcdoc"]) for frame in frames}
    assert list(texts) == ["Consent", "Instructions"]
    assert not any("<script" in text for text in texts.values())
    assert "Gestures and speech" in texts["Consent"]
    assert "pairs of short videos" in texts["Instructions"]
    shutil.rmtree(lab.folder / "tiny" / "speech")
    page = viewer.get(f"{TINY}texts")
    assert [frame["title"] for frame in page.soup.select("iframe")] == ["Consent"]
    assert "The instructions follow when the trials can be planned" in page.text
