"""Training AMUSE's motion prior and denoiser on recordings and a speech model's latents."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
import torch
from torch import Tensor, nn

from generators.amuse import network_file
from generators.amuse.config import FRAME_RATE, LABELS, MOTION_PRESETS, PARTS, MotionConfig
from generators.amuse.losses import MOTION_LOSSES, PRIOR_LOSSES, Weights, motion_losses, without
from generators.amuse.model import MotionModel, MotionPrior
from generators.amuse.network_file import SpeechNetwork
from generators.learned import cut_windows, describe_training, run_training
from generators.registry import TrainedGenerator, TrainingRequest
from generators.settings import content
from motion.arrays import Floats32, Ints
from motion.audio import read_audio
from motion.errors import InputError
from training.config import Pass
from training.data.take import Feature, Take
from training.data.windows import Windows
from training.diffusion import SCALED_LINEAR
from training.features import whole_body
from training.layers import first_weights
from training.run.batches import evenly_spaced
from training.run.task import WindowTask
from training.speech_features.speech_frames import WindowPlan, filterbanks_under

MOST_HELD_OUT: Final = 128
"""Largest number of windows for validation."""

MOST_INITIAL: Final = 1_000
"""Largest number of windows for initial weights."""

DRAWS: Final = 4
"""Draws of noise per latent in an update. The paper has one; the denoiser costs little compared to
the prior and the fifty steps of the third pass, and learns four times as much."""

_SHORTEST_WAVE: Final = 12
"""Frames of the fastest wave of the time encoding."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionTask(WindowTask):
    """Learning the latent of motion, and predicting it from the speech.

    Attributes
    ----------
    config : MotionConfig
        The networks.
    weights : mapping of str to float
        Weights of the losses.
    align_steps : int
        Number of DDIM steps in the third pass.
    named : float
        Probability of replacing emotion, and style, by the mean latent of their label.
    means : mapping of str to (mapping of str to Tensor)
        The mean latents, see `SpeechNetwork.latents`.
    training, held_out : Windows
        Windows of the features ``motion`` and ``latents``.
    """

    config: MotionConfig
    weights: Weights
    align_steps: int
    named: float
    means: Mapping[str, Mapping[str, Tensor]]

    def network(self) -> MotionModel:
        """Return new networks, initialised from statistics of motion and speech."""
        model = MotionModel(self.config)
        windows = self.training.batch(evenly_spaced(self.examples, MOST_INITIAL))
        if isinstance(model.prior, MotionPrior):
            initialise_prior(model.prior, torch.from_numpy(windows["motion"]))
        # All parts of the speech start with the same weight.
        latents_by_part = self._split_latents(torch.from_numpy(windows["latents"][:, 0]))
        for part, latents in zip(PARTS, latents_by_part, strict=False):
            layer = model.denoiser.get_submodule(f"{part}.1")
            first_weights.standardise_inputs(layer, latents.relu())
        return model.to(self.device)

    def losses(self, network: MotionModel, rows: Ints, name: str) -> Mapping[str, Tensor]:
        """Return `motion_losses` of a stage, in which one learns alone or both together."""
        return self._losses(network, self.training, rows, without(self.weights, name))

    def validation(self, network: MotionModel) -> Mapping[str, float]:
        """Return `motion_losses` of evenly spaced held-out windows.

        All losses count, even if they are not trained, so that ablations are comparable.
        """
        rows = evenly_spaced(len(self.held_out), MOST_HELD_OUT)
        weights = MOTION_LOSSES if self.config.prior else without(MOTION_LOSSES, *PRIOR_LOSSES)
        losses = self._losses(network, self.held_out, rows, weights)
        return {name: float(value) for name, value in losses.items()}

    def _losses(
        self, network: MotionModel, windows: Windows, rows: Ints, weights: Weights
    ) -> Mapping[str, Tensor]:
        values = self.tensors(windows, rows)
        noise = torch.randn(2 + DRAWS, len(rows), *network.prior.latent_shape).to(self.device)
        timestep = torch.randint(0, SCALED_LINEAR.steps, (DRAWS, len(rows))).to(self.device)
        # All frames of a window get the same latents of its speech.
        latents = self._split_latents(values["latents"][:, :1])
        if self.named and windows is self.training:
            latents = self._by_label(latents, windows.takes(rows))
        return motion_losses(
            network, values["motion"], latents, noise, timestep, weights, self.align_steps
        )

    def _split_latents(self, latents: Tensor) -> Sequence[Tensor]:
        """Split the feature ``latents`` into content, emotion and style."""
        return torch.chunk(latents, self.config.conditions, dim=-1)

    def _by_label(self, latents: Sequence[Tensor], takes: Sequence[Take]) -> Sequence[Tensor]:
        """Replace some latents (batch, 1, width) by the mean of their label, if known."""
        by_part = dict(zip(PARTS, latents, strict=False))
        for part, by_label in self.means.items():
            by_name = torch.rand(len(takes), 1, 1) < self.named
            means = [
                by_label.get(getattr(take, LABELS[part]), latent[0]).to(latent)[None]
                for latent, take in zip(by_part[part], takes, strict=True)
            ]
            by_part[part] = torch.where(by_name.to(self.device), torch.stack(means), by_part[part])
        return list(by_part.values())


@torch.no_grad()
def initialise_prior(prior: MotionPrior, motion: Tensor) -> None:
    """Initialise a new prior from `motion` (windows, frames, motion width).

    Values of frames differ by a few hundredths, but learned positions are of the order of 1, and
    uniform attention distinguishes the frames of a window only after many thousand steps. So the
    linear layers at both ends start from the principal components of the frames, and attention
    starts from neighbours in time. The architecture does not change.

    With several tokens, five eighths of the width encode the motion and the rest encodes time. With
    one token, only the mean is initialised.
    """
    config = prior.config
    if config.tokens == 1:
        prior.final_layer.bias.copy_(motion.mean(dim=(0, 1)))
        return
    motion_width = 5 * config.width // 8
    components = first_weights.principal_components(motion.flatten(0, 1), motion_width)
    first_weights.encode_components(prior.skel_embedding, components, only=True)
    first_weights.decode_components(prior.final_layer, components)

    def times(count: int) -> Tensor:
        """Return the time encoding of `count` evenly spaced moments of a window."""
        moments = (torch.arange(count) + 0.5) * config.frames / count
        slowest, fastest = math.pi / config.frames, 2 * math.pi / _SHORTEST_WAVE
        waves = first_weights.waves(moments, slowest, fastest, config.width - motion_width)
        return torch.cat([torch.zeros(count, motion_width), waves], dim=1)

    latent_tokens = 2 * config.tokens
    prior.query_pos_encoder.pe[:latent_tokens] = 0
    prior.query_pos_encoder.pe[latent_tokens : latent_tokens + config.frames] = times(config.frames)
    prior.query_pos_decoder.pe[: config.frames] = times(config.frames)
    prior.memory_pos.copy_(times(config.tokens))
    prior.global_motion_token.copy_(times(config.tokens).repeat(2, 1))
    prior.global_motion_token[:, :motion_width].normal_(std=0.3)
    for module in prior.modules():
        if isinstance(module, nn.MultiheadAttention):
            first_weights.attend_nearby(module, motion_width)


def speech_latents(
    speech: SpeechNetwork, identity: str, frames: int, stride: int, device: str = "cpu"
) -> Feature:
    """Return content, emotion and style of the window that starts at each `stride`-th frame.

    They are repeated in the frames up to the next window; the last window that fits covers all
    remaining frames. The speech model is moved to `device`.
    """

    def compute(take: Take) -> Floats32:
        audio = read_audio(take.speech)
        total = max(1, round(audio.duration * FRAME_RATE))
        count = 1 + max(0, total - frames) // stride
        plan = WindowPlan(frames=frames, stride=stride, count=count)
        model, sizes = speech.model.to(device), speech.model.config
        latents = [
            torch.cat([model.latent(part, rows.to(device)) for part in model.parts], dim=-1)
            for rows in filterbanks_under(audio, plan, FRAME_RATE, sizes.frames, sizes.bands)
        ]
        window = np.minimum(np.arange(total) // stride, count - 1)
        return torch.cat(latents).cpu().numpy()[window]

    return Feature(name="latents", version=f"2 {identity} {frames} {stride}", compute=compute)


def train_amuse(request: TrainingRequest) -> TrainedGenerator:
    """Train AMUSE's motion networks; see `generators.registry.TrainGenerator`."""
    if "speech_model" not in request.choices:
        raise InputError(
            "AMUSE's motion networks learn from a speech model's latents, but none is named",
            remedy="Give the speech model's weights: --speech-model FILE",
        )
    file, ablation = Path(request.choices["speech_model"]), request.choices.get("ablation", "")
    speech, identity = network_file.load_speech(file), str(content(file))
    preset, model = MOTION_PRESETS[request.config], speech.model
    config = replace(
        preset.network, condition_width=model.config.latent, conditions=len(model.parts)
    )
    if ablation == "without_prior":
        longest = max(config.longest, config.frames + 1 + config.conditions)
        config = replace(config, prior=False, longest=longest)
    frames, stride = config.frames, preset.stride
    latents = speech_latents(speech, identity, frames, stride, request.device)
    features = (whole_body(FRAME_RATE), latents)
    windows = cut_windows(request, features, FRAME_RATE, frames, stride, held_out=stride)
    extra_settings = {"stride": stride, "align steps": preset.align_steps, "named": preset.named}
    task = MotionTask(
        config=config,
        weights=without({**MOTION_LOSSES, **preset.weights}, ablation),
        align_steps=preset.align_steps,
        named=preset.named,
        means=speech.latents,
        extra_settings={"speech model": identity, **extra_settings},
        **windows,
    )
    training = preset.config_for(task.examples, request.changes)
    if config.prior:
        passes = _passes(preset.together, training.steps, disjoint=ablation == "disjoint")
        training = replace(training, passes=passes)
    trained, facts = run_training(request, task, training)
    facts |= {"speech_model": identity}
    networks = network_file.MotionNetworks(model=trained.network.cpu(), training=facts)
    network_file.write_motion(request.out, networks)
    measured = trained.best.measured
    return describe_training(
        task,
        trained,
        f"Share of the noise that the denoiser does not predict in {len(task.held_out)} held-out "
        f"windows: {measured['ld']:.3f}. The error of their motion is {measured['align']:.4f} when "
        "it is sampled from their speech"
        + (f", and {measured['rec']:.4f} when it is reconstructed." if "rec" in measured else "."),
    )


def _passes(together: int | None, steps: int, *, disjoint: bool) -> tuple[Pass, ...]:
    """Return the stages: both together and then the denoiser, or first prior, then denoiser."""
    if together is None and not disjoint:
        return ()
    end = together or max(1, steps // 2)
    first = Pass(name="prior", parts=("prior",)) if disjoint else Pass(name="together")
    return replace(first, end=end), Pass(name="denoiser", parts=("denoiser",), first=end)
