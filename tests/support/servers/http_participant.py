"""A participant who reads and sends the pages of a real server."""

import re
from urllib.parse import urljoin

import httpx

from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.visitor import filled

TOKEN = re.compile(r"(?:take|media|join)/([\w-]{20,})")


class HttpParticipant:
    """Goes through a study, and notes every token that a log might hold."""

    def __init__(self, client: httpx.Client, address: str, *, pages: int) -> None:
        self.client = client
        self.tokens: set[str] = set()
        self.page = self.read(client.get(address))
        for _page in range(pages):
            self.go_on()

    def read(self, answer: httpx.Response) -> PageReader:
        if answer.status_code == 303:
            answer = self.client.get(urljoin(str(answer.url), answer.headers["location"]))
        assert answer.status_code == 200, answer.text
        self.address = str(answer.url)
        self.tokens.update(TOKEN.findall(self.address), TOKEN.findall(answer.text))
        return PageReader(answer.text)

    @property
    def video(self) -> str:
        """Where the first video of the page is."""
        return urljoin(self.address, str(self.page.one("video")["src"]))

    def go_on(self) -> None:
        """Report all videos as watched without waiting, and send the page's form."""
        for video in self.page.soup.select("video"):
            source = urljoin(self.address, str(video["src"]))
            assert self.client.get(source, headers={"Range": "bytes=0-"}).status_code == 206
            report = {"batch": 0, "intervals": [[0.0, float(str(video["data-duration"]))]]}
            told = self.client.post(
                urljoin(self.address, str(video["data-watched-url"])), json=report
            )
            assert told.json()["missing"] == 0
        to = urljoin(self.address, self.page.action)
        self.page = self.read(self.client.post(to, data=filled(self.page)))
