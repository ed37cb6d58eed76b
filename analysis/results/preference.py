"""Preferences between two sides: two conditions, or a motion with its own and another's speech."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Final, Literal, TypeVar

import numpy as np
import pandas as pd
from scipy import stats

from analysis.answers.table import ANALYSED_KINDS, AnswerTable
from analysis.results.grouping import ConditionKey, PairKey, codes, count_participants, split_by_key
from analysis.results.mixed_models import NetPreference, SidedAnswers, net_preference, sided
from analysis.stats.clustered_mean import Estimate, Interval, clustered_mean
from analysis.stats.f_tests import min_f
from analysis.stats.one_sample_tests import Pooled, pooled_tests, sign_test, signed_rank
from analysis.stats.samples import group_means

Z_95: Final = float(stats.norm.ppf(0.975))

By = Literal["clmm", "win_share", "sign"]

FEWEST: Final = 20
"""Fewest participants, and segments, for the mixed model's likelihood ratio to decide.

The test treats as normal a statistic that follows t with one degree of freedom less than there are
groups. With 20 groups its false positive rate is at most .065 at the level .05; with fewer it is
higher.
"""


@dataclass(frozen=True, kw_only=True)
class Robustness:
    """Tests with fewer assumptions, to be read alongside the headline.

    Attributes
    ----------
    sign_p, wilcoxon_p : float
        Exact sign and signed-rank tests of participants' mean preferences, which treat the segments
        as fixed.
    min_f_p : float
        min F′ over participants and segments; conservative.
    reason : str
        Why a number is missing.
    """

    sign_p: float
    wilcoxon_p: float
    min_f_p: float
    reason: str


@dataclass(frozen=True, kw_only=True)
class Unexcluded:
    """The same numbers with nobody excluded."""

    n: int
    share: Mapping[str, float]
    win_share: Estimate


@dataclass(frozen=True, kw_only=True)
class Decision(Interval):
    """The test by which the report decides, and the estimate that it quotes.

    The estimate is for the first side: log-odds, a win share, or the share of participants who
    prefer it among those who prefer either.

    Attributes
    ----------
    by : {'clmm', 'win_share', 'sign'}
        The mixed model's likelihood ratio; if there is none, or too few participants or segments,
        the win share; if that has no test either, the exact sign test of participants.
    p_value, p_holm : float
        p of the test; p corrected over the report's family, NaN outside it.
    why : str
        Why the mixed model does not decide; empty if it does.
    """

    by: By
    p_value: float
    p_holm: float = math.nan
    why: str = ""

    @property
    def null(self) -> float:
        """The estimate of no preference."""
        return 0.0 if self.by == "clmm" else 0.5


@dataclass(frozen=True, kw_only=True)
class Preference:
    """The results of answers for one side and against another.

    Attributes
    ----------
    sides : (str, str)
        Names of the first and the second side in results.
    n, recruited, attentive : int
        Numbers of answers, of participants who took part, and of those analysed.
    counts : mapping of str to int
        `<first>_strong`, `<first>_weak`, `equal`, `<second>_weak`, `<second>_strong`.
    share : mapping of str to float
        `<first>`, `<second>`, `equal`: percent of all answers.
    win_share : Estimate
        Win share of the first side (ties count as one half), tested against one half.
    clmm : NetPreference
        In favour of the first side.
    robustness : Robustness
        Secondary tests.
    as_published : Pooled
        Tests of pooled answers.
    without_exclusions : Unexcluded
        For comparison.
    decision : Decision
        The test by which the report decides.
    """

    sides: ClassVar[tuple[str, str]]

    n: int
    recruited: int
    attentive: int
    counts: Mapping[str, int]
    share: Mapping[str, float]
    win_share: Estimate
    clmm: NetPreference
    robustness: Robustness
    as_published: Pooled
    without_exclusions: Unexcluded
    decision: Decision


@dataclass(frozen=True, kw_only=True)
class Comparison(Preference, PairKey):
    """The preference for condition a over condition b."""

    sides = "a", "b"

    def mirrored(self) -> Comparison:
        """Return the comparison of b against a."""
        everyone = self.without_exclusions
        return replace(
            self,
            a=self.b,
            b=self.a,
            counts=dict(zip(self.counts, [*self.counts.values()][::-1], strict=True)),
            share=_swapped(self.share),
            win_share=self.win_share.mirrored(),
            clmm=replace(self.clmm, estimate=-self.clmm.estimate),
            without_exclusions=replace(
                everyone, share=_swapped(everyone.share), win_share=everyone.win_share.mirrored()
            ),
            decision=self.decision.mirrored(2 * self.decision.null),
        )


def _swapped(share: Mapping[str, float]) -> dict[str, float]:
    return {**share, "a": share["b"], "b": share["a"]}


@dataclass(frozen=True, kw_only=True)
class MatchedCondition(Preference, ConditionKey):
    """The preference for a condition's motion with its own speech over another's speech."""

    sides = "own", "other"


AnyPreference = TypeVar("AnyPreference", bound=Preference)


def preferences(
    kind: type[AnyPreference], table: AnswerTable, excluded: Collection[str]
) -> list[AnyPreference]:
    """Return the preferences in everything shown in a main or repeated trial.

    Parameters
    ----------
    kind : type
        `Comparison` for pairs; `MatchedCondition` for one motion with two speeches.
    table : AnswerTable
        All answers.
    excluded : collection of str
        Participants who are left out.
    """
    return [
        kind(**vars(key), **_analyse(answers, excluded, kind.sides))
        for key, answers in split_by_key(table, table.shown)
        if answers["kind"].isin(ANALYSED_KINDS).any()
    ]


def _analyse(
    answers: pd.DataFrame, excluded: Collection[str], sides: tuple[str, str]
) -> dict[str, Any]:
    """Return the fields of `Preference`."""
    attentive = answers[~answers["participant"].isin(list(excluded))]
    everyone, analysed = (
        sided(part[part["kind"].isin(ANALYSED_KINDS)]) for part in (answers, attentive)
    )
    net, share = net_preference(analysed), win_share(analysed)
    return {
        "n": len(analysed.responses),
        "recruited": count_participants(answers),
        "attentive": count_participants(attentive),
        "counts": _counts(analysed, sides),
        "share": _shares(analysed, sides),
        "win_share": share,
        "clmm": net,
        "robustness": _robustness(analysed),
        "as_published": pooled_tests(analysed.signed),
        "without_exclusions": Unexcluded(
            n=len(everyone.responses),
            share=_shares(everyone, sides),
            win_share=win_share(everyone),
        ),
        "decision": _decision(analysed, net, share),
    }


def _decision(answers: SidedAnswers, net: NetPreference, share: Estimate) -> Decision:
    """Return the first available of the mixed model, the win share and the sign test."""
    why = net.reason or (net.remark if math.isnan(net.p_value) else "")
    if not why and min(share.participants, share.segments) < FEWEST:
        why = (
            f"with fewer than {FEWEST} participants or segments, the mixed model's likelihood "
            "ratio too often finds differences that are not there"
        )
    if not why:
        margin = Z_95 * net.standard_error
        low, high = net.estimate - margin, net.estimate + margin
        return Decision(by="clmm", estimate=net.estimate, low=low, high=high, p_value=net.p_value)
    by_share = Decision(
        by="win_share",
        estimate=share.estimate,
        low=share.low,
        high=share.high,
        p_value=share.p_value,
        why=why,
    )
    if not math.isnan(share.p_value):
        return by_share
    signs = sign_test(group_means(answers.signed.astype(np.float64), answers.participants))
    if share.participants < 2 or math.isnan(signs.p_value):
        return replace(by_share, reason=net.reason or share.reason)
    why = f"{why.rstrip('.')}; the win share has no interval: {share.reason}"
    return Decision(by="sign", **vars(signs), why=why)


def win_share(answers: SidedAnswers) -> Estimate:
    """Return the share of wins (ties count as one half), tested against one half."""
    return clustered_mean(answers.wins, answers.participants, answers.segments)


def left_share(answers: pd.DataFrame) -> Estimate:
    """Return the share of answers for the left side; ties count as one half."""
    left = (1 - np.sign(answers["value"].to_numpy() - 3)) / 2
    return clustered_mean(left, codes(answers, "participant"), codes(answers, "segment"))


def _robustness(answers: SidedAnswers) -> Robustness:
    signed = answers.signed.astype(np.float64)
    means = group_means(signed, answers.participants)
    signs, ranks = sign_test(means), signed_rank(means)
    both = min_f(signed, answers.participants, answers.segments)
    return Robustness(
        sign_p=signs.p_value,
        wilcoxon_p=ranks.p_value,
        min_f_p=both.p_value,
        reason=both.reason or signs.reason or ranks.reason,
    )


def _counts(answers: SidedAnswers, sides: tuple[str, str]) -> dict[str, int]:
    first, second = sides
    levels = (f"{first}_strong", f"{first}_weak", "equal", f"{second}_weak", f"{second}_strong")
    counts = np.bincount(2 - answers.signed, minlength=5).tolist()
    return dict(zip(levels, counts, strict=True))


def _shares(answers: SidedAnswers, sides: tuple[str, str]) -> dict[str, float]:
    """Return percentages of all answers; NaN without answers."""
    total = len(answers.responses)
    counts = np.bincount(1 - np.sign(answers.signed), minlength=3).tolist()
    first, equal, second = (100 * count / total if total else math.nan for count in counts)
    return {sides[0]: first, sides[1]: second, "equal": equal}
