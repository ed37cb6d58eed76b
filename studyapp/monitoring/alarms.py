"""Alarms: researchers are told once when the study is full, stalls, or fills from one address.

Each server process looks every minute. The one that stores an alarm first sends it, by mail and to
a webhook, outside all requests. An alarm that cannot be sent is removed again, and tried later.
Passwords, and addresses that let somebody write there, come from the environment.
"""

import logging
import os
import smtplib
import ssl
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from email.message import EmailMessage
from email.utils import localtime, make_msgid
from functools import partial
from typing import Final, Literal, Self
from urllib.parse import unquote, urlsplit

from sqlalchemy import delete, func, select
from sqlalchemy.exc import IntegrityError, SQLAlchemyError
from sqlalchemy.orm import Session

from motion.errors import InputError
from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.database.tables.researchers import Alarm
from studyapp.database.tables.study_session import IntakeChange, StudySession, StudyVersion
from studyapp.session.enrolment import max_newcomers_from_one_address
from studyapp.session.intake import current_intake, wanted_places
from studyapp.session.places import require_open_intake, require_open_place
from studyapp.session.refusal import StudyFullError
from studyapp.session.served_study import ServedStudy
from studyapp.study.settings.study import Study

WEBHOOK: Final = "MOTIONJURY_ALARM_WEBHOOK"
"""An address to which each alarm is posted as JSON; whoever knows it can write there."""

SMTP: Final = "MOTIONJURY_SMTP"
"""The server that sends mail, such as ``smtps://name:password@mail.example.org``."""

SECONDS: Final = 20.0


@dataclass(frozen=True)
class AlarmChannels:
    """The ways that the alarms of one study go: what each is called, and sends a text by it."""

    ways: Mapping[str, Callable[[str], None]]

    @classmethod
    def of(cls, study: Study) -> Self:
        """Read where the alarms of `study` go.

        Raises
        ------
        InputError
            If the environment names no usable address, or there is nothing to send mail with.
        """
        webhook, server = _address(WEBHOOK, ("https", "http")), _address(SMTP, ("smtps", "smtp"))
        if study.alarms.mail and not server:
            raise InputError(
                "alarms are to be mailed, and no mail server is named",
                where="alarms.mail in study.toml",
                remedy=f"Set {SMTP}, such as smtps://name:password@mail.example.org",
            )
        ways: dict[str, Callable[[str], None]] = {}
        if webhook:
            ways["the webhook"] = partial(_post, webhook, study.name)
        if study.alarms.mail:
            ways["mail"] = partial(_mail, server, study)
        return cls(ways)

    def send(self, text: str) -> bool:
        """Send `text` by every way there is; return whether one of them succeeded.

        A failure is logged without address and password.
        """
        # Imported here: a server that raises no alarm need not load it.
        import httpx

        succeeded = False
        for name, send in self.ways.items():
            try:
                send(text)
                succeeded = True
            except (
                httpx.HTTPError,
                httpx.InvalidURL,
                smtplib.SMTPException,
                OSError,
                ValueError,  # such as letters that a mail server's name or password cannot have
            ) as error:
                LOG.error("An alarm could not be sent by %s (%s)", name, type(error).__name__)
        return succeeded


def _post(address: str, study: str, text: str) -> None:
    import httpx

    message = {"study": study, "text": text}
    httpx.post(address, json=message, timeout=SECONDS).raise_for_status()


def _mail(address: str, study: Study, text: str) -> None:
    server = urlsplit(address)
    name, password = unquote(server.username or ""), unquote(server.password or "")
    message = EmailMessage()
    message["From"] = name if "@" in name else study.alarms.mail[0]
    message["To"] = ", ".join(study.alarms.mail)
    message["Subject"] = f"Motion Jury: {study.name}"
    # Without these two, some servers refuse a mail, or take it for spam.
    message["Date"] = localtime()
    message["Message-ID"] = make_msgid(domain=message["From"].rpartition("@")[2])
    message.set_content(text)
    tls, host = ssl.create_default_context(), server.hostname or ""
    if server.scheme == "smtps":
        connection: smtplib.SMTP = smtplib.SMTP_SSL(
            host, server.port or 465, timeout=SECONDS, context=tls
        )
    else:
        connection = smtplib.SMTP(host, server.port or 587, timeout=SECONDS)
    with connection:
        if server.scheme == "smtp" and name:
            # Passwords are only sent encrypted.
            connection.starttls(context=tls)
        if name:
            connection.login(name, password)
        connection.send_message(message)


def _address(variable: str, schemes: tuple[str, ...]) -> str:
    text = os.environ.get(variable, "").strip()
    if not text:
        return ""
    try:
        parts = urlsplit(text)
        usable = parts.scheme in schemes and bool(parts.hostname) and parts.port != 0
    except ValueError:
        usable = False
    if not usable:
        raise InputError(
            "the environment variable holds no address that alarms can be sent to",
            where=variable,
            remedy=f"Begin it with {' or '.join(f'{scheme}://' for scheme in schemes)}",
        )
    return text


SECONDS_BETWEEN: Final = 60.0

LOG: Final = logging.getLogger("gunicorn.error")

Kind = Literal["full", "stalled", "one address"]


@dataclass(frozen=True, kw_only=True)
class Event:
    """An alarm that is due; see `studyapp.database.tables.researchers.Alarm`."""

    kind: Kind
    about: str
    text: str


def watch_for_alarms(raise_due: Callable[[], None]) -> None:
    """Call `raise_due` every minute from a thread of its own, as long as the process lives."""

    def watch() -> None:
        while True:
            time.sleep(SECONDS_BETWEEN)
            try:
                raise_due()
            except (SQLAlchemyError, InputError, OSError) as error:
                LOG.error("Alarms could not be looked for (%s)", type(error).__name__)

    threading.Thread(target=watch, name="alarms", daemon=True).start()


def raise_alarms(
    database: Database,
    served: ServedStudy,
    clock: Clock,
    send: Callable[[str], bool],
) -> None:
    """Send the alarms that are due and that nobody has sent.

    Parameters
    ----------
    send : callable
        Sends a text, and returns whether that succeeded.
    """
    now = clock.now()
    with database.reading() as session:
        due = list(_due(session, served, now))
        raised = {(row.kind, row.about) for row in session.scalars(select(Alarm))}
    for event in due:
        if (event.kind, event.about) in raised or not _claim(database, event, now):
            continue
        if not send(event.text):
            with database.writing() as session:
                stored = (Alarm.kind == event.kind, Alarm.about == event.about)
                session.execute(delete(Alarm).where(*stored))


def _claim(database: Database, event: Event, now: datetime) -> bool:
    """Store that `event` is being sent; False where another process has done so."""
    try:
        with database.writing() as session:
            session.add(Alarm(kind=event.kind, about=event.about, at=now))
    except IntegrityError:
        return False
    return True


def _due(session: Session, served: ServedStudy, now: datetime) -> Iterator[Event]:
    study = served.study
    most = max_newcomers_from_one_address(session, now)
    if most >= study.alarms.from_one_address:
        yield Event(
            kind="one address",
            about=now.date().isoformat(),
            text=f"{most} participants of the study {study.title!r} came from one network "
            "address within an hour.",
        )
    intake = current_intake(session)
    try:
        require_open_intake(served, intake)
    except StudyFullError:
        return
    version = session.scalars(select(StudyVersion).where(StudyVersion.in_force)).one()
    try:
        require_open_place(session, served, intake, now)
    except StudyFullError:
        places = sum(wanted_places(served, intake).values())
        yield Event(
            kind="full",
            about=f"version {version.number}, {places} places",
            text=f"The study {study.title!r} is full: all {places} places are held.",
        )
        return
    since = _last_progress(session, version)
    if now - since >= timedelta(hours=study.alarms.stalled_hours):
        yield Event(
            kind="stalled",
            about=since.isoformat(timespec="seconds"),
            text=f"The study {study.title!r} is open, and nobody has finished it for "
            f"{int((now - since).total_seconds() // 3600)} hours.",
        )


def _last_progress(session: Session, version: StudyVersion) -> datetime:
    """Return when somebody last finished, or when the intake last changed."""
    moments = (
        version.opened_at,
        session.scalar(select(func.max(StudySession.completed_at))),
        session.scalar(select(func.max(IntakeChange.at))),
    )
    return max(moment for moment in moments if moment is not None)
