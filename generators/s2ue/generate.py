"""Speech2UnifiedExpressions as a generator: speech in, a clip of face and upper body out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from generators.clip_length import with_length
from generators.interface import OnPart, SpeechSegment, StudyClips, seeded_stream, unheard
from generators.network_motion import check_finite, joined, network_facts
from generators.s2ue.network_file import S2ueNetwork, load_network
from generators.s2ue.sampling import move
from generators.s2ue.settings import ANYBODY, S2ueSettings
from motion.clip import MotionClip, check_frame_rate
from motion.errors import InputError
from motion.face_landmarks import FaceLandmarks
from motion.formats.ted_npz import JOINT_NAMES
from motion.formats.transcript import Word, find_transcript, spread_words
from motion.points.clip_from_points import clip_from_points
from motion.resample import resample
from training.device import check_device
from training.hearing.speech_frames import at_speech_rate
from training.hearing.speech_windows import hear_windows
from training.hearing.word_vectors import StandIn, WordVectors, vectors_of, word_rows
from training.spaces.bones_and_landmarks import BONE_VALUES, joints_of

_AT_ONCE: Final = 1 << 16
"""Samples that are heard at once of a recording."""


class S2ue:
    """Moves face and upper body as a trained network tells (Bhattacharya et al. 2024).

    Parameters
    ----------
    settings : S2ueSettings
        Checkpoint and what belongs to it. Networks are read when the first clip is made.
    device : {'cpu', 'cuda'}
        Where they run.

    Raises
    ------
    InputError
        If the device is not usable.
    """

    name: Final = "s2ue"
    version: Final = "1"
    needs_source: Final = False

    def __init__(self, settings: S2ueSettings, device: str = "cpu") -> None:
        check_device(device)
        self._settings = settings
        self._device = device

    def generate(
        self,
        speech: SpeechSegment,
        *,
        seed: int,
        frame_rate: float,
        source: StudyClips | None = None,
        on_part: OnPart = unheard,
    ) -> MotionClip:
        """Return motion to `speech`; see `generators.interface.Generator.generate`.

        Its provenance further holds the speaker, the device, the checkpoint's hash, whose vectors
        words had, where words come from, how windows lie, and under ``stand_ins`` what took the
        place of something real.
        """
        seeded_stream(seed)
        count = speech.frame_count(frame_rate)
        check_frame_rate(frame_rate)
        config = self._network.network.config
        frames = max(1, round(speech.audio.duration * config.frame_rate))
        said = self._said(speech)
        words = word_rows(said, self._vectors, frames, config.frame_rate) if said else None
        sound = at_speech_rate(speech.audio)
        pieces = (sound[at : at + _AT_ONCE] for at in range(0, len(sound), _AT_ONCE))
        moved = self._moved(pieces, words, seed, speech.segment.speaker)
        clip = resample(self.clip_of(joined(moved, frames, on_part)), frame_rate)
        return with_length(clip, count).with_provenance(
            generator=self.name,
            seed=str(seed),
            segment=speech.segment.name,
            **self._facts(speech.segment.speaker, said),
        )

    def stream(
        self,
        pieces: Iterable[NDArray[np.float32]],
        *,
        seed: int,
        words: NDArray[np.float32] | None = None,
    ) -> Iterator[NDArray[np.float64]]:
        """Yield motion while somebody still speaks, as soon as it is settled.

        How the speech is cut into pieces changes nothing. A frame is settled at the latest when a
        window of motion behind it, 34 frames, and a tenth of a second more have been heard.

        Parameters
        ----------
        pieces : iterable of ndarray
            Samples at 16 kHz, in order.
        seed : int
            Not negative.
        words : ndarray, shape (frames, width), optional
            See `training.hearing.word_vectors.word_rows`; by default nobody knows what is said.

        Yields
        ------
        ndarray, shape (some frames, values)
            15 a second; `clip_of` makes clips of them.
        """
        seeded_stream(seed)
        return self._moved(pieces, words, seed, None)

    def clip_of(self, values: NDArray[np.float64]) -> MotionClip:
        """Return the clip of values of motion, (T, 27 + 3 L)."""
        check_finite(values, self._settings.checkpoint)
        joints = joints_of(values[:, :BONE_VALUES].reshape(len(values), -1, 3))
        shifts = values[:, BONE_VALUES:].reshape(len(values), -1, 3)
        return clip_from_points(
            joints.astype(np.float32),
            JOINT_NAMES,
            self._network.network.config.frame_rate,
            body=self._face.body,
            landmarks=shifts.astype(np.float32),
        )

    def _moved(
        self,
        pieces: Iterable[NDArray[np.float32]],
        words: NDArray[np.float32] | None,
        seed: int,
        speaking: str | None,
    ) -> Iterator[NDArray[np.float64]]:
        network = self._network.network
        config = network.config
        chance = np.random.default_rng(seeded_stream(seed))
        shape = (len(config.modalities), config.speaker_width)
        noise = self._settings.variation * chance.standard_normal(shape)
        person, _ = self._person(chance, speaking)
        return move(
            hear_windows(pieces, config.frame_rate, config.frames, config.seeds),
            words,
            network,
            person.to(self._device),
            torch.from_numpy(noise.astype(np.float32)).to(self._device),
        )

    def _person(self, chance: np.random.Generator, speaking: str | None) -> tuple[Tensor, str]:
        """Return whom it moves as, as shares of speakers and in words."""
        speakers, wanted = self._network.speakers, self._settings.speaker
        if wanted == ANYBODY and ANYBODY not in speakers.names:
            shares = chance.dirichlet(np.ones(len(speakers.names)))
            return torch.from_numpy(shares.astype(np.float32)), ANYBODY
        number = speakers.chosen(wanted, speaking, self._settings.checkpoint)
        return torch.eye(speakers.width)[number - 1], speakers.names[number - 1]

    def _said(self, speech: SpeechSegment) -> tuple[Word, ...]:
        """Return the words of the speech with their times; none where nobody knows them."""
        segment, folder = speech.segment, self._settings.transcripts
        if folder is None:
            return spread_words(segment.transcript, speech.audio)
        return find_transcript(folder, segment.name, segment.transcript, speech.audio)

    def _facts(self, speaking: str, said: tuple[Word, ...]) -> dict[str, str]:
        config = self._network.network.config
        _, name = self._person(np.random.default_rng(0), speaking)
        stand_ins = ["silence for the words, which nobody told"] if not said else []
        if said and isinstance(self._vectors, StandIn):
            stand_ins.append(self._vectors.description)
        if self._settings.speaker is None and name != speaking:
            stand_ins.append(f"speaker {name} for who is heard")
        return {
            "speaker": name,
            "variation": f"{self._settings.variation:g}",
            "vectors": self._vectors.description,
            **network_facts(
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
        loaded = load_network(self._settings.checkpoint, self._face)
        return replace(loaded, network=loaded.network.to(self._device))

    @cached_property
    def _vectors(self) -> WordVectors:
        named, network = self._settings.vectors, self._network
        vectors = vectors_of(named)
        if (vectors.description, vectors.width) != (network.vectors, network.network.config.words):
            raise InputError(
                f"the network learned words by {network.vectors} of "
                f"{network.network.config.words} numbers, and these are {vectors.description} of "
                f"{vectors.width}",
                where=named or self._settings.checkpoint,
                remedy="Name the same vectors, or none where a stand-in was learned from",
            )
        return vectors
