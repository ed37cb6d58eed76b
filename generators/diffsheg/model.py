"""DiffSHEG's network: predicts the noise `eps` in a window of motion `x_t`, given the speech.

Chen et al., CVPR 2024, section 3.3 and Figure 2: a branch for the face, one for the body, and the
denoiser that joins them. `Denoiser.modulate` and `Denoiser.encode_audio` do not depend on the
motion; sampling calls them once for many evaluations, `Denoiser.forward` calls them each time.
"""

from collections.abc import Mapping, Sequence
from typing import Final, cast

import torch
from torch import Tensor, nn
from torch.nn import functional

from generators.diffsheg.config import DenoiserConfig
from generators.diffsheg.layers import (
    Embedding,
    FusedSpeech,
    Fusion,
    LinearSkip,
    SpeechEncoder,
    StyledBlock,
    zeroed,
)
from motion.arrays import Floats32
from training.diffusion import LINEAR, step_embedding
from training.layers.transformers import sinusoids

MEL_GAIN: Final = 2.0
"""Factor on the mel bands of the shared encoder, inferred from the released network's outputs."""

SILENCE: Final = 1e-4
"""Power of silence, added to mel bands before the logarithm."""

CONDITION_DROPOUT: Final = 0.2
"""Share of the training windows of a guided network that have no conditions."""


class Branch(nn.Module):
    """A stack of blocks for one part of the motion: body, face, or both."""

    position: Tensor

    def __init__(self, config: DenoiserConfig, values: int, cond_values: int, width: int) -> None:
        super().__init__()
        self.inward = nn.Linear(values, width)
        self.register_buffer("position", sinusoids(config.longest, width)[None])
        self.dropout = nn.Dropout(config.dropout)
        self.audio = nn.Linear(2 * config.audio_width, 2 * config.audio_width)
        self.speech = SpeechEncoder(config.speech_features, config.speech_width)
        self.step = Embedding(width, 4 * width)
        self.speaker = Embedding(config.speakers, 4 * width)
        conditions = 2 * config.audio_width + config.speech_width + cond_values
        self.fusions = nn.ModuleList(Fusion(width, conditions) for _ in range(config.layers))
        self.blocks = nn.ModuleList(
            StyledBlock(width, config.feed_forward, config.heads, 4 * width, config.dropout)
            for _ in range(config.layers)
        )
        self.outward = zeroed(nn.Linear(width, values))
        self.skip = LinearSkip(config.frames, values) if config.skip else None
        self.guidance = config.guidance
        if config.guidance is not None:
            self.unconditioned = nn.Parameter(torch.randn(1, width + conditions))

    @property
    def _layers(self) -> list[tuple[Fusion, StyledBlock]]:
        layers = zip(self.fusions, self.blocks, strict=True)
        return cast("list[tuple[Fusion, StyledBlock]]", list(layers))

    def modulate(self, t: Tensor, person: Tensor) -> list[Tensor]:
        """Return the modulations of each block for diffusion steps and a speaker."""
        style = self.step(step_embedding(t, self.inward.out_features)) + self.speaker(person)
        style = functional.silu(style)
        return [block.modulate(style) for _, block in self._layers]

    def encode_speech(self, audio: Tensor, hubert: Tensor) -> list[FusedSpeech]:
        """Return the speech for each fusion; one row of `hubert` is used for all of `audio`."""
        speech = self.speech(hubert)
        conditions = torch.cat([self.audio(audio), speech.expand(len(audio), -1, -1)], dim=-1)
        return [fusion.fuse(conditions) for fusion, _ in self._layers]

    def forward(
        self,
        x_t: Tensor,
        t: Tensor,
        modulations: Sequence[Tensor],
        fused_speech: Sequence[FusedSpeech],
        x0_hat: Tensor | None = None,
    ) -> Tensor:
        """Return eps of one part of the motion, (batch, frames, part).

        Parameters
        ----------
        x_t : Tensor
            (batch, frames, part).
        t : Tensor
            (batch,) or (1,) diffusion steps.
        modulations : sequence of Tensor
            See `modulate`.
        fused_speech : sequence of FusedSpeech
            See `encode_speech`.
        x0_hat : Tensor, optional
            (batch, frames, other part), the estimate of the other part's clean motion.
        """
        h = self.dropout(self.inward(x_t) + self.position[:, : x_t.shape[1]])
        null: Tensor | None = None
        if self.guidance is not None and self.training:
            null = torch.rand(len(x_t), device=x_t.device) < CONDITION_DROPOUT
        elif self.guidance is not None:
            h = h.repeat(2, 1, 1)
        for (fusion, block), modulation, speech_of_layer in zip(
            self._layers, modulations, fused_speech, strict=True
        ):
            added = fusion(h[: len(x_t)], speech_of_layer, x0_hat)
            if self.guidance is not None:
                added = self._with_null(added, fusion.unconditioned(self.unconditioned), null)
            if len(h) > len(modulation) > 1:
                modulation = modulation.repeat(2, 1, 1)
            h = block(h + added, modulation)
        eps: Tensor = self.outward(h)
        if self.guidance is not None and not self.training:
            conditional, unconditional = eps.chunk(2)
            eps = unconditional + self.guidance * (conditional - unconditional)
        return eps if self.skip is None else self.skip(eps, x_t, t)

    def _with_null(self, added: Tensor, unconditioned: Tensor, null: Tensor | None) -> Tensor:
        """Return `added` with rows of `null` unconditioned, or followed by unconditioned rows."""
        if null is not None:
            return torch.where(null[:, None, None], unconditioned, added)
        return torch.cat([added, unconditioned.expand_as(added)])


class Denoiser(nn.Module):
    """The UniEG transformer with its shared audio encoder.

    Attributes
    ----------
    parts : dict of str to slice
        The values of a frame that belong to each branch.
    """

    def __init__(self, config: DenoiserConfig) -> None:
        super().__init__()
        self.config = config
        self.step = Embedding(config.width, config.style_width)
        self.audio = StyledBlock(
            config.audio_width,
            config.feed_forward,
            config.heads,
            config.style_width,
            config.dropout,
        )
        layout = _layout(config)
        self.parts = {name: part for name, part, _, _ in layout}
        self.branches = nn.ModuleDict(
            {
                name: Branch(config, _size(part), _size(given), width)
                for name, part, given, width in layout
            }
        )

    def forward(
        self, x_t: Tensor, timestep: Tensor, mel: Tensor, hubert: Tensor, person: Tensor
    ) -> Tensor:
        """Return eps, the noise in `x_t`.

        Parameters
        ----------
        x_t : Tensor
            (batch, frames, motion width), the body's values, then the face's.
        timestep : Tensor
            (batch,) diffusion steps, integers from 0 to 999.
        mel : Tensor
            (batch, frames, mel bands).
        hubert : Tensor
            (batch, frames, HuBERT features).
        person : Tensor
            (batch, speakers), one-hot.

        Returns
        -------
        Tensor
            (batch, frames, motion width).
        """
        modulations = self.modulate(timestep, person)
        audio = self.encode_audio(mel, modulations)
        eps: dict[str, Tensor] = {}
        x0_hat: Tensor | None = None
        for name, branch in self.ordered_branches.items():
            part, speech = x_t[..., self.parts[name]], branch.encode_speech(audio, hubert)
            eps[name] = branch(part, timestep, modulations[name], speech, x0_hat)
            x0_hat = self.estimate(part, eps[name], timestep)
        return self.join_parts(eps)

    @property
    def ordered_branches(self) -> dict[str, Branch]:
        """The branches by name; the second is conditioned on the first one's estimate."""
        return cast("dict[str, Branch]", dict(self.branches.items()))

    def join_parts(self, parts: Mapping[str, Tensor]) -> Tensor:
        """Join the branches' parts of the motion, (…, motion width)."""
        names = sorted(parts, key=lambda name: self.parts[name].start)
        return torch.cat([parts[name] for name in names], dim=-1)

    def modulate(self, t: Tensor, person: Tensor) -> Mapping[str, Sequence[Tensor]]:
        """Return the modulations of each branch, and of the shared encoder under ``audio``.

        Parameters
        ----------
        t : Tensor
            (steps,) diffusion steps.
        person : Tensor
            (1 or steps, speakers), one-hot.
        """
        style = functional.silu(self.step(step_embedding(t, self.config.width)))
        branches = self.ordered_branches.items()
        by_branch = {name: branch.modulate(t, person) for name, branch in branches}
        return {"audio": [self.audio.modulate(style)], **by_branch}

    def encode_audio(self, mel: Tensor, modulations: Mapping[str, Sequence[Tensor]]) -> Tensor:
        """Return the audio for `Branch.encode_speech`, (steps, frames, 2 · mel bands).

        Parameters
        ----------
        mel : Tensor
            (steps, frames, mel bands), as many rows as the modulations have.
        modulations : mapping
            The modulations that `modulate` returns.
        """
        if self.config.loudness == "logarithm":
            mel = ((mel + SILENCE).log10() + 2) / 2
        return torch.cat([mel, self.audio(MEL_GAIN * mel, modulations["audio"][0])], dim=-1)

    def estimate(self, x_t: Tensor, eps: Tensor, t: Tensor) -> Tensor | None:
        """Return x̂0, which conditions the next branch (equation 5); None if nothing does."""
        if self.config.flow in ("none", "joint"):
            return None
        x0_hat = LINEAR.x0_hat(x_t, eps, t)
        return x0_hat.detach() if self.config.detached else x0_hat

    def fit_skips(self, windows: Floats32) -> None:
        """Fit the skips of all branches to normalised motion.

        Parameters
        ----------
        windows : ndarray
            Training windows, (windows, frames, motion width).
        """
        for name, branch in self.ordered_branches.items():
            if branch.skip is not None:
                branch.skip.fit(windows[..., self.parts[name]])


def _layout(config: DenoiserConfig) -> list[tuple[str, slice, slice, int]]:
    """Return each branch's name, its values in a frame, those that condition it, and its width."""
    empty = slice(0, 0)
    body = slice(0, config.gesture_width)
    face = slice(config.gesture_width, config.motion_width)
    if config.flow == "joint":
        return [("whole", slice(0, config.motion_width), empty, config.joint_width)]
    if config.flow == "gesture_to_expression":
        return [("gesture", body, empty, config.width), ("expression", face, body, config.width)]
    cond = face if config.flow == "expression_to_gesture" else empty
    return [("expression", face, empty, config.width), ("gesture", body, cond, config.width)]


def _size(part: slice) -> int:
    return int(part.stop - part.start)
