"""What the values of exported columns mean in one study: labels for the codebook."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from analysis.answers.exclusion_rules import excluded_by_hand
from studyapp.results.export.columns import fixed_values, preference_values
from studyapp.study.design.pair_trials import PREFERENCES
from studyapp.study.protocols.mismatch import MismatchStudy
from studyapp.study.settings.form import FormQuestion
from studyapp.study.settings.questions import Question
from studyapp.study.settings.scales import BAND, SLIDER_END, STEPS, RatingQuestion
from studyapp.study.settings.study import Study

Labels = Mapping[str, str]
"""Each value as text, and what it means."""


def column_labels(study: Study, column: str) -> Labels:
    """Return the values of a column and what they mean; nothing where it has no fixed ones."""
    if (fixed := fixed_values(column)) is not None:
        return fixed
    if column == "arm":
        return {arm.name: f"compares {', '.join(arm.conditions)}" for arm in study.arms}
    if column == "part":
        return dict.fromkeys(study.parts, "")
    if column in ("condition", "left_condition", "right_condition", "reference", "other"):
        return dict(_conditions(study))
    if column == "exclusion_rule":
        rules = [*(each.made() for each in study.settled_exclusions), excluded_by_hand()]
        return {rule.name: rule.description for rule in rules}
    if column == "question":
        return {question.name: question.title for question in study.questions}
    return {}


def _conditions(study: Study) -> Iterator[tuple[str, str]]:
    for name, condition in study.conditions.items():
        if condition.generator is not None:
            yield name, f"made by the generator {condition.generator}"
        else:
            yield name, "finished videos" if condition.videos else "motion files"
    if study.catch.trials:
        yield study.catch.condition, "visibly flawed motion, of catch trials alone"


def answer_labels(study: Study, question: Question) -> Labels:
    """Return the values that may be answered to a question of a trial, and what they mean."""
    if isinstance(question, RatingQuestion):
        if question.scale != "slider":
            return {str(n): label for n, label in enumerate(question.labels, start=1)}
        bands = [
            (BAND * step, SLIDER_END if step == STEPS - 1 else BAND * (step + 1) - 1)
            for step in range(STEPS)
        ]
        return {
            f"{low} to {high}": label
            for (low, high), label in zip(bands, question.labels, strict=True)
        }
    if study.is_ordered:
        return {"1": "the best place", "2 and on": "the places after it; equal places are a tie"}
    levels = 5
    if isinstance(study, MismatchStudy):
        levels = next(asked.levels for asked in study.questions if asked.name == question.name)
    # With fewer than five answers there is no strength.
    words = preference_values(strength=levels == 5)
    return {str(value): words[str(value)] for value in PREFERENCES[levels]}


def form_labels(question: FormQuestion) -> Labels:
    """Return the values that may be answered to a question about the participant."""
    if question.kind == "text":
        return {}
    if question.kind == "number":
        return {f"{question.low} to {question.high}": "a whole number"}
    return {answer: question.label(answer) for answer in question.offered}
