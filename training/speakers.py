"""Speakers as conditions of networks: by name or number, or as a latent that can be sampled."""

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from motion.arrays import Floats32
from motion.errors import InputError, found_at, listed


@dataclass(frozen=True)
class Speakers:
    """The speakers of a network's training data.

    Attributes
    ----------
    names : tuple of str
        Names in the order of the speakers' numbers, which start at 1.
    width : int
        Length of the one-hot vector; the entries after the last speaker are unused.
    """

    names: tuple[str, ...]
    width: int

    def __post_init__(self) -> None:
        if not 0 < len(self.names) <= self.width:
            raise ValueError(f"{len(self.names)} speakers for a vector of {self.width}")

    def number(self, speaker: int | str) -> int:
        """Return the number of a speaker given by name or number.

        Raises
        ------
        InputError
            If the network does not know the speaker.
        """
        text = str(speaker)
        if text in self.names:
            return self.names.index(text) + 1
        if text.isdecimal() and 1 <= int(text) <= len(self.names):
            return int(text)
        raise InputError(
            f"the network knows no speaker {text!r}",
            remedy=f"Give a number from 1 to {len(self.names)}, or one of {listed(self.names)}",
        )

    def number_or_substitute(self, name: str) -> int:
        """Return the number of a speaker, or of a known one in place of an unknown one.

        The name decides which. It is a single speaker because the network is never trained on
        mixtures.
        """
        if name in self.names:
            return self.names.index(name) + 1
        return zlib.crc32(name.encode()) % len(self.names) + 1

    def resolve(self, requested: int | str | None, speaker: str | None, checkpoint: Path) -> int:
        """Return the speaker to move as: the chosen one, the segment's, or the first.

        Raises
        ------
        InputError
            If the network in `checkpoint` does not know the speaker.
        """
        if requested is None:
            return 1 if speaker is None else self.number_or_substitute(speaker)
        with found_at(checkpoint):
            return self.number(requested)

    def one_hot(self, names: Sequence[str]) -> Floats32:
        """Return one-hot vectors, (names, width), of `number_or_substitute` of each name."""
        vectors = np.zeros((len(names), self.width), np.float32)
        vectors[np.arange(len(names)), [self.number_or_substitute(name) - 1 for name in names]] = 1
        return vectors


class SpeakerEncoder(nn.Module):
    """Encodes a speaker as mean and log variance of a latent."""

    def __init__(self, speakers: int, width: int) -> None:
        super().__init__()
        self.embedding = nn.Linear(speakers, width)
        self.mean = nn.Linear(width, width)
        self.variance = nn.Linear(width, width)

    def forward(self, person: Tensor) -> tuple[Tensor, Tensor]:
        """Return mean and log variance, (B, D_k), for one-hot vectors (B, K)."""
        embedded = self.embedding(person)
        return self.mean(embedded), self.variance(embedded)


def latent_loss(latents: Sequence[tuple[Tensor, Tensor]]) -> Tensor:
    """Return the Kullback-Leibler divergence of the speakers' latents from the standard normal."""
    return torch.stack(
        [
            -0.5 * (1 + variance - mean.square() - variance.exp()).mean()
            for mean, variance in latents
        ]
    ).sum()
