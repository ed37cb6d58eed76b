"""Making and changing `study.toml` without losing the comments in it."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Mapping
from decimal import Decimal
from pathlib import Path
from typing import Any, Final

import tomlkit

from generators.registry import generator_names, needs_model
from motion.errors import InputError
from motion.files import write_text
from motion.segment import check_name
from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.reading import ALIASES, parse_study, parse_text, read_text
from studyapp.study.settings.recruitment import Pay, Prolific, draw_code, format_amount
from studyapp.study.settings.study import Study
from studyapp.study.study_options import StudyOptions, condition_variables, conditions_text
from studyapp.study.template_language import render_template, translate_study_file

TEMPLATES: Final = ("pairwise", "rating", "ranking", "mismatch", *ALIASES, "three-systems")
"""The protocols, the papers whose studies they follow, and all three papers' systems together."""

_PARTICIPANTS: Final = ("participants_per_comparison", "participants")
"""Keys that say how many there are; a template has one of them."""


def new_study(path: Path, **wanted: Any) -> Study:
    """Write a commented study file from a template and return what it says.

    Parameters
    ----------
    path : Path
        The study file to be made; an existing one is never overwritten.
    **wanted
        What it is to say; see `studyapp.study.study_options.StudyOptions`.

    Raises
    ------
    InputError
        As `render_study_file`, and if the file exists.
    """
    require_new_file(path)
    text = render_study_file(StudyOptions(**wanted), where=path)
    write_text(path, text)
    return parse_text(text, where=path)


def template_participants(template: str) -> int:
    """Return how many participants a template has; of pairwise studies, for each comparison."""
    said = tomllib.loads(render_template(_template_file(template)))
    return int(said[_participants(said)])


def _template_file(template: str) -> str:
    return f"{ALIASES.get(template, template)}.toml"


def _participants(said: Mapping[str, Any]) -> str:
    return next(key for key in _PARTICIPANTS if key in said)


def require_new_file(path: Path) -> None:
    """Raise `InputError` if there is a study file already."""
    if path.exists():
        raise InputError(
            "the study exists already",
            where=path,
            remedy="Edit that file, or choose another folder",
        )


def render_study_file(wanted: StudyOptions, *, where: object) -> str:
    """Return the text of a study file; nothing is written.

    Parameters
    ----------
    wanted : WantedStudy
        What it is to say.
    where : object
        What errors name.

    Raises
    ------
    InputError
        If the template is unknown or does not have a key that is given, or the result would not
        be a valid study.
    """
    template = wanted.template
    if template not in TEMPLATES:
        raise InputError(
            f"unknown template {template!r}", remedy=f"Use one of {', '.join(TEMPLATES)}"
        )
    file = _template_file(template)
    defaults = tomllib.loads(render_template(file))
    is_ranking = defaults["protocol"] == "ranking"
    stated = _template_variables(wanted)
    if wanted.reference is not None:
        stated["reference"] = check_name(wanted.reference, "condition")
    if wanted.conditions:
        stated |= condition_variables(
            defaults["protocol"],
            wanted.conditions,
            reference=wanted.reference,
            catch_videos=wanted.catch_videos,
        )
    elif wanted.reference is not None and wanted.reference not in defaults["conditions"]:
        known = wanted.reference in generator_names() and not needs_model(wanted.reference)
        added = Condition(generator=wanted.reference if known and not is_ranking else None)
        stated["added"] = conditions_text({wanted.reference: added})
    own = wanted.reference if wanted.conditions is None and not is_ranking else None
    for key, value in (("reference", own), ("trials", wanted.trials)):
        if value is not None and key not in defaults:
            raise InputError(
                f"the template {template!r} does not set {key!r}",
                remedy="Leave the option out and edit the study file",
            )
    if wanted.trials is not None:
        stated["trials"] = wanted.trials
        stated["practice"] = min(int(defaults["practice"]), max(wanted.trials // 2, 0))
    text = render_template(file, **stated)
    text = translate_study_file(text, file, wanted.language, title=wanted.title)
    text = _with_wording(text, wanted)
    parse_text(text, where=where)
    return text


def _with_wording(text: str, wanted: StudyOptions) -> str:
    """Return a study file with the questions and the avatar that are wanted."""
    document: Any = tomlkit.parse(text)
    for question in document["questions"]:
        if (words := wanted.wording.get(question["name"])) is not None:
            question["text"] = words
    if wanted.avatar is not None:
        document["video"]["avatar"] = wanted.avatar
    return tomlkit.dumps(document) if wanted.wording or wanted.avatar else text


def _template_variables(wanted: StudyOptions) -> dict[str, Any]:
    """Return what is stated of a study whatever its protocol."""
    pay = wanted.pay or Pay()
    each = pay.payment or Decimal(0)
    is_paid_there = wanted.channel in ("prolific", "mturk")
    stated: dict[str, Any] = {
        "name": check_name(wanted.name, "study"),
        "title": wanted.title,
        "participants": wanted.participants,
        "channel": wanted.channel,
        "minutes": wanted.minutes,
        "organisation": wanted.organisation,
        "contact": wanted.contact,
        "ethics": wanted.ethics,
        "payment": format_amount(each, pay.currency) if each else None,
        "pay": pay.model_dump(exclude_defaults=True, exclude={"amount"} if is_paid_there else None),
    }
    if wanted.channel == "prolific":
        codes = {key: draw_code() for key in Prolific().codes}
        stated["prolific"] = {"reward": int(each * 100), **codes}
    if wanted.channel == "mturk":
        stated["mturk"] = {"reward": f"{each:.2f}"}
    return {key: value for key, value in stated.items() if value is not None}


class ChangedMeanwhileError(InputError):
    """Somebody has saved the file since it was read; `text` is what it says now."""

    def __init__(self, text: str) -> None:
        self.text = text
        super().__init__(
            "the study file has been changed since you opened it, so yours was not saved",
            remedy="Compare the two, and save once more what is to stand",
        )


def replace_text(path: Path, text: str, *, seen: str) -> Study:
    """Write a study file that was edited elsewhere, and return what it says.

    Parameters
    ----------
    seen : str
        The file's `text_digest` when it was read.

    Raises
    ------
    ChangedMeanwhileError
        If it says something else now.
    InputError
        If `text` is no valid study; every key that is wrong is named.
    """
    now = read_text(path)
    if text_digest(now) != seen:
        raise ChangedMeanwhileError(now)
    study = parse_text(text, where=path.name)
    write_text(path, text)
    return study


def text_digest(text: str) -> str:
    """Return what tells one text of a study file from another."""
    return hashlib.sha256(text.encode()).hexdigest()


def add_condition(path: Path, name: str, *, videos: bool = False) -> Study:
    """Add a condition of motion files, or of finished videos, to a study file with its comments."""
    document = tomlkit.parse(path.read_text(encoding="utf-8"))
    table = tomlkit.table()
    if videos:
        table.add("videos", True)
    table.add(tomlkit.nl())
    document["conditions"][check_name(name, "condition", path)] = table
    return _write(path, document)


def _write(path: Path, document: tomlkit.TOMLDocument) -> Study:
    """Write `document` once it has proved to be a valid study."""
    text = tomlkit.dumps(document)
    study = parse_study(tomllib.loads(text), where=path)
    write_text(path, text)
    return study
