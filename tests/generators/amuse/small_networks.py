"""Files of small untrained AMUSE networks."""

from dataclasses import replace
from pathlib import Path
from typing import Final

import torch

from generators.amuse.config import MotionConfig, SpeechConfig
from generators.amuse.model import MotionModel, MotionPrior
from generators.amuse.network_file import MotionNetworks, SpeechNetwork, write_motion, write_speech
from generators.amuse.speech import SpeechModel
from generators.learned_settings import AmuseSettings

MOTION: Final = MotionConfig(
    width=16, feed_forward=24, heads=2, layers=3, condition_width=8, longest=302
)
SPEECH: Final = SpeechConfig(
    patch_stride=64,
    width=24,
    feed_forward=32,
    heads=2,
    layers=2,
    latent=8,
    styles=2,
    decoder_width=16,
    decoder_hidden=4,
    decoder_feed_forward=32,
    fusion_layers=1,
    decoder_layers=1,
)
SMALL_SPEECH: Final = replace(
    SPEECH, frames=64, bands=32, patch_stride=16, emotions=3, styles=4, decoder_hidden=16
)


def written_networks(folder: Path) -> AmuseSettings:
    """Write both files; the speech model knows happiness and fear, and the speaker anna."""
    torch.manual_seed(11)
    motion = MotionNetworks(model=MotionModel(MOTION))
    assert isinstance(motion.model.prior, MotionPrior)
    _stand_upright(motion.model.prior)
    model = SpeechModel(SPEECH)
    for encoder in (model.content, model.emotion, model.style):
        # Untrained latents hardly differ from speech to speech; these do.
        torch.nn.init.normal_(encoder.get_parameter("feature_head.1.weight"))
    latents = {
        "emotion": {"happiness": torch.randn(8), "fear": torch.randn(8)},
        "style": {"anna": torch.randn(8)},
    }
    write_motion(folder / "motion.safetensors", motion)
    write_speech(folder / "speech.safetensors", SpeechNetwork(model=model, latents=latents))
    return AmuseSettings(
        checkpoint=folder / "motion.safetensors", speech_model=folder / "speech.safetensors"
    )


def _stand_upright(prior: MotionPrior) -> None:
    """Let the prior's motion vary around a body that stands: rows of unit matrices."""
    with torch.no_grad():
        prior.final_layer.weight *= 0.5
        prior.final_layer.bias.zero_()
        prior.final_layer.bias[:330] = torch.tensor([1.0, 0, 0, 0, 1, 0]).repeat(55)
