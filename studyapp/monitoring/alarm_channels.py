"""Ways by which alarms reach researchers: mail, and a webhook. Secrets are in the environment."""

from __future__ import annotations

import logging
import os
import smtplib
import ssl
from collections.abc import Callable
from dataclasses import dataclass
from email.message import EmailMessage
from typing import Final, Self
from urllib.parse import unquote, urlsplit

import httpx

from motion.errors import InputError
from studyapp.study.settings.study import Study

WEBHOOK: Final = "MOTIONJURY_ALARM_WEBHOOK"
"""An address that gets each alarm as JSON; whoever knows it can write there."""

SMTP: Final = "MOTIONJURY_SMTP"
"""The server that sends mail, such as ``smtps://name:password@mail.example.org``."""

SECONDS: Final = 20.0
LOG: Final = logging.getLogger("gunicorn.error")


@dataclass(frozen=True, kw_only=True)
class AlarmChannels:
    """Where the alarms of one study go.

    Attributes
    ----------
    study : str
        Its name.
    webhook, smtp : str
        See `WEBHOOK` and `SMTP`; empty where there is none.
    mail : tuple of str
        Addresses of researchers.
    """

    study: str
    webhook: str
    smtp: str
    mail: tuple[str, ...]

    @classmethod
    def of(cls, study: Study) -> Self:
        """Read where the alarms of `study` go.

        Raises
        ------
        InputError
            If the environment names no usable address, or there is nothing to send mail with.
        """
        found = cls(
            study=study.name,
            webhook=_address(WEBHOOK, ("https", "http")),
            smtp=_address(SMTP, ("smtps", "smtp")),
            mail=study.alarms.mail,
        )
        if found.mail and not found.smtp:
            raise InputError(
                "alarms are to be mailed, and no mail server is named",
                where="alarms.mail in study.toml",
                remedy=f"Set {SMTP}, such as smtps://name:password@mail.example.org",
            )
        return found

    @property
    def is_any(self) -> bool:
        """Whether alarms go anywhere."""
        return bool(self.webhook or self.mail)

    def send(self, text: str) -> bool:
        """Send `text` by every way there is; tell whether one of them succeeded.

        A failure is logged without what it was sent with.
        """
        ways: list[tuple[str, Callable[[str], None]]] = []
        if self.webhook:
            ways.append(("the webhook", self._post))
        if self.mail:
            ways.append(("mail", self._mail))
        succeeded = False
        for name, way in ways:
            try:
                way(text)
                succeeded = True
            except (httpx.HTTPError, httpx.InvalidURL, smtplib.SMTPException, OSError) as error:
                LOG.error("An alarm could not be sent by %s (%s)", name, type(error).__name__)
        return succeeded

    def _post(self, text: str) -> None:
        answer = httpx.post(self.webhook, json={"study": self.study, "text": text}, timeout=SECONDS)
        answer.raise_for_status()

    def _mail(self, text: str) -> None:
        server = urlsplit(self.smtp)
        name, password = unquote(server.username or ""), unquote(server.password or "")
        message = EmailMessage()
        message["From"] = name if "@" in name else self.mail[0]
        message["To"] = ", ".join(self.mail)
        message["Subject"] = f"Motion Jury: {self.study}"
        message.set_content(text)
        safely = ssl.create_default_context()
        host = server.hostname or ""
        if server.scheme == "smtps":
            connection: smtplib.SMTP = smtplib.SMTP_SSL(
                host, server.port or 465, timeout=SECONDS, context=safely
            )
        else:
            connection = smtplib.SMTP(host, server.port or 587, timeout=SECONDS)
        with connection:
            if server.scheme == "smtp" and name:
                # A password never travels in the open.
                connection.starttls(context=safely)
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
