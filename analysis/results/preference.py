"""What answers for one thing and against another say."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
import pandas as pd
from scipy import stats

from analysis.answers.table import ANALYSED_KINDS
from analysis.results.grouping import ConditionPlace, PairPlace, codes, people
from analysis.results.net_preference import NetPreference, SidedAnswers, net_preference, sided
from analysis.stats.clustered_mean import Estimate, Interval, clustered_mean
from analysis.stats.f_tests import min_f
from analysis.stats.samples import group_means
from analysis.stats.signed_rank import Pooled, pooled_tests, sign_test, signed_rank

Z_95: Final = float(stats.norm.ppf(0.975))

By = Literal["clmm", "win_share", "sign"]

FEWEST: Final = 20
"""Participants and segments from which on the mixed model's likelihood ratio decides.

It compares with a normal law what varies like t with one degree of freedom less than there are
groups: with 20 it finds at most .065 where there is nothing, with fewer more.
"""


@dataclass(frozen=True, kw_only=True)
class Robustness:
    """Tests that lean on fewer assumptions, to be read beside the headline.

    Attributes
    ----------
    sign_p, wilcoxon_p : float
        Exact sign and signed-rank tests of participants' mean preferences; they take the
        segments as the only ones of interest.
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
    """The same numbers when nobody is excluded."""

    n: int
    share: Mapping[str, float]
    win_share: Estimate


@dataclass(frozen=True, kw_only=True)
class Decision(Interval):
    """What the report decides by, and what it quotes.

    The estimate is of what decides, for the one: log-odds, a win share, or the share of
    participants who prefer it among those who prefer either.

    Attributes
    ----------
    by : {'clmm', 'win_share', 'sign'}
        The mixed model's likelihood ratio; where there is none, or few participants or segments,
        the win share; where it has no test either, the exact sign test of participants.
    p_value, p_holm : float
        Its test; corrected over the report's family, NaN outside of it.
    why : str
        Why the mixed model does not decide; empty where it does.
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
    """What answers for one thing (`one`) and against another (`other`) say.

    Attributes
    ----------
    n, recruited, attentive : int
        Answers; participants who took part, and those of them who are analysed.
    counts : mapping of str to int
        `<one>_strong`, `<one>_weak`, `equal`, `<other>_weak`, `<other>_strong`.
    share : mapping of str to float
        `<one>`, `<other>`, `equal`: percent of all answers.
    win_share : Estimate
        Of the one, ties counting one half, tested against one half.
    clmm : NetPreference
        In favour of the one.
    robustness : Robustness
        Secondary tests.
    as_published : Pooled
        What pooled answers would say.
    without_exclusions : Unexcluded
        For comparison.
    decision : Decision
        What the report decides by.
    """

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
class Comparison(Preference, PairPlace):
    """What is preferred; `Preference`'s one is a, its other is b."""

    def mirrored(self) -> Comparison:
        """Return the same of b against a."""
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
class MatchedCondition(Preference, ConditionPlace):
    """How far a condition's own speech is preferred; `Preference`'s one is own, its other other."""


def preference(
    answers: pd.DataFrame, excluded: Collection[str], names: tuple[str, str]
) -> Preference:
    """Analyse answers to one question about one thing against another.

    Parameters
    ----------
    answers : DataFrame
        Of practice, main and repeated trials, excluded participants included.
    excluded : collection of str
        Who is left out.
    names : (str, str)
        How results call the one and the other.
    """
    analysed = answers["kind"].isin(ANALYSED_KINDS).to_numpy(bool)
    kept = ~answers["participant"].isin(list(excluded)).to_numpy(bool)
    of_all, of_kept = sided(answers[analysed]), sided(answers[analysed & kept])
    net, share = net_preference(of_kept), win_share(of_kept)
    return Preference(
        n=len(of_kept.responses),
        recruited=people(answers),
        attentive=people(answers[kept]),
        counts=_counts(of_kept, names),
        share=_shares(of_kept, names),
        win_share=share,
        clmm=net,
        robustness=_robustness(of_kept),
        as_published=pooled_tests(of_kept.towards),
        without_exclusions=Unexcluded(
            n=len(of_all.responses), share=_shares(of_all, names), win_share=win_share(of_all)
        ),
        decision=_decision(of_kept, net, share),
    )


def _decision(answers: SidedAnswers, net: NetPreference, share: Estimate) -> Decision:
    """Return the first of model, win share and sign test that there is."""
    why = net.reason or (net.remark if math.isnan(net.p_value) else "")
    if not why and min(share.participants, share.segments) < FEWEST:
        why = (
            f"with fewer than {FEWEST} participants or segments, the mixed model's likelihood "
            "ratio too often finds differences that are not there"
        )
    if not why:
        reach = Z_95 * net.standard_error
        return Decision(
            by="clmm",
            estimate=net.estimate,
            low=net.estimate - reach,
            high=net.estimate + reach,
            p_value=net.p_value,
        )
    of_share = Decision(
        by="win_share",
        estimate=share.estimate,
        low=share.low,
        high=share.high,
        p_value=share.p_value,
        why=why,
    )
    signs = sign_test(group_means(answers.towards.astype(np.float64), answers.participants))
    if not math.isnan(share.p_value):
        return of_share
    if share.participants < 2 or math.isnan(signs.p_value):
        return replace(of_share, reason=net.reason or share.reason)
    return Decision(
        by="sign",
        estimate=signs.estimate,
        low=signs.low,
        high=signs.high,
        p_value=signs.p_value,
        why=f"{why.rstrip('.')}; the win share has no interval: {share.reason}",
    )


def win_share(answers: SidedAnswers) -> Estimate:
    """Return the share of wins, ties counting one half, tested against one half."""
    return clustered_mean(answers.wins, answers.participants, answers.segments)


def left_share(answers: pd.DataFrame) -> Estimate:
    """Return the share of answers for the left side, ties counting one half."""
    left = (1 - np.sign(answers["value"].to_numpy() - 3)) / 2
    return clustered_mean(left, codes(answers, "participant"), codes(answers, "segment"))


def _robustness(answers: SidedAnswers) -> Robustness:
    towards = answers.towards.astype(np.float64)
    means = group_means(towards, answers.participants)
    signs, ranks = sign_test(means), signed_rank(means)
    both = min_f(towards, answers.participants, answers.segments)
    return Robustness(
        sign_p=signs.p_value,
        wilcoxon_p=ranks.p_value,
        min_f_p=both.p_value,
        reason=both.reason or signs.reason or ranks.reason,
    )


def _counts(answers: SidedAnswers, names: tuple[str, str]) -> dict[str, int]:
    one, other = names
    levels = (f"{one}_strong", f"{one}_weak", "equal", f"{other}_weak", f"{other}_strong")
    counts = np.bincount(2 - answers.towards, minlength=5).tolist()
    return dict(zip(levels, counts, strict=True))


def _shares(answers: SidedAnswers, names: tuple[str, str]) -> dict[str, float]:
    """Return percent of all answers; NaN without any."""
    total = len(answers.responses)
    signs = np.bincount(1 - np.sign(answers.towards), minlength=3).tolist()
    first, equal, second = (100 * count / total if total else math.nan for count in signs)
    return {names[0]: first, names[1]: second, "equal": equal}
