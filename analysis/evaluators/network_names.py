"""What scores of feature networks are called.

Papers give one name to distances in different features, so each name says which network it is of.
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
"""The networks that are trained here, by what they look at."""

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
    """Return what the Fréchet distance in the features of the network named so is called."""
    kind, _, number = network.partition(", ")
    return DISTANCES[kind].replace(kind, network) if number else DISTANCES[kind]


def extrapolated(distance: str) -> str:
    """Return what a Fréchet distance extrapolated to infinitely many samples is called."""
    return distance.replace(" (", "∞ (", 1)


def as_published(distance: str) -> str:
    """Return what a Fréchet distance by the published code's own rule is called."""
    return distance.replace(" (", " by the published rule (", 1)


def kernel_of(network: str) -> str:
    """Return what the kernel distance in the features of the network named so is called."""
    return f"kernel distance (KID, {network})"
