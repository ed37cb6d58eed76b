"""Values between the rows of a tensor."""

from torch import Tensor


def interpolate_features(features: Tensor, positions: Tensor) -> Tensor:
    """Return `features` (n, channels) at fractional `positions`, linearly between neighbours."""
    positions = positions.clamp(0, len(features) - 1)
    lower = positions.floor().long()
    upper = (lower + 1).clamp(max=len(features) - 1)
    share = (positions - lower).to(features.dtype)[:, None]
    return (1 - share) * features[lower] + share * features[upper]
