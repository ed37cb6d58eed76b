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


REFUSED = {
    "host": [
        *("", "https://study.example.org", "study.example.org/one", "study.example.org:443"),
        *("a b", "study..org", "-a.org", "a-.org", "under_score.org", "study.example.org."),
        *("192.0.2.1", "[2001:db8::1]", "*.example.org", "exämple.org", f"{'a' * 64}.org"),
        *("a.org; }", "a.org\n}", "$host", "a.org{", 'a"b.org', f"{'a.' * 127}org"),
    ],
    "folder": [
        *("my-study", "/srv/../etc", "/srv/a$b", "/srv/a`b`", "/srv/it's", '/srv/"a"/b'),
        *("/srv/a\\b", "/srv/a\nb", "/", "/srv/ü", "/srv/-a", f"/srv/{'a' * 33}"),
    ],
    "contact": ["ada", "a@b@c", "ada@exa mple.org", "a\n@b.org", "}@b.org"],
}


@pytest.mark.parametrize(
    ("field", "value"), [(field, value) for field, values in REFUSED.items() for value in values]
)
def test_values_that_a_file_cannot_hold_are_refused(field: str, value: str) -> None:
    given = PurePosixPath(value) if field == "folder" else value
    with pytest.raises(InputError, match=rf"{field} .*\. (Give|On the server)"):
        plan_deployment(**GIVEN | {field: given})


def test_default_names_come_from_folder_and_host() -> None:
    deployment = plan_deployment(
        **GIVEN
        | {
            "folder": PurePosixPath("/srv/My_Study 2"),
            "host": "Study.xn--exmple-cua.org",
            "prefix": "/studies/one/",
        }
    )

    assert (deployment.name, deployment.unit) == ("my-study-2", "motionjury-my-study-2")
    assert deployment.database_name == "motionjury_my_study_2"
    assert deployment.address == "https://study.xn--exmple-cua.org/studies/one/"
