"""Training AMUSE's speech model on quadruples of recordings."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from generators.amuse import losses, speech
from generators.amuse.config import LABELS, SPEECH_PRESETS, SpeechConfig
from generators.amuse.network_file import SpeechNetwork, write_speech
from generators.amuse.speech import AnySpeechModel, SpeechAutoencoder, SpeechModel, SpeechOutput
from generators.learned import cut_windows, describe_training, run_training
from generators.registry import TrainedGenerator, TrainingRequest
from generators.settings import content
from motion.arrays import Ints
from motion.errors import InputError, listed
from training.data.labelled_windows import Classes, check_texts, macro_f1, quadruples
from training.data.windows import Windows
from training.features import speech_filterbank
from training.released_weights import WEIGHTS
from training.run.batches import evenly_spaced
from training.run.task import WindowTask
from training.speech_features.spectra import ROWS_PER_SECOND
from training.speech_features.spectrogram_transformer import (
    augment,
    initialise_from_speech,
    read_ast_weights,
)

MOST_QUADRUPLES: Final = 20_000
"""Largest number of training quadruples."""

MOST_HELD_OUT: Final = 64
"""Largest number of windows for validation."""

MOST_INITIAL: Final = 200
"""Largest number of windows for initial weights."""

SELF_ERROR: Final = "self of fours"
"""Self-reconstruction error of the windows whose latents are exchanged."""

MFCC: Final = 13
"""Number of cepstral coefficients of the auto-encoder."""

_AT_ONCE: Final = 16


@dataclass(frozen=True, kw_only=True, eq=False)
class SpeechTask(WindowTask):
    """Learning to disentangle speech and to reconstruct it.

    Attributes
    ----------
    config : SpeechConfig
        The network.
    weights : mapping of str to float
        Weights of the losses.
    training, held_out : Windows
        Windows of the feature ``filterbank``.
    quadruples : ndarray, shape (quadruples, 4)
        Rows of `training`.
    classes : Classes
        The emotions and the speakers.
    encoder_weights : mapping of str to Tensor
        Initial weights of each encoder's transformer; empty for random ones.
    """

    config: SpeechConfig
    weights: Mapping[str, float]
    quadruples: Ints
    classes: Classes
    encoder_weights: Mapping[str, Tensor] = field(default_factory=dict)

    @property
    def examples(self) -> int:
        """The number of training quadruples."""
        return len(self.quadruples)

    def network(self) -> AnySpeechModel:
        """Return a new network."""
        network = speech.make_speech_model(self.config)
        if isinstance(network, SpeechModel):
            # Initial weights are computed on the CPU, so that they do not depend on the device.
            on_cpu = replace(self, device="cpu")
            filterbanks = on_cpu._filterbanks(
                self.training, evenly_spaced(len(self.training), MOST_INITIAL)
            )
            for encoder in (network.content, network.emotion, network.style):
                if self.encoder_weights:
                    encoder.transformer.load_state_dict(self.encoder_weights)
                else:
                    initialise_from_speech(encoder.transformer, filterbanks)
        return network.to(self.device)

    def losses(self, network: AnySpeechModel, rows: Ints, name: str = "") -> Mapping[str, Tensor]:
        """Return `speech_losses` of quadruples with random masks, shifts and noise.

        An auto-encoder reconstructs them unchanged.
        """
        windows = self.quadruples[rows].ravel()
        filterbanks = self._filterbanks(self.training, windows)
        if isinstance(network, SpeechAutoencoder):
            return {"loss": network.reconstruction_error(filterbanks)}
        numbers = self._numbers(self.training, windows)
        return losses.speech_losses(network, *augment(filterbanks), numbers, self.weights)

    def validation(self, network: AnySpeechModel) -> Mapping[str, float]:
        """Return the measures of held-out windows.

        ``loss`` is the reconstruction error plus the cross entropies of emotion and style. Others
        are accuracies and macro F1 scores, as in Table A.1, and `reconstruction_errors` of held-out
        quadruples, as in Table A.2. An auto-encoder has only its reconstruction error.
        """
        rows = self.validation_rows
        if isinstance(network, SpeechAutoencoder):
            return {
                "loss": float(network.reconstruction_error(self._filterbanks(self.held_out, rows)))
            }
        filterbanks, out = self._encode(network, rows)
        losses_by_name = {"self": float(functional.l1_loss(out.reconstruction, filterbanks))}
        scores: dict[str, float] = {}
        numbers = self._numbers(self.held_out, rows)
        for short, kind, logits, true in zip(
            ("emo", "sty"), LABELS, (out.emotion_logits, out.style_logits), numbers, strict=True
        ):
            losses_by_name[short] = float(functional.cross_entropy(logits, true))
            predicted, actual = logits.argmax(1).cpu().numpy(), true.cpu().numpy()
            scores |= {f"{kind} accuracy": float((predicted == actual).mean())}
            scores |= {f"{kind} F1": macro_f1(predicted, actual)}
        if len(held_out := self.held_out_quadruples):
            filterbanks, out = self._encode(network, held_out.ravel())
            errors = losses.reconstruction_errors(network.decoder, out, filterbanks, self.weights)
            scores |= {SELF_ERROR: float(errors.pop("self"))}
            scores |= {name: float(error) for name, error in errors.items()}
        return {"loss": sum(losses_by_name.values()), **losses_by_name, **scores}

    @cached_property
    def validation_rows(self) -> Ints:
        """Rows of `held_out` for validation."""
        labelled = self.classes.labelled_rows(self.held_out)
        return labelled[evenly_spaced(len(labelled), MOST_HELD_OUT)]

    @cached_property
    def held_out_quadruples(self) -> Ints:
        """Rows of `held_out`, (quadruples, 4); empty if no two speakers share two texts there."""
        rows = quadruples(self.held_out, limit=MOST_QUADRUPLES, seed=0)
        rows = rows[np.isin(rows, self.classes.labelled_rows(self.held_out)).all(axis=1)]
        return rows[evenly_spaced(len(rows), MOST_HELD_OUT // 4)]

    def _encode(self, network: SpeechModel, rows: Ints) -> tuple[Tensor, SpeechOutput]:
        """Return held-out filterbanks and their latents."""
        filterbanks = self._filterbanks(self.held_out, rows)
        outputs = [network(part) for part in torch.split(filterbanks, _AT_ONCE)]
        return filterbanks, SpeechOutput(*(torch.cat(part) for part in zip(*outputs, strict=True)))

    @torch.inference_mode()
    def mean_latents(self, model: AnySpeechModel) -> dict[str, dict[str, Tensor]]:
        """Return the mean latent of each emotion, and of each speaker's style."""
        if isinstance(model, SpeechAutoencoder):
            return {}
        rows = self.classes.labelled_rows(self.training)
        parts = [rows[first : first + _AT_ONCE] for first in range(0, len(rows), _AT_ONCE)]
        means: dict[str, dict[str, Tensor]] = {}
        for part, numbers in zip(LABELS, self._numbers(self.training, rows), strict=True):
            z = [model.latent(part, self._filterbanks(self.training, batch)) for batch in parts]
            means[part] = self.classes.means(LABELS[part], torch.cat(z).cpu(), numbers.cpu())
        return means

    def _filterbanks(self, windows: Windows, rows: Ints) -> Tensor:
        values = self.tensors(windows, rows)["filterbank"]
        # The released size has a few more rows than ten seconds; they are empty.
        return functional.pad(values, (0, 0, 0, self.config.frames - values.shape[1]))

    def _numbers(self, windows: Windows, rows: Ints) -> Tensor:
        """Return the numbers of emotions and of speakers, (2, rows)."""
        return torch.from_numpy(self.classes.numbers(windows, rows)).to(self.device)


def train_amuse_speech(request: TrainingRequest) -> TrainedGenerator:
    """Train AMUSE's speech model; see `generators.registry.TrainGenerator`."""
    check_texts(request.takes)
    preset, ablation = SPEECH_PRESETS[request.config], request.choices.get("ablation", "")
    mfcc = MFCC if ablation == "mfcc" else 0
    config = replace(preset.network, mfcc=mfcc)
    weights, origin = _encoder_weights(request.choices.get("encoder_weights"), config)
    frames, stride = (ROWS_PER_SECOND * seconds for seconds in (preset.seconds, preset.stride))
    features = (speech_filterbank(config.bands),)
    windows = cut_windows(request, features, ROWS_PER_SECOND, frames, stride)
    training = windows["training"]
    rows = quadruples(training, limit=MOST_QUADRUPLES, seed=preset.training.seed, required=True)
    classes = Classes.from_windows(training, LABELS.values())
    emotions, speakers = classes.names.values()
    task = SpeechTask(
        config=replace(config, emotions=len(emotions), styles=len(speakers)),
        weights=losses.without(losses.SPEECH_LOSSES, ablation),
        quadruples=rows,
        classes=classes,
        extra_settings={"emotions": list(emotions), "speakers": list(speakers), **origin},
        encoder_weights=weights,
        **windows,
    )
    if not len(task.validation_rows):
        raise InputError(
            "no recording for validation has both a speaker and an emotion of the training",
            remedy="Give a split list (--split) with such recordings for validation",
        )
    schedule = preset.config_for(task.examples, request.changes)
    trained, facts = run_training(request, task, schedule)
    network, z = trained.network, task.mean_latents(trained.network)
    write_speech(request.out, SpeechNetwork(model=network, latents=z, training={**facts, **origin}))
    return describe_training(
        task,
        trained,
        f"They form {len(rows)} quadruples in {len(emotions)} emotions.",
        _describe_measures(task, trained.best.measured),
    )


def _encoder_weights(
    path: str | None, config: SpeechConfig
) -> tuple[Mapping[str, Tensor], Mapping[str, str]]:
    """Return the encoders' initial weights, and their origin."""
    if path is None:
        return {}, {}
    folder = Path(path)
    if config.mfcc:
        raise InputError(
            "an auto-encoder of cepstral coefficients has no encoders to initialise",
            where=folder,
            remedy="Leave out --encoder-weights, or --ablation mfcc",
        )
    weights = read_ast_weights(folder, speech.ast_config(config))
    return weights, {"encoder_weights": f"{folder.name} (sha256 {content(folder / WEIGHTS)})"}


def _describe_measures(task: SpeechTask, measured: Mapping[str, float]) -> str:
    windows = f"{len(task.validation_rows)} held-out windows"
    if task.config.mfcc:
        return f"Its reconstruction error in {windows} is {measured['loss']:.3f}."
    emotion_chance, speaker_chance = (1 / len(names) for names in task.classes.names.values())
    summary = (
        f"In {windows} it recognises the emotion of {measured['emotion accuracy']:.0%} (chance "
        f"{emotion_chance:.0%}) and the speaker of {measured['style accuracy']:.0%} (chance "
        f"{speaker_chance:.0%}); its reconstruction error is {measured['self']:.3f}."
    )
    if SELF_ERROR not in measured:
        return summary
    parts = {name: part for name, (part, _) in losses.CROSSED.items() if name in measured}
    errors = [f"{measured[name]:.3f} with another's {part}" for name, part in parts.items()]
    return (
        f"{summary} In {len(task.held_out_quadruples)} held-out quadruples it is "
        f"{measured[SELF_ERROR]:.3f}, and with parts of two recordings "
        f"{listed(errors)}."
    )
