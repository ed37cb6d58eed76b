"""Figures and the contact sheet name the conditions: no address of the server leads to them."""

from __future__ import annotations

from pathlib import Path

import pytest
from flask import Flask

from studyapp.study.folder import StudyFolder

SECRET = b"which condition is which"


@pytest.fixture
def hidden(tiny_study: Path, app: Flask) -> list[str]:
    """Write a file at each place where figures lie; return their paths from the study folder."""
    folder = StudyFolder(tiny_study)
    places = [
        folder.figures / "strip-take-0.png",
        folder.figures / "grid-take-0.mp4",
        folder.videos / "sheet" / "index.html",
        folder.videos / "sheet" / "sheet-01.png",
        folder.videos / "sheet" / ".cells" / "0.webp",
    ]
    for path in places:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(SECRET)
    return [path.relative_to(tiny_study).as_posix() for path in places]


@pytest.mark.parametrize(
    "address",
    [
        "/{}",
        "/media/{}",
        "/media/{}.mp4",
        "/media/../{}",
        "/media/..%2f{}",
        "/media/%2e%2e/{}",
        "/static/{}",
        "/static/../{}",
        "/static/..%2f..%2f{}",
    ],
)
def test_no_address_leads_to_a_figure(app: Flask, hidden: list[str], address: str) -> None:
    client = app.test_client()
    for path in hidden:
        answer = client.get(address.format(path))
        assert answer.status_code in (308, 404), address.format(path)
        assert SECRET not in answer.data
