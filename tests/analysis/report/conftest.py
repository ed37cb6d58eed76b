from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

import pytest
from bs4 import BeautifulSoup

VOID = {"meta", "br", "hr", "img", "link", "input", "col", "wbr"}


class _Nesting(HTMLParser):
    """Fail on any element that is not closed where it was opened."""

    def __init__(self):
        super().__init__(convert_charrefs=True)
        self.open = []

    def handle_starttag(self, tag, attrs):
        names = [name for name, _ in attrs]
        assert len(names) == len(set(names)), f"<{tag}> repeats an attribute"
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        pass

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag, f"</{tag}> is out of place at {self.getpos()}"


@pytest.fixture
def open_page():
    """Return a reader of report pages that insists on well-formed HTML."""

    def read(path: Path) -> BeautifulSoup:
        text = path.read_text(encoding="utf-8")
        nesting = _Nesting()
        nesting.feed(text)
        assert nesting.open == []
        return BeautifulSoup(text, "html.parser")

    return read
