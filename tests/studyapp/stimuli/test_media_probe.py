from __future__ import annotations

from pathlib import Path

import av
import numpy as np

from studyapp.stimuli.media_probe import Flaw, flaw_of
from tests.support.encoded import Told, write_video


def test_sound_alone_and_other_formats_are_no_video(tmp_path: Path) -> None:
    sound, other = tmp_path / "sound.mp4", tmp_path / "other.mkv"
    with av.open(str(sound), "w") as container:
        stream = container.add_stream("aac", rate=48_000)
        frame = av.AudioFrame.from_ndarray(np.zeros((1, 48_000), np.float32), "fltp", "mono")
        frame.sample_rate = 48_000
        container.mux([*stream.encode(frame), *stream.encode(None)])
    write_video(other, Told())
    assert flaw_of(sound, 1.0) == Flaw("video-damaged", "has no picture")
    assert flaw_of(other, 2.0) == Flaw("video-damaged", "is not an MP4 file")
