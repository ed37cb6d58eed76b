"""The released network's own size, on real speech; its weights, and so the motion, are random."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from generators.interface import SpeechSegment
from generators.learned_settings import DiffShegSettings
from generators.registry import load_generator
from motion.audio import read_audio
from motion.segment import Segment

SHARED = Path(__file__).parents[4] / "shared"


@pytest.mark.slow
def test_a_file_as_the_authors_released_it_moves_to_real_speech(tmp_path: Path) -> None:
    names = SHARED / "reference" / "diffsheg_beat_state_dict.json"
    recording = SHARED / "data" / "2_scott_0_103_103.wav"
    if not names.exists() or not recording.exists():
        pytest.skip("the released network's names or the recording are not here")
    random = torch.Generator().manual_seed(1)
    weights = {
        name: (name.endswith("running_var") * 1.0 + 0.02 * torch.rand(shape, generator=random))
        for name, shape in json.loads(names.read_text()).items()
    }
    torch.save({"encoder": weights}, tmp_path / "released.pt")
    model = DiffShegSettings(
        checkpoint=tmp_path / "released.pt", stats=SHARED / "data" / "diffsheg_stats", speaker=2
    )
    audio = read_audio(recording).cut(5, 6.5)
    segment = Segment(
        name="fear", wav=recording.name, start=5, end=6.5, speaker="scott", emotion="fear"
    )
    clip = load_generator("diffsheg", model).generate(
        SpeechSegment(segment=segment, audio=audio), seed=1, frame_rate=30
    )
    assert len(clip) == 45
    assert clip.arkit is not None
    assert np.ptp(clip.poses, axis=0).max() > 0
    assert "8 layers of 512" in clip.provenance["config"]
