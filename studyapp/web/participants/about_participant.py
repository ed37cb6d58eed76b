"""Questions about the participant: their fields, and their page before and after the trials."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from flask import render_template, request

from studyapp.study.settings.form import Stage
from studyapp.web.language import say
from studyapp.web.running import running

FORM_FIELD: Final = "form:"
"""Stands before the names of questions about the participant; no question's name holds a colon."""


def form_page(
    token: str, stage: Stage, *, problem: str = "", given: Mapping[str, str] | None = None
) -> str:
    """Return the page that asks the questions of `stage`."""
    study = running().study
    return render_template(
        "form.html",
        study=study,
        token=token,
        stage=stage,
        questions=study.form.asked(stage),
        problem=problem,
        problems=problems_of(stage, given or {}) if problem else {},
        given=given or {},
    )


def problems_of(stage: Stage, given: Mapping[str, str]) -> dict[str, str]:
    """Return what cannot be accepted of the answers to the questions of `stage`, by question."""
    found = {
        question.name: question.problem(given.get(question.name, "").strip(), number)
        for number, question in enumerate(running().study.form.asked(stage), start=1)
    }
    return {name: say(problem) for name, problem in found.items() if problem is not None}


def form_fields() -> dict[str, str]:
    """Return the answers about the participant that were sent, under their questions' names."""
    return {
        name.removeprefix(FORM_FIELD): value.replace("\r\n", "\n")  # as the browser counts it
        for name, value in request.form.items()
        if name.startswith(FORM_FIELD)
    }
