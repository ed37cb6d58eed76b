"""`rehearsal.json`: what the simulated participants of a rehearsal were given to prefer."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from analysis.results.known_values import KnownValue
from motion.errors import InputError
from motion.files import write_text
from studyapp.rehearsal.simulation.population import Population
from studyapp.study.settings.validation import explain

Measure = Literal["win_share", "own_speech", "mean_rating", "mean_rank"]


class Expected(BaseModel):
    """What the attentive raters of a rehearsal answer on average to one question.

    Attributes
    ----------
    part : str
        The set, block or task that asks it; empty where the study has no parts.
    measure : {'win_share', 'own_speech', 'mean_rating', 'mean_rank'}
        Wins plus half the ties of the first condition of a comparison, in [0, 1]; the same of a
        motion with its own speech against itself with another, in [0, 1]; the mean rating, on the
        question's scale; the mean rank, 1 the best.
    about : str
        The comparison (``first-second``) of a win share, else the condition.
    value : float
        Averaged over all raters *and all segments* such a population could meet. This is what
        the report's interval, clustered by participant and by segment, is an interval for.
    value_on_these_segments : float
        The same over all raters, but for the very segments of this study, whose luck (how well
        each condition happens to do in each) is fixed once the seed is. A count over very many
        participants tends to this one.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    part: str = ""
    question: str
    measure: Measure
    about: str
    value: float
    value_on_these_segments: float


class Truth(BaseModel):
    """`rehearsal.json`: what the simulated participants were given to prefer.

    Attributes
    ----------
    seed : int
        Seed of the rehearsal.
    study : str
        Digest of the study that was rehearsed: its definition, segments and videos.
    population : Population
        Whom the participants were drawn from.
    expected : tuple of Expected
        What they prefer: one for everything that each question measures.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal[3] = 3
    seed: int
    study: str
    population: Population
    expected: tuple[Expected, ...]


def write_truth(path: Path, truth: Truth) -> None:
    """Write `rehearsal.json` in one step."""
    write_text(path, truth.model_dump_json(indent=1) + "\n")


def read_truth(path: Path) -> Truth:
    """Read `rehearsal.json`.

    Raises
    ------
    InputError
        If it is missing or damaged.
    """
    remedy = "Run 'motionjury rehearse' again"
    try:
        return Truth.model_validate_json(path.read_bytes())
    except FileNotFoundError:
        raise InputError("there was no rehearsal yet", where=path, remedy=remedy) from None
    except ValidationError as error:
        raise InputError(explain(error), where=path, remedy=remedy) from None


def known_values(truth: Truth) -> tuple[KnownValue, ...]:
    """Return everything that was put in."""
    return tuple(
        KnownValue(
            about=expected.about,
            part=expected.part,
            question=expected.question,
            measure=expected.measure,
            value=expected.value,
            on_these_segments=expected.value_on_these_segments,
        )
        for expected in truth.expected
    )
