"""Creating and changing `study.toml` with its comments."""

import hashlib
import tomllib
from collections.abc import Mapping
from decimal import Decimal
from itertools import chain
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import tomlkit
from jinja2 import ChainableUndefined, Environment, PackageLoader, Undefined

from generators.registry import generator_names, needs_model
from motion.errors import InputError
from motion.files import write_text
from motion.segment import check_name
from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.presentation import Language
from studyapp.study.settings.questions import is_about_face
from studyapp.study.settings.reading import ALIASES, parse_study, parse_text, read_text
from studyapp.study.settings.recruitment import Pay, Prolific, draw_code, format_amount
from studyapp.study.settings.study import Study
from studyapp.study.study_options import StudyOptions, condition_variables, conditions_text

TEMPLATES: Final = ("pairwise", "rating", "ranking", "mismatch", *ALIASES, "three-systems")
"""The protocols, the papers whose studies they follow, and all three papers' systems together."""

_FILES: Final = Environment(
    loader=PackageLoader("studyapp.study"),
    undefined=ChainableUndefined,
    trim_blocks=True,
    keep_trailing_newline=True,
    autoescape=False,  # noqa: S701  (study files are TOML, not HTML)
)


def _key(name: str, example: object, value: object) -> str:
    """Return a key as a line of a study file, commented out if it has no value."""
    if isinstance(value, Undefined):
        return f"# {name} = {example}"
    return f"{name} = {_toml(value)}"


def _toml(value: object) -> str:
    return tomlkit.item(value).as_string()


_FILES.globals["key"] = _key
_FILES.filters["toml"] = _toml


def read_texts(template: str, language: Language = "en") -> dict[str, Any]:
    """Return the texts for participants of one of `TEMPLATES`."""
    return tomllib.loads(_FILES.get_template(f"{language}/{_file_of(template)}").render())


def render_template(
    template: str,
    language: Language = "en",
    wording: Mapping[str, str] = MappingProxyType({}),
    **variables: object,
) -> str:
    """Return one of `TEMPLATES` filled with `variables`; `wording` replaces questions' texts."""
    texts = read_texts(template, language)
    questions = chain(texts["questions"], *texts.get("form", {}).values())
    words = {
        each["name"]: each | {"text": wording.get(each["name"], each["text"])} for each in questions
    }
    filled = variables | {"language": language, "texts": texts, "words": words}
    return _FILES.get_template(_file_of(template)).render(filled)


def read_template(template: str) -> dict[str, Any]:
    """Return the keys of one of `TEMPLATES`."""
    return tomllib.loads(render_template(template))


def _file_of(template: str) -> str:
    return f"{ALIASES.get(template, template)}.toml"


_AS_STATED: Final = (
    *("title", "participants", "channel", "minutes"),
    *("organisation", "contact", "ethics", "avatar", "framing"),
)
"""Options that are template variables of the same name."""

_PARTICIPANTS: Final = ("participants_per_comparison", "participants")
"""The key for the number of participants; each template has one of them."""


def new_study(path: Path, **options: Any) -> Study:
    """Write a commented study file from a template and return the study.

    Parameters
    ----------
    path : Path
        The study file.
    **options
        See `studyapp.study.study_options.StudyOptions`.

    Raises
    ------
    InputError
        As `render_study_file`.
    """
    return write_study(path, StudyOptions(**options))


def write_study(path: Path, options: StudyOptions) -> Study:
    """Write a commented study file as `options` say, and return the study."""
    text = render_study_file(options, where=path)
    write_text(path, text)
    return parse_text(text, where=path)


def template_participants(template: str) -> int:
    """Return a template's number of participants; of pairwise studies, for each comparison."""
    defaults = read_template(template)
    return next(int(defaults[key]) for key in _PARTICIPANTS if key in defaults)


def render_study_file(options: StudyOptions, *, where: object) -> str:
    """Return the text of a study file; nothing is written.

    Parameters
    ----------
    where : object
        What errors name.

    Raises
    ------
    InputError
        If the template lacks a key that `options` set, or the result is not a valid study.
    """
    template, reference = options.template, options.reference
    defaults = read_template(template)
    is_ranking = defaults["protocol"] == "ranking"
    variables = _template_variables(options)
    if reference is not None:
        variables["reference"] = check_name(reference, "condition")
    if options.conditions:
        variables |= condition_variables(
            defaults["protocol"],
            options.conditions,
            reference=reference,
            catch_videos=options.catch_videos,
        )
    elif reference is not None and reference not in defaults["conditions"]:
        is_rule = reference in generator_names() and not needs_model(reference)
        added = Condition(generator=reference if is_rule and not is_ranking else None)
        variables["added"] = conditions_text({reference: added})
    template_reference = reference if options.conditions is None and not is_ranking else None
    for key, value in (("reference", template_reference), ("trials", options.trials)):
        if value is not None and key not in defaults:
            raise InputError(
                f"the template {template!r} has no key {key!r}",
                remedy="Leave the option out and edit the study file",
            )
    if options.trials is not None:
        variables["trials"] = options.trials
        variables["practice"] = min(int(defaults["practice"]), max(options.trials // 2, 0))
    if "framing" not in variables and "face" not in variables.get("freeze", defaults["freeze"]):
        questions = read_texts(template, options.language)["questions"]
        texts = (options.wording.get(each["name"], each["text"]) for each in questions)
        if all(map(is_about_face, texts)):
            variables["framing"] = "face"
    text = render_template(template, options.language, options.wording, **variables)
    remedy = "Nothing was written: give other values"
    try:
        # Lines of a file that nobody sees say nothing.
        parse_study(tomllib.loads(text), where=where)
    except tomllib.TOMLDecodeError:
        # tomlkit writes the escape character as TOML 1.1 does, which tomllib cannot read.
        what = "a text contains a control character"
        raise InputError(what, where=where, remedy=remedy) from None
    except InputError as error:
        raise InputError(error.what, where=where, remedy=remedy) from None
    return text


def _template_variables(options: StudyOptions) -> dict[str, Any]:
    """Return the template variables that all protocols share."""
    pay = options.pay or Pay()
    payment = pay.payment or Decimal(0)
    has_own_reward = options.channel in ("prolific", "mturk")
    variables: dict[str, Any] = {key: getattr(options, key) for key in _AS_STATED} | {
        "name": check_name(options.name, "study"),
        "payment": format_amount(payment, pay.currency) if payment else None,
        "pay": pay.model_dump(
            exclude_defaults=True, exclude={"amount"} if has_own_reward else None
        ),
    }
    if options.channel == "prolific":
        codes = {key: draw_code() for key in Prolific().codes}
        variables["prolific"] = {"reward": int(payment * 100), **codes}
    if options.channel == "mturk":
        variables["mturk"] = {"reward": f"{payment:.2f}"}
    return {key: value for key, value in variables.items() if value is not None}


class ChangedMeanwhileError(InputError):
    """Somebody has saved the file since it was read; `text` is its text now."""

    def __init__(self, text: str) -> None:
        self.text = text
        super().__init__(
            "the study file has changed since you opened it, so your version was not saved",
            remedy="Compare the two versions, and save the one you want to keep",
        )


def replace_text(path: Path, text: str, *, seen: str) -> Study:
    """Replace the study file by an edited version and return the study.

    Parameters
    ----------
    seen : str
        The file's `text_digest` when it was read.

    Raises
    ------
    ChangedMeanwhileError
        If the file has changed since.
    InputError
        If `text` is not a valid study; every wrong key is named.
    """
    present = read_text(path)
    if text_digest(present) != seen:
        raise ChangedMeanwhileError(present)
    study = parse_text(text, where=path.name)
    write_text(path, text)
    return study


def text_digest(text: str) -> str:
    """Return a digest of a study file's text."""
    return hashlib.sha256(text.encode()).hexdigest()


def add_condition(path: Path, name: str, *, videos: bool = False) -> Study:
    """Add a condition of motion files or finished videos to a study file, keeping its comments."""
    document = tomlkit.parse(read_text(path))
    table = tomlkit.table()
    if videos:
        table.add("videos", True)
    table.add(tomlkit.nl())
    document["conditions"][check_name(name, "condition", path)] = table
    text = tomlkit.dumps(document)
    study = parse_study(tomllib.loads(text), where=path)
    write_text(path, text)
    return study
