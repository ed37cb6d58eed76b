from __future__ import annotations

from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.study.stimuli import PairVideo, Stimuli, read_stimuli, write_stimuli

PAIR = PairVideo(segment="s", left="a", right="b", file="videos/x.mp4", duration=2.0, key="k")


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    stimuli = Stimuli(pairs=(PAIR,))
    write_stimuli(tmp_path / "stimuli.json", stimuli)
    assert read_stimuli(tmp_path / "stimuli.json") == stimuli


def test_a_pair_is_found_by_its_sides_in_their_order() -> None:
    stimuli = Stimuli(pairs=(PAIR,))
    assert stimuli.pair("s", "a", "b") == PAIR
    assert stimuli.pair("s", "b", "a") is None


def test_missing_videos_say_what_to_run(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="motionjury render"):
        read_stimuli(tmp_path / "stimuli.json")


@pytest.mark.parametrize("content", ["", "{", '{"pairs": [{}]}', '{"format": 9}'])
def test_a_damaged_record_is_named_with_its_remedy(tmp_path: Path, content: str) -> None:
    path = tmp_path / "stimuli.json"
    path.write_text(content)
    with pytest.raises(InputError, match=r"stimuli.json: .* Delete it"):
        read_stimuli(path)


@pytest.mark.parametrize(
    "file",
    ["../secret.mp4", "videos/../../secret.mp4", "/etc/hostname", "videos/link.mp4", "a\0.mp4"],
)
def test_a_video_outside_the_study_is_refused_however_it_is_named(
    tmp_path: Path, file: str
) -> None:
    study = tmp_path / "study"
    (study / "videos").mkdir(parents=True)
    (tmp_path / "secret.mp4").touch()
    (study / "videos" / "link.mp4").symlink_to(tmp_path / "secret.mp4")
    write_stimuli(
        study / "stimuli.json", Stimuli(pairs=(PAIR, PAIR.model_copy(update={"file": file})))
    )

    with pytest.raises(InputError, match="outside the study's folder"):
        read_stimuli(study / "stimuli.json")


def test_the_videos_may_lie_on_another_disk(tmp_path: Path) -> None:
    study = tmp_path / "study"
    study.mkdir()
    (tmp_path / "disk").mkdir()
    (study / "videos").symlink_to(tmp_path / "disk")
    write_stimuli(study / "stimuli.json", Stimuli(pairs=(PAIR,)))

    assert read_stimuli(study / "stimuli.json").pairs == (PAIR,)
