"""DiffSHEG as a generator: speech in, a clip of face and body out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np
import torch

from generators.diffsheg.config import (
    BLEND_BELOW,
    JUMP_LENGTH,
    RELEASED_OVERLAP,
    SAMPLINGS,
    Sampling,
)
from generators.diffsheg.network_file import MotionNetwork, load_network
from generators.diffsheg.sampling import WindowSampler, stream
from generators.interface import OnPart, SpeechSegment
from generators.learned import NetworkGenerator, check_finite, concatenate_parts, network_provenance
from generators.learned_settings import DiffShegSettings
from motion.arrays import Floats, Floats32
from motion.body.skinning import ForearmTwists
from motion.clip import MotionClip
from motion.errors import InputError
from training.spaces.beat import beat_clip, beat_clip_piece
from training.spaces.smplx_bodies import show_clip
from training.speech_features.hubert import Hubert, check_hubert, load_hubert, stand_in
from training.speech_features.speech_frames import (
    SpeechFrames,
    StreamWindow,
    extract_frames,
    stream_frames,
    window_for,
)


class DiffSheg(NetworkGenerator[DiffShegSettings]):
    """Generates motion by a trained network (Chen et al. 2024), window by window with FOPPAS.

    Raises
    ------
    InputError
        If HuBERT's folder is not usable.
    """

    name = "diffsheg"
    version = "2"

    def __init__(self, settings: DiffShegSettings, device: str = "cpu") -> None:
        super().__init__(settings, device)
        if settings.hubert is not None:
            check_hubert(settings.hubert)
        self._sampler: tuple[int, WindowSampler] | None = None

    def make_motion(
        self, speech: SpeechSegment, seed: int, on_part: OnPart
    ) -> tuple[MotionClip, dict[str, str]]:
        """Return motion and its facts.

        The facts are data set, speaker, sampling, device, the checkpoint's hash, the HuBERT and how
        it encoded the speech, the frames, overlap and frame rate of windows, and under
        ``stand_ins`` all substitutes.
        """
        config = self._network.model.config
        speaker = self._speaker_number(speech.segment.speaker)
        frames = max(1, round(speech.audio.duration * config.frame_rate))
        speech_frames = extract_frames(speech.audio, config.frame_rate, self._hubert)
        clip = self._clip(
            concatenate_parts(
                self._denormalised_motion(speech_frames, seed, speaker), frames, on_part
            )
        )
        window = window_for(speech.audio)
        return clip, {
            "heard": "as a whole" if window is None else str(window),
            **self._facts(speaker, speech.segment.speaker),
        }

    def stream(self, chunks: Iterable[Floats32], *, seed: int) -> Iterator[Floats]:
        """Yield motion of live speech as soon as it is final.

        The motion does not depend on the division of the speech into chunks. A frame is final, at
        the latest, after a window of motion and the look-ahead of `StreamWindow`; memory is bounded
        by both, whatever the length of the speech.

        Parameters
        ----------
        chunks : iterable of ndarray
            Samples at 16 kHz, in order.
        seed : int
            Random seed, at least 0.

        Yields
        ------
        ndarray, shape (some frames, values)
            Motion at the network's frame rate, in the data set's representation; `stream_clips`
            yields clips.

        Raises
        ------
        InputError
            If the speaker or a file cannot be used.
        """
        config = self._network.model.config
        speech_frames = stream_frames(chunks, int(config.frame_rate), self._hubert, StreamWindow())
        return self._denormalised_motion(speech_frames, seed, self._speaker_number(None))

    def stream_clips(self, chunks: Iterable[Floats32], *, seed: int) -> Iterator[MotionClip]:
        """Yield clips of live speech as soon as they are final.

        Joined in order, they equal the clip of all the speech at once, bit by bit.

        Parameters
        ----------
        chunks, seed
            See `stream`.

        Yields
        ------
        MotionClip
            The next frames, at the network's frame rate, with the provenance of `generate` but an
            empty segment name.
        """
        facts = self._facts(self._speaker_number(None), None) | {
            "generator": self.name,
            "seed": str(seed),
            "segment": "",
            "heard": str(StreamWindow()),
        }
        frame_rate = self._network.model.config.frame_rate
        twists: ForearmTwists | None = None
        for motion in self.stream(chunks, seed=seed):
            if self._network.dataset == "beat":
                clip, twists = beat_clip_piece(motion, frame_rate, twists)
            else:
                clip = show_clip(motion, frame_rate)
            yield clip.with_provenance(**facts)

    def _denormalised_motion(
        self, speech: Iterable[SpeechFrames], seed: int, speaker: int
    ) -> Iterator[Floats]:
        """Yield the network's motion to speech, denormalised, (some frames, values)."""
        config = self._network.model.config
        windows = stream(
            speech,
            self._sampler_of(speaker),
            frames=config.frames,
            width=config.motion_width,
            sampling=self._sampling,
            seed=seed,
        )
        for normalised in windows:
            motion = self._network.normalisation.restored(
                normalised.cpu().numpy().astype(np.float64)
            )
            check_finite(motion, self._settings.checkpoint)
            yield motion

    def _sampler_of(self, speaker: int) -> WindowSampler:
        """Return the sampler of windows, reused for clips of the same speaker."""
        if self._sampler is None or self._sampler[0] != speaker:
            denoiser = self._network.model
            person = torch.eye(denoiser.config.speakers)[speaker - 1]
            self._sampler = (speaker, WindowSampler(denoiser, person, self._sampling))
        return self._sampler[1]

    def _clip(self, motion: Floats) -> MotionClip:
        make_clip = beat_clip if self._network.dataset == "beat" else show_clip
        return make_clip(motion, self._network.model.config.frame_rate)

    def _speaker_number(self, segment_speaker: str | None) -> int:
        """Return the number of the speaker to move as, given the segment's speaker."""
        known, requested = self._network.speakers, self._settings.speaker
        if known is not None:
            return known.resolve(requested, segment_speaker, self._settings.checkpoint)
        if requested is None:
            return 1
        count = self._network.model.config.speakers
        if not isinstance(requested, int) or requested > count:
            raise InputError(
                f"there is no speaker {requested}",
                where=self._settings.checkpoint,
                remedy=f"Give a number from 1 to {count}",
            )
        return requested

    def _facts(self, speaker: int, segment_speaker: str | None) -> dict[str, str]:
        """Return a clip's provenance of network and sampling."""
        config, sampling = self._network.model.config, self._sampling
        speakers = self._network.speakers
        name = str(speaker) if speakers is None else speakers.names[speaker - 1]
        facts = {
            "config": f"{config.layers} layers of {config.width}, {config.flow}, "
            f"windows of {config.frames} frames at {config.frame_rate:g} fps",
            "dataset": self._network.dataset,
            "speaker": name,
            "sampling": f"{sampling.steps} steps, overlap {sampling.overlap}, entry "
            f"{sampling.entry}, jump length {JUMP_LENGTH}, jump count "
            f"{sampling.jump_count}, blended below {BLEND_BELOW:g}"
            f"{', from the last pose, with its own noise' if sampling.smooth else ''}",
            "hubert": self._hubert.description,
        }
        stand_ins = [self._hubert.description] if self._hubert.stands_in else []
        if speakers is not None and self._settings.speaker is None and name != segment_speaker:
            stand_ins.append(f"speaker {name} in place of the segment's")
        if self._network.dataset == "show":
            stand_ins.append("relaxed hands for SMPL-X's mean hands")
        return facts | network_provenance(
            self._settings,
            self._device,
            frames=config.frames,
            overlap=sampling.overlap,
            frame_rate=config.frame_rate,
            stand_ins=stand_ins,
        )

    @cached_property
    def _network(self) -> MotionNetwork:
        settings = self._settings
        network = load_network(settings.checkpoint, settings.dataset, settings.stats)
        return network.to(self._device)

    @cached_property
    def _hubert(self) -> Hubert:
        folder = self._settings.hubert
        hubert = stand_in() if folder is None else load_hubert(folder)
        training_identity = self._network.hubert
        if training_identity is not None and hubert.identity != training_identity:
            raise InputError(
                f"the network was trained with features of {training_identity}, not of "
                f"{hubert.description}",
                where=self._settings.checkpoint,
                remedy="Name the folder of the same HuBERT, or none if it was a stand-in",
            )
        return hubert.to_device(self._device)

    @cached_property
    def _sampling(self) -> Sampling:
        name, steps, overlap = (
            getattr(self._settings, key) for key in ("sampling", "steps", "overlap")
        )
        if overlap is None:
            factor = 1.5 if name == "smooth" else 1
            overlap = round(factor * RELEASED_OVERLAP[self._network.dataset])
        return replace(SAMPLINGS[name], steps=steps, overlap=overlap)
