from __future__ import annotations

import pytest

from motion.errors import InputError
from studyapp.rehearsal.server import rehearsal_server
from studyapp.study.folder import StudyFolder


def test_a_server_that_cannot_start_says_why(folder: StudyFolder) -> None:
    folder.stimuli.write_text("{")
    with (
        pytest.raises(InputError, match=r"did not start.*stimuli\.json"),
        rehearsal_server(folder, speed=100),
    ):
        raise AssertionError("it is served")
