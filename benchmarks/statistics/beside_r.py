"""The cumulative link mixed model compared with R's `ordinal::clmm`."""

import json
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd

from analysis.stats.ordinal.mixed_model import OrdinalFit, RandomEffect, fit
from benchmarks.statistics.beside_python import timed
from benchmarks.validity.studies import Design, Preferences, preferences

SCRIPT: Final = """
suppressMessages(library(ordinal))
answers <- read.csv(commandArgs(TRUE)[1])
answers$response <- factor(answers$response)
answers$participant <- factor(answers$participant)
answers$item <- factor(answers$item)
used <- system.time(
  model <- clmm(response ~ s + (0 + s | participant) + (0 + s | item), data = answers))
found <- summary(model)$coefficients
number <- function(x) paste0("[", paste(format(x, digits = 15), collapse = ","), "]")
cat("{\\"estimates\\":", number(found[, 1]), ",\\"errors\\":", number(found[, 2]),
    ",\\"log_likelihood\\":", format(as.numeric(logLik(model)), digits = 15),
    ",\\"seconds\\":", used[["user.self"]] + used[["sys.self"]], "}\\n")
"""

HAS_ORDINAL: Final = 'quit(status = !requireNamespace("ordinal", quietly = TRUE))'


@dataclass(frozen=True, kw_only=True)
class BesideR:
    """Comparison of the same model with R.

    Attributes
    ----------
    seconds, seconds_r : float
        Processor time of each.
    estimates_apart : float
        Largest difference between estimates, thresholds included.
    effect_error_apart : float
        Relative difference of the standard error of the effect `s`, without the thresholds'.
    log_likelihood_apart : float
        Difference of the log-likelihoods.
    """

    seconds: float
    seconds_r: float
    estimates_apart: float
    effect_error_apart: float
    log_likelihood_apart: float

    @property
    def times_faster(self) -> float:
        """R's time over ours."""
        return self.seconds_r / self.seconds

    @property
    def agrees(self) -> bool:
        """Whether all three differences are as small as promised."""
        return (
            self.estimates_apart < 1e-3
            and self.effect_error_apart < 1e-2
            and self.log_likelihood_apart < 1e-3
        )


def why_not_r() -> str:
    """Return why R cannot be used, or an empty text."""
    program = shutil.which("Rscript")
    if program is None:
        return "R is not installed"
    result = subprocess.run([program, "-e", HAS_ORDINAL], capture_output=True, check=False)  # noqa: S603
    return "" if result.returncode == 0 else "R has no package ordinal"


def made_answers(participants: int, items: int) -> Preferences:
    """Return answers to fit, with an effect and differences between all groups."""
    design = Design(
        participants=participants, items=items, effect=0.4, participant_sd=0.6, item_sd=0.45
    )
    return preferences(design, np.random.default_rng(1))


def fitted(answers: Preferences, *, effect: bool = True) -> OrdinalFit:
    """Fit the report's model, or the reduced one without the effect."""
    random = [
        RandomEffect(name=name, groups=groups, multiplier=answers.side)
        for name, groups in (("participant", answers.participants), ("item", answers.items))
    ]
    covariates = {"s": answers.side} if effect else {}
    return fit(answers.responses, covariates, random, errors=effect)


def beside_r(answers: Preferences, *, turns: int = 3) -> BesideR:
    """Fit `answers` here and in R.

    Raises
    ------
    subprocess.CalledProcessError
        If R fails.
    """
    our_fit, seconds = timed(partial(fitted, answers), turns=turns)
    theirs = _by_r(answers)
    # R gives the thresholds first.
    estimates = np.array([*our_fit.thresholds, *our_fit.estimates.values()])
    errors = np.array([*our_fit.standard_errors.values()])
    return BesideR(
        seconds=seconds,
        seconds_r=theirs["seconds"],
        estimates_apart=float(np.abs(estimates - theirs["estimates"]).max()),
        effect_error_apart=float(np.abs(errors / theirs["errors"][-len(errors) :] - 1).max()),
        log_likelihood_apart=abs(our_fit.log_likelihood - theirs["log_likelihood"]),
    )


def _by_r(answers: Preferences) -> dict[str, Any]:
    table = pd.DataFrame(
        {
            "response": answers.responses,
            "s": answers.side,
            "participant": answers.participants,
            "item": answers.items,
        }
    )
    with tempfile.TemporaryDirectory(prefix="beside-r-") as name:
        script, data = Path(name, "clmm.R"), Path(name, "answers.csv")
        script.write_text(SCRIPT, encoding="utf-8")
        table.to_csv(data, index=False)
        done = subprocess.run(  # noqa: S603
            [shutil.which("Rscript") or "Rscript", str(script), str(data)],
            capture_output=True,
            check=True,
            text=True,
        )
    our_fit: dict[str, Any] = json.loads(done.stdout)
    return our_fit
