"""`study.toml`: the whole study, validated before anything runs."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Final, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from generators.registry import generator_names, needs_source
from motion.errors import InputError
from motion.freeze import CHANNELS
from motion.segment import check_name
from studyapp.definition.validation import explain

GROUND_TRUTH: Final = "ground_truth"

Name = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,99}$")]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Condition(_Section):
    """One system under comparison.

    Attributes
    ----------
    generator : str or None
        The generator that makes its motion; None when its motion files are imported.
    source : str or None
        The condition whose clips the generator starts from, for generators that need one.
    """

    generator: str | None = None
    source: Name | None = None


class Catch(_Section):
    """Catch trials: a comparison whose answer an attentive participant sees at once.

    Attributes
    ----------
    trials : int
        How many each participant gets.
    condition : str
        Name of the visibly flawed motion.
    generator : str
        What makes the flawed motion.
    against : str or None
        The condition it is shown beside; by default the ground truth where the study has one,
        else the reference.
    max_failed : int
        More failed catch trials than this exclude a participant from the analysis. AMUSE's text
        excludes above one, its appendix above none.
    """

    trials: int = Field(3, ge=0, le=20)
    condition: Name = "broken"
    generator: str = "broken"
    against: Name | None = None
    max_failed: int = Field(1, ge=0, le=20)


class Question(_Section):
    """One question of a trial; ``{emotion}`` in the text becomes the segment's emotion."""

    name: Name
    title: str = Field(min_length=1, max_length=60)
    text: str = Field(min_length=1, max_length=300)

    @model_validator(mode="after")
    def _only_known_fields(self) -> Self:
        unknown = set(re.findall(r"{(.*?)}", self.text)) - {"emotion"}
        if unknown or self.text.count("{") != self.text.count("}"):
            raise ValueError("the text may hold {emotion} and no other braces")
        return self


class Video(_Section):
    """How all stimuli of the study look.

    Attributes
    ----------
    size : int
        Pixels along each side of one clip; a pair is twice as wide.
    avatar : str
        Who is shown, the same for all conditions: a name in `renderer.avatars.AVATARS`.
    body : str or None
        A licensed SMPL-X model file (``.npz``) to show instead of an avatar.
    expression_matrix : str or None
        A file (``.npz``, ``.npy`` or ``.csv``) of 100 SMPL-X expression coefficients by 52 ARKit
        actions, which turns the one into the other where the body shows only that.
    """

    framing: Literal["upper_body", "full_body"] = "upper_body"
    size: int = Field(720, ge=64, le=1440, multiple_of=2)
    frame_rate: int = Field(30, ge=10, le=60)
    avatar: Literal["alex", "maya", "jonas", "amara", "henry", "mannequin"] = "alex"
    body: str | None = None
    expression_matrix: str | None = None


class Watching(_Section):
    """What counts as having watched: the share of each video that must really have played."""

    coverage: float = Field(0.95, ge=0, le=1, strict=False)


class Page(_Section):
    """What participants are told before they agree to take part."""

    organisation: str = Field("", max_length=200)
    contact: str = Field("", max_length=200)
    minutes: int | None = Field(None, ge=1, le=240)
    payment: str = Field("", max_length=200)
    consent: str = Field(min_length=1, max_length=4000)


class Study(_Section):
    """The whole study.

    Attributes
    ----------
    reference : str
        The condition that every other condition is compared with.
    trials : int
        Pairs each participant is asked about in the analysed trials, at most; three per emotion
        in AMUSE.
    practice : int
        The first so many trials are discarded and shown again at the end.
    lease_minutes : int
        An unfinished participant who does nothing for so long gives the place back.
    freeze : tuple of str
        Channels held still in every stimulus, so that what a condition happens to contain
        cannot give it away.
    """

    format: Literal[1] = 1
    name: Name
    title: str = Field(min_length=1, max_length=200)
    protocol: Literal["pairwise"] = "pairwise"
    reference: Name
    participants_per_comparison: int = Field(25, ge=1, le=10_000)
    trials: int = Field(24, ge=1, le=500)
    practice: int = Field(3, ge=0, le=20)
    announce_practice: bool = False
    lease_minutes: int = Field(45, ge=5, le=1440)
    seed: int = Field(1, ge=0, le=2**32 - 1)
    freeze: tuple[str, ...] = Field((), strict=False)
    conditions: dict[Name, Condition] = Field(min_length=2)
    catch: Catch = Catch()
    questions: tuple[Question, ...] = Field(min_length=1, max_length=8, strict=False)
    video: Video = Video()
    watching: Watching = Watching()
    page: Page

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        problems = [*self._condition_problems(), *self._other_problems()]
        if problems:
            raise ValueError("; ".join(problems))
        return self

    def _condition_problems(self) -> list[str]:
        known = ", ".join(self.conditions)
        problems = []
        if self.reference not in self.conditions:
            problems.append(f"reference {self.reference!r} is no condition of it ({known})")
        if self.catch.condition in self.conditions:
            problems.append(
                f"catch condition {self.catch.condition!r} must not be one of the conditions"
            )
        if self.catch.against is not None and self.catch.against not in self.conditions:
            problems.append(f"catch.against {self.catch.against!r} is no condition ({known})")
        generators = {f"conditions.{n}": c.generator for n, c in self.conditions.items()}
        for where, generator in {**generators, "catch": self.catch.generator}.items():
            if generator is not None and generator not in generator_names():
                problems.append(
                    f"{where}: unknown generator {generator!r} ({', '.join(generator_names())})"
                )
        for name, condition in self.conditions.items():
            problems.extend(self._source_problems(name, condition))
        return problems

    def _source_problems(self, name: str, condition: Condition) -> list[str]:
        if condition.generator is not None and condition.generator not in generator_names():
            return []
        needs = condition.generator is not None and needs_source(condition.generator)
        if needs and condition.source is None:
            return [f"conditions.{name}: generator {condition.generator!r} needs a source"]
        if condition.source is None:
            return []
        if not needs:
            return [f"conditions.{name}: source is given, but nothing there uses it"]
        if condition.source not in self.conditions or condition.source == name:
            return [f"conditions.{name}: source {condition.source!r} is no other condition"]
        seen = {name}
        following: str | None = condition.source
        while following is not None and following in self.conditions:
            if following in seen:
                return [f"conditions.{name}: its sources run in a circle"]
            seen.add(following)
            following = self.conditions[following].source
        return []

    def _other_problems(self) -> list[str]:
        problems = []
        names = [question.name for question in self.questions]
        if len(set(names)) != len(names):
            problems.append("two questions have the same name")
        if "trial" in names:
            problems.append("no question can be named 'trial', the page sends its own field so")
        unknown = sorted(set(self.freeze) - set(CHANNELS))
        if unknown:
            problems.append(f"freeze: unknown {', '.join(unknown)} (use {', '.join(CHANNELS)})")
        if self.practice > self.trials:
            problems.append(f"practice {self.practice} is more than trials {self.trials}")
        return problems

    @property
    def others(self) -> tuple[str, ...]:
        """The conditions compared with the reference, in the file's order."""
        return tuple(name for name in self.conditions if name != self.reference)

    @property
    def catch_against(self) -> str:
        """The condition that catch trials show beside the flawed motion."""
        if self.catch.against is not None:
            return self.catch.against
        return GROUND_TRUTH if GROUND_TRUTH in self.conditions else self.reference

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Every (left, right) a participant may be shown: both orders of each pair."""
        compared = [(self.reference, other) for other in self.others]
        if self.catch.trials:
            compared.append((self.catch_against, self.catch.condition))
        return tuple(pair for a, b in compared for pair in ((a, b), (b, a)))

    @property
    def shown_conditions(self) -> tuple[str, ...]:
        """Every condition that appears in a pair."""
        return tuple(dict.fromkeys(left for left, _ in self.pairs))

    @property
    def has_recording(self) -> bool:
        """Whether real recorded motion takes part."""
        return GROUND_TRUTH in self.conditions

    def generated(self) -> dict[str, Condition]:
        """Return every condition with a generator, the catch condition last, sources first."""
        ordered: dict[str, Condition] = {}

        def add(name: str) -> None:
            condition = self.conditions[name]
            if condition.source is not None:
                add(condition.source)
            if condition.generator is not None:
                ordered.setdefault(name, condition)

        for name in self.conditions:
            add(name)
        if self.catch.trials:
            ordered[self.catch.condition] = Condition(
                generator=self.catch.generator, source=self.catch_against
            )
        return ordered


def comparison_name(reference: str, other: str) -> str:
    """Return the name of the comparison of `reference` with `other`."""
    return f"{reference}-{other}"


def read_study(path: Path) -> Study:
    """Read and validate a `study.toml`.

    Raises
    ------
    InputError
        Naming the file and every key that is unknown, missing or out of range.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(
            "there is no such study file",
            where=path,
            remedy="Make a study with 'motionjury init FOLDER', or check the folder's name",
        ) from None
    except UnicodeDecodeError as error:
        raise InputError(
            f"the file is not UTF-8 text (byte {error.start})",
            where=path,
            remedy="Save it as UTF-8",
        ) from None
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"not valid TOML: {error}", where=path, remedy="Mend that line") from None
    return parse_study(data, where=path)


def parse_study(data: Mapping[str, object], *, where: object) -> Study:
    """Validate the contents of a study file; `InputError` names every key that is wrong."""
    try:
        return Study.model_validate(data)
    except ValidationError as error:
        raise InputError(
            explain(error), where=where, remedy="Correct these keys and run the command again"
        ) from None


def check_condition(study: Study, name: str, where: object) -> str:
    """Return `name` if the study has such a condition (the catch condition included)."""
    check_name(name, "condition", where)
    known = (*study.conditions, study.catch.condition)
    if name not in known:
        raise InputError(
            f"unknown condition {name!r}", where=where, remedy=f"Use one of {', '.join(known)}"
        )
    return name
