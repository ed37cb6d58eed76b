"""A study to measure the server with: finished videos that are made on the spot."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import av
import numpy as np

from studyapp.study.folder import StudyFolder
from studyapp.study.media import Stimuli, VideoCopy, write_stimuli

FRAME_RATE: Final = 15
SIZE: Final = 128
"""Height and width of the picture; what counts for a server is the size of the file."""

CONDITIONS: Final = ("first", "second", "third", "flawed")

STUDY_FILE: Final = """\
name = "bench"
title = "Motion and speech"
protocol = "pairwise"
comparisons = "all_pairs"
layout = "players"
reference = "first"
participants = {places}
trials = {trials}
practice = {practice}
lease_minutes = 600
catch = {{ trials = {catch}, condition = "flawed", against = "third", videos = true }}

[conditions.first]
videos = true
[conditions.second]
videos = true
[conditions.third]
videos = true

[[questions]]
name = "rhythm"
title = "Rhythm"
text = "In which video do the gestures fit the rhythm of the speech better?"

[[questions]]
name = "emotion"
title = "Emotion"
text = "In which video do the gestures show better what the speaker feels?"

[page]
consent = "You will watch short videos of an animated speaker."
"""


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
    text = STUDY_FILE.format(
        places=shape.places, trials=shape.trials, practice=shape.practice, catch=shape.catch
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
    """Write a video of H.264, and lengthen its file to the size asked for."""
    picture = np.full((SIZE, SIZE, 3), 236, dtype=np.uint8)
    with av.open(path, "w", options={"movflags": "+faststart"}) as container:
        stream = container.add_stream("libx264", rate=FRAME_RATE)
        stream.width = stream.height = SIZE
        stream.pix_fmt = "yuv420p"
        for index in range(round(shape.seconds * FRAME_RATE)):
            picture[:, index % SIZE] = 90
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(stream.encode(None))
    missing = shape.file_bytes - path.stat().st_size
    with path.open("ab") as file:
        file.write(missing.to_bytes(4, "big") + b"free" + bytes(missing - 8))
