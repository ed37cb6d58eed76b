from __future__ import annotations

from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.session.served_study import ServedStudy


def test_a_missing_video_is_named(tiny_study: Path) -> None:
    gone = tiny_study / "videos" / "pairs" / "005.mp4"
    gone.unlink()

    with pytest.raises(InputError, match=r"005\.mp4.*missing.*motionjury render"):
        ServedStudy.read(tiny_study)


def test_a_pair_that_was_never_rendered_is_named(tiny_study: Path) -> None:
    stimuli = tiny_study / "stimuli.json"
    stimuli.write_text(stimuli.read_text("utf-8").replace("take-3", "take-9"), "utf-8")

    with pytest.raises(InputError, match=r"no video of 'rule_based' beside .* take-3"):
        ServedStudy.read(tiny_study)
