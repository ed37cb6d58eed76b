"""`study.toml`: what the study files of all protocols have in common, and what a protocol is."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from itertools import permutations
from typing import Annotated, Final, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from analysis.results.grouping import read_family
from motion.clip import CHANNELS
from motion.errors import InputError
from motion.segment import Segment
from studyapp.study.design.trial import (
    NO_VOTES,
    Answers,
    Arm,
    Ask,
    Content,
    PlannedTrial,
    Tally,
    Trial,
)
from studyapp.study.settings.conditions import (
    Attention,
    Catch,
    Condition,
    catch_problems,
    comparison_name,
    display_name,
    generated,
    label_problems,
    source_problems,
)
from studyapp.study.settings.exclusions import (
    Exclusion,
    ExclusionSection,
    exclusion_problems,
    settle_exclusions,
)
from studyapp.study.settings.presentation import Message, Page, Video, Watching
from studyapp.study.settings.questions import Form, Question, question_problems
from studyapp.study.settings.recruitment import Recruitment
from studyapp.study.settings.rehearsal import Rehearsal
from studyapp.study.settings.sections import Name, Section

GROUND_TRUTH: Final = "ground_truth"


class Evaluator(Section):
    """A published network in whose features metrics measure distances, too.

    Attributes
    ----------
    preset : str
        Which; see docs/published-fgd.md.
    file : str
        Its checkpoint; a relative path begins at the study's folder.
    statistics : str or None
        For ``beat``, the folder of ``bvh_mean.npy`` and ``bvh_std.npy``; None for that of `file`.
    """

    preset: Literal["emage", "beat", "ted", "talkshow"]
    file: str = Field(min_length=1)
    statistics: str | None = None


def _each(given: object) -> object:
    """Return one table of TOML as the only one of several."""
    return (given,) if isinstance(given, Mapping) else given


MailAddress = Annotated[str, Field(pattern=r"^[^@\s,]+@[^@\s,]+$", max_length=200)]


class Alarms(Section):
    """When researchers are told of the running study; each thing once.

    Attributes
    ----------
    mail : tuple of str
        Addresses that get alarms by mail; a webhook is named in the environment.
    stalled_hours : float
        After so long without anybody finishing, though the study is open, it has stalled.
    from_one_address : int
        So many newcomers from one network address within an hour fill the study.
    """

    mail: tuple[MailAddress, ...] = Field((), max_length=10, strict=False)
    stalled_hours: float = Field(24, gt=0, le=24 * 365, strict=False)
    from_one_address: int = Field(10, ge=2, le=100_000)


class Study(Section, ABC):
    """The whole study: the keys that all protocols share, and what every protocol answers.

    A protocol is a subclass. Its keys say how its trials are made; `arms`, `contents`, `plan`,
    `asks`, `problem` and `failed` say it to the rest of the house, which knows no protocol by
    name. All of them are pure.

    Attributes
    ----------
    participants : int
        How many are wanted.
    lease_minutes : int
        An unfinished participant who does nothing for so long gives the place back.
    open : bool
        Whether new participants are let in.
    replace_excluded : bool
        Whether a participant who fails more catch trials or attention checks than the exclusion
        rules allow opens the place again for somebody else.
    allow_gaps : bool
        Whether a segment that some condition has no finished video of is left out of the study;
        otherwise the missing video is an error.
    freeze : tuple of str
        Channels held still in every stimulus, so that what a condition happens to contain
        cannot give it away.
    exclusions : tuple of ExclusionSection or None
        Who is left out of the analysis, rule after rule; None for the rules of every study (see
        `settled_exclusions`).
    margin : float or None
        The largest difference that does not matter, for tests of equivalence: of a win share from
        one half, of two mean ratings in scores; None where nothing is to be called equally good.
    evaluator : tuple of Evaluator
        Published networks that metrics measure with; one of them may stand alone.
    family : str or None
        Which tests decide, and are corrected together: all, by question, against=CONDITION, or
        primary=CONDITION,CONDITION[,QUESTION]; None for all.
    questions : tuple of Question
        What is asked of every trial of the parts they name.
    form : Form
        Questions about the participant, before and after the trials.
    recruitment : Recruitment
        Where participants come from, and who of them is paid.
    rehearsal : Rehearsal
        Whom a rehearsal simulates; nothing about the study itself.
    alarms : Alarms
        When researchers are told of the running study, and where.
    """

    format: Literal[1] = 1
    name: Name
    title: str = Field(min_length=1, max_length=200)
    protocol: str
    participants: int = Field(ge=1, le=100_000)
    lease_minutes: int = Field(45, ge=5, le=1440)
    open: bool = True
    replace_excluded: bool = False
    allow_gaps: bool = False
    seed: int = Field(1, ge=0, le=2**32 - 1)
    freeze: tuple[str, ...] = Field((), strict=False)
    conditions: dict[Name, Condition] = Field(min_length=1)
    catch: Catch = Catch()
    attention: Attention = Attention()
    exclusions: tuple[Exclusion, ...] | None = Field(None, max_length=20, strict=False)
    margin: float | None = Field(None, gt=0, allow_inf_nan=False, strict=False)
    evaluator: Annotated[tuple[Evaluator, ...], BeforeValidator(_each)] = Field((), strict=False)
    family: str | None = Field(None, max_length=300)
    questions: tuple[Question, ...] = Field(min_length=1, max_length=8, strict=False)
    form: Form = Form()
    video: Video = Video()
    watching: Watching = Watching()
    recruitment: Recruitment = Recruitment()
    rehearsal: Rehearsal = Rehearsal()
    alarms: Alarms = Alarms()
    page: Page

    @property
    def arms(self) -> tuple[Arm, ...]:
        """The groups of places, each with the conditions its participants compare.

        One for everybody, unless a protocol says otherwise.
        """
        return (Arm(name="all", conditions=tuple(self.conditions), places=self.participants),)

    @abstractmethod
    def contents(self, segments: Sequence[Segment]) -> Iterator[Content]:
        """Yield what every video shows that a participant may meet, each once."""

    @abstractmethod
    def plan(
        self, arm: Arm, number: int, segments: Sequence[Segment], votes: Tally = NO_VOTES
    ) -> tuple[PlannedTrial, ...]:
        """Return the trials of one place in the order they are shown.

        Parameters
        ----------
        arm : Arm
            One of `arms`.
        number : int
            The place's number within the arm, from 0.
        segments : sequence of Segment
            All segments of the study.
        votes : Tally
            What has been preferred so far; looked at where `follows_votes` says so.
        """

    @abstractmethod
    def values(self, question: Question, trial: Trial) -> Sequence[int]:
        """Return what may be answered to `question` in `trial`."""

    @abstractmethod
    def prefers(self, answers: Answers, better: int, worse: int) -> bool:
        """Tell whether `answers` set stimulus `better` above `worse` on every question."""

    def asks(self, trial: Trial) -> tuple[Ask, ...]:
        """Return the answers that `trial` asks for, in the page's order."""
        return tuple(
            Ask(
                question=question.name,
                stimulus=stimulus,
                values=self.values(question, trial),
                reasons=question.reason_names,
                shares_reasons=self.is_ordered,
            )
            for stimulus in (
                range(1, len(trial.conditions) + 1) if self.asks_each_stimulus else (None,)
            )
            for question in self.questions
            if question.belongs_to(trial.part)
        )

    def problem(self, trial: Trial, answers: Answers) -> Message | None:
        """Say why complete `answers`, each right in itself, do not go together, if so."""
        del trial, answers
        return None

    def failed(self, trial: Trial, answers: Answers) -> bool:
        """Tell whether `answers` fail a catch trial or an attention check; others never fail."""
        if trial.instructed is not None:
            return self.disobeys(trial, answers)
        if trial.expected is not None:
            flawed = 1 + trial.conditions.index(self.catch.condition)
            return not self.prefers(answers, trial.expected, flawed)
        return False

    def disobeys(self, trial: Trial, answers: Answers) -> bool:
        """Tell whether an answer to an attention check is not the one asked for."""
        del self
        return any(value != trial.instructed for value in answers.values())

    def notes(self, segments: Sequence[Segment]) -> tuple[str, ...]:
        """Return what a researcher should know of the study with these segments, as sentences."""
        del segments
        return ()

    def design_of(self, arm: Arm) -> Study:
        """Return the study as far as it decides what participants of `arm` are asked."""
        del arm
        return self

    @property
    def asks_each_stimulus(self) -> bool:
        """Whether questions are asked about each stimulus rather than about the whole trial."""
        return False

    @property
    def is_ordered(self) -> bool:
        """Whether the answers to a question are ranks, which only together say something."""
        return False

    @property
    def follows_votes(self) -> bool:
        """Whether what is shown depends on what was answered before."""
        return False

    @property
    def parts(self) -> tuple[str, ...]:
        """The parts of a study session; none where all trials are alike."""
        return ()

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        problems = self.problems()
        if problems:
            raise ValueError("; ".join(problems))
        return self

    def problems(self) -> list[str]:
        """Return everything that does not fit together; protocols add what is theirs."""
        unknown = sorted(set(self.freeze) - set(CHANNELS))
        known = ", ".join(CHANNELS)
        return [
            *catch_problems(self.conditions, self.catch),
            *label_problems(self.conditions, self.catch),
            *(p for name in self.conditions for p in source_problems(self.conditions, name)),
            *question_problems(self.questions, self.parts),
            *([f"freeze: unknown {', '.join(unknown)} (use {known})"] if unknown else []),
            *exclusion_problems(self.exclusions, self.catch, self.attention),
            *self._margin_problems(),
            *self._family_problems(),
            *self.recruitment.problems(self.page.minutes),
            *self.rehearsal.problems(
                (*self.conditions, self.catch.condition),
                [question.name for question in self.questions],
            ),
        ]

    @property
    def settled_exclusions(self) -> tuple[ExclusionSection, ...]:
        """Who is left out of the analysis, rule after rule, with every number settled."""
        return settle_exclusions(self.exclusions, self.catch, self.attention)

    def _family_problems(self) -> list[str]:
        if self.family is None:
            return []
        try:
            read_family(self.family, list(self.conditions), [each.name for each in self.questions])
        except InputError as error:
            return [f"family: {error.what} ({error.remedy})"]
        return []

    def _margin_problems(self) -> list[str]:
        if self.margin is None or self.protocol in ("pairwise", "rating"):
            return []
        return [f"margin: a {self.protocol} study has no test of equivalence"]

    @property
    def catch_against(self) -> str:
        """The condition that catch trials show beside the flawed motion."""
        if self.catch.against is not None:
            return self.catch.against
        return GROUND_TRUTH if self.has_recording else next(iter(self.conditions))

    @property
    def has_recording(self) -> bool:
        """Whether real recorded motion takes part."""
        return GROUND_TRUTH in self.conditions

    @property
    def only_generated(self) -> bool:
        """Whether generators make all motion: of files and videos nobody knows what they show."""
        return not self.has_recording and all(
            condition.generator is not None for condition in self.conditions.values()
        )

    @property
    def display_names(self) -> Mapping[str, str]:
        """What researchers and readers of reports call each condition and each comparison."""
        names = {name: display_name(name, made) for name, made in self.conditions.items()}
        names.setdefault(self.catch.condition, self.catch.condition.replace("_", " "))
        compared = {
            comparison_name(a, b): f"{names[a]} against {names[b]}"
            for a, b in permutations(self.conditions, 2)
        }
        return compared | names

    def is_finished(self, condition: str) -> bool:
        """Tell whether finished videos of `condition` are brought, so that it has no motion."""
        if condition == self.catch.condition:
            return self.catch.videos
        return self.conditions[condition].videos

    @property
    def roles(self) -> Mapping[str, str]:
        """What conditions are in the study, where one has a part of its own."""
        return {self.catch.condition: "catch trials"}

    @property
    def only_finished(self) -> bool:
        """Whether finished videos of everything are brought, so that nothing is rendered."""
        caught = (self.catch.condition,) if self.catch.trials else ()
        return all(self.is_finished(name) for name in (*self.conditions, *caught))

    def generated(self) -> dict[str, Condition]:
        """Return every condition with a generator, the catch condition last, sources first."""
        made = generated(self.conditions)
        if self.catch.trials and not self.catch.videos:
            made[self.catch.condition] = Condition(
                generator=self.catch.generator, source=self.catch_against
            )
        return made
