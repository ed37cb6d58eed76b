"""The fenced blocks of a Markdown page that are run, changed or filled."""

import re
from dataclasses import dataclass
from typing import Final

_FENCE: Final = re.compile(r"^```(?P<info>[^\n`]*)\n(?P<body>.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True, kw_only=True)
class Fenced:
    """A fenced block.

    Attributes
    ----------
    language : str
        The first word after the fence, such as ``sh``.
    words : tuple of str
        The words after the language.
    body : str
        Its content, including the last newline.
    start, end : int
        Its position in the page, fences included.
    """

    language: str
    words: tuple[str, ...]
    body: str
    start: int
    end: int


def fenced_blocks(page: str) -> list[Fenced]:
    """Return all fenced blocks of a page, in order."""
    blocks = []
    for block in _FENCE.finditer(page):
        language, *words = block["info"].split() or [""]
        blocks.append(
            Fenced(
                language=language,
                words=tuple(words),
                body=block["body"],
                start=block.start(),
                end=block.end(),
            )
        )
    return blocks


def follows(page: str, before: Fenced, after: Fenced) -> bool:
    """Return whether only white space separates two blocks."""
    return not page[before.end : after.start].strip()


def with_body(page: str, block: Fenced, body: str) -> str:
    """Return the page with another body in a block."""
    info = " ".join((block.language, *block.words))
    return f"{page[: block.start]}```{info}\n{body}```{page[block.end :]}"
