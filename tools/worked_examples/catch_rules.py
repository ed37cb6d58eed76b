"""Whom two readings of the same rule about catch trials exclude."""

from __future__ import annotations

from dataclasses import dataclass

from scipy import stats


@dataclass(frozen=True, kw_only=True)
class Excluded:
    """How probable it is that a participant is excluded.

    Attributes
    ----------
    failing : float
        The participant's chance to fail one catch trial.
    more_than_one, any_of_them, all_of_them : float
        Chance of exclusion where more than one failure excludes, where any does, and where only
        failing all of them does.
    """

    failing: float
    more_than_one: float
    any_of_them: float
    all_of_them: float


def excluded(failing: float, catch_trials: int) -> Excluded:
    """Compute how probable it is that a participant is excluded by each rule.

    Parameters
    ----------
    failing : float
        Chance to fail one catch trial, 0 to 1; whether one is failed says nothing of the next.
    catch_trials : int
        How many there are, at least one.
    """
    failures = stats.binom(catch_trials, failing)
    return Excluded(
        failing=failing,
        more_than_one=float(failures.sf(1)),
        any_of_them=float(failures.sf(0)),
        all_of_them=float(failures.pmf(catch_trials)),
    )
