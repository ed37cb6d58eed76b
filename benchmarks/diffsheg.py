"""Speed of DiffSHEG's full network on this machine, compared with a plain loop.

``python -m benchmarks.diffsheg`` samples the same windows in turns, round after round, and takes
medians, because other work on the machine varies. The plain loop runs the whole network at each
evaluation, with all of torch's threads. Weights are random: speed does not depend on them. Rates
are frames of motion per second of wall-clock time; speech features are not counted.
"""

import argparse
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from statistics import median
from typing import Final

import torch
from torch import Tensor

from generators.diffsheg.config import BEAT, Sampling
from generators.diffsheg.model import Denoiser
from generators.diffsheg.sampling import (
    Sampler,
    Window,
    WindowSampler,
    sample_windows,
    stream,
)
from training.device import torch_threads
from training.speech_features.speech_frames import SpeechFrames

SAMPLING: Final = Sampling()
SEED: Final = 1
AHEAD: Final = "computed ahead"
PLAIN: Final = "plain loop"


@dataclass(frozen=True)
class Turn:
    """One turn of one implementation: wall-clock seconds, and those of all processors together."""

    wall: float
    processors: float


def random_network() -> Denoiser:
    """Return a network of the released size with seeded weights."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(SEED)
        denoiser = Denoiser(BEAT).eval().requires_grad_(False)
        for name, weight in denoiser.named_parameters():
            weight.normal_(0, 0.05)
            if weight.ndim == 1 and name.endswith("weight"):
                weight.add_(1)
    return denoiser


def random_speech(frames: int) -> SpeechFrames:
    """Return random speech features."""
    random = torch.Generator().manual_seed(SEED)
    return SpeechFrames(
        torch.rand(frames, BEAT.audio_width, generator=random),
        torch.randn(frames, BEAT.speech_features, generator=random),
    )


def plain_loop(denoiser: Denoiser, person: Tensor) -> Sampler:
    """Return a sampler that runs the whole network at each evaluation."""

    def eps(x_t: Tensor, place: int, speech: SpeechFrames) -> Tensor:
        t = torch.tensor([SAMPLING.timesteps[place]])
        result: Tensor = denoiser(x_t, t, speech.mel[None], speech.hubert[None], person[None])
        return result

    def sample(windows: Sequence[Window], known: Tensor | None) -> list[Tensor]:
        inputs = ((partial(eps, speech=window.speech), window.noise) for window in windows)
        return sample_windows(inputs, SAMPLING, known)

    return sample


def sampled_motion(sampler: Sampler, speech: SpeechFrames) -> Tensor:
    """Return the motion for `speech`."""
    pieces = stream(
        [speech],
        sampler,
        frames=BEAT.frames,
        width=BEAT.motion_width,
        sampling=SAMPLING,
        seed=SEED,
    )
    return torch.cat(list(pieces))


def timed(work: Callable[[], object]) -> Turn:
    """Return the time that `work` takes."""
    wall, processors = time.perf_counter(), time.process_time()
    work()
    return Turn(time.perf_counter() - wall, time.process_time() - processors)


def in_turns(works: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, list[Turn]]:
    """Return the turns of each of `works`, interleaved so that all run under the same load."""
    turns: dict[str, list[Turn]] = {name: [] for name in works}
    for _ in range(rounds):
        for name, work in works.items():
            turns[name].append(timed(work))
    return turns


def evaluations(frames: int) -> int:
    """Return the number of network evaluations for this many frames."""
    settled = BEAT.frames - SAMPLING.overlap
    later = -(-max(frames - BEAT.frames, 0) // settled)
    return _steps_down(SAMPLING.first_walk) + later * _steps_down(SAMPLING.later_walk)


def _steps_down(walk: Sequence[int]) -> int:
    return sum(there < here for here, there in pairwise(walk))


def compare(ways: dict[str, Sampler], speech: SpeechFrames, threads: int, rounds: int) -> None:
    """Print the speed of both with this many threads."""
    works = {name: partial(sampled_motion, sampler, speech) for name, sampler in ways.items()}
    with torch_threads(threads):
        turns = in_turns(works, rounds)
    print(
        f"\n{threads} thread{'s' * (threads > 1)}, {len(speech)} frames, "
        f"{evaluations(len(speech))} evaluations, {rounds} turns"
    )
    for name, of_one in turns.items():
        rate = len(speech) / median(turn.wall for turn in of_one)
        print(
            f"  {name:12s}{rate:7.1f} frames/s, {rate / BEAT.frame_rate:.2f} x real time, "
            f"{median(turn.processors for turn in of_one):.1f} s of processors"
        )
    pairs = list(zip(turns[PLAIN], turns[AHEAD], strict=True))
    for what, ratios in (
        ("by the clock", [plain.wall / fast.wall for plain, fast in pairs]),
        ("of processors", [plain.processors / fast.processors for plain, fast in pairs]),
    ):
        print(f"  ratio {what}: {median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})")


def streams_in_real_time(sampler: Sampler, speech: SpeechFrames) -> int:
    """Return how many concurrent streams, each with one thread, keep up with their speech."""
    streams = 0
    with torch_threads(1):
        while timed(partial(_together, sampler, speech, streams + 1)).wall <= _seconds(speech):
            streams += 1
    return streams


def _together(sampler: Sampler, speech: SpeechFrames, streams: int) -> None:
    with ThreadPoolExecutor(streams) as pool:
        list(pool.map(partial(sampled_motion, sampler), [speech] * streams))


def _seconds(speech: SpeechFrames) -> float:
    return len(speech) / BEAT.frame_rate


def main() -> None:
    """Print everything."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--seconds", type=float, default=10.0, help="of speech in each turn")
    options.add_argument("--rounds", type=int, default=5)
    args = options.parse_args()
    denoiser, person = random_network(), torch.eye(BEAT.speakers)[1]
    speech = random_speech(round(args.seconds * BEAT.frame_rate))
    began = time.perf_counter()
    ways: dict[str, Sampler] = {AHEAD: WindowSampler(deepcopy(denoiser), person, SAMPLING)}
    print(f"computed ahead in {time.perf_counter() - began:.2f} s, once for a speaker")
    ways[PLAIN] = plain_loop(denoiser, person)
    fast, plain = (sampled_motion(ways[name], speech) for name in (AHEAD, PLAIN))
    print(
        f"motion apart by {float((fast - plain).abs().max() / plain.abs().max()):.1e} of its most"
    )
    for threads in sorted({torch.get_num_threads(), 1}, reverse=True):
        compare(ways, speech, threads, args.rounds)
    streams = streams_in_real_time(ways[AHEAD], speech)
    print(f"\n{streams} streams at once stay in real time, each with one thread")


if __name__ == "__main__":
    main()
