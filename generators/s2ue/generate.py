"""Speech2UnifiedExpressions as a generator: speech in, a clip of face and upper body out."""

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import Final

import numpy as np
import torch
from torch import Tensor

from generators.interface import OnPart, SpeechSegment, seeded_stream
from generators.learned import NetworkGenerator, check_finite, concatenate_parts, network_provenance
from generators.learned_settings import S2ueSettings
from generators.s2ue.model import Network, S2ueNetwork, load_network
from motion.arrays import Floats, Floats32
from motion.body.face_landmarks import FaceLandmarks
from motion.clip import MotionClip
from motion.formats.transcript import Word, find_transcript
from training.spaces.bones_and_landmarks import bone_and_landmark_clip, with_units
from training.speech_features.speech_frames import SpeechWindow, at_speech_rate, stream_windows
from training.speech_features.word_vectors import (
    StandIn,
    WordVectors,
    matching_vectors,
    slice_rows,
    word_rows,
)

TRANSITION_SHARE: Final = 0.4
"""Share of a window's new frames over which the transition from the previous window ends."""

_DECAY: Final = 0.3
"""Ratio of the weights with which adjacent shared frames are held at the previous window's."""

_BENDING: Final = 0.01
"""Weight of the transition's bending, relative to the error at the first shared frame."""


class S2ue(NetworkGenerator[S2ueSettings]):
    """Generates face and upper body by a trained network (Bhattacharya et al. 2024)."""

    name = "s2ue"
    version = "3"

    def make_motion(
        self, speech: SpeechSegment, seed: int, on_part: OnPart
    ) -> tuple[MotionClip, dict[str, str]]:
        """Return motion and its facts.

        The facts are the speaker, the device, the checkpoint's hash, the word vectors, the windows,
        and under ``stand_ins`` all substitutes.
        """
        rate = self._network.model.config.frame_rate
        frames = max(1, round(speech.audio.duration * rate))
        segment, folder = speech.segment, self._settings.transcripts
        transcript = find_transcript(folder, segment.name, segment.transcript, speech.audio)
        words = word_rows(transcript, self._vectors, frames, rate) if transcript else None
        sound = at_speech_rate(speech.audio)
        motion = self.stream([sound], seed=seed, words=words, speaker=segment.speaker)
        facts = self._facts(segment.speaker, transcript)
        return self.clip_of(concatenate_parts(motion, frames, on_part)), facts

    def stream(
        self,
        chunks: Iterable[Floats32],
        *,
        seed: int,
        words: Floats32 | None = None,
        speaker: str | None = None,
    ) -> Iterator[Floats]:
        """Yield motion of live speech as soon as it is final.

        The division into chunks does not matter. A frame is final, at the latest, a window of
        motion (34 frames) and a tenth of a second later.

        Parameters
        ----------
        chunks : iterable of ndarray
            Samples at 16 kHz, in order.
        seed : int
            Random seed, at least 0.
        words : ndarray, shape (frames, width), optional
            See `training.speech_features.word_vectors.word_rows`; by default the words are unknown.
        speaker : str, optional
            Speaker of the speech, and of the motion unless the settings name another.

        Yields
        ------
        ndarray, shape (some frames, values)
            Motion at 15 frames per second; `clip_of` converts it to clips.
        """
        network, speakers = self._network.model, self._network.speakers
        config = network.config
        chance = np.random.default_rng(seeded_stream(seed))
        noise = self._settings.variation * chance.standard_normal(config.latents)
        person = speakers.one_hot([self._name(speaker)])[0]
        windows = stream_windows(chunks, config.frame_rate, config.frames, config.seeds)
        tensors = (torch.from_numpy(x.astype(np.float32)) for x in (person, noise))
        return synthesise_windows(windows, words, network, *(x.to(self._device) for x in tensors))

    def clip_of(self, values: Floats) -> MotionClip:
        """Return the clip of values of motion, (T, 27 + 3 L)."""
        check_finite(values, self._settings.checkpoint)
        return bone_and_landmark_clip(values, self._network.model.config.frame_rate, self._face)

    def _name(self, speaker: str | None) -> str:
        """Return the speaker to move as, one of the network's."""
        speakers, settings = self._network.speakers, self._settings
        return speakers.names[speakers.resolve(settings.speaker, speaker, settings.checkpoint) - 1]

    def _facts(self, speaker: str, transcript: tuple[Word, ...]) -> dict[str, str]:
        config, name = self._network.model.config, self._name(speaker)
        stand_ins = ["no words, as there is no transcript"] if not transcript else []
        if transcript and isinstance(self._vectors, StandIn):
            stand_ins.append(self._vectors.description)
        if self._settings.speaker is None and name != speaker:
            stand_ins.append(f"speaker {name} in place of the segment's")
        return {
            "speaker": name,
            "variation": f"{self._settings.variation:g}",
            "vectors": self._vectors.description,
            **network_provenance(
                self._settings,
                self._device,
                frames=config.frames,
                overlap=config.seeds,
                frame_rate=config.frame_rate,
                stand_ins=stand_ins,
            ),
        }

    @cached_property
    def _face(self) -> FaceLandmarks:
        return FaceLandmarks.of_default_body()

    @cached_property
    def _network(self) -> S2ueNetwork:
        return load_network(self._settings.checkpoint, self._face).to(self._device)

    @cached_property
    def _vectors(self) -> WordVectors:
        loaded, path = self._network, self._settings.vectors
        return matching_vectors(
            path, loaded.vectors, loaded.model.config.words, self._settings.checkpoint
        )


def synthesise_windows(
    windows: Iterable[SpeechWindow],
    words: Floats32 | None,
    network: Network,
    person: Tensor,
    noise: Tensor,
) -> Iterator[Floats]:
    """Yield values of motion (some frames, 27 + 3 L) as soon as they are final.

    Each window starts with the last frames of the previous one and makes a smooth transition to its
    own motion. The first one starts at rest, like recordings.

    Parameters
    ----------
    windows : iterable of SpeechWindow
        The windows of speech.
    words : ndarray, shape (frames, width), optional
        The vector of the word in each frame of the speech; None if the words are unknown.
    network : Network
        The network, in evaluation mode.
    person, noise : Tensor
        See `generators.s2ue.model.Network.synthesise`, for a single window.
    """
    config = network.config
    seeds, new = config.seeds, config.frames - config.seeds
    seed_motion = network.rest.expand(seeds, -1)
    transition = torch.from_numpy(_transition_matrix(config.frames, seeds)).to(seed_motion)
    for window in windows:
        word_vectors = slice_rows(words, window.first, config.frames, config.words)
        with torch.inference_mode():
            synthesised, _ = network.synthesise(
                window.sound[None].to(seed_motion.device),
                torch.from_numpy(word_vectors)[None].to(seed_motion.device),
                person[None],
                noise[None],
                seed_motion[None],
            )
            values = network.with_lips(synthesised, window.spectrum[None].to(seed_motion.device))[0]
            values = with_units(values + transition @ (seed_motion - values[:seeds]))
        is_full = window.count == config.frames
        seed_motion = values[new:]
        yield values[: new if is_full else window.count].cpu().numpy().astype(np.float64)


def _transition_matrix(frames: int, seeds: int) -> Floats:
    """Return the matrix from the difference of two windows to the transition between them.

    The transition is the least-squares curve that starts near the first window, ends on the
    second, and bends little, so that position and velocity blend.

    Returns
    -------
    ndarray, shape (frames, seeds)
        Multiplied with the differences of the shared frames, it is added to the second window.
    """
    count = seeds + round(TRANSITION_SHARE * (frames - seeds))
    anchors = np.diag(np.append(_DECAY ** np.arange(seeds), np.zeros(count - seeds)))
    bends = np.diff(np.eye(frames + 2), n=2, axis=0)[:, :count]
    transition = np.linalg.solve(anchors + _BENDING * bends.T @ bends, anchors[:, :seeds])
    return np.pad(transition, ((0, frames - count), (0, 0)))
