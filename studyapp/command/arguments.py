"""Arguments that several subcommands share."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import click

from motion.errors import InputError
from studyapp.definition.folder import StudyFolder


class _StudyFolderType(click.ParamType[StudyFolder]):
    name = "folder"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> StudyFolder:
        if isinstance(value, StudyFolder):
            return value
        folder = StudyFolder(Path(str(value)))
        if not folder.definition.exists():
            raise InputError(
                "this is no study folder, study.toml is missing",
                where=folder.root,
                remedy=f"Make one with 'motionjury init {folder.root}'",
            )
        return folder


study_folder = click.argument("folder", type=_StudyFolderType())
"""The study folder; it must exist."""

processes: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "--processes",
    type=click.IntRange(1, 256),
    default=len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
    show_default=True,
    help="How many videos are made at once.",
)
