"""A small study whose motion is generated, made once."""

import shutil
from pathlib import Path

import pytest

from studyapp.stimuli.generation import generate
from studyapp.stimuli.recordings import Take, import_take
from studyapp.study.folder import StudyFolder
from studyapp.study.study_file import new_study
from tests.support.studies.redefining import set_keys
from tests.support.studies.takes import write_motion, write_speech


@pytest.fixture(scope="session")
def generated(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    """Return a study of two segments with clips, and without videos."""
    root = tmp_path_factory.mktemp("generated")
    folder = StudyFolder(root / "study")
    new_study(folder.definition, name="study", trials=2)
    set_keys(folder.definition, {"video.size": 96, "video.frame_rate": 10})
    take = Take(
        motion=write_motion(root / "motion.npz", seconds=2.0),
        speech=write_speech(root / "take.wav", seconds=2.0),
        segment_seconds=1.0,
        condition="ground_truth",
        speaker="scott",
        emotion="neutral",
    )
    import_take(folder, take)
    generate(folder)
    return folder


@pytest.fixture
def study(generated: StudyFolder, tmp_path: Path) -> StudyFolder:
    """Return a copy of it of one's own."""
    return StudyFolder(Path(shutil.copytree(generated.root, tmp_path / "own")))
