from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from motion.audio import Audio
from motion.errors import InputError
from motion.formats import read_motion, write_clip
from motion.points.detection import Detection
from motion.skeleton import REST_JOINTS, joint_index
from renderer.encoder import SOUND_RATE
from studyapp.stimuli import video_takes
from studyapp.stimuli.video_takes import import_video
from studyapp.study.folder import StudyFolder
from tests.motion.random_clips import clip_of
from tests.support.command_line import refused, run
from tests.support.encoded import VideoRecipe, write_video
from training.data.folders import read_takes

SECONDS = 8
RATE = 15


@pytest.fixture(scope="module")
def video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a grey video of eight seconds with sound."""
    path = tmp_path_factory.mktemp("video") / "talk.mp4"
    tone = np.sin(np.arange(SECONDS * SOUND_RATE) / 40)
    sound = Audio((0.1 * tone).astype(np.float32), SOUND_RATE)
    write_video(path, VideoRecipe(frames=SECONDS * RATE, rate=RATE, sound=sound))
    return path


@pytest.fixture
def detection(monkeypatch: pytest.MonkeyPatch) -> Detection:
    """In any video, detect a person who is absent from the third to the fourth second."""
    frames = SECONDS * RATE
    pose = np.zeros((frames, 33, 3))
    for part, first in zip(("shoulder", "elbow", "wrist", "hip"), (11, 13, 15, 23), strict=True):
        for side, place in (("left", first), ("right", first + 1)):
            pose[:, place] = REST_JOINTS[joint_index(f"{side}_{part}")] * [1, -1, -1]
    pose[:, [0, 7, 8]] = (0, -0.26, -0.19), (0.08, -0.28, -0.07), (-0.08, -0.28, -0.07)
    face = np.tile(np.random.default_rng(0).normal(0, 40, (478, 3)), (frames, 1, 1))
    pose[3 * RATE : 4 * RATE] = face[3 * RATE : 4 * RATE] = np.nan
    visibility = np.broadcast_to(np.arange(33) < 25, (frames, 33)).astype(float)  # no legs
    result = Detection(frame_rate=RATE, pose=pose, visibility=visibility, face=face)
    monkeypatch.setattr(video_takes, "detect", lambda video, on_frame: result)
    return result


def quietly(done: int, total: int) -> None:
    """Show nothing."""


@pytest.mark.usefixtures("detection")
def test_a_video_becomes_takes_for_training(video: Path, tmp_path: Path) -> None:
    said = run("import", "--from-video", video, "--speaker", "anna", tmp_path / "takes")
    assert "note: left out 3.0 to 4.0 s: nobody was found" in said
    assert f"2 takes of 7.0 s in {tmp_path / 'takes'}. Next: 'motionjury train'." in said
    takes = read_takes(tmp_path / "takes")
    assert [take.name for take in takes.takes] == ["talk_01", "talk_02"]
    assert {take.speaker for take in takes.takes} == {"anna"}
    assert not takes.skipped
    clip = read_motion(takes.takes[1].motion)
    assert clip.duration == pytest.approx(4) and clip.arkit is not None
    assert clip.provenance["source"] == "talk.mp4"


@pytest.mark.usefixtures("detection")
def test_another_video_is_added_and_the_same_one_refused(video: Path, tmp_path: Path) -> None:
    import_video(video, tmp_path / "takes", speaker=None, on_frame=quietly)
    other = tmp_path / "other.mp4"
    other.write_bytes(video.read_bytes())
    import_video(other, tmp_path / "takes", speaker=None, on_frame=quietly)
    before = sorted((tmp_path / "takes").rglob("*"))
    with pytest.raises(InputError, match="of this name exists"):
        import_video(other, tmp_path / "takes", speaker=None, on_frame=quietly)
    assert sorted((tmp_path / "takes").rglob("*")) == before


@pytest.mark.parametrize(
    ("write", "sentence"),
    [
        (lambda path, video: path.write_bytes(b"no video"), "broken.mp4"),
        (lambda path, video: write_video(path, VideoRecipe(sound=None)), "no audio"),
        (lambda path, video: path.write_bytes(video.read_bytes()[:4000]), "broken.mp4"),
        (lambda path, video: path.write_bytes(video.read_bytes()), "no face was found in 8"),
    ],
)
def test_an_unusable_video_is_refused_without_writing_files(
    write: Callable[[Path, Path], object],
    sentence: str,
    video: Path,
    tmp_path: Path,
    detection: Detection,
) -> None:
    detection.face[:] = np.nan
    path = tmp_path / "broken.mp4"
    write(path, video)
    with pytest.raises(InputError) as caught:
        import_video(path, tmp_path / "takes", speaker="anna", on_frame=quietly)
    assert sentence in str(caught.value) and "video" in caught.value.remedy.lower()
    assert not (tmp_path / "takes").exists()


@pytest.mark.usefixtures("detection")
def test_takes_need_a_separate_folder_and_no_other_options(
    video: Path, folder: StudyFolder
) -> None:
    command = ("import", "--from-video", video, folder.root)
    assert "this is a study folder" in refused(*command)
    assert "--from-video can only" in refused(*command, "--fps", 15)


@pytest.mark.slow
def test_the_detector_finds_our_avatar(tmp_path: Path) -> None:
    pytest.importorskip("mediapipe")
    poses = np.tile(0.15 * np.sin(np.arange(90) / 10)[:, None, None], (1, 55, 3))
    for side, sign in (("left", 1), ("right", -1)):
        poses[:, joint_index(f"{side}_shoulder"), 2] -= sign * 1.1
    write_clip(tmp_path / "clip.npz", clip_of(poses, arkit=np.zeros((90, 52))))
    options = ("--size", 360, "--framing", "upper_body", "--out", tmp_path)
    run("preview", tmp_path / "clip.npz", *options)
    made = import_video(tmp_path / "clip.mp4", tmp_path / "takes", speaker=None, on_frame=quietly)
    assert made.seconds == pytest.approx(3, abs=0.1)
