import hashlib
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from motion.errors import InputError
from motion.formats.beat_tracks import write_arkit_json
from studyapp.stimuli.recordings import Take, import_take
from studyapp.stimuli.training_recordings import recordings_of
from studyapp.study.folder import StudyFolder
from tests.support.studies.redefining import set_keys


@pytest.fixture
def folder_of_motion(motion_file: Callable[..., Path], tmp_path: Path) -> Path:
    folder = tmp_path / "recorded"
    for name in ("a.npz", "deep/b.npz", ".hidden/c.npz"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(motion_file(1.0), folder / name)
    (folder / "notes.txt").write_text("no motion")
    return folder


def test_recordings_of_a_study_have_take_emotion_and_frozen_channels(
    folder: StudyFolder, take: Callable[..., Take]
) -> None:
    import_take(folder, take())
    set_keys(folder.definition, {"freeze": ["hands"]})
    recordings = recordings_of(folder.root)
    assert [source.name for source in recordings.sources] == ["take_01", "take_02", "take_03"]
    assert {(s.recording, s.emotion) for s in recordings.sources} == {("take.wav", "neutral")}
    assert recordings.frozen == ("hands",)
    assert recordings.networks == folder.root / "evaluators"
    stored = folder.clip("ground_truth", "take_01")
    assert recordings.sources[0].sha256 == hashlib.sha256(stored.read_bytes()).hexdigest()
    assert len(recordings.sources[0].read()) == 60
    assert recordings.read_body().has_arkit_slots


def test_nested_motion_files_are_separate_recordings_unless_a_table_says_otherwise(
    folder_of_motion: Path,
) -> None:
    nested = recordings_of(folder_of_motion)
    table = folder_of_motion / "segments.csv"
    table.write_text("name,emotion,wav\na,anger,take.wav\nb,calm,take.wav\n")
    stated = recordings_of(folder_of_motion)
    write_arkit_json(folder_of_motion / "a.json", np.full((60, 51), 0.5), 30)

    assert [(s.name, s.recording, s.emotion) for s in nested.sources] == [
        ("a.npz", "a", ""),
        ("deep/b.npz", "b", ""),
    ]
    assert nested.frozen == ()
    assert stated.sources[0].read().arkit is not None
    assert {source.recording for source in stated.sources} == {"take.wav"}
    assert [source.emotion for source in stated.sources] == ["anger", "calm"]


def test_a_folder_without_motion_or_with_another_table_is_refused(
    folder: StudyFolder, take: Callable[..., Take], folder_of_motion: Path, tmp_path: Path
) -> None:
    for content in (b"name\na\n", b"name,emotion\na\n", b"name,emotion\na,\xff\n"):
        (folder_of_motion / "segments.csv").write_bytes(content)
        with pytest.raises(InputError, match=r"segments\.csv: the table is not CSV in UTF-8 with"):
            recordings_of(folder_of_motion)
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="no such folder"):
        recordings_of(tmp_path / "none")
    with pytest.raises(InputError, match="no motion file"):
        recordings_of(tmp_path / "empty")
    import_take(folder, take())
    shutil.rmtree(folder.root / "motion" / "ground_truth")
    with pytest.raises(InputError, match=r"'ground_truth' has no motion.*motionjury import"):
        recordings_of(folder.root)
