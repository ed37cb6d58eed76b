from pathlib import Path

import pyotp

from studyapp.clock import Clock
from studyapp.researchers.account import list_accounts
from studyapp.researchers.credentials import enable_second_factor, new_secret
from studyapp.researchers.links import choose_password, join
from studyapp.researchers.logins import log_in
from tests.support.command_line import run
from tests.support.researcher_accounts import PASSWORD
from tests.support.studies.stored import opened


def researchers(study: Path, *arguments: str, status: int = 0) -> str:
    return run("researchers", study, *arguments, status=status)


def token_of(output: str, address: str = "http://127.0.0.1:8000") -> str:
    before, _, token = output.strip().rpartition("/")
    assert before == f"{address}/research/join"
    return token


def test_the_help_of_a_subcommand_needs_no_study() -> None:
    assert "Print a link to join the study" in run("researchers", "invite", "--help")


def test_a_researcher_is_invited_listed_and_given_a_new_password(tiny_study: Path) -> None:
    assert "Nobody yet" in researchers(tiny_study, "list")
    assert not (tiny_study / "responses.db").exists()

    token = token_of(researchers(tiny_study, "invite", "--role", "analyst"))

    with opened(tiny_study / "responses.db") as database:
        join(database, Clock(), token, name="Ada", password=PASSWORD)
        assert researchers(tiny_study, "list").startswith("Ada (analyst), since 20")
        address = "https://study.example.org/jury"
        token = token_of(researchers(tiny_study, "reset", "ada", "--address", address), address)
        choose_password(database, Clock(), token, password=f"{PASSWORD} anew")
        log_in(database, Clock(), name="Ada", password=f"{PASSWORD} anew", address="")


def test_a_lost_second_factor_is_reset(tiny_study: Path) -> None:
    token = token_of(researchers(tiny_study, "invite", "--role", "owner"))
    with opened(tiny_study / "responses.db") as database:
        join(database, Clock(), token, name="Ada", password=PASSWORD)
        secret, (ada,) = new_secret(), list_accounts(database)
        code = pyotp.TOTP(secret).now()
        enable_second_factor(
            database, Clock(), ada.id, secret=secret, code=code, password=PASSWORD, address=""
        )
        assert "(owner, second factor)" in researchers(tiny_study, "list")
        assert "no researcher 'Eve'" in researchers(tiny_study, "reset", "Eve", status=1)

        assert "password alone" in researchers(tiny_study, "reset-second-factor", "ada")

        log_in(database, Clock(), name="Ada", password=PASSWORD, address="")
