from __future__ import annotations

import httpx
import pytest

from motion.errors import InputError
from studyapp.rehearsal.server import rehearsal_server
from studyapp.study.folder import StudyFolder


def test_the_study_is_served_until_the_block_ends_and_an_error_comes_with_what_it_said(
    folder: StudyFolder,
) -> None:
    folder.definition.write_text(f"open = false\n{folder.definition.read_text()}")
    with (
        pytest.raises(InputError, match="nothing to see") as caught,
        rehearsal_server(folder, speed=100) as address,
    ):
        page = httpx.get(address, trust_env=False)
        assert page.status_code == httpx.codes.CONFLICT
        assert "takes no new participants" in page.text
        raise InputError("nothing to see")
    assert "server: none" in caught.value.__notes__[0]
    with pytest.raises(httpx.ConnectError):
        httpx.get(address, trust_env=False)


def test_a_server_that_cannot_start_says_why(folder: StudyFolder) -> None:
    folder.stimuli.write_text("{")
    with (
        pytest.raises(InputError, match=r"did not start.*stimuli\.json"),
        rehearsal_server(folder, speed=100),
    ):
        raise AssertionError("it is served")
