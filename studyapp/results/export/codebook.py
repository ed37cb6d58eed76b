"""The codebook of an export: what every column, value and question of it means."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from importlib import metadata
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from studyapp.results.export.columns import Column, TableColumns
from studyapp.results.export.labels import answer_labels, column_labels, form_labels
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.form import FormQuestion
from studyapp.study.settings.questions import Question
from studyapp.study.settings.study import Study


def codebook(
    folder: StudyFolder, study: Study, tables: Sequence[tuple[TableColumns, Sequence[str]]]
) -> dict[str, Any]:
    """Return the codebook as plain data, for JSON and for `codebook_page`.

    Parameters
    ----------
    folder : StudyFolder
        The study.
    study : Study
        Its definition: values and wording are its own.
    tables : sequence of (TableColumns, file names)
        What was exported.
    """
    return {
        "study": {
            "name": study.name,
            "title": study.title,
            "protocol": study.protocol,
            "seed": study.seed,
            "sha256": hashlib.sha256(folder.definition.read_bytes()).hexdigest(),
        },
        "motionjury": metadata.version("motionjury"),
        "tables": [_table(study, table, files) for table, files in tables],
        "questions": [_question(study, question) for question in study.questions],
        "form": [
            _form_question(stage, question)
            for stage in study.form.stages()
            for question in study.form.asked(stage)
        ],
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
        return {
            question.name: question.text
            for stage in study.form.stages()
            for question in study.form.asked(stage)
        }
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
