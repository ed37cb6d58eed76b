"""Whether a draw of the speaker changes face and body together."""

from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray

from generators.s2ue.model import S2ueNetwork
from training.data.windows import Windows
from training.spaces.bones_and_landmarks import BONE_VALUES

FloatArray = NDArray[np.float64]

DRAWS: Final = 12
_SHUFFLES: Final = 200


def drawn_together(trained: S2ueNetwork, windows: Windows) -> float:
    """Return how similarly draws of the speaker's latent change body and face.

    All windows are generated from `DRAWS` draws with the same speech and recorded seeds. The result
    is the RV coefficient of the draws' differences in posture and in expression, minus that of
    shuffled draws: 1 if the same draws are similar in both, 0 if face and body vary independently.
    """
    network, config = trained.model, trained.model.config
    rows = np.arange(len(windows))
    inputs = {name: torch.from_numpy(array) for name, array in windows.batch(rows).items()}
    people = torch.from_numpy(trained.speakers.one_hot(windows.speakers(rows)))
    means = []
    for draw in range(DRAWS):
        noise = torch.randn((1, *config.latents), generator=torch.Generator().manual_seed(draw))
        with torch.inference_mode():
            values, _ = network.synthesise(
                inputs["sound"],
                inputs["words"],
                people,
                noise.expand(len(rows), -1, -1),
                inputs["motion"][:, : config.seeds],
            )
        means.append(values[:, config.seeds :].mean(dim=1).double().numpy())
    draws = np.stack(means)
    return alike(
        draws[..., :BONE_VALUES].reshape(DRAWS, -1), draws[..., BONE_VALUES:].reshape(DRAWS, -1)
    )


def alike(body: FloatArray, face: FloatArray) -> float:
    """Return how similarly body and face, each (draws, values), vary between draws."""
    first, second = ((values - values.mean(axis=0)) for values in (body, face))
    first, second = first @ first.T, second @ second.T
    chance = np.random.default_rng(1)
    orders = [chance.permutation(len(first)) for _ in range(_SHUFFLES)]
    null = float(np.mean([_rv(first, second[np.ix_(order, order)]) for order in orders]))
    return (_rv(first, second) - null) / (1 - null)


def _rv(first: FloatArray, second: FloatArray) -> float:
    return float((first * second).sum() / np.sqrt((first * first).sum() * (second * second).sum()))
