from __future__ import annotations

from tests.support.servers.malformed_requests import Known, malformed_requests

KNOWN = Known(pages=["/take/me"], trials=["trial"], videos=["video"])


def test_the_same_seed_gives_the_same_requests() -> None:
    first, second = (list(malformed_requests(300, KNOWN, seed=7)) for _ in range(2))

    assert first == second
    assert first != list(malformed_requests(300, KNOWN, seed=8))


def test_nothing_in_a_request_ends_its_head_too_early() -> None:
    for request in malformed_requests(300, KNOWN, seed=7):
        head, _, body = request.partition(b"\r\n\r\n")
        length = [
            line for line in head.split(b"\r\n") if line.lower().startswith(b"content-length")
        ]
        if request.startswith(b"POST /take") and len(length) == 1:
            assert int(length[0].split(b":")[1]) == len(body)
