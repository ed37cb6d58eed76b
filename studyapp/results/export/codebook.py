"""The codebook of an export: what every column, value and question of it means."""

import json
from collections.abc import Iterator, Mapping, Sequence
from importlib import metadata
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from analysis.answers.exclusion_rules import excluded_by_hand
from motion.files import sha256_of
from studyapp.results.export.columns import Column, TableColumns, declared
from studyapp.results.stored_answers import Source
from studyapp.study.design.allocation import PREFERENCES
from studyapp.study.folder import StudyFolder
from studyapp.study.protocols.mismatch import MismatchStudy
from studyapp.study.settings.questions import (
    BAND_WIDTH,
    SCALE_STEPS,
    SLIDER_MAX,
    FormQuestion,
    Question,
    RatingQuestion,
)
from studyapp.study.settings.study import Study


def codebook(
    folder: StudyFolder,
    study: Study,
    origin: Source,
    tables: Sequence[tuple[TableColumns, Sequence[str]]],
) -> dict[str, Any]:
    """Return the codebook as plain data, for JSON and for `codebook_page`.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    study : Study
        Its definition: values and wording are its own.
    origin : {'participants', 'rehearsal'}
        Who answered.
    tables : sequence of (TableColumns, file names)
        What was exported.
    """
    return {
        "study": {
            "name": study.name,
            "title": study.title,
            "protocol": study.protocol,
            "seed": study.seed,
            "sha256": sha256_of(folder.definition),
            "origin": origin,
        },
        "motionjury": metadata.version("motionjury"),
        "tables": [_table(study, table, files) for table, files in tables],
        "questions": [_question(study, question) for question in study.questions],
        "form": [_form_question(stage, question) for stage, question in study.form.asked()],
    }


def _table(study: Study, table: TableColumns, files: Sequence[str]) -> dict[str, Any]:
    return {
        "name": table.name or "answers",
        "files": list(files),
        "row": table.title,
        "columns": [
            vars(column) | {"values": dict(_labels(study, table, column))}
            for column in table.columns
        ],
    }


def _labels(study: Study, table: TableColumns, column: Column) -> dict[str, str]:
    if table.name == "form" and column.name == "question":
        return {question.name: question.text for _, question in study.form.asked()}
    # What was wrong with a request is no kind of trial.
    if table.name == "refusals":
        return {}
    return dict(column_labels(study, column.name))


def _question(study: Study, question: Question) -> dict[str, Any]:
    return {
        "name": question.name,
        "title": question.title,
        "text": question.text,
        "parts": list(question.parts),
        "values": dict(answer_labels(study, question)),
        "reasons": {reason.name: reason.text for reason in question.reasons},
    }


def _form_question(stage: str, question: FormQuestion) -> dict[str, Any]:
    return {
        "name": question.name,
        "stage": stage,
        "text": question.text,
        "kind": question.kind,
        "required": question.required,
        "free_text": question.kind == "text",
        "values": dict(form_labels(question)),
    }


def as_json(content: Mapping[str, Any]) -> str:
    """Return `content` as the text of a JSON file; a number that is none is an error."""
    return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def codebook_page(book: Mapping[str, Any]) -> str:
    """Return a codebook as a page of Markdown."""
    return written_page("codebook.md", **book)


def written_page(name: str, **values: object) -> str:
    """Return the Markdown page that a template of the folder `pages` makes of `values`."""
    environment = Environment(
        loader=PackageLoader(__package__, "pages"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        # Markdown, whose cells the filter escapes.
        autoescape=False,  # noqa: S701
    )
    environment.filters["plain"] = _plain
    return environment.get_template(name).render(values)


def _plain(text: str) -> str:
    """Return text that stays within its line and its cell, and opens no markup of its own."""
    return " ".join(str(text).split()).replace("|", "\\|").replace("<", "&lt;")


Labels = Mapping[str, str]
"""Each value as text, and what it means."""


def column_labels(study: Study, column: str) -> Labels:
    """Return the values of a column and what they mean; nothing where it has no fixed ones."""
    fixed: Labels | None = declared()["values"].get(column)
    if fixed is not None:
        return fixed
    if column == "arm":
        return {arm.name: f"compares {', '.join(arm.conditions)}" for arm in study.arms}
    if column == "part":
        return dict.fromkeys(study.parts, "")
    if column in ("condition", "left_condition", "right_condition", "reference", "other"):
        return dict(_conditions(study))
    if column == "exclusion_rule":
        rules = [*(each.to_rule() for each in study.settled_exclusions), excluded_by_hand()]
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
            (
                BAND_WIDTH * step,
                SLIDER_MAX if step == SCALE_STEPS - 1 else BAND_WIDTH * (step + 1) - 1,
            )
            for step in range(SCALE_STEPS)
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
    words = declared()["preferences"]["strong" if levels == 5 else "plain"]
    return {str(value): words[str(value)] for value in PREFERENCES[levels]}


def form_labels(question: FormQuestion) -> Labels:
    """Return the values that may be answered to a question about the participant."""
    if question.kind == "text":
        return {}
    if question.kind == "number":
        return {f"{question.low} to {question.high}": "a whole number"}
    return {answer: question.label(answer) for answer in question.offered}
