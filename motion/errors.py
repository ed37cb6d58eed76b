"""Errors that people are meant to read, and the wording of lists and counts."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager


class InputError(Exception):
    """An input that a person supplied cannot be used.

    Every message answers three questions: what is wrong, where, and what to do about it. The
    command line prints the message without a traceback and exits non-zero.

    Parameters
    ----------
    what : str
        What is wrong, as a clause; a final full stop is dropped, since the message adds its own.
    where : object, optional
        The file, and the line, row, frame or key in it, where the error is.
    remedy : str, optional
        What to do, as a sentence; a final full stop is dropped too.
    """

    def __init__(self, what: str, *, where: object = "", remedy: str = "") -> None:
        self.what = _without_full_stop(what)
        self.where = str(where)
        self.remedy = _without_full_stop(remedy)
        message = f"{self.where}: {self.what}" if self.where else self.what
        super().__init__(f"{message}. {self.remedy}." if self.remedy else f"{message}.")


@contextmanager
def found_at(where: object) -> Iterator[None]:
    """Add `where` to an `InputError` raised in the block."""
    try:
        yield
    except InputError as error:
        raise InputError(error.what, where=where, remedy=error.remedy) from error


def _without_full_stop(words: str) -> str:
    # Texts of other libraries' errors, and of other messages, may end in a full stop.
    return words.rstrip(". \n")


def listed(words: Sequence[str]) -> str:
    """Return ``a, b and c``; empty for no words."""
    return " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))


def counted(number: int, noun: str) -> str:
    """Return ``1 clip`` or ``2 clips``."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
