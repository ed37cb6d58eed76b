"""Values in the files of a server are validated."""

from __future__ import annotations

from pathlib import PurePosixPath
from typing import Any

import pytest

from motion.errors import InputError
from studyapp.custody.deployment import plan_deployment

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
def test_an_invalid_host_is_refused(host: str) -> None:
    with pytest.raises(InputError, match=r"not a host name\. Give .*study\.example\.org"):
        plan_deployment(**GIVEN | {"host": host})


@pytest.mark.parametrize("host", ["localhost", "Study.Example.org", "xn--exmple-cua.org", "a.b-c"])
def test_hosts_are_converted_to_lower_case(host: str) -> None:
    assert plan_deployment(**GIVEN | {"host": host}).host == host.lower()


@pytest.mark.parametrize(
    "folder",
    [
        *("my-study", "/srv/../etc", "/srv/a$b", "/srv/a`b`", "/srv/it's", '/srv/"a"/b'),
        *("/srv/a\\b", "/srv/a\nb", "/", "/srv/ü", "/srv/-a", f"/srv/{'a' * 33}"),
    ],
)
def test_a_folder_that_a_service_cannot_use_is_refused(folder: str) -> None:
    with pytest.raises(InputError, match=r"folder .*\. (Give|On the server)"):
        plan_deployment(**GIVEN | {"folder": PurePosixPath(folder)})


@pytest.mark.parametrize("contact", ["ada", "a@b@c", "ada@exa mple.org", "a\n@b.org", "}@b.org"])
def test_an_invalid_e_mail_address_is_refused(contact: str) -> None:
    with pytest.raises(InputError, match="not an e-mail address"):
        plan_deployment(**GIVEN | {"contact": contact})


def test_names_follow_from_the_folder() -> None:
    deployment = plan_deployment(
        **GIVEN | {"folder": PurePosixPath("/srv/My_Study 2"), "prefix": "/studies/one/"}
    )

    assert (deployment.name, deployment.unit) == ("my-study-2", "motionjury-my-study-2")
    assert deployment.database_name == "motionjury_my_study_2"
    assert deployment.address == "https://study.example.org/studies/one/"
