"""A name is accepted if Prolific signed it recently for this host."""

import time
from collections.abc import Iterator
from typing import Any

import jwt
import pytest
from cryptography.hazmat.primitives.asymmetric.rsa import RSAPrivateKey, generate_private_key

from studyapp.session.refusal import UnacceptableError
from studyapp.web.participants.recruiter_names import prolific_keys, signed_names

HOST = "study.example.org"
NAMES = {"PROLIFIC_PID": "p1", "STUDY_ID": "s1", "SESSION_ID": "x1"}


@pytest.fixture(scope="module")
def private_key() -> RSAPrivateKey:
    return generate_private_key(public_exponent=65537, key_size=2048)


@pytest.fixture
def fetched(private_key: RSAPrivateKey, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[int]]:
    """Let Prolific's keys be fetched from here; a mark is made each time."""
    public = jwt.algorithms.RSAAlgorithm.to_jwk(private_key.public_key(), as_dict=True)
    times: list[int] = []

    def fetch(client: jwt.PyJWKClient) -> dict[str, Any]:
        times.append(1)
        keys = {"keys": [public | {"kid": "one", "alg": "RS256", "use": "sig"}]}
        assert client.jwk_set_cache is not None
        client.jwk_set_cache.put(keys)
        return keys

    monkeypatch.setattr(jwt.PyJWKClient, "fetch_data", fetch)
    prolific_keys.cache_clear()
    yield times
    prolific_keys.cache_clear()


def signed(key: RSAPrivateKey, *, kid: str = "one", **changes: Any) -> str:
    claims = {"aud": HOST, "exp": time.time() + 60, "prolific": NAMES | {"workspace_id": "w"}}
    return jwt.encode(claims | changes, key, algorithm="RS256", headers={"kid": kid})


@pytest.mark.parametrize("audience", [HOST, f"https://{HOST}", [f"https://{HOST}/one"]])
def test_prolifics_signature_outlasts_reading_the_first_pages(
    private_key: RSAPrivateKey, fetched: list[int], audience: Any
) -> None:
    for expired in (-60, 0, 1800):
        token = signed(private_key, aud=audience, exp=time.time() - expired)
        assert signed_names(token, HOST) == NAMES
    assert len(fetched) == 1


def test_invalid_prolific_signatures_are_refused(
    private_key: RSAPrivateKey, fetched: list[int]
) -> None:
    claims = {"aud": HOST, "exp": time.time() + 60, "prolific": NAMES}
    made_up = generate_private_key(public_exponent=65537, key_size=2048)

    for token in (
        "",
        "no.token.atall",
        "x" * 5000,
        signed(made_up),
        signed(private_key, aud="other.example.org"),
        signed(private_key, exp=time.time() - 7200),
        signed(private_key, prolific={"PROLIFIC_PID": ""}),
        signed(private_key, prolific="p1"),
        jwt.encode(claims, "", algorithm="none", headers={"kid": "one"}),
        jwt.encode(claims, HOST * 2, algorithm="HS256", headers={"kid": "one"}),
    ):
        assert signed_names(token, HOST) is None, token


def test_unknown_keys_do_not_cause_a_request_each_time(
    private_key: RSAPrivateKey, fetched: list[int]
) -> None:
    for number in range(20):
        assert signed_names(signed(private_key, kid=f"made up {number}"), HOST) is None
    assert len(fetched) <= 2


def test_if_the_keys_are_unavailable_people_are_asked_to_try_again(
    private_key: RSAPrivateKey, fetched: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_client: jwt.PyJWKClient) -> None:
        fetched.append(1)
        raise jwt.PyJWKClientConnectionError("no way out")

    monkeypatch.setattr(jwt.PyJWKClient, "fetch_data", fail)

    # A server that does not answer holds up the first of them, and not one after the other.
    for _ in range(3):
        with pytest.raises(UnacceptableError, match="At the moment"):
            signed_names(signed(private_key), HOST)
    assert len(fetched) == 1
