"""Messages about unusable input."""

import pytest

from motion.errors import InputError


@pytest.mark.parametrize("end", [".", "..", ". ", ".\n"])
def test_a_message_has_place_problem_and_remedy_with_single_full_stops(end: str) -> None:
    inner = InputError("the file is damaged", remedy=f"Get it again{end}")

    error = InputError(f"it was said: {inner}", where="study.toml", remedy=f"Do so{end}")

    assert str(error) == "study.toml: it was said: the file is damaged. Get it again. Do so."
    assert (error.what[-5:], error.remedy) == ("again", "Do so")
