"""Takes whose filterbanks encode text, emotion and speaker in separate bands."""

from typing import Final

import numpy as np

from tests.training.takes import prepared_takes, take_named
from training.data.feature_cache import PreparedTakes

EMOTIONS: Final = {"happiness": (65, 66), "anger": (73, 74)}
"""Two texts of each, as BEAT numbers them."""

SPEAKERS: Final = {"1": "ann", "2": "bob"}
ROWS: Final = 100


def toy_speech(held_out: int = 1) -> PreparedTakes:
    """Return takes of two windows by two speakers in two emotions; further texts are held out."""
    chance = np.random.default_rng(4)
    takes, arrays = [], []
    for number, speaker in SPEAKERS.items():
        for emotion, texts in EMOTIONS.items():
            for text in (*texts, *range(texts[0] + 2, texts[0] + 2 + held_out)):
                split = "train" if text in texts else "validation"
                name = f"{number}_{speaker}_0_{text}_{text}"
                values = 0.1 * chance.standard_normal((2 * ROWS, 32))
                values[:, text % 8] += 1
                values[:, 8 + list(EMOTIONS).index(emotion)] += 2
                values[:, 16 + int(number)] += 2
                arrays.append(values.astype(np.float32))
                takes.append(take_named(name, speaker=speaker, emotion=emotion, split=split))
    return prepared_takes(takes, {"filterbank": arrays}, 100.0)
