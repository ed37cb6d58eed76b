"""Parsing a served form: its fields, their choices, and its buttons."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bs4 import BeautifulSoup, Tag

Fields = tuple[tuple[str, str], ...]

FormFields = Mapping[str, Sequence[str]]
"""The answered values of each field."""

FormData = dict[str, list[str]]
"""The values of every name, as a browser sends them."""


class IncompleteFormError(Exception):
    """A form lacks something that a participant needs."""


@dataclass(frozen=True, kw_only=True)
class Form:
    """A form that is sent by POST.

    Attributes
    ----------
    action : str
        Its address, as in the page; empty for the page itself.
    hidden : tuple of (name, value)
        Hidden fields.
    required_ticks : tuple of (name, value)
        Required tick boxes.
    choices : mapping of name to tuple of str
        Values of each radio group or menu.
    lines : mapping of name to (low, high)
        Fields for a line of text, or a number in this range.
    boxes : mapping of name to tuple of str
        Values of optional tick boxes.
    buttons : tuple of (name, value)
        Submit buttons; the name is empty if a button sends no value.
    """

    action: str
    hidden: Fields
    required_ticks: Fields
    choices: Mapping[str, tuple[str, ...]]
    lines: Mapping[str, tuple[float, float]]
    boxes: Mapping[str, tuple[str, ...]]
    buttons: Fields

    @property
    def trial(self) -> str:
        """Token of its presentation; empty outside a trial."""
        return dict(self.hidden).get("trial", "")

    @property
    def questions(self) -> frozenset[str]:
        """Names of the fields that need an answer."""
        return frozenset((*self.choices, *self.lines))

    def fill(self, answers: FormFields) -> FormData:
        """Return the data that a browser would send with `answers`.

        Raises
        ------
        IncompleteFormError
            If a question or a value is not offered, a question has no answer, or there is no submit
            button.
        """
        if not self.buttons:
            raise IncompleteFormError("has no submit button")
        for name, values in answers.items():
            for value in values:
                self._require_offered(name, value)
        unknown = sorted(self.questions - set(answers))
        if unknown:
            raise IncompleteFormError(f"asks {', '.join(unknown)}, which the study does not define")
        data: FormData = {}
        button = tuple((name, value) for name, value in self.buttons[:1] if name)
        for name, value in (*self.hidden, *self.required_ticks, *button):
            data.setdefault(name, []).append(value)
        return data | {name: list(values) for name, values in answers.items()}

    def _require_offered(self, name: str, value: str) -> None:
        if name in self.lines:
            low, high = self.lines[name]
            if math.isfinite(low + high) and value and not low <= float(value) <= high:
                raise IncompleteFormError(
                    f"does not accept {value!r} for {name!r} (only {low:g} to {high:g})"
                )
            return
        offered = self.choices.get(name) or self.boxes.get(name)
        if offered is None:
            raise IncompleteFormError(f"does not ask the question {name!r}")
        if value not in offered:
            raise IncompleteFormError(
                f"does not offer {value!r} for {name!r} (only {', '.join(offered)})"
            )


def read_form(soup: BeautifulSoup, form: Tag) -> Form:
    """Return `form`, which is part of the page `soup`."""
    hidden: list[tuple[str, str]] = []
    ticks: list[tuple[str, str]] = []
    choices: dict[str, tuple[str, ...]] = {}
    lines: dict[str, tuple[float, float]] = {}
    boxes: dict[str, tuple[str, ...]] = {}
    buttons: list[tuple[str, str]] = []
    for control in _controls(soup, form):
        name, value = str(control.get("name", "")), str(control.get("value", ""))
        match _kind(control):
            case "hidden":
                hidden.append((name, value))
            case "checkbox" if control.has_attr("required"):
                ticks.append((name, value or "on"))
            case "checkbox":
                boxes[name] = (*boxes.get(name, ()), value or "on")
            case "radio":
                choices[name] = (*choices.get(name, ()), value)
            case "select":
                choices[name] = _options(control)
            case "text" | "textarea":
                lines[name] = (-math.inf, math.inf)
            case "number":
                lines[name] = (
                    float(str(control.get("min", "-inf"))),
                    float(str(control.get("max", "inf"))),
                )
            case "submit":
                buttons.append((name, value))
    return Form(
        action=str(form.get("action") or ""),
        hidden=tuple(hidden),
        required_ticks=tuple(ticks),
        choices=choices,
        lines=lines,
        boxes=boxes,
        buttons=tuple(buttons),
    )


def _controls(soup: BeautifulSoup, form: Tag) -> Iterator[Tag]:
    """Yield the form's enabled controls, which may be outside the form and refer to it."""
    for control in soup.find_all(["input", "button", "select", "textarea"]):
        belongs = (
            control["form"] == form.get("id")
            if control.has_attr("form")
            else control.find_parent("form") is form
        )
        if belongs and not control.has_attr("disabled"):
            yield control


def _options(menu: Tag) -> tuple[str, ...]:
    """Return the values of a menu; its empty entry means no answer."""
    values = [
        str(option.get("value", option.get_text(strip=True))) for option in menu.find_all("option")
    ]
    return tuple(value for value in values if value)


def _kind(control: Tag) -> str:
    """Return the type of a control; the default of a button is submit."""
    if control.name in ("select", "textarea"):
        return str(control.name)
    default = "submit" if control.name == "button" else "text"
    return str(control.get("type", default)).lower()
