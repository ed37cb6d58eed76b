from __future__ import annotations

import re
from pathlib import Path

import pytest
from flask import Flask, abort
from werkzeug.exceptions import default_exceptions

from tests.studyapp.web.visitor import Visitor
from tests.support.studies.taking_part_steps import SetClock

WEB = Path(__file__).parents[3] / "studyapp" / "web"


def test_every_answer_is_protected_and_no_page_is_kept(app: Flask, clock: SetClock) -> None:
    visitor = Visitor(app, clock).enrol().begin()
    pages = ("/", "/nowhere", "/take/nobody", visitor.address, "/research/log-in")
    for address in (*pages, "/static/style.css"):
        headers = app.test_client().get(address, buffered=True).headers
        policy = headers["Content-Security-Policy"]
        assert (headers["Referrer-Policy"], headers["X-Frame-Options"]) == ("no-referrer", "DENY")
        assert headers["X-Content-Type-Options"] == "nosniff"
        for rule in ("default-src 'none'", "frame-ancestors 'none'", "form-action 'self'"):
            assert rule in policy
        assert "unsafe" not in policy
        assert "mturk" not in policy
        assert (headers["Cache-Control"] == "no-store") is (address in pages)
        assert ("Set-Cookie" in headers) is ("research" in address)


@pytest.mark.parametrize(
    "template", sorted((WEB / "templates").rglob("*.html")), ids=lambda p: p.name
)
def test_pages_hold_no_inline_script_or_style_and_ask_nobody_else(template: Path) -> None:
    text = template.read_text("utf-8")

    assert not re.search(r"<style|\sstyle=|\son[a-z]+=|javascript:|https?://", text)
    assert all("src=" in tag for tag in re.findall(r"<script[^>]*>", text))


def test_a_request_that_is_too_large_is_refused(app: Flask) -> None:
    answer = app.test_client().post("/", data={"visit": "x" * 70_000})

    assert answer.status_code == 413
    assert "too much" in answer.text


def test_only_a_failure_of_ours_is_called_ours_and_logged_without_the_address(
    app: Flask, caplog: pytest.LogCaptureFixture
) -> None:
    @app.get("/fails/<int:status>/<token>")
    def fails(status: int, token: str) -> str:
        if status == 500:
            raise ZeroDivisionError
        abort(status)

    for status in default_exceptions:
        answer = app.test_client().get(f"/fails/{status}/s3cret")
        assert answer.status_code == status
        assert ("went wrong on our side" in answer.text) == (status >= 500), status
        assert re.search(r"(is|are) stored|is lost|[Gg]o back", answer.text), status
        assert "ZeroDivisionError" not in answer.text
    assert "ZeroDivisionError" in caplog.text
    assert "s3cret" not in caplog.text
