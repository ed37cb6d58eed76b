"""Which scores each paper's table shows, under which heading, and which way it calls better.

The names are those of this package's scores; a table can be made of the conditions' scores of the
preset with the same name. A direction is the paper's own: AMUSE calls the diversity near that of
recorded motion best, DiffSHEG the greatest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from analysis.evaluators import network_names as names
from analysis.metrics.result import Better


@dataclass(frozen=True, kw_only=True)
class TableColumn:
    """One column of a paper's table.

    Attributes
    ----------
    metric : str
        Name of the score.
    label : str
        How the paper heads the column.
    better : {'lower', 'higher', 'near the reference', 'unsaid'}
        Which scores the paper calls better.
    block : str
        Heading over several columns; empty where the table has none.
    """

    metric: str
    label: str
    better: Better
    block: str = ""


PAPER_TABLES: Final[Mapping[str, tuple[TableColumn, ...]]] = MappingProxyType(
    {
        # Chhatre et al. 2024, table 1; jerk from its supplement.
        "amuse": (
            TableColumn(
                metric="semantic-relevant gesture recall (amuse)", label="SRGR", better="higher"
            ),
            TableColumn(metric="beat alignment (amuse)", label="BA", better="higher"),
            TableColumn(metric=names.FGD_OF_EMOTION, label="FGD", better="lower"),
            TableColumn(metric=names.VARIANCE_OF_EMOTION, label="Div", better="near the reference"),
            TableColumn(metric=names.EMOTION_ACCURACY, label="GA", better="higher"),
            TableColumn(
                metric="jerk (hands, unfiltered)", label="jerk", better="near the reference"
            ),
        ),
        # Chen et al. 2024, table 1.
        "diffsheg": (
            TableColumn(metric=names.FMD, label="FMD", better="lower", block="Holistic"),
            TableColumn(metric=names.FED, label="FED", better="lower", block="Expression"),
            TableColumn(
                metric="mean distance between clips (expressions)",
                label="Div",
                better="higher",
                block="Expression",
            ),
            TableColumn(metric=names.FGD, label="FGD", better="lower", block="Gesture"),
            TableColumn(
                metric="beat alignment (beat)", label="BA", better="higher", block="Gesture"
            ),
            TableColumn(
                metric="percent of correct motion (diffsheg)",
                label="PCM",
                better="higher",
                block="Gesture",
            ),
            TableColumn(
                metric="semantic-relevant gesture recall (diffsheg)",
                label="SRGR",
                better="higher",
                block="Gesture",
            ),
            TableColumn(
                metric="mean distance between clips", label="Div", better="higher", block="Gesture"
            ),
        ),
        # Bhattacharya et al. 2024, table 1.
        "s2ue": (
            TableColumn(metric="mean absolute error (MALE, s2ue)", label="MALE", better="lower"),
            TableColumn(metric="mean absolute error (MAJE, s2ue)", label="MAJE", better="lower"),
            TableColumn(
                metric="mean acceleration error (MAcE-LM, s2ue)", label="MAcE-LM", better="lower"
            ),
            TableColumn(
                metric="mean acceleration error (MAcE-P, s2ue)", label="MAcE-P", better="lower"
            ),
            TableColumn(metric=names.FLD, label="FLD", better="lower"),
            TableColumn(metric=names.FGD, label="FGD", better="lower"),
        ),
        # Liu et al. 2022; the deviation from Liu et al. 2024 (EMAGE).
        "beat": (
            TableColumn(metric=names.FGD, label="FGD", better="lower"),
            TableColumn(
                metric="semantic-relevant gesture recall (beat)", label="SRGR", better="higher"
            ),
            TableColumn(metric="beat alignment (beat)", label="BeatAlign", better="higher"),
            TableColumn(
                metric="deviation from the mean pose (L1div)", label="L1div", better="higher"
            ),
        ),
        # Kucherenko et al. 2021, and later GENEA challenges.
        "genea": (
            TableColumn(metric="jerk (genea)", label="jerk", better="near the reference"),
            TableColumn(
                metric="acceleration (genea)", label="acceleration", better="near the reference"
            ),
            TableColumn(
                metric="distance of speed histograms (genea)", label="Hellinger", better="lower"
            ),
            TableColumn(metric=names.FGD, label="FGD", better="lower"),
        ),
    }
)
"""By preset; the mark of generative models in DiffSHEG's table is no score."""
