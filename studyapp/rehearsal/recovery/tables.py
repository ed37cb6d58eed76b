"""The tables of what came of a rehearsal."""

from __future__ import annotations

import pandas as pd

from studyapp.rehearsal.recovery.recovery import Recovery
from studyapp.rehearsal.simulation.kinds import DESCRIPTIONS

VALUES = (
    *("part", "question", "measure", "about", "put_in", "put_in_on_these_segments"),
    *("found", "low", "high", "inside", "participants", "reason"),
)
DIFFERENCES = (
    *("part", "question", "measure", "first", "second", "put_in", "found", "low", "high"),
    *("sign", "participants", "reason"),
)


def recovery_tables(recovery: Recovery) -> dict[str, pd.DataFrame]:
    """Return every table under the name of its file."""
    return {
        "values.csv": _values(recovery),
        "differences.csv": _differences(recovery),
        "raters.csv": _raters(recovery),
        "bookkeeping.csv": pd.DataFrame(
            [vars(check) | {"agrees": check.agrees} for check in recovery.checks],
            columns=["what", "happened", "counted", "agrees", "remark"],
        ),
    }


def _values(recovery: Recovery) -> pd.DataFrame:
    rows = [
        vars(known)
        | vars(found)
        | {
            "put_in": known.value,
            "put_in_on_these_segments": known.on_these_segments,
            "found": found.estimate,
            "inside": found.covers(known.value) if found.has_interval else None,
        }
        for known, found in recovery.values
    ]
    return pd.DataFrame(rows, columns=VALUES)


def _differences(recovery: Recovery) -> pd.DataFrame:
    rows = [
        vars(each)
        | vars(each.found)
        | {"put_in": each.truth, "found": each.found.estimate, "sign": each.sign}
        for each in recovery.differences
    ]
    return pd.DataFrame(rows, columns=DIFFERENCES)


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
