"""Names of feature networks and of their scores.

Papers use one name for distances in different features, so each name includes the network.
"""

from __future__ import annotations

from typing import Final

EMOTION: Final = "emotion network"
GESTURE: Final = "gesture autoencoder"
EXPRESSION: Final = "expression autoencoder"
WHOLE: Final = "autoencoder of gesture and expression"
LANDMARKS: Final = "landmark autoencoder"

OF_CHANNELS: Final = {
    "body": EMOTION,
    "landmarks": LANDMARKS,
    "gesture": GESTURE,
    "expression": EXPRESSION,
    "both": WHOLE,
}
"""The networks that are trained here, by their input."""

PUBLISHED: Final = {
    "emage": "EMAGE's evaluator",
    "beat": "BEAT's evaluator",
    "ted": "TED's evaluator",
    "talkshow": "TalkSHOW's evaluator",
}
"""The published networks that `analysis.evaluators` loads, by preset."""

FGD_OF_EMOTION: Final = f"FGD ({EMOTION})"
FGD: Final = f"FGD ({GESTURE})"
FED: Final = f"FED ({EXPRESSION})"
FMD: Final = f"FMD ({WHOLE})"
FLD: Final = f"FLD ({LANDMARKS})"
VARIANCE_OF_EMOTION: Final = f"variance of features ({EMOTION})"
EMOTION_ACCURACY: Final = f"gesture emotion accuracy ({EMOTION})"

DISTANCES: Final = {
    EMOTION: FGD_OF_EMOTION,
    GESTURE: FGD,
    EXPRESSION: FED,
    WHOLE: FMD,
    LANDMARKS: FLD,
    **{name: f"FGD ({name})" for name in PUBLISHED.values()},
}
"""The Fréchet distance in the features of each network."""


def distance_of(network: str) -> str:
    """Return the name of the Fréchet distance in the features of a network."""
    kind, _, number = network.partition(", ")
    return DISTANCES[kind].replace(kind, network) if number else DISTANCES[kind]


def extrapolated(distance: str) -> str:
    """Return the name of a Fréchet distance extrapolated to infinitely many samples."""
    return distance.replace(" (", "∞ (", 1)


def as_published(distance: str) -> str:
    """Return the name of a Fréchet distance by the published code's rule."""
    return distance.replace(" (", " by the published rule (", 1)


def kernel_of(network: str) -> str:
    """Return the name of the kernel distance in the features of a network."""
    return f"kernel distance (KID, {network})"
