"""`rehearsal.json`: what the simulated participants of a rehearsal were given to prefer."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from motion.errors import InputError
from motion.files import write_text
from studyapp.definition.validation import explain
from studyapp.rehearsal.population import Population


class ExpectedShare(BaseModel):
    """The true win share of one comparison on one question, towards the reference.

    Attributes
    ----------
    share : float
        Wins of the reference plus half the ties among attentive raters, in [0, 1], averaged over
        all raters *and all segments* such a population could meet. This is what the report's
        interval, clustered by participant and by segment, is an interval for.
    share_on_these_segments : float
        The same over all raters, but for the very segments of this study, whose luck (how well
        each condition happens to do in each) is fixed once the seed is. A count over very many
        participants tends to this one.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    comparison: str
    question: str
    share: float
    share_on_these_segments: float


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
    expected : tuple of ExpectedShare
        What they prefer, for every comparison and question.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal[1] = 1
    seed: int
    study: str
    population: Population
    expected: tuple[ExpectedShare, ...]


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
