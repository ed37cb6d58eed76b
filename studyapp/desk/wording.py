"""Where a message tells of the command line, what to do on the desk's pages instead."""

from __future__ import annotations

import re
from typing import Final

from motion.errors import InputError

TITLES: Final = {
    "import": "Bring in",
    "generate": "Generate",
    "render": "Render",
    "check": "Check",
    "plan": "Plan",
    "rehearse": "Rehearse",
    "metrics": "Measure",
    "report": "Report",
}
"""Commands that the desk runs, and what its pages call them."""

_OPTIONS: Final = (
    ("with 'motionjury import'", "under 'Bring in'"),
    ("or give --speech to bring in a new take", "or upload its recording too, as a new take"),
    ("Give --speaker and --emotion", "Fill in 'Speaker' and 'Emotion'"),
    (", or give --condition", ""),
    ("Put it into a sub-folder that is called after", "Remove it, and upload it again with"),
    ("Give a shorter --segment", "Give a smaller 'Length of the segments in seconds'"),
    ("Give the frames per second with --fps", "Fill in 'True frame rate'"),
    ("Give the true frames per second with --fps", "Fill in 'True frame rate'"),
    ("(--fps)", "('True frame rate')"),
    ("Name its joints with --joints", "Have it imported on the server, with --joints"),
    (" (--as-recorded leaves them)", ""),
    ("Say it with --items, such as --items 24,48, or bring", "Bring"),
    ("or serve it with --new-version", "or begin a new version on the study's page"),
    (
        "Draw them with 'motionjury recruit STUDY codes'",
        "Write codes of your own there, in the settings",
    ),
    ("; 'motionjury import' takes larger ones", ""),
    ("--pay", "'Pay'"),
    ("--minutes", "'Minutes'"),
    (", and run the command again", ", and run it again"),
    (" and run the command again", ""),
)
"""Words with options that no page has, and those in their place."""

_COMMAND: Final = re.compile(rf"'motionjury\s+({'|'.join(TITLES)})'")
_VERBOSE: Final = re.compile(r"(; --verbose tells \d+ notes?| \(--verbose tells them\))")


def at_the_desk(text: str) -> str:
    """Return what a command says, in the words of the desk's pages."""
    for command_line, page in _OPTIONS:
        text = text.replace(command_line, page)
    return _COMMAND.sub(lambda found: f"'{TITLES[found[1]]}'", _VERBOSE.sub("", text))


def problem_at_the_desk(error: InputError) -> InputError:
    """Return an error in the words of the desk's pages."""
    return InputError(at_the_desk(error.what), where=error.where, remedy=at_the_desk(error.remedy))
