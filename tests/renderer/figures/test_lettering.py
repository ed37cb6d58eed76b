from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from renderer.figures.lettering import fitted, font, wrapped


@given(st.text(max_size=80), st.floats(20, 400))
def test_fitted_text_is_never_wider_than_its_place(text: str, width: float) -> None:
    letters = font(12)
    shown = fitted(text.replace("\n", " "), letters, width)
    assert letters.getlength(shown) <= max(width, letters.getlength("…"))


@given(st.lists(st.sampled_from(["no", "never", "breakfast", "in", "the", "house"]), max_size=30))
def test_wrapped_text_keeps_every_word_where_there_is_room(words: list[str]) -> None:
    letters = font(12)
    lines = wrapped(" ".join(words), letters, 160, 40)
    assert " ".join(lines).split() == words
    assert all(letters.getlength(line) <= 160 for line in lines)


def test_what_does_not_fit_ends_with_an_ellipsis() -> None:
    lines = wrapped("one two three four five six seven eight", font(12), 60, 2)
    assert len(lines) == 2
    assert lines[-1].endswith("…")


def test_letters_are_there_without_a_system_font() -> None:
    for sign in "Ğéßλж–“→":
        assert font(20).getmask(sign).getbbox() is not None
        assert bytes(font(20).getmask(sign)) != bytes(font(20).getmask("\U0001f9ff"))
