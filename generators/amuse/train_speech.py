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

from generators.amuse.config import LABELS, SPEECH_PRESETS, Part, SpeechConfig
from generators.amuse.losses import (
    SpeechLosses,
    augmented,
    reconstruction_errors,
    speech_losses,
)
from generators.amuse.network_file import SpeechNetwork, write_speech_network
from generators.amuse.speech import (
    AnySpeechModel,
    HeardSpeech,
    SpeechAutoencoder,
    SpeechModel,
    ast_config,
    speech_model_of,
)
from generators.settings import content
from generators.teaching import best_step_said, cut_windows, learn, prepared_takes
from generators.trainable import TrainedGenerator, TrainingRequest
from motion.errors import InputError
from motion.listing import listed
from training.corpus.description import DESCRIPTION, read_request
from training.data.quadruples import quadruples
from training.data.take import TakeFolder
from training.data.windows import Windows
from training.features import speech_filterbank
from training.hearing.ast_weights import listen, read_ast_weights
from training.hearing.spectra import ROWS_PER_SECOND
from training.pretrained import WEIGHTS
from training.run.batch_order import evenly
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
    labels : mapping of str to tuple of str
        The classes: of ``emotion``, and of ``style`` the speakers.
    encoder_weights : mapping of str to Tensor
        What each encoder's transformer sets out from; empty where that is chance.
    """

    config: SpeechConfig
    weights: SpeechLosses
    fours: NDArray[np.int64]
    labels: Mapping[Part, tuple[str, ...]]
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
                    listen(encoder.transformer, seen)
        return network.to(self.device)

    def losses(self, network: AnySpeechModel, rows: NDArray[np.int64]) -> Mapping[str, Tensor]:
        """Return `speech_losses` of quadruples that chance masks, shifts and makes noisy.

        An auto-encoder rebuilds them as they are.
        """
        chosen = self.fours[rows].ravel()
        if isinstance(network, SpeechAutoencoder):
            return {"loss": network.missed(self._filterbanks(self.training, chosen))}
        four = (len(rows), 4)
        heard, target = (
            one.view(*four, *one.shape[1:])
            for one in augmented(self._filterbanks(self.training, chosen))
        )
        classes = self._classes(self.training, chosen).view(2, *four)
        return speech_losses(network, heard, target, classes, self.weights)

    def validation(self, network: AnySpeechModel) -> Mapping[str, float]:
        """Return what is measured of held-out windows.

        ``loss`` is what the filterbanks miss, and the cross entropies of emotion and style; then
        accuracies and F1 scores (macro), as in Table A.1, and `reconstruction_errors` of held-out
        quadruples, as in Table A.2. Of an auto-encoder, what it misses.
        """
        rows = self.measured
        if isinstance(network, SpeechAutoencoder):
            return {"loss": float(network.missed(self._filterbanks(self.held_out, rows)))}
        filterbanks, heard = self._heard(network, rows)
        found = {"self": float(functional.l1_loss(heard.reconstruction, filterbanks))}
        scores = {}
        classes = self._classes(self.held_out, rows)
        for short, kind, logits, true in zip(
            ("emo", "sty"), LABELS, (heard.emotion_logits, heard.style_logits), classes, strict=True
        ):
            found[short] = float(functional.cross_entropy(logits, true))
            told, named = logits.argmax(1).cpu().numpy(), true.cpu().numpy()
            scores[f"{kind} accuracy"] = float((told == named).mean())
            scores[f"{kind} F1"] = macro_f1(told, named)
        if len(fours := self.held_out_fours):
            filterbanks, heard = self._heard(network, fours.ravel())
            errors = reconstruction_errors(network.decoder, heard[:3], filterbanks, self.weights)
            scores |= {SELF: float(errors.pop("self"))}
            scores |= {name: float(error) for name, error in errors.items()}
        return {"loss": sum(found.values()), **found, **scores}

    @cached_property
    def measured(self) -> NDArray[np.int64]:
        """Rows of `held_out` that tell how well held-out recordings are known."""
        known = self.known(self.held_out)
        return known[evenly(len(known), HELD_OUT)]

    @cached_property
    def held_out_fours(self) -> NDArray[np.int64]:
        """Rows of `held_out`, (quadruples, 4); none where no two speakers share two texts there."""
        fours = quadruples(self.held_out, most=MOST, seed=0)
        fours = fours[np.isin(fours, self.known(self.held_out)).all(axis=1)]
        return fours[evenly(len(fours), HELD_OUT // 4)]

    def _heard(self, network: SpeechModel, rows: NDArray[np.int64]) -> tuple[Tensor, HeardSpeech]:
        """Return held-out filterbanks, and what is heard in them."""
        filterbanks = self._filterbanks(self.held_out, rows)
        heard = [network(part) for part in torch.split(filterbanks, _AT_ONCE)]
        return filterbanks, HeardSpeech(*(torch.cat(part) for part in zip(*heard, strict=True)))

    @torch.inference_mode()
    def mean_latents(self, model: AnySpeechModel) -> dict[str, dict[str, Tensor]]:
        """Return the mean latent of each emotion, and of each speaker's style."""
        if isinstance(model, SpeechAutoencoder):
            return {}
        rows = self.known(self.training)
        means: dict[str, dict[str, Tensor]] = {}
        for part, classes in zip(LABELS, self._classes(self.training, rows), strict=True):
            starts = range(0, len(rows), _AT_ONCE)
            heard = (self._filterbanks(self.training, rows[at : at + _AT_ONCE]) for at in starts)
            latents = torch.cat([model.latent(part, one) for one in heard])
            means[part] = {
                name: latents[classes == number].mean(dim=0).cpu()
                for number, name in enumerate(self.labels[part])
                if bool((classes == number).any())
            }
        return means

    def known(self, windows: Windows) -> NDArray[np.int64]:
        """Return the rows of windows whose emotion and speaker are among the classes."""
        takes = [windows.take_of(row) for row in range(len(windows))]
        fits = [
            all(getattr(take, of) in self.labels[part] for part, of in LABELS.items())
            for take in takes
        ]
        return np.flatnonzero(fits)

    def _filterbanks(self, windows: Windows, rows: NDArray[np.int64]) -> Tensor:
        values = torch.from_numpy(windows.batch(rows)["filterbank"])
        # The released size has a few rows more than ten seconds; they are empty.
        short = self.config.frames - values.shape[1]
        return functional.pad(values, (0, 0, 0, short)).to(self.device)

    def _classes(self, windows: Windows, rows: NDArray[np.int64]) -> Tensor:
        """Return the numbers of emotions and of speakers, (2, rows)."""
        takes = [windows.take_of(int(row)) for row in rows]
        classes = [
            [self.labels[part].index(getattr(take, of)) for take in takes]
            for part, of in LABELS.items()
        ]
        return torch.tensor(classes, device=self.device)


def macro_f1(told: NDArray[np.int64], true: NDArray[np.int64]) -> float:
    """Return the mean over classes of the harmonic mean of precision and recall."""
    scores = [
        2 * np.sum((told == one) & (true == one)) / (np.sum(told == one) + np.sum(true == one))
        for one in np.unique(true)
    ]
    return float(np.mean(scores))


def train_amuse_speech(request: TrainingRequest) -> TrainedGenerator:
    """Train AMUSE's speech model; see `generators.trainable.TrainGenerator`."""
    _check_texts(request.takes)
    preset, ablation = SPEECH_PRESETS[request.config], request.choices.get("ablation")
    weights, origin = _encoder_weights(request.choices, preset.network)
    features = (speech_filterbank(preset.network.bands),)
    prepared = prepared_takes(request, features, ROWS_PER_SECOND)
    frames, stride = (ROWS_PER_SECOND * seconds for seconds in (preset.seconds, preset.stride))
    cut = cut_windows(prepared, frames, stride)
    training = cut["training"]
    fours = quadruples(training, most=MOST, seed=preset.training.seed)
    if not len(fours):
        raise InputError(
            "no two speakers speak the same two texts in one emotion",
            remedy="Give recordings named as BEAT's are, or make a corpus with --shared-passages",
        )
    learned = [training.take_of(row) for row in range(len(training))]
    labels = {
        part: tuple(sorted({getattr(take, of) for take in learned} - {""}))
        for part, of in LABELS.items()
    }
    emotions, speakers = labels["emotion"], labels["style"]
    task = SpeechTask(
        config=replace(
            preset.network,
            emotions=len(emotions),
            styles=len(speakers),
            mfcc=MFCC if ablation == "mfcc" else 0,
        ),
        weights=SpeechLosses(emotion=ablation != "style_only", style=ablation != "emotion_only"),
        **cut,
        fours=fours,
        labels=labels,
        further={"emotions": list(emotions), "speakers": list(speakers), **origin},
        device=request.device,
        encoder_weights=weights,
    )
    if not len(task.measured):
        raise InputError(
            "no recording for validation is by a speaker and in an emotion that is learned",
            remedy="Give a split list (--split) with such recordings for validation",
        )
    config = preset.trained_on(task.examples, request.changes)
    trained, facts = learn(request, task, config, ("transformers",))
    network = SpeechNetwork(
        model=trained.network,
        latents=task.mean_latents(trained.network),
        training={**facts, **origin},
    )
    write_speech_network(request.out, network)
    return TrainedGenerator(
        sentences=(
            f"Learned from {len(fours)} fours of {len(training)} windows, by {len(speakers)} "
            f"speakers in {len(emotions)} emotions.",
            _measured_said(task, trained.best.measured),
            best_step_said(trained),
        ),
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
    weights = read_ast_weights(folder, ast_config(config))
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


def _measured_said(task: SpeechTask, found: Mapping[str, float]) -> str:
    heard = f"{len(task.measured)} held-out windows"
    if task.config.mfcc:
        return f"It misses the coefficients of {heard} by {found['loss']:.3f}."
    emotions, speakers = (f"(chance {1 / len(names):.0%})" for names in task.labels.values())
    said = (
        f"Of {heard} it tells the emotion of {found['emotion accuracy']:.0%} {emotions} and the "
        f"speaker of {found['style accuracy']:.0%} {speakers}; its filterbanks miss theirs by "
        f"{found['self']:.3f}."
    )
    if SELF not in found:
        return (
            f"{said} Errors of cross-reconstruction are left out: no two speakers speak two "
            "held-out texts in one emotion. A split list (--split) can hold out such texts."
        )
    names = {"xcon": "content", "xemo": "emotion", "xsty": "style"}
    crossed = [f"{found[one]:.3f} with another's {of}" for one, of in names.items() if one in found]
    return (
        f"{said} Those of {len(task.held_out_fours)} held-out fours miss theirs by "
        f"{found[SELF]:.3f}, and rebuilt from two recordings by {listed(crossed)}."
    )
