"""What the desk's pages are made of: templates and wording."""

import re
from collections.abc import Mapping
from typing import Any, Final

from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.desk.job_kinds import KINDS
from studyapp.researchers.account import Role
from studyapp.web.research.page import problem_page, rendered

DUTIES: Final[Mapping[Role, str]] = {
    "viewer": "open studies as a member",
    "analyst": "make studies, and open others as a member",
    "owner": "invite researchers to the desk, change their roles, remove their access, take over "
    "studies that nobody owns, make studies, and open others as a member",
}
"""What each role may do at the desk; in a study, the role there counts."""


_COMMAND: Final = re.compile(rf"'motionjury\s+({'|'.join(KINDS)})'")
_OPTION: Final = re.compile(r"\s*\(--[^)]*\)")
"""Messages name an option in parentheses, behind the words for it."""


def at_the_desk(text: str) -> str:
    """Return what a command says, with the desk's names of commands and without options."""
    return _COMMAND.sub(lambda command: f"'{KINDS[command[1]].title}'", _OPTION.sub("", text))


def problem_at_the_desk(error: InputError) -> InputError:
    """Return an error in the words of the desk's pages."""
    return InputError(at_the_desk(error.what), where=error.where, remedy=at_the_desk(error.remedy))


def wrong_role() -> ResponseReturnValue:
    """Return the page for researchers whose role in the study is not enough."""
    return problem_page(
        "This page is not for your role in the study",
        "An owner of the study can give you another.",
        403,
    )


def page(template: str, /, problem: InputError | None = None, **values: Any) -> str:
    """Return the page that ``desk/<template>.html`` makes of `values` and of what is wrong."""
    shown = None if problem is None else problem_at_the_desk(problem)
    return rendered(f"desk/{template}.html", problem=shown, **values)
