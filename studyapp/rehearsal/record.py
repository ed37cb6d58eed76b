"""`rehearsal.json`: the simulated population of a rehearsal, and its true values."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from analysis.results.known_values import KnownValue
from motion.errors import InputError
from motion.files import write_text
from studyapp.rehearsal.simulation.population import Population
from studyapp.study.settings.sections import explain_errors


class Truth(BaseModel):
    """The contents of `rehearsal.json`.

    Attributes
    ----------
    seed : int
        Seed of the rehearsal.
    study : str
        Digest of the study that was rehearsed: its definition, segments and videos.
    population : Population
        The population of the participants.
    expected : tuple of KnownValue
        The true value of everything that is estimated.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    format: Literal[4] = 4
    seed: int
    study: str
    population: Population
    expected: tuple[KnownValue, ...]


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
        raise InputError("the study has not been rehearsed", where=path, remedy=remedy) from None
    except ValidationError as error:
        raise InputError(explain_errors(error), where=path, remedy=remedy) from None
