from __future__ import annotations

from pathlib import Path

import numpy as np

from motion.audio import Audio, write_wav
from studyapp.stimuli.media_probe import Flaw, flaw_of


def test_sound_alone_is_no_video(tmp_path: Path) -> None:
    sound = tmp_path / "sound.wav"
    write_wav(sound, Audio(samples=np.zeros(16_000, np.float32), sample_rate=16_000))
    assert flaw_of(sound, 1.0) == Flaw("no picture", "has no picture")
