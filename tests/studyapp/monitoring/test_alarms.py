"""Researchers are told once of what happens to their study."""

from __future__ import annotations

import logging
import smtplib
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from unittest.mock import MagicMock

import pytest
from flask import Flask, request
from pydantic import ValidationError
from sqlalchemy import select

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.database.tables import Alarm
from studyapp.monitoring.alarms import SMTP, WEBHOOK, AlarmChannels, raise_alarms
from studyapp.session.arrivals import count_newcomer
from studyapp.session.served_study import ServedStudy
from studyapp.study.settings.study import Alarms
from tests.support.servers.local_server import listening
from tests.support.studies.made_study import make_study
from tests.support.studies.taking_part_steps import Participant, SetClock


@dataclass
class Told:
    """What researchers of a study are told; as long as `works`, telling them succeeds."""

    database: Database
    served: ServedStudy
    clock: SetClock
    texts: list[str] = field(default_factory=list)
    works: bool = True

    def send(self, text: str) -> bool:
        self.texts.append(text)
        return self.works

    def look(self) -> int:
        """Look for alarms, as a server does again and again; return how many were told so far."""
        raise_alarms(self.database, self.served, self.clock, self.send)
        return len(self.texts)

    def fill(self) -> None:
        for number in range(sum(arm.places for arm in self.served.study.arms)):
            Participant(self.database, self.served, self.clock).enrol(f"visit {number}")

    def come(self, address: str, how_many: int) -> None:
        with self.database.writing() as session:
            for _ in range(how_many):
                count_newcomer(session, address, self.clock.now())


@pytest.fixture
def told(opened: Database, served: ServedStudy, clock: SetClock) -> Told:
    return Told(opened, served, clock)


def test_a_full_study_is_told_once_whoever_looks(told: Told) -> None:
    assert told.look() == 0
    told.fill()

    assert [told.look() for _ in range(3)] == [1, 1, 1]
    assert told.texts == ["The study 'Gestures and speech' is full: all 4 places are held."]


def test_what_could_not_be_sent_is_sent_later(told: Told) -> None:
    told.fill()
    told.works = False
    told.look()
    told.works = True

    assert (told.look(), told.look()) == (2, 2)


def test_an_open_study_that_nobody_finishes_is_told_once_for_each_standstill(
    participant: Participant, told: Told
) -> None:
    seen = []
    for hours in (23, 1, 1):
        told.clock.advance(hours=hours)
        seen.append(told.look())
    assert seen == [0, 1, 1]
    assert "nobody has finished it for 24 hours" in told.texts[0]

    participant.take_all()
    told.clock.advance(hours=25)
    assert told.look() == 2


def test_a_study_that_lets_nobody_in_does_not_stall(told: Told) -> None:
    study = told.served.study.model_copy(update={"open": False})
    told.served = replace(told.served, study=study)
    told.clock.advance(hours=100)

    assert told.look() == 0


def test_many_newcomers_from_one_address_within_an_hour_are_told_once(told: Told) -> None:
    told.come("192.0.2.9", 5)
    told.clock.advance(hours=1)
    told.come("192.0.2.9", 9)
    told.come("198.51.100.7", 5)
    assert told.look() == 0
    told.come("192.0.2.9", 1)

    assert (told.look(), told.look()) == (1, 1)
    assert told.texts == [
        "10 participants of the study 'Gestures and speech' came from one network address "
        "within an hour."
    ]
    with told.database.reading() as session:
        (stored,) = session.scalars(select(Alarm))
    assert (stored.kind, stored.about) == ("one address", "2026-05-04")


@pytest.fixture
def webhook() -> Iterator[tuple[str, list[object]]]:
    got: list[object] = []
    app = Flask(__name__)

    @app.post("/hook")
    def take() -> str:
        got.append(request.get_json())
        return ""

    with listening(app.wsgi_app) as address:
        yield address, got


def test_a_webhook_gets_the_alarm_as_json_and_its_failure_names_no_secret(
    webhook: tuple[str, list[object]],
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    address, got = webhook
    study = make_study(name="mine")
    monkeypatch.setenv(WEBHOOK, f"{address}/hook")
    assert AlarmChannels.of(study).send("It is full.")
    assert got == [{"study": "mine", "text": "It is full."}]

    monkeypatch.setenv(WEBHOOK, f"{address}/secret-of-the-hook")
    with caplog.at_level(logging.INFO, "gunicorn.error"):
        assert not AlarmChannels.of(study).send("It is full.")
    assert "An alarm could not be sent by the webhook (HTTPStatusError)" in caplog.messages
    assert not any("secret" in line for line in caplog.messages if "alarm" in line)


def test_mail_goes_encrypted_with_the_name_and_password_of_the_environment(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    server = MagicMock()
    monkeypatch.setattr(smtplib, "SMTP", server)
    monkeypatch.setenv(SMTP, "smtp://lab%40example.org:s3cret@mail.example.org")

    study = make_study(alarms={"mail": ["ada@example.org"]})
    assert AlarmChannels.of(study).send("It is full.")

    assert server.call_args.args == ("mail.example.org", 587)
    done = [(name, arguments) for name, arguments, _ in server.return_value.method_calls]
    assert [name for name, _ in done] == ["starttls", "login", "send_message"]
    assert done[1][1] == ("lab@example.org", "s3cret")
    assert done[2][1][0]["To"] == "ada@example.org"
    assert server.return_value.__exit__.called


def test_mail_without_a_server_and_addresses_that_are_none_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    study = make_study(alarms={"mail": ["ada@example.org"]})
    with pytest.raises(InputError, match="no mail server is named"):
        AlarmChannels.of(study)
    monkeypatch.setenv(SMTP, "mail.example.org:s3cret")
    with pytest.raises(InputError, match=SMTP) as caught:
        AlarmChannels.of(study)
    assert "s3cret" not in str(caught.value)
    with pytest.raises(ValidationError):
        make_study(alarms={"mail": ["ada@example.org\nBcc: all@example.org"]})
    monkeypatch.delenv(SMTP)
    assert not AlarmChannels.of(make_study(alarms=Alarms().model_dump())).is_any
