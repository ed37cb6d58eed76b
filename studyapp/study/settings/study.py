"""`study.toml`: the keys that all protocols share, and the interface of a protocol."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from itertools import permutations
from typing import Annotated, ClassVar, Final, Literal, Self

from numpy.random import Generator
from pydantic import BeforeValidator, Field, model_validator

from analysis.results.grouping import read_family
from motion.errors import InputError
from motion.segment import Segment
from studyapp.study.design.allocation import draw_segments
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
    source_problems,
)
from studyapp.study.settings.exclusions import (
    Exclusion,
    ExclusionSection,
    exclusion_problems,
    settle_exclusions,
)
from studyapp.study.settings.presentation import FrozenChannel, Message, Page, Video, Watching
from studyapp.study.settings.questions import (
    Form,
    Question,
    is_about_face,
    question_problems,
)
from studyapp.study.settings.recruitment import Recruitment
from studyapp.study.settings.rehearsal import Rehearsal
from studyapp.study.settings.sections import MAIL_ADDRESS, Name, Section

GROUND_TRUTH: Final = "ground_truth"


class Evaluator(Section):
    """A published feature network for the metrics.

    Attributes
    ----------
    preset : str
        See docs/published-fgd.md.
    file : str
        Its checkpoint; relative paths start at the study folder.
    statistics : str or None
        For ``beat``, the folder of ``bvh_mean.npy`` and ``bvh_std.npy``; None for that of `file`.
    """

    preset: Literal["emage", "beat", "ted", "talkshow"]
    file: str = Field(min_length=1)
    statistics: str | None = None


def _as_tuple(value: object) -> object:
    """Return a single TOML table as a tuple."""
    return (value,) if isinstance(value, Mapping) else value


MailAddress = Annotated[str, Field(pattern=MAIL_ADDRESS, max_length=200)]


class Alarms(Section):
    """When researchers are alerted to the running study; once for each event.

    Attributes
    ----------
    mail : tuple of str
        E-mail addresses that get alarms; a webhook is set in the environment.
    stalled_hours : float
        An open study has stalled if nobody finishes for so long.
    from_one_address : int
        Newcomers from one network address within an hour that raise an alarm.
    """

    mail: tuple[MailAddress, ...] = Field((), max_length=10, strict=False)
    stalled_hours: float = Field(24, gt=0, le=24 * 365, strict=False)
    from_one_address: int = Field(10, ge=2, le=100_000)


class Study(Section, ABC):
    """A study: the keys that all protocols share, and the interface of a protocol.

    A protocol is a subclass. Its keys describe its trials; `arms`, `contents`, `plan`, `asks`,
    `problem` and `failed` are all that the rest of the program needs, which knows no protocol by
    name. All of them are pure.

    Attributes
    ----------
    participants : int
        Number of places.
    lease_minutes : int
        An unfinished participant who is inactive for so long loses the place.
    open : bool
        Whether new participants are admitted.
    replace_excluded : bool
        Whether the place of a participant who fails too many catch trials or attention checks is
        opened again.
    allow_gaps : bool
        Whether a segment without a finished video of some condition is left out of the study;
        otherwise the missing video is an error.
    freeze : tuple of str
        Channels held still in every stimulus, so that they cannot give a condition away.
    exclusions : tuple of ExclusionSection or None
        Rules that exclude participants from the analysis; None for those of
        `settled_exclusions`.
    margin : float or None
        The largest irrelevant difference, for tests of equivalence: of a win share from one half,
        or of two mean ratings; None for no such tests.
    evaluator : tuple of Evaluator
        Published feature networks for the metrics; a single one may be a table.
    family : str or None
        The tests that decide and are corrected together: all, by question, against=CONDITION, or
        primary=CONDITION,CONDITION[,QUESTION]; None for all.
    questions : tuple of Question
        The questions of every trial, or of trials in the parts they name.
    form : Form
        Questions about the participant, before and after the trials.
    recruitment : Recruitment
        Where participants come from, and who is paid.
    rehearsal : Rehearsal
        The simulated participants of rehearsals.
    alarms : Alarms
        When researchers are alerted, and where.
    """

    asks_each_stimulus: ClassVar[bool] = False
    """Whether questions are about each stimulus rather than the whole trial."""

    is_ordered: ClassVar[bool] = False
    """Whether the answers to a question are ranks."""

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
    freeze: tuple[FrozenChannel, ...] = Field((), strict=False)
    conditions: dict[Name, Condition] = Field(min_length=1)
    catch: Catch = Catch()
    attention: Attention = Attention()
    exclusions: tuple[Exclusion, ...] | None = Field(None, max_length=20, strict=False)
    margin: float | None = Field(None, gt=0, strict=False)
    evaluator: Annotated[tuple[Evaluator, ...], BeforeValidator(_as_tuple)] = Field(
        (), strict=False
    )
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
        """The groups of places; by default, one for everybody."""
        return (Arm(name="all", conditions=tuple(self.conditions), places=self.participants),)

    @abstractmethod
    def contents(self, segments: Sequence[Segment]) -> Iterator[Content]:
        """Yield the content of every video that a participant may see, each once."""

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
            The preferences so far; used only if `follows_votes`.
        """

    @abstractmethod
    def values(self, question: Question, trial: Trial) -> Sequence[int]:
        """Return the possible answers to `question` in `trial`."""

    def prefers(self, answers: Answers, better: int, worse: int) -> bool:
        """Tell whether each of `answers` prefers `better` of two stimuli, however slightly."""
        del worse
        return all((value > 0) if better == 2 else (value < 0) for value in answers.values())

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
        """Say why complete and valid `answers` contradict each other; None if they do not."""
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
        """Tell whether an answer to an attention check differs from its instruction."""
        del self
        return any(value != trial.instructed for value in answers.values())

    def draw_extra_segments(
        self, segments: Sequence[Segment], trials: Sequence[PlannedTrial], chance: Generator
    ) -> tuple[list[Segment], list[Segment]]:
        """Return the segments of catch trials and of attention checks beside other `trials`."""
        drawn = draw_segments(
            segments,
            self.catch.trials + self.attention.trials,
            chance,
            used=[trial.segment for trial in trials],
        )
        return drawn[: self.catch.trials], drawn[self.catch.trials :]

    def notes(self, segments: Sequence[Segment]) -> tuple[str, ...]:
        """Return what a researcher should know about the study with these segments."""
        del segments
        return ()

    def design_of(self, arm: Arm) -> Study:
        """Return the study reduced to what participants of `arm` see and are asked."""
        del arm
        return self

    @property
    def asks_about_face(self) -> bool:
        """Whether a question names the face."""
        return any(is_about_face(question.text) for question in self.questions)

    @property
    def most_questions(self) -> int:
        """The number of questions in the part that has the most."""
        return max(
            sum(question.belongs_to(part) for question in self.questions)
            for part in self.parts or ("",)
        )

    @property
    def follows_votes(self) -> bool:
        """Whether the trials of a place depend on earlier answers."""
        return False

    @property
    def parts(self) -> tuple[str, ...]:
        """The parts of a study session; none if all trials are alike."""
        return ()

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        problems = self.problems()
        if problems:
            raise ValueError("; ".join(problems))
        return self

    def problems(self) -> list[str]:
        """Return all contradictions between keys; protocols add their own."""
        has_equivalence_tests = self.protocol in ("pairwise", "rating")
        needless_margin = f"margin: a {self.protocol} study has no test of equivalence"
        return [
            *catch_problems(self.conditions, self.catch),
            *source_problems(self.conditions),
            *question_problems(self.questions, self.parts),
            *exclusion_problems(self.exclusions, self.catch, self.attention),
            *([needless_margin] if self.margin is not None and not has_equivalence_tests else []),
            *self._family_problems(),
            *self.recruitment.problems(self.page.minutes),
            *self.rehearsal.problems(
                (*self.conditions, self.catch.condition),
                [question.name for question in self.questions],
            ),
        ]

    @property
    def settled_exclusions(self) -> tuple[ExclusionSection, ...]:
        """The exclusion rules in order, with all their numbers."""
        return settle_exclusions(self.exclusions, self.catch, self.attention)

    def _family_problems(self) -> list[str]:
        if self.family is None:
            return []
        try:
            read_family(self.family, list(self.conditions), [q.name for q in self.questions])
        except InputError as error:
            return [f"family: {error.what} ({error.remedy})"]
        return []

    @property
    def judged(self) -> tuple[str, ...]:
        """The conditions that participants judge, the reference first."""
        return tuple(self.conditions)

    @property
    def catch_against(self) -> str:
        """The condition that catch trials show beside the flawed motion; only motion is broken."""
        if self.catch.against is not None:
            return self.catch.against
        usable = [n for n in self.judged if self.catch.videos or not self.conditions[n].videos]
        return GROUND_TRUTH if GROUND_TRUTH in usable else (*usable, *self.judged)[0]

    @property
    def has_recording(self) -> bool:
        """Whether one of the conditions is recorded motion."""
        return GROUND_TRUTH in self.conditions

    @property
    def only_generated(self) -> bool:
        """Whether generators make all motion; files and videos could show recordings."""
        return all(condition.generator is not None for condition in self.conditions.values())

    @property
    def display_names(self) -> Mapping[str, str]:
        """The names of conditions and comparisons on researchers' pages and in reports."""
        names = {name: display_name(name, each) for name, each in self.conditions.items()}
        names.setdefault(self.catch.condition, self.catch.condition.replace("_", " "))
        comparisons = {
            comparison_name(a, b): f"{names[a]} against {names[b]}"
            for a, b in permutations(self.conditions, 2)
        }
        return comparisons | names

    def is_finished(self, condition: str) -> bool:
        """Tell whether `condition` has finished videos and no motion."""
        if condition == self.catch.condition:
            return self.catch.videos
        return self.conditions[condition].videos

    @property
    def roles(self) -> Mapping[str, str]:
        """The roles of conditions with a special role."""
        return {self.catch.condition: "catch trials"}

    @property
    def only_finished(self) -> bool:
        """Whether every condition has finished videos, so that nothing is rendered."""
        flawed = (self.catch.condition,) if self.catch.trials else ()
        return all(self.is_finished(name) for name in (*self.conditions, *flawed))

    def generated(self) -> dict[str, Condition]:
        """Return every condition with a generator, the catch condition last, sources first."""
        conditions = generated(self.conditions)
        if self.catch.trials and not self.catch.videos:
            conditions[self.catch.condition] = Condition(
                generator=self.catch.generator, source=self.catch_against
            )
        return conditions
