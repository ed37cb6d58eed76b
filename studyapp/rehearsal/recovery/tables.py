"""The tables of what came of a rehearsal, as they are written."""

from __future__ import annotations

import pandas as pd

from studyapp.rehearsal.recovery.recovery import Recovery
from studyapp.rehearsal.simulation.kinds import DESCRIPTIONS


def recovery_tables(recovery: Recovery) -> dict[str, pd.DataFrame]:
    """Return every table under the name of its file."""
    return {
        "values.csv": _values(recovery),
        "differences.csv": _differences(recovery),
        "raters.csv": _raters(recovery),
        "bookkeeping.csv": _bookkeeping(recovery),
    }


def _values(recovery: Recovery) -> pd.DataFrame:
    return pd.DataFrame(
        [
            {
                "part": known.part,
                "question": known.question,
                "measure": known.measure,
                "about": known.about,
                "put_in": known.value,
                "put_in_on_these_segments": known.on_these_segments,
                "found": found.estimate,
                "low": found.low,
                "high": found.high,
                "inside": found.covers(known.value) if found.has_interval else None,
                "participants": found.participants,
                "reason": found.reason,
            }
            for known, found in recovery.values
        ],
        columns=[
            *("part", "question", "measure", "about", "put_in", "put_in_on_these_segments"),
            *("found", "low", "high", "inside", "participants", "reason"),
        ],
    )


def _differences(recovery: Recovery) -> pd.DataFrame:
    return pd.DataFrame(
        [
            {
                "part": each.part,
                "question": each.question,
                "measure": each.measure,
                "first": each.first,
                "second": each.second,
                "put_in": each.truth,
                "found": each.found.estimate,
                "low": each.found.low,
                "high": each.found.high,
                "sign": each.sign,
                "participants": each.found.participants,
                "reason": each.found.reason,
            }
            for each in recovery.differences
        ],
        columns=[
            *("part", "question", "measure", "first", "second", "put_in", "found", "low", "high"),
            *("sign", "participants", "reason"),
        ],
    )


def _raters(recovery: Recovery) -> pd.DataFrame:
    rules = sorted({rule for kind in recovery.kinds for rule in kind.excluded_by})
    return pd.DataFrame(
        [
            {
                "kind": kind.kind,
                "description": DESCRIPTIONS[kind.kind],
                "came": kind.came,
                "completed": kind.completed,
                "no_answer": kind.silent,
                "analysed": kind.analysed,
                "excluded": kind.excluded,
                **{f"excluded_by_{rule}": kind.excluded_by.get(rule, 0) for rule in rules},
                "missed": kind.missed,
                "wrongly_excluded": kind.wrongly_excluded,
            }
            for kind in recovery.kinds
        ]
    )


def _bookkeeping(recovery: Recovery) -> pd.DataFrame:
    return pd.DataFrame(
        [
            {
                "what": check.what,
                "happened": check.happened,
                "counted": check.counted,
                "agrees": check.agrees,
                "remark": check.remark,
            }
            for check in recovery.checks
        ]
    )
