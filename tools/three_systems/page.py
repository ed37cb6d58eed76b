"""The measured part of the page of the study of three systems, in Markdown."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from analysis.report.sections.metric_table import TableColumn
from analysis.report.sections.metrics import PAPER_TABLES, TITLES
from motion.errors import listed
from studyapp.rehearsal.simulation.population import default_population
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study
from tools.markdown import rendered, table
from tools.three_systems.line import Took
from tools.three_systems.networks import Network

PAPERS: Final = ("amuse", "diffsheg", "s2ue")

_WHOSE: Final[Mapping[str, str]] = {
    "amuse": "AMUSE's",
    "diffsheg": "DiffSHEG's",
    "s2ue": "Speech2UnifiedExpressions'",
}
_ARROWS: Final[Mapping[str, str]] = {"lower": "↓", "higher": "↑", "near the reference": "→ gt"}
_SYSTEMS: Final[Mapping[str, str]] = {
    "amuse-speech": "AMUSE's speech model",
    "amuse": "AMUSE's motion",
    "diffsheg": "DiffSHEG",
    "s2ue": "Speech2UnifiedExpressions",
}


def measured(study: StudyFolder, took: Mapping[str, Took], networks: Sequence[Network]) -> str:
    """Return the measured part: pictures and tables.

    Parameters
    ----------
    study : StudyFolder
        A study with its rehearsal and its report.
    took : mapping of step to Took
        Times of the steps in order.
    networks : sequence of Network
        The networks used.
    """
    results = json.loads((study.report / "results.json").read_text("utf-8"))
    metrics = _Metrics.of(results)
    return rendered(
        "tools.three_systems",
        "three_systems.md",
        people=results["participants"],
        segments=len(study.segments()),
        preferences=_preferences(results, study.study()),
        papers=[(TITLES[paper], metrics.table(paper)) for paper in PAPERS],
        reasons=metrics.reasons(),
        times=_times(took),
        networks=table(("network", "updates", "kept", "from"), map(_network, networks)),
    )


@dataclass(frozen=True, kw_only=True)
class _Metrics:
    """A report's results on metrics.

    Attributes
    ----------
    scores : mapping of (condition, metric) to mapping
        Scores as in `results.json`.
    taus : mapping of (metric, question) to mapping
        Kendall's τ with people.
    conditions, questions : tuple of str
        Names in the order of `study.toml`.
    """

    scores: Mapping[tuple[str, str], Mapping[str, Any]]
    taus: Mapping[tuple[str, str], Mapping[str, Any]]
    conditions: tuple[str, ...]
    questions: tuple[str, ...]

    @classmethod
    def of(cls, results: Mapping[str, Any]) -> _Metrics:
        """Return the results in `results.json`."""
        return cls(
            scores={
                (entry["condition"], entry["metric"]): entry
                for entry in results["metrics"]["conditions"]
            },
            taus={
                (entry["metric"], question): entry["kendall"]
                for question, ranking_of_metrics in results["metrics_against_people"].items()
                for entry in ranking_of_metrics["metrics"]
            },
            conditions=tuple(results["conditions_shown"]),
            questions=tuple(results["questions"]),
        )

    def row(self, column: TableColumn) -> list[str]:
        """Return a metric's scores for all conditions and its agreement with each question."""
        name = column.metric
        scores = [self.scores.get((entry, name), {}) for entry in self.conditions]
        unit = next((entry["unit"] for entry in scores if entry.get("unit")), "")
        taus = [self.taus.get((name, question), {}) for question in self.questions]
        return [
            f"{column.block} {column.label}".strip() + (f", {unit}" if unit else ""),
            _ARROWS.get(column.better, ""),
            *(_number(entry.get("value")) for entry in scores),
            *(_number(entry.get("estimate"), ".2f") for entry in taus),
        ]

    def table(self, paper: str) -> str:
        """Return the table of a paper's metrics."""
        head = ("metric", "better", *(f"`{entry}`" for entry in self.conditions))
        taus = (f"τ, {question}" for question in self.questions)
        return table((*head, *taus), map(self.row, PAPER_TABLES[paper]))

    def reasons(self) -> list[str]:
        """Return each reason for missing scores and each remark once."""
        about: dict[str, dict[str, list[str]]] = {}
        for paper in PAPERS:
            for column in PAPER_TABLES[paper]:
                for condition in self.conditions:
                    entry = self.scores.get((condition, column.metric), {})
                    for why in filter(None, (entry.get("reason"), entry.get("remark"))):
                        whom = about.setdefault(why, {})
                        name = f"{_WHOSE[paper]} {column.label}"
                        whom.setdefault(name, []).append(f"`{condition}`")
        return [
            "; ".join(f"{name} of {listed(conditions)}" for name, conditions in whom.items())
            + f": {why.rstrip('.')}."
            for why, whom in about.items()
        ]


def _preferences(results: Mapping[str, Any], study: Study) -> str:
    true_values = default_population(study).quality
    questions = results["questions"]
    rows = []
    for condition in results["conditions_shown"]:
        row = [f"`{condition}`"]
        for question in questions:
            standings = results["bradley_terry"][question]["conditions"]
            standing = next(entry for entry in standings if entry["condition"] == condition)
            strength, low, high = (
                _number(standing[key], ".2f") for key in ("estimate", "low", "high")
            )
            true_value = _number(true_values[condition][question], ".2f")
            row += [true_value, f"{strength} [{low}, {high}]"]
        rows.append(row)
    heads = [f"{question}, {kind}" for question in questions for kind in ("true value", "estimate")]
    return table(("condition", *heads), rows)


def _times(took: Mapping[str, Took]) -> str:
    rows = [
        [f"`{name}`" if name.startswith("motionjury") else name, _duration(entry.processor)]
        for name, entry in took.items()
    ]
    rows.append(["all of it", _duration(sum(entry.processor for entry in took.values()))])
    return table(("step", "processor time"), rows)


def _network(network: Network) -> list[str]:
    facts = network.training
    steps = facts.get("config", {}).get("steps", "–")
    return [
        _SYSTEMS[network.name],
        str(steps),
        f"step {facts.get('best_step', steps)}",
        "given by path" if network.is_given else "trained by this page's command",
    ]


def _number(value: float | None, form: str = ".3g") -> str:
    if value is None or math.isnan(value):
        return "–"
    return f"{value:{form}}".replace("e+0", "e").replace("-", "−")


def _duration(seconds: float) -> str:
    minutes = seconds / 60
    return f"{seconds:.0f} s" if minutes < 2 else f"{minutes:.0f} min"
