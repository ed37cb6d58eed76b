from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from motion.audio import Audio, write_wav
from motion.segment import EMOTIONS
from tests.training.takes import take_named
from tools.three_systems.takes import learned_takes, shown_takes
from training.data.take import Split, Take


@pytest.fixture
def takes(tmp_path: Path) -> list[Take]:
    """Return three takes of each emotion and split by either of two speakers, of other lengths."""
    made = []
    for speaker in ("ada", "unheard"):
        for split in get_args(Split):
            for emotion in EMOTIONS:
                for number in (3, 1, 2):
                    name = f"{speaker}-{split}-{emotion}-{number}"
                    write_wav(
                        tmp_path / f"{name}.wav",
                        Audio(np.zeros(number * 100, np.float32), 1000),
                    )
                    purpose = "test" if speaker == "unheard" else split
                    facts = {"speaker": speaker, "emotion": emotion, "split": purpose}
                    made.append(take_named(name, tmp_path, **facts))
    return made


def test_the_shortest_test_takes_of_each_emotion_by_known_speakers_are_shown(
    takes: list[Take],
) -> None:
    assert [take.name for take in shown_takes(takes, 2)] == [
        f"ada-test-{emotion}-{number}" for emotion in EMOTIONS for number in (1, 2)
    ]


def test_feature_networks_learn_from_training_takes_of_each_emotion_alike(
    takes: list[Take],
) -> None:
    chosen = learned_takes(takes, 2)
    assert {take.split for take in chosen} == {"train"}
    assert Counter(take.emotion for take in chosen) == dict.fromkeys(EMOTIONS, 2)
    assert len(learned_takes(takes, 99)) == 3 * len(EMOTIONS)
