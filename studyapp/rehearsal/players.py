"""Reading the videos of a page as they were really served."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import urljoin, urlsplit

from bs4 import Tag


class UnplayableError(Exception):
    """A video lacks something without which it cannot be watched; says what."""


@dataclass(frozen=True)
class Player:
    """One video as the page plays it.

    Attributes
    ----------
    source : str
        Absolute address of the file.
    watched_address : str
        Absolute address that is told which parts were played.
    duration : float
        Seconds.
    """

    source: str
    watched_address: str
    duration: float

    @property
    def token_candidates(self) -> tuple[str, ...]:
        """Parts of the address that can be the media token; nothing else tells what is shown."""
        return token_candidates(self.source)


def token_candidates(address: str) -> tuple[str, ...]:
    """Return the parts of an address that can be a token."""
    parts = urlsplit(address).path.split("/")
    return tuple(piece for part in parts if part for piece in {part, part.partition(".")[0]})


def read_player(video: Tag, page_address: str) -> Player:
    """Return what a page's `video` plays.

    Raises
    ------
    UnplayableError
        If its file, its length or where to report to is missing.
    """
    inner = video.find("source")
    found = {
        "src": video.get("src") or (inner.get("src") if inner else None),
        "data-duration": video.get("data-duration"),
        "data-watched-url": video.get("data-watched-url"),
    }
    for name, value in found.items():
        if not value:
            raise UnplayableError(f"has a video without {name}")
    return Player(
        source=urljoin(page_address, str(found["src"])),
        watched_address=urljoin(page_address, str(found["data-watched-url"])),
        duration=float(str(found["data-duration"])),
    )
