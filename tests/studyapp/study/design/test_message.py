from __future__ import annotations

from studyapp.study.settings.presentation import Message


def test_places_are_filled_with_numbers_words_messages_and_lists() -> None:
    about = Message("{number} about {letter}", number=2, letter="B")

    assert str(Message("Nothing else.")) == "Nothing else."
    assert str(Message("{n} {word}", n=3, word="words", unused=1)) == "3 words"
    assert str(Message("Questions {numbers}.", numbers=(1, about, 3))) == (
        "Questions 1, 2 about B and 3."
    )


def test_everything_in_it_is_said_in_another_language() -> None:
    german = {"{n} and {rest}": "{rest} sowie {n}", "a {n}": "eine {n}"}

    said = Message("{n} and {rest}", n=1, rest=(Message("a {n}", n=2), 3)).said(
        lambda text: german[text], "; ".join
    )

    assert said == "eine 2; 3 sowie 1"


def test_braces_in_a_value_stay_as_they_are() -> None:
    assert str(Message("Not {answer}.", answer="{number}")) == "Not {number}."
