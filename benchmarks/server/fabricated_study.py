"""A study to measure the server with: finished videos that are made on the spot."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from motion.audio import Audio
from renderer.encoder import SOUND_RATE, VideoWriter, video_frame
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Stimuli, VideoCopy, write_stimuli
from tests.support.studies.finished_study import brought, question, study_file

FRAME_RATE: Final = 15
SIZE: Final = 128
"""Height and width of the picture; what counts for a server is the size of the file."""

CONDITIONS: Final = ("first", "second", "third", "flawed")


@dataclass(frozen=True, kw_only=True)
class StudyShape:
    """How large a fabricated study is.

    Attributes
    ----------
    trials, practice, catch : int
        As in the study file; the defaults are those of a published study, 30 presentations.
    seconds : float
        Length of every video.
    file_bytes : int
        Size of every video's file.
    """

    places: int
    trials: int = 24
    practice: int = 3
    catch: int = 3
    seconds: float = 6.0
    file_bytes: int = 1_000_000


def write_fabricated_study(folder: Path, shape: StudyShape) -> None:
    """Write a study of three conditions with two players a page into `folder`, ready to serve."""
    text = study_file(
        "pairwise",
        participants=shape.places,
        trials=shape.trials,
        practice=shape.practice,
        lease_minutes=600,
        reference=CONDITIONS[0],
        conditions=brought(*CONDITIONS[:3]),
        catch={
            "trials": shape.catch,
            "condition": CONDITIONS[3],
            "against": CONDITIONS[2],
            "videos": True,
        },
        attention=None,
        questions=[
            question("rhythm", "Which fits better?"),
            question("emotion", "Which shows it?"),
        ],
    )
    (folder / "study.toml").write_text(text, encoding="utf-8")
    video = folder / "video.mp4"
    _write_video(video, shape)
    for condition in CONDITIONS:
        for number in range(shape.trials):
            path = folder / "videos" / condition / f"speech-{number:02}.mp4"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.hardlink_to(video)
    _write_copies(StudyFolder(folder), video, shape)


def _write_copies(files: StudyFolder, video: Path, shape: StudyShape) -> None:
    """Write what `motionjury render` would; all that participants are shown is `video`."""
    study = files.study()
    shown = [stimulus for (stimulus,) in study.contents(files.segments_of(study))]
    copies = [
        VideoCopy(
            segment=stimulus.segment,
            file=f"videos/shown/{number:03}.mp4",
            duration=shape.seconds,
            key="fabricated",
            original="fabricated",
            condition=stimulus.condition,
            heard=stimulus.speech,
        )
        for number, stimulus in enumerate(shown)
    ]
    (files.root / "videos" / "shown").mkdir()
    for copy in copies:
        (files.root / copy.file).hardlink_to(video)
    write_stimuli(files.stimuli, Stimuli(copies=tuple(copies)))


def _write_video(path: Path, shape: StudyShape) -> None:
    """Write a silent video, and lengthen its file to the size asked for."""
    picture = np.full((SIZE, SIZE, 3), 236, dtype=np.uint8)
    silence = Audio(np.zeros(round(shape.seconds * SOUND_RATE), np.float32), SOUND_RATE)
    with VideoWriter(path, SIZE, SIZE, FRAME_RATE, silence) as writer:
        for index in range(round(shape.seconds * FRAME_RATE)):
            picture[:, index % SIZE] = 90
            writer.write(video_frame(picture))
    missing = shape.file_bytes - path.stat().st_size
    with path.open("ab") as file:
        file.write(missing.to_bytes(4, "big") + b"free" + bytes(missing - 8))
