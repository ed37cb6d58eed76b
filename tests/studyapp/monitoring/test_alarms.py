"""Researchers are alerted once of each event in their study."""

import logging
import smtplib
from dataclasses import dataclass, field, replace
from threading import Event
from unittest.mock import MagicMock

import pytest
from flask import Flask, request
from pydantic import ValidationError
from sqlalchemy.exc import SQLAlchemyError

from motion.errors import InputError
from studyapp.database.engine import Database
from studyapp.database.sqlite import WriterLockError
from studyapp.monitoring import alarms
from studyapp.monitoring.alarms import SMTP, WEBHOOK, AlarmChannels, raise_alarms, watch_for_alarms
from studyapp.session.enrolment import add_newcomer
from studyapp.session.served_study import ServedStudy
from tests.support.servers.local_server import listening
from tests.support.studies.made_study import make_study
from tests.support.studies.taking_part_steps import Participant, SetClock


@dataclass
class Outbox:
    """The alarms that were sent for a study; sending succeeds as long as it `works`."""

    database: Database
    served: ServedStudy
    clock: SetClock
    texts: list[str] = field(default_factory=list)
    works: bool = True

    def send(self, text: str) -> bool:
        self.texts.append(text)
        return self.works

    def look(self) -> int:
        """Raise alarms as a server does; return how many were sent so far."""
        raise_alarms(self.database, self.served, self.clock, self.send)
        return len(self.texts)

    def fill(self) -> None:
        for number in range(sum(arm.places for arm in self.served.study.arms)):
            Participant(self.database, self.served, self.clock).enrol(f"visit {number}")

    def come(self, address: str, how_many: int) -> None:
        with self.database.writing() as session:
            for _ in range(how_many):
                add_newcomer(session, address, self.clock.now())


@pytest.fixture
def outbox(opened: Database, served: ServedStudy, clock: SetClock) -> Outbox:
    return Outbox(opened, served, clock)


def test_a_full_study_raises_one_alarm_unless_sending_failed(outbox: Outbox) -> None:
    assert outbox.look() == 0
    outbox.fill()
    outbox.works = False
    assert outbox.look() == 1
    outbox.works = True

    assert [outbox.look() for _ in range(3)] == [2, 2, 2]
    told = "The study 'Gestures and speech' is full: all 4 places are held."
    assert outbox.texts == [told] * 2


def test_a_stalled_study_raises_one_alarm_for_each_stall(
    participant: Participant, outbox: Outbox
) -> None:
    seen = []
    for hours in (23, 1, 1):
        outbox.clock.advance(hours=hours)
        seen.append(outbox.look())
    assert seen == [0, 1, 1]
    assert "nobody has finished it for 24 hours" in outbox.texts[0]

    participant.take_all()
    outbox.clock.advance(hours=25)
    assert outbox.look() == 2
    closed = outbox.served.study.model_copy(update={"open": False})
    outbox.served = replace(outbox.served, study=closed)
    outbox.clock.advance(hours=100)
    participant.another().enrol("late").begin().take_all()
    outbox.clock.advance(hours=100)
    assert outbox.look() == 2


def test_many_newcomers_from_one_address_within_an_hour_raise_one_alarm(outbox: Outbox) -> None:
    outbox.come("192.0.2.9", 5)
    outbox.clock.advance(hours=1)
    outbox.come("192.0.2.9", 9)
    outbox.come("198.51.100.7", 5)
    assert outbox.look() == 0
    outbox.come("192.0.2.9", 1)

    assert (outbox.look(), outbox.look()) == (1, 1)
    assert outbox.texts == [
        "10 participants of the study 'Gestures and speech' came from one network address "
        "within an hour."
    ]


def test_alarms_are_looked_for_again_after_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(alarms, "SECONDS_BETWEEN", 0.0)
    failures: list[Exception] = [OSError(), WriterLockError("blocked"), SQLAlchemyError()]
    succeeded = Event()

    def look() -> None:
        if failures:
            raise failures.pop()
        succeeded.set()
        Event().wait()  # such threads never end

    watch_for_alarms(look)

    assert succeeded.wait(30)


def test_a_webhook_gets_the_alarm_as_json_and_its_failure_names_no_secret(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    app, got = Flask(__name__), []

    @app.post("/hook")
    def take() -> str:
        got.append(request.get_json())
        return ""

    study = make_study(name="mine")
    with listening(app.wsgi_app) as address, caplog.at_level(logging.INFO, "gunicorn.error"):
        monkeypatch.setenv(WEBHOOK, f"{address}/hook")
        assert AlarmChannels.of(study).send("It is full.")
        monkeypatch.setenv(WEBHOOK, f"{address}/secret-of-the-hook")
        assert not AlarmChannels.of(study).send("It is full.")
        monkeypatch.setenv(WEBHOOK, "https://secret..example.org/")  # no name of a host
        assert not AlarmChannels.of(study).send("It is full.")
    assert got == [{"study": "mine", "text": "It is full."}]
    assert "An alarm could not be sent by the webhook (HTTPStatusError)" in caplog.messages
    assert not any("secret" in line for line in caplog.messages if "alarm" in line)


@pytest.mark.parametrize(
    ("scheme", "port", "steps"),
    [
        ("smtp", 587, ["starttls", "login", "send_message"]),
        ("smtps", 465, ["login", "send_message"]),
    ],
)
def test_mail_is_sent_encrypted_with_credentials_from_the_environment(
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    scheme: str,
    port: int,
    steps: list[str],
) -> None:
    server = MagicMock()
    monkeypatch.setattr(smtplib, "SMTP" if scheme == "smtp" else "SMTP_SSL", server)
    monkeypatch.setenv(SMTP, f"{scheme}://lab%40example.org:s3cret@mail.example.org")

    study = make_study(alarms={"mail": ["ada@example.org"]})
    assert AlarmChannels.of(study).send("It is full.")

    assert caplog.messages == []
    assert server.call_args.args == ("mail.example.org", port)
    done = [(name, arguments) for name, arguments, _ in server.return_value.method_calls]
    assert [name for name, _ in done] == steps
    assert done[-2][1] == ("lab@example.org", "s3cret")
    mail = done[-1][1][0]
    assert mail["To"] == "ada@example.org"
    assert mail["Date"]
    assert mail["Message-ID"].endswith("@example.org>")
    assert server.return_value.__exit__.called


@pytest.mark.parametrize(
    ("server", "problem"),
    [
        ("", "no mail server is named"),
        ("mail.example.org:s3cret", SMTP),
        ("smtp://mail.example.org:s3cret", SMTP),
    ],
)
def test_mail_without_a_usable_server_is_refused(
    monkeypatch: pytest.MonkeyPatch, server: str, problem: str
) -> None:
    monkeypatch.setenv(SMTP, server)
    with pytest.raises(InputError, match=problem) as caught:
        AlarmChannels.of(make_study(alarms={"mail": ["ada@example.org"]}))
    assert "s3cret" not in str(caught.value)


def test_an_address_cannot_inject_mail_headers() -> None:
    with pytest.raises(ValidationError):
        make_study(alarms={"mail": ["ada@example.org\nBcc: all@example.org"]})
