"""Reading a form as it was really served: its fields, what each offers, and its buttons."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bs4 import BeautifulSoup, Tag

Fields = tuple[tuple[str, str], ...]

FormFields = Mapping[str, Sequence[str]]
"""What is answered: the values of each field."""

FormData = dict[str, list[str]]
"""What a browser would send: every value of every name."""


class IncompleteFormError(Exception):
    """A form lacks something that a person would need; says what."""


@dataclass(frozen=True, kw_only=True)
class Form:
    """A form that is sent by POST, with exactly what its page offers.

    Attributes
    ----------
    action : str
        Address it is sent to, as the page names it; empty for the page itself.
    hidden : tuple of (name, value)
        What is sent along unseen.
    required_ticks : tuple of (name, value)
        Tick boxes without which a browser would not send it.
    choices : mapping of name to tuple of str
        Values that each radio group or menu offers.
    lines : mapping of name to (low, high)
        Fields that take a line of text, or a number between the two.
    boxes : mapping of name to tuple of str
        Values of boxes that may be ticked.
    buttons : tuple of (name, value)
        Submit buttons; the name is empty where a button sends nothing itself.
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
        """Token of the presentation it is for; empty outside a trial."""
        return dict(self.hidden).get("trial", "")

    @property
    def asked(self) -> frozenset[str]:
        """Names of the fields that wait for an answer."""
        return frozenset((*self.choices, *self.lines))

    def filled(self, answers: FormFields) -> FormData:
        """Return the data a browser would send with `answers` chosen.

        Raises
        ------
        IncompleteFormError
            If a question or a value is not offered, a question is left over, or there is no
            button to send the form with.
        """
        if not self.buttons:
            raise IncompleteFormError("has no button to send its form with")
        for name, values in answers.items():
            for value in values:
                self._require_offered(name, value)
        unknown = sorted(self.asked - set(answers))
        if unknown:
            raise IncompleteFormError(f"asks {', '.join(unknown)}, which the study does not know")
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
                    f"takes no {value!r} for {name!r} (only {low:g} to {high:g})"
                )
            return
        offered = self.choices.get(name) or self.boxes.get(name)
        if offered is None:
            raise IncompleteFormError(f"does not ask the question {name!r}")
        if value not in offered:
            raise IncompleteFormError(
                f"offers no {value!r} for {name!r} (only {', '.join(offered)})"
            )


def read_form(soup: BeautifulSoup, form: Tag) -> Form:
    """Return what `form`, a part of the page `soup`, offers."""
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
    """Yield the form's usable controls; one may name its form and lie elsewhere."""
    for control in soup.find_all(["input", "button", "select", "textarea"]):
        belongs = (
            control["form"] == form.get("id")
            if control.has_attr("form")
            else control.find_parent("form") is form
        )
        if belongs and not control.has_attr("disabled"):
            yield control


def _options(menu: Tag) -> tuple[str, ...]:
    """Return what a menu offers; its empty entry stands for no answer."""
    values = [
        str(option.get("value", option.get_text(strip=True))) for option in menu.find_all("option")
    ]
    return tuple(value for value in values if value)


def _kind(control: Tag) -> str:
    """Return the type of a control; a button without one sends its form."""
    if control.name in ("select", "textarea"):
        return str(control.name)
    default = "submit" if control.name == "button" else "text"
    return str(control.get("type", default)).lower()
