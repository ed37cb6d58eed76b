import re
from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.database.tables.study_session import StudySession
from studyapp.researchers.pseudonyms import PseudonymKey


def person(**names: str | None) -> StudySession:
    return StudySession(**({"token": "t", "recruiter_study": ""} | names))


def test_the_key_is_made_once_and_readable_only_by_its_owner(tmp_path: Path) -> None:
    path = tmp_path / "pseudonyms.key"
    assert PseudonymKey.read(path) is None

    made = PseudonymKey.read_or_make(path)

    assert path.stat().st_mode & 0o777 == 0o600
    assert made.secret.hex() not in repr(made) and str(made.secret) not in repr(made)
    assert PseudonymKey.read_or_make(path) == PseudonymKey.read(path) == made
    assert [file.name for file in tmp_path.iterdir()] == ["pseudonyms.key"]
    path.chmod(0o640)
    with pytest.raises(InputError, match="chmod 600"):
        PseudonymKey.read(path)


@pytest.mark.parametrize("content", [b"", b"abc", b"\xff\xfe", b"00" * 31])
def test_a_damaged_key_is_refused_and_not_replaced(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "key"
    path.write_bytes(content)
    path.chmod(0o600)

    with pytest.raises(InputError, match="not a key of pseudonyms"):
        PseudonymKey.read_or_make(path)
    assert path.read_bytes() == content


def test_a_pseudonym_depends_on_person_and_key() -> None:
    key, other = PseudonymKey(bytes(32)), PseudonymKey(bytes(31) + b"1")
    one = person(recruiter_participant="pid", recruiter_study="study", visit="v")

    assert key.pseudonym(one) == key.pseudonym(
        person(recruiter_participant="pid", recruiter_study="moved", visit="w")
    )
    assert re.fullmatch("p[a-z2-7]{16}", key.pseudonym(one))
    assert key.pseudonym(one) != other.pseudonym(one)
    others = [{"recruiter_participant": "pids"}, {"visit": "pid"}, {"visit": "v"}, {}]
    assert len({key.pseudonym(each) for each in (one, *(person(**o) for o in others))}) == 5


def test_the_pseudonym_is_the_documented_function() -> None:
    # HMAC-SHA256 under 32 zero bytes of '["visit", "v"]', computed with openssl.
    assert PseudonymKey(bytes(32)).pseudonym(person(visit="v")) == "pxajyqmjznczyflmy"
