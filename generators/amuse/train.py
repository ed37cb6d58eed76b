"""Training AMUSE's motion prior and denoiser on recordings, told what a speech model hears."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from generators.amuse.config import FRAME_RATE, LABELS, MOTION_PRESETS, PARTS, MotionConfig
from generators.amuse.initialisation import hear, set_out
from generators.amuse.losses import OF_ALIGNMENT, OF_PRIOR, LossWeights, motion_losses
from generators.amuse.model import MotionModel, MotionPrior
from generators.amuse.network_file import (
    MotionNetworks,
    SpeechNetwork,
    load_speech_network,
    write_motion_networks,
)
from generators.settings import content
from generators.teaching import best_step_said, cut_windows, learn, prepared_takes
from generators.trainable import TrainedGenerator, TrainingRequest
from motion.audio import read_audio
from motion.errors import InputError
from training.data.feature import Feature
from training.data.take import Take
from training.data.windows import Windows
from training.diffusion import SCALED_LINEAR
from training.features import whole_body
from training.joined_windows import WindowPlan, filterbanks_under
from training.run.batch_order import evenly
from training.run.passes import Pass
from training.window_task import WindowTask

HELD_OUT: Final = 128
"""At most so many windows tell how well held-out takes are known."""

SEEN: Final = 1_000
"""At most so many windows tell the mean of the motion."""

DRAWS: Final = 4
"""How often a latent gets noise in an update. The paper does it once; the denoiser is small beside
the prior and the fifty steps of the third pass, and learns four times as much."""

STAGES: Final = {"prior": ("ld", *OF_ALIGNMENT), "denoiser": (*OF_PRIOR, *OF_ALIGNMENT)}
"""What does not count where prior or denoiser learns alone."""

LEFT_OUT: Final = {"without_alignment": OF_ALIGNMENT, "without_prior": STAGES["denoiser"]}
"""What does not count in ablations that leave out losses."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionTask(WindowTask):
    """Learning the latent of motion, and to find it from the speech.

    Attributes
    ----------
    config : MotionConfig
        The networks.
    weights : LossWeights
        What counts how much.
    align_steps : int
        Of DDIM in the third pass.
    named : float
        How often emotion, and style, are told by the mean latent of their label.
    means : mapping of str to (mapping of str to Tensor)
        These, see `SpeechNetwork.latents`.
    training, held_out : Windows
        Of the features ``motion`` and ``latents``.
    """

    config: MotionConfig
    weights: LossWeights
    align_steps: int
    named: float
    means: Mapping[str, Mapping[str, Tensor]]

    def network(self) -> MotionModel:
        """Return fresh networks that set out from what motion and speech are like."""
        model = MotionModel(self.config)
        seen = self.training.batch(evenly(self.examples, SEEN))
        if isinstance(model.prior, MotionPrior):
            set_out(model.prior, torch.from_numpy(seen["motion"]))
        told = torch.from_numpy(seen["latents"][:, 0])
        hear(model.denoiser, torch.chunk(told, self.config.conditions, dim=-1))
        return model.to(self.device)

    def losses(self, network: MotionModel, rows: NDArray[np.int64]) -> Mapping[str, Tensor]:
        """Return `motion_losses` of a batch at steps and with noise that chance draws."""
        return self.losses_of("", network, rows)

    def losses_of(
        self, name: str, network: MotionModel, rows: NDArray[np.int64]
    ) -> Mapping[str, Tensor]:
        """Return the losses of a stage, in which one learns alone or both together."""
        return self._losses(
            network, self.training, rows, self.weights.without(*STAGES.get(name, ()))
        )

    def validation(self, network: MotionModel) -> Mapping[str, float]:
        """Return `motion_losses` of held-out windows, evenly among them.

        All count, whatever is learned by, so that ablations are measured alike.
        """
        rows = evenly(len(self.held_out), HELD_OUT)
        measured = LossWeights() if self.config.prior else LossWeights().without(*OF_PRIOR)
        losses = self._losses(network, self.held_out, rows, measured)
        return {name: float(value) for name, value in losses.items()}

    def _losses(
        self,
        network: MotionModel,
        windows: Windows,
        rows: NDArray[np.int64],
        weights: LossWeights,
    ) -> Mapping[str, Tensor]:
        values = self.tensors(windows, rows)
        motion = values["motion"]
        # All frames of a window are told the same of its speech.
        told = values["latents"][:, :1]
        noise = torch.randn(2 + DRAWS, len(rows), *network.prior.latent_shape).to(self.device)
        timestep = torch.randint(0, SCALED_LINEAR.steps, (DRAWS, len(rows))).to(self.device)
        latents: Sequence[Tensor] = torch.chunk(told, self.config.conditions, dim=-1)
        if self.named and windows is self.training:
            latents = self._by_name(latents, [windows.take_of(int(row)) for row in rows])
        return motion_losses(network, motion, latents, noise, timestep, weights, self.align_steps)

    def _by_name(self, heard: Sequence[Tensor], takes: Sequence[Take]) -> Sequence[Tensor]:
        """Return latents (batch, 1, width), some of them the mean of their label where known."""
        told = dict(zip(PARTS, heard, strict=False))
        for part, of in LABELS.items():
            if part in self.means:
                known, by_name = self.means[part], torch.rand(len(takes), 1, 1) < self.named
                means = [
                    known.get(getattr(take, of), own[0]).to(own)[None]
                    for own, take in zip(told[part], takes, strict=True)
                ]
                told[part] = torch.where(by_name.to(self.device), torch.stack(means), told[part])
        return list(told.values())


def speech_latents(speech: SpeechNetwork, identity: str, frames: int, stride: int) -> Feature:
    """Return content, emotion and style of the window that begins at each `stride`-th frame.

    The frames up to the next window hold the same, and those behind the last window that fits.
    """

    def compute(take: Take) -> NDArray[np.float32]:
        audio = read_audio(take.speech)
        total = max(1, round(audio.duration * FRAME_RATE))
        count = 1 + max(0, total - frames) // stride
        plan = WindowPlan(frames=frames, stride=stride, count=count)
        model, sizes = speech.model, speech.model.config
        told = [
            torch.cat([model.latent(part, rows) for part in model.parts], dim=-1)
            for rows in filterbanks_under(audio, plan, FRAME_RATE, sizes.frames, sizes.bands)
        ]
        window = np.minimum(np.arange(total) // stride, count - 1)
        return torch.cat(told).numpy()[window]

    return Feature(name="latents", version=f"2 {identity} {frames} {stride}", compute=compute)


def train_amuse(request: TrainingRequest) -> TrainedGenerator:
    """Train AMUSE's motion networks; see `generators.trainable.TrainGenerator`."""
    ablation = request.choices.get("ablation")
    preset = MOTION_PRESETS[request.config]
    speech, identity = _speech_of(request)
    config = replace(
        preset.network,
        condition_width=speech.model.config.latent,
        conditions=len(speech.model.parts),
    )
    if ablation == "without_prior":
        longest = max(config.longest, config.frames + 1 + config.conditions)
        config = replace(config, prior=False, longest=longest)
    told = speech_latents(speech, identity, config.frames, preset.stride)
    prepared = prepared_takes(request, (whole_body(FRAME_RATE), told), FRAME_RATE)
    weights = LossWeights(**preset.weights).without(*LEFT_OUT.get(str(ablation), ()))
    task = MotionTask(
        config=config,
        weights=weights,
        align_steps=preset.align_steps,
        named=preset.named,
        means=speech.latents,
        **cut_windows(prepared, config.frames, preset.stride, held_out=preset.stride),
        further={
            "speech model": identity,
            "stride": preset.stride,
            "align steps": preset.align_steps,
            "named": preset.named,
        },
        device=request.device,
    )
    training = preset.trained_on(task.examples, request.changes)
    if config.prior:
        passes = _passes(preset.together, training.steps, disjoint=ablation == "disjoint")
        training = replace(training, passes=passes)
    trained, facts = learn(request, task, training, ("transformers",))
    facts |= {"speech_model": identity}
    networks = MotionNetworks(model=trained.network.cpu(), training=facts)
    write_motion_networks(request.out, networks)
    found = trained.best.measured
    return TrainedGenerator(
        sentences=(
            f"Learned from {len(task.training)} windows of {config.frames / FRAME_RATE:g} s.",
            f"What the denoiser does not predict in {len(task.held_out)} held-out windows: "
            f"{found['ld']:.3f} of 1. The motion that it tells to their speech misses theirs by "
            f"{found['align']:.4f}"
            + (f", its reconstruction by {found['rec']:.4f}." if "rec" in found else "."),
            best_step_said(trained),
        ),
        skipped=prepared.skipped,
    )


def _passes(together: int | None, steps: int, *, disjoint: bool) -> tuple[Pass, ...]:
    """Return what learns when: both together and then the denoiser, or one after the other."""
    if together is None and not disjoint:
        return ()
    alone = together or max(1, steps // 2)
    first = Pass(name="prior", parts=("prior",)) if disjoint else Pass(name="together")
    return replace(first, end=alone), Pass(name="denoiser", parts=("denoiser",), first=alone)


def _speech_of(request: TrainingRequest) -> tuple[SpeechNetwork, str]:
    """Return the speech model and the hash of its file."""
    named = request.choices.get("speech_model")
    if named is None:
        raise InputError(
            "AMUSE's motion networks learn from what a speech model hears, and none is named",
            remedy="Give its weights: --speech-model FILE",
        )
    return load_speech_network(Path(named)), str(content(Path(named)))
