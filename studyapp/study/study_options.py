"""The options of a new study: its conditions, and the template variables that follow from them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, get_args

import tomlkit
from pydantic import ValidationError

from generators.registry import generator_names, needs_source, settings_type
from generators.settings import File, types_of
from motion.errors import InputError, listed
from motion.segment import check_name
from studyapp.study.settings.conditions import Condition
from studyapp.study.settings.presentation import Framing, Language
from studyapp.study.settings.recruitment import Channel, Pay
from studyapp.study.settings.sections import explain_errors
from studyapp.study.settings.study import GROUND_TRUTH


@dataclass(frozen=True, kw_only=True)
class StudyOptions:
    """What a study file is made from; None leaves the template's own value.

    Attributes
    ----------
    name : str
        The study's name.
    template : str
        One of `studyapp.study.study_file.TEMPLATES`.
    language : {'en', 'de', 'ja'}
        Language of the participants' pages.
    title : str or None
        The title that participants see.
    reference : str or None
        In pairwise studies, the condition that every other one is compared with; also the source
        of the template's mismatched condition. In rankings, the condition that is not ranked.
    trials : int or None
        Pairs that each participant judges; for pairwise studies.
    participants : int or None
        In pairwise studies, for each comparison.
    conditions : mapping of str to Condition, or None
        Replaces the template's conditions.
    catch_videos : bool
        Whether there will be finished videos of a visibly broken motion for catch trials.
    channel : {'link', 'prolific', 'mturk', 'invitations'} or None
        Where participants come from.
    pay : Pay or None
        The pay of each participant.
    minutes : int or None
        Duration of the study.
    organisation, contact, ethics : str or None
        See `studyapp.study.settings.presentation.Page`.
    avatar : str or None
        The avatar in the videos.
    framing : {'upper_body', 'full_body', 'face', 'hands'} or None
        What the videos show; None for the face if every question is about it, otherwise for what
        the template has.
    wording : mapping of str to str
        Question texts that replace the template's, by question name.
    """

    name: str
    template: str = "pairwise"
    language: Language = "en"
    title: str | None = None
    reference: str | None = None
    trials: int | None = None
    participants: int | None = None
    conditions: Mapping[str, Condition] | None = None
    catch_videos: bool = False
    channel: Channel | None = None
    pay: Pay | None = None
    minutes: int | None = None
    organisation: str | None = None
    contact: str | None = None
    ethics: str | None = None
    avatar: str | None = None
    framing: Framing | None = None
    wording: Mapping[str, str] = field(default_factory=dict)


MAX_VIDEOS_PER_PAGE: Final = 8
"""Motions that one page can show."""


def condition_variables(
    protocol: str,
    conditions: Mapping[str, Condition],
    *,
    reference: str | None,
    catch_videos: bool,
) -> dict[str, Any]:
    """Return the variables of the template of `protocol` for conditions that replace its own.

    Parameters
    ----------
    reference : str or None
        The condition that all others are compared with, or that is not ranked.
    catch_videos : bool
        Whether there will be finished videos of a broken motion.
    """
    names = [check_name(name, "condition") for name in conditions]
    has_motion = any(not condition.videos for condition in conditions.values())
    variables: dict[str, Any] = {
        "names": names,
        "conditions": conditions_text(conditions),
        "nothing_breaks": not has_motion and not catch_videos,
        **({"videos": True} if catch_videos else {}),
    }
    if not has_motion:
        # Nothing in a finished video can be held still.
        variables["freeze"] = []
    if protocol == "pairwise":
        variables["reference"] = reference or (GROUND_TRUTH if GROUND_TRUTH in names else names[0])
        if any(condition.videos for condition in conditions.values()):
            # Finished videos cannot be composed.
            variables["layout"] = "players"
    elif protocol in ("rating", "ranking"):
        shown = [name for name in names if name != reference or protocol == "rating"]
        variables["shown"] = shown
    return variables


def conditions_text(conditions: Mapping[str, Condition]) -> str:
    """Return conditions as tables of a study file."""
    tables = {
        name: condition.model_dump(exclude_none=True, exclude_defaults=True)
        for name, condition in conditions.items()
    }
    return tomlkit.dumps({"conditions": tables}).rstrip()


FILES: Final = "files"
VIDEOS: Final = "videos"


def read_conditions(texts: Sequence[str], folder: Path) -> dict[str, Condition] | None:
    """Return the conditions that ``NAME=SOURCE`` each describe; None for no text.

    Parameters
    ----------
    texts : sequence of str
        A source is ``files``, ``videos``, a generator, ``mismatched:NAME``, or a network and its
        weights: ``NETWORK:FILE``, or ``NETWORK:FILE,FILE`` if it has several files.
    folder : Path
        The study folder.

    Raises
    ------
    InputError
        If a source is none of these, a file is missing, or two conditions have the same name.
    """
    conditions: dict[str, Condition] = {}
    for text in texts:
        name, equals, source = text.partition("=")
        if not equals:
            raise InputError(
                f"{text!r} does not say where its motion comes from",
                remedy="Give NAME=files, NAME=videos, NAME=rule_based or NAME=mismatched:OTHER",
            )
        name = check_name(name.strip(), "condition")
        if name in conditions:
            raise InputError(f"the condition {name!r} is given twice", remedy="Name each once")
        conditions[name] = _read_source(source.strip(), folder)
    return conditions or None


def _read_source(text: str, folder: Path) -> Condition:
    kind, _, details = text.partition(":")
    if kind in (FILES, VIDEOS) and not details:
        return Condition(videos=kind == VIDEOS)
    if kind not in generator_names():
        raise InputError(
            f"unknown source {text!r}",
            remedy=f"Use {FILES}, {VIDEOS}, or a generator: "
            f"{', '.join(map(source_notation, generator_names()))}",
        )
    if required := _required_files(kind):
        weights = zip(required, _read_weight_files(kind, details, required), strict=True)
        return make_condition(kind, dict(weights), folder)
    if needs_source(kind) != bool(details):
        need = "needs the condition it starts from" if needs_source(kind) else "takes no source"
        raise InputError(f"the generator {kind!r} {need}", remedy=f"Give {source_notation(kind)}")
    return Condition(generator=kind, source=check_name(details, "condition") if details else None)


def _required_files(generator: str) -> list[str]:
    """Return the keys of the files that a generator needs."""
    kind = settings_type(generator)
    files = [key for key, type_of_values in types_of(kind).items() if type_of_values == File]
    return [key for key in files if kind.model_fields[key].is_required()]


def _read_weight_files(generator: str, text: str, required: Sequence[str]) -> list[Path]:
    """Return the files of a network's weights."""
    files = text.split(",") if len(required) > 1 else [text]
    if not all(files) or len(files) != len(required):
        raise InputError(
            f"the generator {generator!r} is a network and needs its weights",
            remedy=f"Give {source_notation(generator)}, its {listed(required)}",
        )
    return [Path(file.strip()).expanduser() for file in files]


def source_notation(generator: str) -> str:
    """Return how a generator is given as a source."""
    details = (
        "OTHER" if needs_source(generator) else ",".join("FILE" for _ in _required_files(generator))
    )
    return f"{generator}:{details}" if details else generator


def make_condition(generator: str, options: Mapping[str, Any], folder: Path = Path()) -> Condition:
    """Return the condition that options describe.

    Parameters
    ----------
    options : mapping
        Options of `SettingsCommand`; None where one is not given.
    folder : Path
        The study folder; files elsewhere are named by their full path.

    Raises
    ------
    InputError
        If an option belongs to another generator, or its value is unusable.
    """
    types = types_of(settings_type(generator))
    values: dict[str, Any] = {"generator": generator}
    for key, value in options.items():
        if isinstance(value, Path):
            values[key] = _path_from(folder, value)
        elif isinstance(value, str) and value.isdecimal() and int in get_args(types.get(key)):
            values[key] = int(value)
        elif value is not None:
            values[key] = value
    try:
        return Condition.model_validate(values)
    except ValidationError as error:
        raise InputError(explain_errors(error), remedy="Correct these options") from None


def _path_from(folder: Path, path: Path) -> str:
    """Return `path` relative to `folder`, or in full if it lies elsewhere."""
    file, base = path.resolve(), folder.resolve()
    return str(file.relative_to(base) if file.is_relative_to(base) else file)
