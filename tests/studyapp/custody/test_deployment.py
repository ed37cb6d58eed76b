"""What may stand in the files of a server."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Any

import pytest

from motion.errors import InputError
from studyapp.custody.deployment import planned_deployment

GIVEN: dict[str, Any] = {
    "title": "Gestures",
    "folder": PurePosixPath("/srv/motionjury/my-study"),
    "host": "study.example.org",
}


@pytest.mark.parametrize(
    "host",
    [
        *("", "https://study.example.org", "study.example.org/one", "study.example.org:443"),
        *("a b", "study..org", "-a.org", "a-.org", "under_score.org", "study.example.org."),
        *("192.0.2.1", "[2001:db8::1]", "*.example.org", "exämple.org", f"{'a' * 64}.org"),
        *("a.org; }", "a.org\n}", "$host", "a.org{", 'a"b.org', f"{'a.' * 127}org"),
    ],
)
def test_what_is_no_host_is_refused(host: str) -> None:
    with pytest.raises(InputError, match=r"not a name of a host\. Give .*study\.example\.org"):
        planned_deployment(**GIVEN | {"host": host})


@pytest.mark.parametrize("host", ["localhost", "Study.Example.org", "xn--exmple-cua.org", "a.b-c"])
def test_hosts_are_taken_in_small_letters(host: str) -> None:
    assert planned_deployment(**GIVEN | {"host": host}).host == host.lower()


@pytest.mark.parametrize(
    "folder",
    [
        *("my-study", "/srv/../etc", "/srv/a$b", "/srv/a`b`", "/srv/it's", '/srv/"a"/b'),
        *("/srv/a\\b", "/srv/a\nb", "/", "/srv/ü", "/srv/-a", f"/srv/{'a' * 33}"),
    ],
)
def test_a_folder_that_no_service_could_have_is_refused(folder: str) -> None:
    with pytest.raises(InputError, match=r"folder .*\. (Name|Call it)"):
        planned_deployment(**GIVEN | {"folder": PurePosixPath(folder)})


@pytest.mark.parametrize("contact", ["ada", "a@b@c", "ada@exa mple.org", "a\n@b.org", "}@b.org"])
def test_what_is_no_mail_address_is_refused(contact: str) -> None:
    with pytest.raises(InputError, match="not a mail address"):
        planned_deployment(**GIVEN | {"contact": contact})


def test_names_follow_from_the_folder() -> None:
    found = planned_deployment(
        **GIVEN | {"folder": PurePosixPath("/srv/My_Study 2"), "prefix": "/studies/one/"}
    )

    assert (found.name, found.unit) == ("my-study-2", "motionjury-my-study-2")
    assert found.database_name == "motionjury_my_study_2"
    assert found.address == "https://study.example.org/studies/one/"
