"""Questions about the participant: their fields, and their page before and after the trials."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from flask import render_template, request

from studyapp.definition.form import Stage
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
        given=given or {},
    )


def form_fields() -> dict[str, str]:
    """Return the answers about the participant that were sent, under their questions' names."""
    return {
        name.removeprefix(FORM_FIELD): value
        for name, value in request.form.items()
        if name.startswith(FORM_FIELD)
    }
