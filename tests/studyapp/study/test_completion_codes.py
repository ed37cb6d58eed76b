from __future__ import annotations

import pytest

from studyapp.study.completion_codes import CODE_LENGTH, draw_code, guessable


@pytest.mark.parametrize(
    "code",
    [
        "",
        "KX7QM2P",
        "AAAAAAAAAA",
        "ABABABABAB",
        "COMPLETED7X",
        "prolific-42",
        "K1234567X9",
        "XQWERTY79K",
        "9876PWTRKX",
        "DONE-KX7QM2",
        "KXQM7KXQM7",
    ],
)
def test_a_code_that_could_be_guessed_is_told(code: str) -> None:
    assert guessable(code) is not None


@pytest.mark.parametrize("code", ["KX7QM2PWTR", "C1G9PC0D", "8E8AC860"])
def test_codes_as_recruiters_draw_them_are_fine(code: str) -> None:
    assert guessable(code) is None


def test_drawn_codes_are_fine_and_each_is_another() -> None:
    drawn = {draw_code() for _ in range(500)}

    assert len(drawn) == 500
    assert {len(code) for code in drawn} == {CODE_LENGTH}
    assert not any(guessable(code) for code in drawn)
