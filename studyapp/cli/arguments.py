"""Arguments that several subcommands share."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final
from urllib.parse import urlsplit

import click

from motion.errors import InputError
from motion.formats.joint_maps import JointMap, read_joint_map
from studyapp.study.folder import StudyFolder


def existing_study(root: Path) -> StudyFolder:
    """Return the study folder at `root`; raise `InputError` where there is none."""
    folder = StudyFolder(root)
    if not folder.definition.exists():
        raise InputError(
            "this is not a study folder, study.toml is missing",
            where=folder.root,
            remedy=f"Make one with 'motionjury init {folder.root}'",
        )
    return folder


def study_here() -> StudyFolder | None:
    """Return the study in whose folder the command is run; None where that is none."""
    here = StudyFolder(Path())
    return here if here.definition.exists() else None


def refuse_beside(options: Mapping[str, object], beside: str) -> None:
    """Raise `InputError` where one of the options is given beside what they do not go with."""
    given = [name for name, value in options.items() if value not in (None, False)]
    if given:
        raise InputError(
            f"{', '.join(given)} cannot be given with {beside}",
            remedy="Leave out either the one or the other",
        )


class _StudyFolderType(click.ParamType[StudyFolder]):
    name = "folder"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> StudyFolder:
        return value if isinstance(value, StudyFolder) else existing_study(Path(str(value)))


class _JointMapType(click.ParamType[JointMap]):
    """A file that names the joints of a skeleton."""

    name = "file"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> JointMap:
        return value if isinstance(value, Mapping) else read_joint_map(Path(str(value)))


joints_option = click.option(
    "--joints",
    "joint_map",
    type=_JointMapType(),
    help="The joints of a BVH, or of joint positions, of another skeleton: lines such as "
    'pelvis = "Hips".',
)

_MOST_PROCESSES: Final = 256


def _default_processes() -> int:
    """Return how many processors this program may use, at most `_MOST_PROCESSES`."""
    if hasattr(os, "sched_getaffinity"):
        return min(len(os.sched_getaffinity(0)), _MOST_PROCESSES)
    return min(os.cpu_count() or 1, _MOST_PROCESSES)


study_folder = click.argument("folder", type=_StudyFolderType(), default=".")
"""The study folder; it must exist. The one in which the command is run where none is named."""

named_study_folder = click.argument("folder", type=_StudyFolderType())
"""The study folder of commands whose next argument could be taken for it."""

optional_study_folder: Callable[[Callable[..., None]], Callable[..., None]] = click.argument(
    "folder", required=False, type=_StudyFolderType()
)
"""A study folder, which must exist, or none."""

processes: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "--processes",
    type=click.IntRange(1, _MOST_PROCESSES),
    default=_default_processes,
    show_default="one for each processor",
    help="How many videos or takes are made, or segments measured, at once.",
)

cluster: Callable[[Callable[..., None]], Callable[..., None]] = click.option(
    "--cluster",
    metavar="ADDRESS",
    help="Render on the Dask cluster whose scheduler is at ADDRESS, such as tcp://node1:8786. "
    "Its workers need this version and see the study under the same path.",
)


def public_address(
    *, default: str | None, help: str
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Return the option that says where the study is served, for all to see.

    The command gets it without a slash at its end, empty where it is not given.
    """
    return click.option(
        "--address",
        default=default,
        show_default=default is not None,
        metavar="URL",
        envvar="MOTIONJURY_ADDRESS",
        callback=lambda context, parameter, given: _checked_address(given or ""),
        help=help,
    )


def _checked_address(address: str) -> str:
    parts = urlsplit(address)
    is_found = parts.scheme in ("http", "https") and parts.hostname
    if address and (not is_found or parts.query or parts.fragment):
        raise InputError(
            "this is not an address of a study",
            where=f"address {address!r}",
            remedy="Give one such as https://study.example.org/",
        )
    return address.rstrip("/")
