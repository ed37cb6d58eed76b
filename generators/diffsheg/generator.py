"""DiffSHEG as a generator: speech in, a clip of face and body out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray

from generators.clip_length import with_length
from generators.diffsheg.beat_motion import beat_clip
from generators.diffsheg.estimates import SpeechFrames, prepared
from generators.diffsheg.foppas import stream
from generators.diffsheg.hubert import Hubert, check_hubert, load_hubert, stand_in
from generators.diffsheg.listening import HearingWindow, hear_stream, hear_whole
from generators.diffsheg.network_file import MotionNetwork, load_network
from generators.diffsheg.show_motion import show_clip
from generators.diffsheg.walk import Sampling
from generators.interface import SpeechSegment, StudyClips, seeded_stream
from generators.model_settings import ModelSettings
from motion.clip import MotionClip, check_frame_rate
from motion.errors import InputError
from motion.resample import resample

RELEASED_OVERLAP: Final = {"beat": 4, "show": 10}
"""Frames that the windows of the released networks share."""


class DiffSheg:
    """Moves as a trained network tells (Chen et al. 2024), window after window by FOPPAS.

    Parameters
    ----------
    model : ModelSettings
        Checkpoint and what belongs to it. Networks are read when the first clip is made.
    sampling : Sampling, optional
        How windows are walked; by default as the release's fast setting.

    Raises
    ------
    InputError
        If HuBERT's folder is not usable.
    """

    name: Final = "diffsheg"
    needs_source: Final = False

    def __init__(self, model: ModelSettings, sampling: Sampling | None = None) -> None:
        if model.hubert is not None:
            check_hubert(model.hubert)
        self._model = model
        self._sampling = sampling

    def generate(
        self,
        speech: SpeechSegment,
        *,
        seed: int,
        frame_rate: float,
        source: StudyClips | None = None,
    ) -> MotionClip:
        """Return motion to `speech`; see `generators.interface.Generator.generate`.

        It is made at the network's frame rate and resampled. Its provenance further holds data
        set, speaker, sampling, the checkpoint's hash, which HuBERT heard the speech, and under
        ``stand_ins`` what took the place of something real.
        """
        seeded_stream(seed)
        count = speech.frame_count(frame_rate)
        check_frame_rate(frame_rate)
        heard = hear_whole(speech.audio, self._network.denoiser.config.frame_rate, self._hubert)
        clip = self._clip(np.concatenate(list(self._moved([heard], seed))))
        return with_length(resample(clip, frame_rate), count).with_provenance(
            generator=self.name,
            seed=str(seed),
            segment=speech.segment.name,
            **self._facts(),
        )

    def stream(
        self,
        pieces: Iterable[NDArray[np.float32]],
        *,
        seed: int,
        window: HearingWindow | None = None,
    ) -> Iterator[NDArray[np.float64]]:
        """Yield motion while somebody still speaks, as soon as it is settled.

        How the speech is cut into pieces changes nothing: all of it at once gives the same motion.
        A frame is settled at the latest when a window of motion and what `window` looks ahead have
        been heard; memory is bounded by both, however long the speech.

        Parameters
        ----------
        pieces : iterable of ndarray
            Samples at 16 kHz, in order.
        seed : int
            Not negative.
        window : HearingWindow, optional
            What is heard around each second; by default four seconds before and one ahead.

        Yields
        ------
        ndarray, shape (some frames, values)
            At the network's frame rate and in the data set's own values, which
            `generators.diffsheg.beat_motion` and `generators.diffsheg.show_motion` take to clips.

        Raises
        ------
        InputError
            If the seed, the speaker or a file cannot be used.
        """
        seeded_stream(seed)
        config = self._network.denoiser.config
        window = HearingWindow() if window is None else window
        heard = hear_stream(pieces, int(config.frame_rate), self._hubert, window)
        return self._moved(heard, seed)

    def _moved(self, heard: Iterable[SpeechFrames], seed: int) -> Iterator[NDArray[np.float64]]:
        """Yield the network's motion to speech in its own units, (some frames, values)."""
        denoiser, sampling = self._network.denoiser, self._walk
        config = denoiser.config
        with torch.inference_mode():
            told = prepared(denoiser, self._person(), sampling)
        settled = stream(
            heard,
            told,
            frames=config.frames,
            width=config.motion_width,
            sampling=sampling,
            seed=seed,
        )
        for normalised in settled:
            motion = self._network.normalisation.restored(normalised.numpy().astype(np.float64))
            if not np.isfinite(motion).all():
                raise InputError(
                    "the network tells motion that is not finite",
                    where=self._model.checkpoint,
                    remedy="Its training has diverged: give another checkpoint",
                )
            yield motion

    def _clip(self, motion: NDArray[np.float64]) -> MotionClip:
        made = beat_clip if self._network.dataset == "beat" else show_clip
        return made(motion, self._network.denoiser.config.frame_rate)

    def _person(self) -> torch.Tensor:
        speakers = self._network.denoiser.config.speakers
        if self._model.speaker > speakers:
            raise InputError(
                f"there is no speaker {self._model.speaker}",
                where=self._model.checkpoint,
                remedy=f"Give a number from 1 to {speakers}",
            )
        return torch.eye(speakers)[self._model.speaker - 1]

    def _facts(self) -> dict[str, str]:
        """Return what a clip's provenance says of network and sampling."""
        config, sampling = self._network.denoiser.config, self._walk
        facts = {
            "config": f"{config.layers} layers of {config.width}, {config.flow}, "
            f"windows of {config.frames} frames at {config.frame_rate:g} fps",
            "dataset": self._network.dataset,
            "speaker": str(self._model.speaker),
            "sampling": f"{sampling.steps} steps, overlap {sampling.overlap}, entry "
            f"{sampling.entry}, jump length {sampling.jump_length}, jump count "
            f"{sampling.jump_count}",
            "checkpoint": self._model.checkpoint.name,
            "checkpoint_sha256": self._model.checkpoint_sha256,
            "hubert": self._hubert.description,
        }
        stand_ins = [self._hubert.description] if self._hubert.stands_in else []
        if self._network.dataset == "show":
            stand_ins.append("relaxed hands for SMPL-X's mean hands")
        return facts | ({"stand_ins": "; ".join(stand_ins)} if stand_ins else {})

    @cached_property
    def _network(self) -> MotionNetwork:
        return load_network(self._model.checkpoint, self._model.dataset, self._model.stats)

    @cached_property
    def _hubert(self) -> Hubert:
        return stand_in() if self._model.hubert is None else load_hubert(self._model.hubert)

    @cached_property
    def _walk(self) -> Sampling:
        if self._sampling is not None:
            return self._sampling
        return Sampling(overlap=RELEASED_OVERLAP[self._network.dataset])
