"""The desk's first page: the studies that a researcher belongs to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from flask import abort
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.desk.lab import OpenedStudy, current_lab, opened
from studyapp.desk.page import page
from studyapp.desk.studies import LabStudy, Standing
from studyapp.researchers.account import Right, has_owner
from studyapp.study.settings.reading import read_study
from studyapp.web.research.page import researcher
from studyapp.web.research.pages import Page


@dataclass(frozen=True, kw_only=True)
class Line:
    """A study in the list."""

    study: OpenedStudy
    title: str
    standing: Standing


def overview() -> ResponseReturnValue:
    """List the researcher's studies."""
    lab = current_lab()
    found = (opened(study, researcher()) for study in lab.studies())
    lines = [
        Line(study=each, title=title_of(each), standing=each.study.standing())
        for each in found
        if each is not None
    ]
    unowned = [
        study.name
        for study in lab.studies()
        if researcher().may(Right.MANAGE) and _is_unowned(study)
    ]
    return page("overview", lines=lines, unowned=unowned)


def _is_unowned(study: LabStudy) -> bool:
    try:
        return not has_owner(study.database)
    except InputError:
        return False


def title_of(study: OpenedStudy) -> str:
    """Return the study's title; its folder's name where the study file cannot be read."""
    try:
        return read_study(study.folder.definition).title
    except InputError:
        return study.name


def nowhere(rest: str) -> ResponseReturnValue:
    """Say that there is no such page."""
    del rest
    abort(404)


PAGES: Final = (Page("GET", "/", overview, Right.KEEP_ACCOUNT),)
