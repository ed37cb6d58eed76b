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


@dataclass(frozen=True)
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
            TableColumn("semantic-relevant gesture recall (amuse)", "SRGR", "higher"),
            TableColumn("beat alignment (amuse)", "BA", "higher"),
            TableColumn(names.FGD_OF_EMOTION, "FGD", "lower"),
            TableColumn(names.VARIANCE_OF_EMOTION, "Div", "near the reference"),
            TableColumn(names.EMOTION_ACCURACY, "GA", "higher"),
            TableColumn("jerk (hands, unfiltered)", "jerk", "near the reference"),
        ),
        # Chen et al. 2024, table 1.
        "diffsheg": (
            TableColumn(names.FMD, "FMD", "lower", "Holistic"),
            TableColumn(names.FED, "FED", "lower", "Expression"),
            TableColumn("mean distance between clips (expressions)", "Div", "higher", "Expression"),
            TableColumn(names.FGD, "FGD", "lower", "Gesture"),
            TableColumn("beat alignment (beat)", "BA", "higher", "Gesture"),
            TableColumn("percent of correct motion (diffsheg)", "PCM", "higher", "Gesture"),
            TableColumn("semantic-relevant gesture recall (diffsheg)", "SRGR", "higher", "Gesture"),
            TableColumn("mean distance between clips", "Div", "higher", "Gesture"),
        ),
        # Bhattacharya et al. 2024, table 1.
        "s2ue": (
            TableColumn("mean absolute error (MALE, s2ue)", "MALE", "lower"),
            TableColumn("mean absolute error (MAJE, s2ue)", "MAJE", "lower"),
            TableColumn("mean acceleration error (MAcE-LM, s2ue)", "MAcE-LM", "lower"),
            TableColumn("mean acceleration error (MAcE-P, s2ue)", "MAcE-P", "lower"),
            TableColumn(names.FLD, "FLD", "lower"),
            TableColumn(names.FGD, "FGD", "lower"),
        ),
        # Liu et al. 2022; the deviation from Liu et al. 2024 (EMAGE).
        "beat": (
            TableColumn(names.FGD, "FGD", "lower"),
            TableColumn("semantic-relevant gesture recall (beat)", "SRGR", "higher"),
            TableColumn("beat alignment (beat)", "BeatAlign", "higher"),
            TableColumn("deviation from the mean pose (L1div)", "L1div", "higher"),
        ),
        # Kucherenko et al. 2021, and later GENEA challenges.
        "genea": (
            TableColumn("jerk (genea)", "jerk", "near the reference"),
            TableColumn("acceleration (genea)", "acceleration", "near the reference"),
            TableColumn("distance of speed histograms (genea)", "Hellinger", "lower"),
            TableColumn(names.FGD, "FGD", "lower"),
        ),
    }
)
"""By preset; the mark of generative models in DiffSHEG's table is no score."""
