"""The report's numbers as CSV files for programs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict

import pandas as pd

from analysis.metrics.conditions import ConditionScore
from analysis.metrics.result import MetricResult
from analysis.preferences.clustered import ClusteredMean
from analysis.preferences.counts import LEVEL_NAMES
from analysis.preferences.win_share import Preference
from analysis.report.findings import Findings
from analysis.report.inputs import ReportInputs


def data_tables(inputs: ReportInputs, findings: Findings) -> dict[str, pd.DataFrame]:
    """Return every CSV table by file name; the first column says who answered."""
    tables = {
        "participant_flow.csv": _flow(inputs, findings),
        "exclusions.csv": _records(
            [asdict(exclusion) for exclusion in findings.exclusion.exclusions],
            ["study_session", "comparison", "rule", "reason"],
        ),
        "counts.csv": _records([_counts(p) for p in findings.preferences]),
        "preferences.csv": _records(
            [
                row
                for exclusions, found in (
                    ("applied", findings.preferences),
                    ("none", findings.everyone),
                )
                for row in _estimates(found, exclusions, inputs)
            ]
        ),
        "emotions.csv": _records(
            [{"emotion": p.emotion} | _place(p) | _mean(p.win_share) for p in findings.emotions]
        ),
        "segments.csv": _records([asdict(share) for share in findings.segments]),
        "side_bias.csv": _records(
            [
                {"question": bias.question, "reference_on_left": bias.reference_on_left}
                | _mean(bias.left_share, "left_share")
                for bias in findings.side_bias
            ]
        ),
        "metrics.csv": _records([_condition_score(score) for score in findings.metrics.conditions]),
        "metrics_by_clip.csv": _records(
            [
                {"condition": score.condition, "segment": score.segment} | _result(score.result)
                for score in findings.metrics.clips
            ]
        ),
        "responses_analysed.csv": findings.exclusion.analysed,
    }
    for table in tables.values():
        if "origin" not in table.columns:
            table.insert(0, "origin", inputs.origin)
    return tables


def _flow(inputs: ReportInputs, findings: Findings) -> pd.DataFrame:
    exclusion = findings.exclusion
    started = inputs.study_sessions
    rows = []
    for flow in exclusion.flow:
        row: dict[str, object] = {"comparison": flow.comparison}
        if started is not None:
            row["started"] = started.get(flow.comparison, flow.answered)
        row["answered"] = flow.answered
        row |= {
            f"removed_{outcome.rule.replace(' ', '_')}": removed
            for outcome, removed in zip(exclusion.outcomes, flow.removed, strict=True)
        }
        rows.append(row | {"analysed": flow.analysed})
    return _records(rows)


def _counts(preference: Preference) -> dict[str, object]:
    counts = preference.counts
    names = [level.replace(" ", "_") for level in LEVEL_NAMES]
    return (
        _place(preference)
        | {"answers": counts.total}
        | dict(zip(names, counts.levels, strict=True))
        | {
            "ours_percent": counts.ours,
            "indifferent_percent": counts.indifferent,
            "others_percent": counts.others,
        }
    )


def _estimates(
    found: Sequence[Preference], exclusions: str, inputs: ReportInputs
) -> Iterable[dict[str, object]]:
    for p in found:
        row = _place(p) | {"exclusions": exclusions} | _mean(p.win_share) | {"p_holm": p.holm_p}
        if inputs.truth:
            known = inputs.truth.get((p.comparison, p.question))
            row["true_win_share"] = known.share if known else None
            row["true_win_share_on_these_segments"] = known.on_these_segments if known else None
        yield row


def _place(preference: Preference) -> dict[str, object]:
    return {
        "comparison": preference.comparison,
        "reference": preference.reference,
        "other": preference.other,
        "question": preference.question,
    }


def _mean(mean: ClusteredMean, name: str = "win_share") -> dict[str, object]:
    fields = asdict(mean)
    return {name: fields.pop("estimate"), **fields}


def _condition_score(score: ConditionScore) -> dict[str, object]:
    return {
        "condition": score.condition,
        "metric": score.name,
        "unit": score.unit,
        "value": score.value,
        "spread_between_clips": score.spread,
        "clips_scored": score.scored,
        "clips": score.clips,
        "settings": _words(score.settings),
        "reason": score.reason,
    }


def _result(result: MetricResult) -> dict[str, object]:
    return {
        "metric": result.name,
        "unit": result.unit,
        "value": result.value,
        "n": result.n,
        "settings": _words(result.settings),
        "reason": result.reason,
    }


def _words(settings: Mapping[str, str]) -> str:
    return "; ".join(f"{key}: {value}" for key, value in settings.items())


def _records(rows: Sequence[dict[str, object]], columns: list[str] | None = None) -> pd.DataFrame:
    return pd.DataFrame.from_records(rows, columns=columns)
