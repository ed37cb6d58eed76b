from __future__ import annotations

import httpx
import pytest

from studyapp.preflight.serving_checks import address_findings

HTTPS = "https://study.example.org/mine"


def server(health: str = "ok\n", ranges: bool = True) -> httpx.MockTransport:
    def respond(request: httpx.Request) -> httpx.Response:
        if request.url.path == "/mine/healthz":
            return httpx.Response(200, text=health)
        if request.url.path != "/mine/static/players.js":
            return httpx.Response(404)
        assert request.headers["Range"] == "bytes=0-9"
        return httpx.Response(206, content=b"0" * 10) if ranges else httpx.Response(200, text="all")

    return httpx.MockTransport(respond)


def names(address: str, transport: httpx.BaseTransport) -> list[str]:
    return [found.name for found in address_findings(address, transport=transport)]


def test_a_study_that_is_well_is_found_on_its_sub_path() -> None:
    assert names(HTTPS, server()) == []


def test_an_address_without_encryption_is_warned_of_except_on_this_machine() -> None:
    assert names("http://study.example.org/mine", server()) == ["address-insecure"]
    assert names("http://localhost/mine", server()) == []


@pytest.mark.parametrize(
    ("transport", "name"),
    [
        (server(health="Welcome to nginx"), "address-other"),
        (httpx.MockTransport(lambda _: httpx.Response(502)), "address-other"),
        (server(ranges=False), "ranges-lost"),
    ],
)
def test_what_answers_otherwise_is_told(transport: httpx.BaseTransport, name: str) -> None:
    assert names(HTTPS, transport) == [name]


def test_an_address_that_nobody_answers_at_is_told() -> None:
    def refuse(_: httpx.Request) -> httpx.Response:
        raise httpx.ConnectError("no route")

    assert names(HTTPS, httpx.MockTransport(refuse)) == ["address-unreachable"]
