from __future__ import annotations

from pathlib import Path

import pytest

from tools import message_catalogues
from tools.message_catalogues import found_texts, texts_of_code


@pytest.fixture
def code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(message_catalogues, "ROOT", tmp_path)
    return tmp_path / "code.py"


@pytest.mark.parametrize(
    ("written", "texts"),
    [
        ('_("A text")', ["A text"]),
        ('ngettext("one", "many", 3)', [("one", "many")]),
        ('Message("words", n=1)', ["words"]),
        ('raise UnacceptableError("What.", "Remedy {n}.", n=1)', ["What.", "Remedy {n}."]),
        ('raise StudyFullError("What.", "Remedy.")', ["What.", "Remedy."]),
        ('raise ValueError("for programmers")', []),
        ("Message(what, **values)", []),
    ],
)
def test_texts_for_participants_are_found_in_code(
    code: Path, written: str, texts: list[str | tuple[str, str]]
) -> None:
    code.write_text(written, "utf-8")

    assert [found.text for found in texts_of_code(code)] == texts


@pytest.mark.parametrize(
    "written",
    [
        '_(f"Question {n}")',
        "_(words)",
        'raise UnacceptableError("What.", "a" + remedy)',
        'raise UnacceptableError("What.")',
    ],
)
def test_a_text_that_cannot_be_found_is_refused(code: Path, written: str) -> None:
    code.write_text(written, "utf-8")

    with pytest.raises(ValueError, match=r"code\.py:1: .* no literal"):
        list(texts_of_code(code))


def test_templates_scripts_and_all_rooms_of_code_are_searched() -> None:
    found = list(found_texts())

    assert {file.split("/")[1] for file, _, _ in found} == {"session", "study", "web"}
    assert {file.rsplit(".", 1)[1] for file, _, _ in found} == {"html", "js", "py"}
    assert any(isinstance(text, tuple) for file, _, text in found if file.endswith(".js"))
    assert any(isinstance(text, tuple) for file, _, text in found if file.endswith(".html"))
