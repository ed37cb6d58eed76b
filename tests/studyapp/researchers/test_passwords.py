from __future__ import annotations

import pytest

from motion.errors import InputError
from studyapp.researchers.passwords import (
    LONGEST,
    check_password,
    hashed,
    is_outdated,
    is_right,
)


@pytest.mark.parametrize(
    "password",
    [
        "correct horse battery",
        "tr0ub4dor&3xyz",
        "83920174650192837465",
        "password and purple rain",
        "日本語のとても長い合言葉です",
    ],
)
def test_what_nobody_would_try_first_is_accepted(password: str) -> None:
    check_password(password, name="Ada Lovelace")


@pytest.mark.parametrize(
    "password",
    [
        "password1234",
        "Passw0rd!Passw0rd!",
        "qwertyuiop12",
        "123456789012",
        "9876543210987",
        "abcabcabcabcabc",
        "welcome-to-study",
        "MotionJury2026!",
        "study-password-2026",
        "secret shadow master",
        "a1" * 128,
        "letmein!letmein!",
        "Ada Lovelace 1815",
        "lovelace.ada.lovelace",
        "aaaaaaaaaaaaaaaa",
    ],
)
def test_what_everybody_tries_first_is_refused(password: str) -> None:
    name = "Lovelace" if password.startswith("lovelace") else "Ada Lovelace"
    with pytest.raises(InputError, match=r"first that anybody would try.*words"):
        check_password(password, name=name)


@pytest.mark.parametrize("length", [0, 11, LONGEST + 1])
def test_a_password_of_another_length_is_refused_with_both_limits(length: int) -> None:
    with pytest.raises(InputError, match=rf"12 to 256 characters, this one has {length}"):
        check_password(("zq7!kvmw2p#" * 50)[:length], name="Ada")


def test_a_hash_is_that_of_its_password_alone_and_never_twice_the_same() -> None:
    one, other = hashed("correct horse battery"), hashed("correct horse battery")

    assert one != other
    assert "correct" not in one
    assert is_right(one, "correct horse battery")
    assert not is_right(one, "correct horse batterz")
    assert not is_right("no hash at all", "correct horse battery")
    assert not is_right(None, "correct horse battery")


def test_a_password_is_the_same_however_its_letters_are_encoded() -> None:
    assert is_right(hashed("gru\u0308ne Wiesen im Mai"), "gr\u00fcne Wiesen im Mai")


def test_a_hash_of_other_parameters_is_outdated() -> None:
    assert not is_outdated(hashed("correct horse battery"))
    assert is_outdated("$argon2id$v=19$m=65536,t=3,p=4$AAAAAAAAAAAAAAAAAAAAAA$" + "A" * 43)
