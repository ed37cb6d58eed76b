"""Speed of AMUSE's released sizes on this machine, compared with a plain implementation.

``python -m benchmarks.amuse`` runs both for the same ten seconds in turns and takes medians,
because other work on the machine varies. The plain implementation computes attention with separate
matrix products, as the release does, and the denoiser with unfused layers. Weights are random:
speed does not depend on them.
"""

import argparse
from collections.abc import Callable
from statistics import median

import torch
from torch import Tensor

from benchmarks.diffsheg import in_turns
from generators.amuse.config import PARTS, MotionConfig, SpeechConfig
from generators.amuse.model import MotionModel
from generators.amuse.speech import SpeechModel
from training.device import torch_threads
from training.layers.transformers import pack


def speech_model(attention: str) -> SpeechModel:
    """Return a speech model of the released size with this implementation of attention."""
    torch.manual_seed(1)
    model = SpeechModel(SpeechConfig()).eval().requires_grad_(False)
    for encoder in (model.content, model.emotion, model.style):
        encoder.transformer.config._attn_implementation = attention
    return model


def compared(
    what: str, fast: Callable[[], Tensor], plain: Callable[[], Tensor], rounds: int, frames: int
) -> None:
    """Print the speed of both, and the difference between their outputs."""
    output, other = fast(), plain()
    difference = float((output - other).abs().max() / other.abs().max())
    turns = in_turns({"here": fast, "plain": plain}, rounds)
    print(f"{what}: apart by {difference:.1e} of the most")
    for name, of_one in turns.items():
        wall, processors = (
            median(getattr(turn, kind) for turn in of_one) for kind in ("wall", "processors")
        )
        print(
            f"  {name:6s}{wall:7.3f} s by the clock, {frames / wall:6.0f} frames/s; "
            f"{processors:.3f} s of processors"
        )
    ratios = [p.processors / h.processors for h, p in zip(*turns.values(), strict=True)]
    print(f"  ratio of processors: {median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})")


@torch.inference_mode()
def main() -> None:
    """Print everything."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--rounds", type=int, default=5)
    options.add_argument("--threads", type=int, default=torch.get_num_threads())
    args = options.parse_args()
    motion = MotionModel(MotionConfig()).eval().requires_grad_(False)
    latents, noise = (
        [torch.randn(1, 1, 256) for _ in PARTS],
        torch.randn(1, 1, motion.config.width),
    )

    def sample() -> Tensor:
        return motion.prior.decode(motion.sample(noise, latents))[0]

    def sample_plainly() -> Tensor:
        torch.backends.mha.set_fastpath_enabled(False)
        try:
            return sample()
        finally:
            torch.backends.mha.set_fastpath_enabled(True)

    packed = speech_model("sdpa")
    filterbank = torch.randn(1, packed.config.frames, packed.config.bands)
    pack(packed)
    plain = {name: speech_model(name) for name in ("eager", "sdpa")}

    def latent(model: SpeechModel) -> Tensor:
        return torch.cat([model.latent(part, filterbank) for part in PARTS])

    with torch_threads(args.threads):
        print(f"{args.threads} threads, {args.rounds} turns, ten seconds of speech")
        compared("Sampling in 50 steps, and decoding", sample, sample_plainly, args.rounds, 300)
        for name, model in plain.items():
            compared(
                f"Hearing by three encoders, plain attention: {name}",
                lambda: latent(packed),
                lambda model=model: latent(model),  # type: ignore[misc]
                args.rounds,
                300,
            )


if __name__ == "__main__":
    main()
