"""Takes whose motion follows their mel bands, made of arrays alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from generators.diffsheg.config import BEAT
from motion.errors import InputError
from tests.training.takes import prepared_takes, take_named
from training.data.feature_cache import PreparedTakes
from training.data.take import Split

SPEAKERS = ("1", "2", "3")
WIDTHS = {
    "gesture": BEAT.gesture_width,
    "expression": BEAT.expression_width,
    "mel": BEAT.audio_width,
    "hubert": BEAT.speech_features,
    "semantic": 1,
}
SKIPPED = InputError("the sound is shorter than the motion", where="7.wav", remedy="Record anew")


def toy_takes(takes: int = 12, frames: int = 70) -> PreparedTakes:
    """Return takes of two speakers to learn from; some are held out, one of a third speaker.

    Two curves decide all motion: how loud the speech is, and one that nothing tells.
    """
    chance = np.random.default_rng(3)
    mixing = chance.standard_normal((2, WIDTHS["gesture"] + WIDTHS["expression"]))
    arrays: dict[str, list[NDArray[np.float32]]] = {name: [] for name in WIDTHS}
    named = []
    for number in range(takes):
        split: Split = "train" if number % 4 else "validation"
        speaker = SPEAKERS[2] if number == 4 else SPEAKERS[number % 2]
        curves = gaussian_filter1d(chance.standard_normal((frames, 2)), 2, axis=0) * 3
        motion = curves @ mixing
        gesture, expression = np.split(motion, [WIDTHS["gesture"]], axis=1)
        made = {
            "gesture": gesture,
            "expression": expression,
            "mel": np.repeat(10 ** curves[:, :1], WIDTHS["mel"], axis=1),
            "hubert": chance.standard_normal((frames, WIDTHS["hubert"])),
            "semantic": np.zeros((frames, 1)),
        }
        for name, values in made.items():
            arrays[name].append(values.astype(np.float32))
        named.append(take_named(f"{number:02}", speaker=speaker, split=split))
    return prepared_takes(named, arrays, BEAT.frame_rate, skipped=(SKIPPED,))
