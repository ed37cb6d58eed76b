"""A text for participants before it is said in the study's language."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, TypeAlias

from motion.listing import listed

Value: TypeAlias = "int | str | Message | tuple[Value, ...]"
"""What stands in a place of a message; a tuple is said as a list: a, b and c."""


class Message:
    """An English text with named places, ``{so}``, and what stands in them.

    The text is a literal wherever a message is made, so that it can be found and translated.

    Parameters
    ----------
    text : str
        Whole sentences, or the words of a label.
    **values : int, str, Message or tuple of them
        By the names of the places.
    """

    def __init__(self, text: str, /, **values: Value) -> None:
        self.text: Final = text
        self.values: Final = values

    def said(self, translate: Callable[[str], str], join: Callable[[Sequence[str]], str]) -> str:
        """Return the message in another language.

        Parameters
        ----------
        translate : callable
            Gives a text in that language, with the same places.
        join : callable
            Makes a list of words there.
        """

        def filled(value: Value) -> str:
            if isinstance(value, Message):
                return value.said(translate, join)
            if isinstance(value, tuple):
                return join([filled(each) for each in value])
            return str(value)

        text = translate(self.text)
        return text.format_map({name: filled(value) for name, value in self.values.items()})

    def __str__(self) -> str:
        """Return the message in English."""
        return self.said(str, listed)

    def __repr__(self) -> str:
        return f"Message({str(self)!r})"
