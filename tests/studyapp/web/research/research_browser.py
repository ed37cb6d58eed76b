"""A researcher's browser without scripts."""

from flask import Flask
from flask.testing import FlaskClient
from werkzeug.test import TestResponse

from tests.studyapp.web.page_reader import PageReader
from tests.support.researcher_accounts import PASSWORD

LOGIN = "/research/log-in"


class ResearchBrowser:
    """Keeps the cookie and the code that forms carry, as a browser and its pages do."""

    def __init__(self, app: Flask) -> None:
        self.client: FlaskClient = app.test_client()

    def get(self, address: str, status: int = 200) -> PageReader:
        answer = self.client.get(address)
        assert answer.status_code == status, answer.text
        return PageReader(answer.text)

    def code(self) -> str:
        """Return the code of forms, from a page that everybody may open."""
        answer = self.client.get(LOGIN, follow_redirects=True)
        return PageReader(answer.text).soup.select("[name=form_code]")[0]["value"]  # type: ignore[return-value]

    def post(self, address: str, **fields: str | list[str]) -> TestResponse:
        """Send a form as its page would."""
        return self.client.post(address, data={"form_code": self.code(), **fields})

    def log_in(self, name: str, password: str = PASSWORD, **fields: str) -> TestResponse:
        return self.post(LOGIN, name=name, password=password, **fields)

    @property
    def cookies(self) -> dict[str, str]:
        """The cookies that the browser would send to researchers' pages."""
        cookies = self.client._cookies or {}
        return {cookie.key: cookie.value for cookie in cookies.values()}
