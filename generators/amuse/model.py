"""AMUSE's motion networks: a prior that encodes ten seconds as one latent, and its denoiser.

Chhatre et al., CVPR 2024, section 3.3 and appendix C.1, after Chen et al. 2023 (MLD). Learned
positions are added once, at the input of a sequence, as in the released network.
"""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from generators.amuse.config import PARTS, STEPS, MotionConfig
from training.diffusion import SCALED_LINEAR, step_embedding
from training.layers.transformers import SkipTransformer
from training.spaces.smplx_bodies import BodyPoints


def _transformer(config: MotionConfig, *, reads_memory: bool = False) -> SkipTransformer:
    sizes = (config.width, config.feed_forward, config.heads, config.layers)
    return SkipTransformer(*sizes, dropout=config.dropout, reads_memory=reads_memory)


class Positions(nn.Module):
    """Learned positions, added to a sequence (batch, tokens, width)."""

    def __init__(self, config: MotionConfig) -> None:
        super().__init__()
        self.pe = nn.Parameter(torch.rand(config.longest, config.width))

    def forward(self, x: Tensor) -> Tensor:
        """Return `x` with the position of each token added."""
        return x + self.pe[: x.shape[1]]


class MotionPrior(nn.Module):
    """The variational autoencoder of motion: P_E and P_D."""

    def __init__(self, config: MotionConfig) -> None:
        super().__init__()
        self.config = config
        self.latent_shape = (config.tokens, config.width)
        self.global_motion_token = nn.Parameter(torch.randn(2 * config.tokens, config.width))
        self.skel_embedding = nn.Linear(config.motion_width, config.width)
        self.query_pos_encoder = Positions(config)
        self.encoder = _transformer(config)
        self.query_pos_decoder = Positions(config)
        self.decoder = _transformer(config, reads_memory=True)
        if config.tokens > 1:
            self.memory_pos = nn.Parameter(torch.randn(config.tokens, config.width))
        self.final_layer = nn.Linear(config.width, config.motion_width)

    def encode(self, motion: Tensor) -> tuple[Tensor, Tensor]:
        """Return means and deviations (batch, tokens, width) of the latent of `motion`."""
        tokens = self.global_motion_token.expand(len(motion), -1, -1)
        x = torch.cat([tokens, self.skel_embedding(motion)], dim=1)
        x = self.encoder(self.query_pos_encoder(x))
        mu, log_variance = x[:, : len(self.global_motion_token)].chunk(2, dim=1)
        return mu, (0.5 * (log_variance + self.config.log_variance)).exp()

    def decode(self, z: Tensor, frames: int | None = None) -> Tensor:
        """Return the motion of latents `z`, (batch, frames, motion width)."""
        count = self.config.frames if frames is None else frames
        queries = self.query_pos_decoder(z.new_zeros(len(z), count, z.shape[-1]))
        memory = z if self.config.tokens == 1 else z + self.memory_pos
        motion: Tensor = self.final_layer(self.decoder(queries, memory))
        return motion


class NoPrior(nn.Module):
    """The motion itself instead of a latent: AMUSE without its prior (Table A.3)."""

    def __init__(self, config: MotionConfig) -> None:
        super().__init__()
        self.latent_shape = (config.frames, config.motion_width)

    def encode(self, motion: Tensor) -> tuple[Tensor, Tensor]:
        """Return the motion, without uncertainty."""
        return motion, torch.zeros_like(motion)

    def decode(self, z: Tensor, frames: int | None = None) -> Tensor:
        """Return the motion."""
        return z[:, :frames]


class Denoiser(nn.Module):
    """The latent denoiser Δ: predicts the noise `eps` in a latent, given the speech."""

    def __init__(self, config: MotionConfig) -> None:
        super().__init__()
        self.config = config
        self.time_embedding = nn.Sequential(
            nn.Linear(config.condition_width, config.width),
            nn.SiLU(),
            nn.Linear(config.width, config.width),
        )
        for part in PARTS[: config.conditions]:
            projection = nn.Sequential(nn.ReLU(), nn.Linear(config.condition_width, config.width))
            self.add_module(part, projection)
        self.query_pos = Positions(config)
        self.encoder = _transformer(config)
        # Without a prior, input and output each have a linear layer.
        frame, width = config.motion_width, config.width
        self.embedding = nn.Identity() if config.prior else nn.Linear(frame, width)
        self.final_layer = nn.Identity() if config.prior else nn.Linear(width, frame)

    def forward(self, z_t: Tensor, timestep: Tensor, *speech: Tensor) -> Tensor:
        """Return eps, the noise in `z_t`; see `predict`."""
        predicted = self.predict(z_t, timestep, *speech)
        if self.config.predicts == "eps":
            return predicted
        return SCALED_LINEAR.eps_of_v(z_t, predicted, timestep)

    def predict(self, z_t: Tensor, timestep: Tensor, *speech: Tensor) -> Tensor:
        """Return the layers' prediction for `z_t`: its noise, or its velocity.

        Parameters
        ----------
        z_t : Tensor
            (batch, tokens, width), latents with noise; without a prior (batch, frames, motion
            width).
        timestep : Tensor
            (batch,) or (1,), diffusion steps from 0 to 999.
        *speech : Tensor
            (batch, 1, condition width), the speech's content, emotion and style.

        Returns
        -------
        Tensor
            Noise or velocity, with the shape of `z_t`.
        """
        t = timestep.reshape(-1).expand(len(z_t))
        step = self.time_embedding(step_embedding(t, self.config.condition_width))
        conditions = (self.get_submodule(part)(zs) for part, zs in zip(PARTS, speech, strict=False))
        x = torch.cat([self.embedding(z_t), step[:, None].to(z_t.dtype), *conditions], dim=1)
        predicted: Tensor = self.final_layer(self.encoder(self.query_pos(x))[:, : z_t.shape[1]])
        return predicted


class MotionModel(nn.Module):
    """Prior and denoiser, and the points on the body that their losses compare."""

    def __init__(self, config: MotionConfig) -> None:
        super().__init__()
        self.config = config
        self.prior = MotionPrior(config) if config.prior else NoPrior(config)
        self.denoiser = Denoiser(config)
        self.points = BodyPoints()

    def sample(self, noise: Tensor, speech: Sequence[Tensor], steps: int = STEPS) -> Tensor:
        """Return latents sampled from `noise` by DDIM, with its shape.

        Parameters
        ----------
        noise : Tensor
            (batch, tokens, width): equal noise gives equal latents.
        speech : sequence of Tensor
            Content, emotion and style, (batch, 1, condition width) each.
        steps : int
            Number of DDIM steps.
        """
        return SCALED_LINEAR.ddim(
            noise, lambda z_t, t: self.denoiser(z_t, t, *speech), steps, self.config.clip
        )
