"""Training AMUSE's speech model on fours of recordings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor
from torch.nn import functional

from generators.amuse.config import SPEECH_PRESETS, SpeechConfig
from generators.amuse.encoder_weights import WEIGHTS, read_encoder_weights
from generators.amuse.initialisation import listen
from generators.amuse.network_file import SpeechNetwork, write_speech_network
from generators.amuse.quadruples import quadruples
from generators.amuse.speech import (
    AnySpeechModel,
    SpeechAutoencoder,
    SpeechModel,
    speech_model_of,
)
from generators.amuse.speech_losses import (
    SpeechLosses,
    augmented,
    reconstruction_errors,
    speech_losses,
)
from generators.settings import content
from generators.teaching import learn, prepared_takes
from generators.trainable import TrainedGenerator, TrainingRequest
from motion.audio import read_audio
from motion.errors import InputError
from motion.listing import listed
from training.corpus.description import DESCRIPTION, read_request
from training.data.feature import Feature
from training.data.take import Take, TakeFolder
from training.data.windows import Windows
from training.hearing.spectra import ROWS_PER_SECOND, check_speech, filterbank
from training.hearing.speech_frames import at_speech_rate
from training.run.batch_order import evenly
from training.run.launching import is_leader
from training.window_task import WindowTask

MOST: Final = 20_000
"""Quadruples that are learned from, at most."""

HELD_OUT: Final = 64
"""At most so many windows tell how well held-out recordings are known."""

SEEN: Final = 200
"""At most so many windows tell what patches are like."""

SELF: Final = "self of fours"
"""Self-reconstruction error of the very windows whose latents are swapped."""

MFCC: Final = 13
"""Cepstral coefficients that an auto-encoder hears."""

_AT_ONCE: Final = 16


@dataclass(frozen=True, kw_only=True, eq=False)
class SpeechTask(WindowTask):
    """Learning to take speech apart, and to put it together again.

    Attributes
    ----------
    config : SpeechConfig
        The network.
    weights : SpeechLosses
        What is learned by.
    training, held_out : Windows
        Of the feature ``filterbank``.
    fours : ndarray, shape (quadruples, 4)
        Rows of `training`.
    emotions, speakers : tuple of str
        The classes.
    encoder_weights : mapping of str to Tensor
        What each encoder's transformer sets out from; empty where that is chance.
    """

    config: SpeechConfig
    weights: SpeechLosses
    fours: NDArray[np.int64]
    emotions: tuple[str, ...]
    speakers: tuple[str, ...]
    encoder_weights: Mapping[str, Tensor] = field(default_factory=dict)

    @property
    def examples(self) -> int:
        """Quadruples to learn from."""
        return len(self.fours)

    def network(self) -> AnySpeechModel:
        """Return a fresh network."""
        network = speech_model_of(self.config)
        if isinstance(network, SpeechModel):
            seen = self._filterbanks(self.training, evenly(len(self.training), SEEN))
            for encoder in (network.content, network.emotion, network.style):
                if self.encoder_weights:
                    encoder.transformer.load_state_dict(self.encoder_weights)
                else:
                    listen(encoder, seen)
        return network.to(self.device)

    def losses(self, network: AnySpeechModel, rows: NDArray[np.int64]) -> Mapping[str, Tensor]:
        """Return `speech_losses` of quadruples that chance masks, shifts and makes noisy.

        An auto-encoder rebuilds them as they are.
        """
        chosen = self.fours[rows].ravel()
        if isinstance(network, SpeechAutoencoder):
            return {"loss": network.missed(self._filterbanks(self.training, chosen))}
        shape = (len(rows), 4, self.config.frames, self.config.bands)
        heard, target = augmented(self._filterbanks(self.training, chosen))
        emotions, styles = (one.view(len(rows), 4) for one in self._classes(self.training, chosen))
        return speech_losses(
            network, heard.view(shape), target.view(shape), emotions, styles, self.weights
        )

    def validation(self, network: AnySpeechModel) -> Mapping[str, float]:
        """Return what is measured of held-out windows.

        ``loss`` is what the filterbanks miss, and the cross entropies of emotion and style; then
        accuracies and F1 scores (macro), as in Table A.1, and `reconstruction_errors` of held-out
        quadruples, as in Table A.2. Of an auto-encoder, what it misses.
        """
        known = self.known(self.held_out)
        rows = known[evenly(len(known), HELD_OUT)]
        if isinstance(network, SpeechAutoencoder):
            return {"loss": float(network.missed(self._filterbanks(self.held_out, rows)))}
        found = {"self": 0.0, "emo": 0.0, "sty": 0.0}
        named: dict[str, list[Tensor]] = {"emotion": [], "style": []}
        for first in range(0, len(rows), _AT_ONCE):
            part = rows[first : first + _AT_ONCE]
            filterbanks = self._filterbanks(self.held_out, part)
            emotions, styles = self._classes(self.held_out, part)
            heard = network(filterbanks)
            share = len(part) / len(rows)
            found["self"] += share * float(functional.l1_loss(heard.reconstruction, filterbanks))
            found["emo"] += share * float(functional.cross_entropy(heard.emotion_logits, emotions))
            found["sty"] += share * float(functional.cross_entropy(heard.style_logits, styles))
            named["emotion"].append(torch.stack([heard.emotion_logits.argmax(1), emotions]))
            named["style"].append(torch.stack([heard.style_logits.argmax(1), styles]))
        scores = {}
        for kind, pairs in named.items():
            told, true = torch.cat(pairs, dim=1).cpu().numpy()
            scores[f"{kind} accuracy"] = float((told == true).mean())
            scores[f"{kind} F1"] = macro_f1(told, true)
        return {"loss": sum(found.values()), **found, **scores, **self._rebuilt(network)}

    @cached_property
    def held_out_fours(self) -> NDArray[np.int64]:
        """Rows of `held_out`, (quadruples, 4); none where no two speakers share two texts there."""
        try:
            fours = quadruples(self.held_out, most=MOST, seed=0)
        except InputError:
            return np.empty((0, 4), dtype=np.int64)
        fours = fours[np.isin(fours, self.known(self.held_out)).all(axis=1)]
        return fours[evenly(len(fours), HELD_OUT // 4)]

    def _rebuilt(self, network: SpeechModel) -> dict[str, float]:
        """Return the `reconstruction_errors` of held-out quadruples, where there are any."""
        errors: dict[str, float] = {}
        for four in self.held_out_fours:
            filterbanks = self._filterbanks(self.held_out, four)
            heard = network(filterbanks)
            latents = (heard.content, heard.emotion, heard.style)
            missed = reconstruction_errors(network.decoder, latents, filterbanks, self.weights)
            for name, error in missed.items():
                key = SELF if name == "self" else name
                errors[key] = errors.get(key, 0.0) + float(error) / len(self.held_out_fours)
        return errors

    def mean_latents(self, model: AnySpeechModel) -> dict[str, dict[str, Tensor]]:
        """Return the mean latent of each emotion, and of each speaker's style."""
        if isinstance(model, SpeechAutoencoder):
            return {}
        rows = self.known(self.training)
        parts = [
            self._filterbanks(self.training, rows[first : first + _AT_ONCE])
            for first in range(0, len(rows), _AT_ONCE)
        ]
        emotions, styles = self._classes(self.training, rows)
        means = {}
        with torch.inference_mode():
            for part, classes, names in (
                ("emotion", emotions, self.emotions),
                ("style", styles, self.speakers),
            ):
                latents = torch.cat([getattr(model, part)(one)[0] for one in parts])
                means[part] = {
                    name: latents[classes == number].mean(dim=0).cpu()
                    for number, name in enumerate(names)
                    if bool((classes == number).any())
                }
        return means

    def known(self, windows: Windows) -> NDArray[np.int64]:
        """Return the rows of windows whose emotion and speaker are among the classes."""
        takes = [windows.take_of(row) for row in range(len(windows))]
        fits = [take.emotion in self.emotions and take.speaker in self.speakers for take in takes]
        return np.flatnonzero(fits)

    def _filterbanks(self, windows: Windows, rows: NDArray[np.int64]) -> Tensor:
        values = torch.from_numpy(windows.batch(rows)["filterbank"])
        # The released size has a few rows more than ten seconds; they are empty.
        short = self.config.frames - values.shape[1]
        return functional.pad(values, (0, 0, 0, short)).to(self.device)

    def _classes(self, windows: Windows, rows: NDArray[np.int64]) -> tuple[Tensor, Tensor]:
        takes = [windows.take_of(int(row)) for row in rows]
        emotions = [self.emotions.index(take.emotion) for take in takes]
        styles = [self.speakers.index(take.speaker) for take in takes]
        return (
            torch.tensor(emotions, device=self.device),
            torch.tensor(styles, device=self.device),
        )


def macro_f1(told: NDArray[np.int64], true: NDArray[np.int64]) -> float:
    """Return the mean over classes of the harmonic mean of precision and recall."""
    scores = []
    for one in np.unique(true):
        right = np.sum((told == one) & (true == one))
        scores.append(2 * right / (np.sum(told == one) + np.sum(true == one)))
    return float(np.mean(scores))


def speech_filterbank(bands: int) -> Feature:
    """Return the standardised filterbank of a take's speech, a row each 10 ms."""

    def compute(take: Take) -> NDArray[np.float32]:
        samples = at_speech_rate(read_audio(take.speech))
        check_speech(samples)
        rows = round(len(samples) / 16_000 * ROWS_PER_SECOND)
        return np.asarray(filterbank(samples, rows, bands).numpy(), dtype=np.float32)

    return Feature(name="filterbank", version=f"1 {bands}", compute=compute)


def train_amuse_speech(request: TrainingRequest) -> TrainedGenerator:
    """Train AMUSE's speech model; see `generators.trainable.TrainGenerator`."""
    _check_texts(request.takes)
    preset = SPEECH_PRESETS[request.config]
    ablation = request.choices.get("ablation")
    weights, origin = _encoder_weights(request.choices, preset.network)
    heard = speech_filterbank(preset.network.bands)
    prepared = prepared_takes(request, (heard,), ROWS_PER_SECOND)
    frames = preset.seconds * ROWS_PER_SECOND
    stride = preset.stride * ROWS_PER_SECOND
    training = Windows(prepared, split="train", frames=frames, stride=stride)
    learned = [training.take_of(row) for row in range(len(training))]
    emotions = tuple(sorted({take.emotion for take in learned if take.emotion}))
    speakers = tuple(sorted({take.speaker for take in learned}))
    held_out = Windows(prepared, split="validation", frames=frames, stride=frames)
    config = replace(
        preset.network,
        emotions=len(emotions),
        styles=len(speakers),
        mfcc=MFCC if ablation == "mfcc" else 0,
    )
    counted = SpeechLosses(emotion=ablation != "style_only", style=ablation != "emotion_only")
    task = SpeechTask(
        config=config,
        weights=counted,
        training=training,
        held_out=held_out,
        fours=quadruples(training, most=MOST, seed=preset.training.seed),
        emotions=emotions,
        speakers=speakers,
        further={"emotions": list(emotions), "speakers": list(speakers), **origin},
        device=request.device,
        encoder_weights=weights,
    )
    if not len(task.known(held_out)):
        raise InputError(
            "no recording for validation is by a speaker and in an emotion that is learned",
            remedy="Give a split list (--split) with such recordings for validation",
        )
    training_config = preset.trained_on(task.examples, request.changes)
    trained, facts = learn(request, task, training_config, ("transformers",))
    found = trained.best.measured
    if is_leader():
        network = SpeechNetwork(
            model=trained.network,
            latents=task.mean_latents(trained.network),
            training={**facts, **origin},
        )
        write_speech_network(request.out, network)
    return TrainedGenerator(
        sentences=_said(task, found, trained.best.step, trained.steps),
        warnings=(),
        skipped=prepared.skipped,
    )


def _encoder_weights(
    choices: Mapping[str, str], config: SpeechConfig
) -> tuple[Mapping[str, Tensor], Mapping[str, str]]:
    """Return what encoders set out from, and where it is from."""
    if "encoder_weights" not in choices:
        return {}, {}
    folder = Path(choices["encoder_weights"])
    if choices.get("ablation") == "mfcc":
        raise InputError(
            "an auto-encoder of cepstral coefficients has no encoders that could take weights",
            where=folder,
            remedy="Leave out --encoder-weights, or --ablation mfcc",
        )
    weights = read_encoder_weights(folder, config)
    return weights, {"encoder_weights": f"{folder.name} (sha256 {content(folder / WEIGHTS)})"}


def _check_texts(takes: TakeFolder) -> None:
    """Raise where names of recordings tell no texts: in a corpus whose speakers have their own."""
    for folder in takes.takes[0].speech.resolve().parents:
        if (folder / DESCRIPTION).exists() and not read_request(folder).shared_passages:
            raise InputError(
                "each speaker of this corpus speaks texts of their own, and a speech model learns "
                "from texts that several speak",
                where=folder,
                remedy="Make a corpus with 'motionjury corpus --shared-passages'",
            )


def _said(task: SpeechTask, found: Mapping[str, float], best: int, steps: int) -> tuple[str, ...]:
    heard = min(HELD_OUT, len(task.known(task.held_out)))
    if task.config.mfcc:
        said = f"It misses the coefficients of {heard} held-out windows by {found['loss']:.3f}."
    else:
        said = (
            f"Of {heard} held-out windows it tells the emotion of {found['emotion accuracy']:.0%} "
            f"(chance {1 / len(task.emotions):.0%}) and the speaker of "
            f"{found['style accuracy']:.0%} (chance {1 / len(task.speakers):.0%}); its filterbanks "
            f"miss theirs by {found['self']:.3f}. {_rebuilt_said(task, found)}"
        )
    return (
        f"Learned from {len(task.fours)} fours of {len(task.training)} windows, by "
        f"{len(task.speakers)} speakers in {len(task.emotions)} emotions.",
        said,
        f"Its weights are those of step {best} of {steps}.",
    )


def _rebuilt_said(task: SpeechTask, found: Mapping[str, float]) -> str:
    """Say Table A.2, or why it is left out."""
    if not len(task.held_out_fours):
        return (
            "Errors of cross-reconstruction are left out: no two speakers speak two held-out texts "
            "in one emotion. A split list (--split) can hold out such texts."
        )
    names = {"xcon": "content", "xemo": "emotion", "xsty": "style"}
    crossed = [f"{found[one]:.3f} with another's {of}" for one, of in names.items() if one in found]
    return (
        f"Those of {len(task.held_out_fours)} held-out fours miss theirs by {found[SELF]:.3f}, and "
        f"rebuilt from two recordings by {listed(crossed)}."
    )
