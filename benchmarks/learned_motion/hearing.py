"""What AMUSE's speech model distinguishes in speech of test takes (Tables A.1 and A.2)."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import torch

from generators.amuse.config import LABELS, SPEECH_PRESETS
from generators.amuse.losses import SPEECH_LOSSES
from generators.amuse.network_file import load_speech
from generators.amuse.train_speech import SpeechTask
from training.data.feature_cache import prepare
from training.data.labelled_windows import Classes
from training.data.take import TakeFolder
from training.data.windows import Windows
from training.features import speech_filterbank
from training.speech_features.spectra import ROWS_PER_SECOND


@torch.inference_mode()
def heard_apart(takes: TakeFolder, network: Path, cache: Path) -> Mapping[str, float]:
    """Return `SpeechTask.validation` of a speech model on the test takes."""
    speech = load_speech(network)
    feature = speech_filterbank(speech.model.config.bands)
    prepared = prepare(takes, (feature,), cache, frame_rate=ROWS_PER_SECOND)
    frames = SPEECH_PRESETS["tiny"].seconds * ROWS_PER_SECOND
    training, test = (
        Windows(prepared, split=split, frames=frames, stride=frames) for split in ("train", "test")
    )
    task = SpeechTask(
        config=speech.model.config,
        weights=SPEECH_LOSSES,
        training=training,
        held_out=test,
        quadruples=np.empty((0, 4), dtype=np.int64),
        classes=Classes({of: tuple(speech.latents[part]) for part, of in LABELS.items()}),
    )
    return task.validation(speech.model)
