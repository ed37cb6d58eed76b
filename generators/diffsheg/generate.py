"""DiffSHEG as a generator: speech in, a clip of face and body out."""

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
from training.speakers import Speakers
from training.speech_features.hubert import Hubert, load_hubert, stand_in
from training.speech_features.speech_frames import (
    SpeechFrames,
    StreamWindow,
    extract_frames,
    stream_frames,
    window_for,
)


class DiffSheg(NetworkGenerator[DiffShegSettings]):
    """Generates motion by a trained network (Chen et al. 2024), window by window with FOPPAS."""

    name = "diffsheg"
    version = "2"

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
        parts = self._denormalised_motion(speech_frames, seed, speaker)
        motion = concatenate_parts(parts, frames, on_part)
        make_clip = beat_clip if self._network.dataset == "beat" else show_clip
        window = window_for(speech.audio)
        return make_clip(motion, config.frame_rate), {
            "heard": "as a whole" if window is None else str(window),
            **self._facts(speaker, speech.segment.speaker),
        }

    def stream_clips(self, chunks: Iterable[Floats32], *, seed: int) -> Iterator[MotionClip]:
        """Yield clips of live speech as soon as they are final.

        Joined in order, they equal the clip of all the speech at once, bit by bit; the division of
        the speech into chunks does not matter. A frame is final, at the latest, after a window of
        motion and the look-ahead of `StreamWindow`; memory is bounded by both, whatever the length
        of the speech.

        Parameters
        ----------
        chunks : iterable of ndarray
            Samples at 16 kHz, in order.
        seed : int
            Random seed, at least 0.

        Yields
        ------
        MotionClip
            The next frames, at the network's frame rate, with the provenance of `generate` but an
            empty segment name.

        Raises
        ------
        InputError
            If the speaker or a file cannot be used.
        """
        frame_rate, speaker = self._network.model.config.frame_rate, self._speaker_number(None)
        facts = self._facts(speaker, None) | {
            "generator": self.name,
            "seed": str(seed),
            "segment": "",
            "heard": str(StreamWindow()),
        }
        speech_frames = stream_frames(chunks, int(frame_rate), self._hubert, StreamWindow())
        twists: ForearmTwists | None = None
        for motion in self._denormalised_motion(speech_frames, seed, speaker):
            if self._network.dataset == "beat":
                clip, twists = beat_clip_piece(motion, frame_rate, twists)
            else:
                clip = show_clip(motion, frame_rate)
            yield clip.with_provenance(**facts)

    def _denormalised_motion(
        self, speech: Iterable[SpeechFrames], seed: int, speaker: int
    ) -> Iterator[Floats]:
        """Yield the network's motion to speech, denormalised, (some frames, values)."""
        denoiser, config = self._network.model, self._network.model.config
        person = torch.eye(config.speakers)[speaker - 1]
        windows = stream(
            speech,
            WindowSampler(denoiser, person, self._sampling),
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

    def _speaker_number(self, segment_speaker: str | None) -> int:
        """Return the number of the speaker to move as, given the segment's speaker."""
        requested = self._settings.speaker
        if self._network.speakers is None and requested is None:
            return 1
        return self._speakers.resolve(requested, segment_speaker, self._settings.checkpoint)

    @cached_property
    def _speakers(self) -> Speakers:
        """The network's speakers; of a released network, only their numbers are known."""
        count = self._network.model.config.speakers
        numbers = tuple(str(number + 1) for number in range(count))
        return self._network.speakers or Speakers(numbers, count)

    def _facts(self, speaker: int, segment_speaker: str | None) -> dict[str, str]:
        """Return a clip's provenance of network and sampling."""
        config, sampling = self._network.model.config, self._sampling
        name = self._speakers.names[speaker - 1]
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
        is_named = self._network.speakers is not None
        if is_named and self._settings.speaker is None and name != segment_speaker:
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
