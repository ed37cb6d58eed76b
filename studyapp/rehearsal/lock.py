"""One rehearsal of a study at a time."""

from __future__ import annotations

from contextlib import AbstractContextManager

from motion.errors import InputError
from studyapp.definition.folder import StudyFolder
from studyapp.definition.lock import held_alone


def only_rehearsal(folder: StudyFolder) -> AbstractContextManager[None]:
    """Keep other rehearsals of `folder` away during the block.

    Raises
    ------
    InputError
        If the study is being rehearsed already.
    """
    return held_alone(
        folder.root,
        busy=InputError(
            "this study is being rehearsed already",
            where=folder.root,
            remedy="Wait until the other 'motionjury rehearse' is done, or stop it",
        ),
    )
