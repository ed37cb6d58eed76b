"""Everything the report says, as result objects; no text, no layout."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import pandas as pd

from analysis.exclusions.study_sessions import (
    ExclusionResult,
    ExclusionRule,
    exclude,
    failed_attention_checks,
    failed_catch_trials,
    incomplete_sessions,
)
from analysis.metrics.conditions import StudyMetrics
from analysis.metrics.measuring import study_metrics
from analysis.preferences.segments import SegmentShare, segment_shares
from analysis.preferences.side_bias import SideBias, side_bias
from analysis.preferences.win_share import Preference, compare, compare_by_emotion
from analysis.report.inputs import ReportInputs

SIGNIFICANCE = 0.05
"""Holm-corrected p values below this decide for one side."""

Verdict = Literal["reference", "other", "undecided", "untested"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Findings:
    """The results that the report shows.

    Attributes
    ----------
    presentations : int
        Trials of a whole study session, of all kinds.
    exclusion : ExclusionResult
        Which study sessions are left out, and the answers with and without them.
    preferences : tuple of Preference
        Every comparison and question after exclusions; one family of tests.
    everyone : tuple of Preference
        The same without exclusions, in the same order.
    emotions : tuple of Preference
        Every comparison, question and emotion after exclusions.
    segments : tuple of SegmentShare
        Every comparison, question and segment after exclusions.
    side_bias : tuple of SideBias
        One per question, after exclusions.
    metrics : StudyMetrics
        Automatic metrics of every condition that has clips.
    """

    presentations: int
    exclusion: ExclusionResult
    preferences: tuple[Preference, ...]
    everyone: tuple[Preference, ...]
    emotions: tuple[Preference, ...]
    segments: tuple[SegmentShare, ...]
    side_bias: tuple[SideBias, ...]
    metrics: StudyMetrics


def find(inputs: ReportInputs) -> Findings:
    """Run every analysis of the report."""
    presentations = inputs.presentations or _longest(inputs.responses)
    exclusion = exclude(
        inputs.responses,
        (
            incomplete_sessions(presentations, len(inputs.questions), inputs.completed),
            failed_catch_trials(inputs.max_failed_catch),
            *_attention_rules(inputs),
        ),
    )
    questions = tuple(inputs.questions)
    comparisons = _comparisons(inputs)
    return Findings(
        presentations=presentations,
        exclusion=exclusion,
        preferences=compare(exclusion.analysed, comparisons, questions),
        everyone=compare(exclusion.everyone, comparisons, questions),
        emotions=compare_by_emotion(exclusion.analysed, comparisons, questions),
        segments=segment_shares(exclusion.analysed),
        side_bias=side_bias(exclusion.analysed, questions),
        metrics=study_metrics(inputs.clips, inputs.speech, frozen=inputs.frozen),
    )


def _attention_rules(inputs: ReportInputs) -> tuple[ExclusionRule, ...]:
    allowed = inputs.max_failed_attention
    return () if allowed is None else (failed_attention_checks(allowed),)


def verdict(preference: Preference) -> Verdict:
    """Return which side the corrected test decides for, if any, or that there is no test."""
    if math.isnan(preference.holm_p):
        return "untested"
    if not preference.holm_p < SIGNIFICANCE:
        return "undecided"
    return "reference" if preference.win_share.estimate > 0.5 else "other"


def _longest(responses: pd.DataFrame) -> int:
    if responses.empty:
        return 0
    return int(responses.groupby("study_session")["position"].nunique().max())


def _comparisons(inputs: ReportInputs) -> list[tuple[str, str, str]]:
    """Return every comparison as (name, reference, other), in the order of the conditions.

    Those that nobody has answered yet are among them: they belong to the family of tests.
    """
    if inputs.origin == "none":
        return []
    answered = inputs.responses.loc[
        inputs.responses["kind"] != "catch", ["comparison", "reference", "other"]
    ].drop_duplicates()
    found = [(str(name), str(one), str(other)) for name, one, other in answered.to_numpy()]
    missing = set(inputs.conditions) - {inputs.reference} - {other for _, _, other in found}
    found += [(f"{inputs.reference}-{other}", inputs.reference, other) for other in missing]
    order = {condition: place for place, condition in enumerate(inputs.conditions)}
    return sorted(found, key=lambda pair: (order.get(pair[2], len(order)), pair))
