"""The one family of errors that a person is meant to read."""

from __future__ import annotations


class InputError(Exception):
    """Something a person supplied cannot be used as it is.

    Every message answers three questions, so that whoever reads it can go on: what is wrong,
    where it was found, and what to do about it. The command line prints the message without a
    traceback and exits non-zero.

    Parameters
    ----------
    what : str
        What is wrong, as a clause without a final full stop.
    where : object, optional
        The file, and within it the line, row, frame or key, where it was found.
    remedy : str, optional
        What to do, as a sentence without a final full stop.
    """

    def __init__(self, what: str, *, where: object = "", remedy: str = "") -> None:
        self.what = what
        self.where = str(where)
        self.remedy = remedy
        message = f"{self.where}: {what}" if self.where else what
        super().__init__(f"{message}. {remedy}." if remedy else f"{message}.")
