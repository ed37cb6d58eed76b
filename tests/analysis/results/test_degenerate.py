import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.results.report import as_json
from tests.analysis.results.made_tables import TABLES, one_answer_everywhere, report_of

Change = Callable[[pd.DataFrame], pd.DataFrame]

OF_STUDIES_ALONE = "flow"
"""Of a table it holds nothing that only a study knows."""

SAID_BESIDE = {"share": "win_share", "set": None, "settings": None}
"""Numbers whose neighbour says why they are missing; None: what may always be missing."""


def says_why(result: dict[str, Any]) -> bool:
    return bool(result.get("reason") or result.get("remark"))


def _result(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}


def nulls_without_reason(value: Any, where: str = "") -> Iterator[str]:
    """Yield the paths of missing numbers without a reason."""
    if isinstance(value, list):
        for number, one in enumerate(value):
            yield from nulls_without_reason(one, f"{where}[{number}]")
    if not isinstance(value, dict):
        return
    for name, one in value.items():
        if name == OF_STUDIES_ALONE:
            continue
        own = isinstance(one, dict) and ("reason" in one or "remark" in one)
        numbers = list(one.values()) if isinstance(one, dict) and not own else [one]
        if None in numbers:
            beside = SAID_BESIDE.get(name, name)
            if beside and not says_why(value) and not says_why(_result(value.get(beside))):
                yield f"{where}.{name}"
        if own or None not in numbers:
            yield from nulls_without_reason(one, f"{where}.{name}")


def separated(table: pd.DataFrame) -> pd.DataFrame:
    """The first condition, or the own speech, always wins."""
    if "rank" in table:
        places = {name: place for place, name in enumerate(table["condition"].unique(), 1)}
        return table.assign(rank=table["condition"].map(places))
    if "left_speech" in table:
        return table.assign(response=table["left_speech"].map({"own": 1, "other": 5}))
    if "left" in table:
        order = list(pd.unique(table[["left", "right"]].to_numpy().ravel()))
        better = table["left"].map(order.index) < table["right"].map(order.index)
        return table.assign(response=better.map({True: 1, False: 5}))
    first = table["condition"].iloc[0]
    return table.assign(response=(table["condition"] == first).map({True: 5, False: 1}))


def few_conditions(table: pd.DataFrame) -> pd.DataFrame:
    if "left" in table:
        return table[table["left"].isin(["ours", "other"]) & table["right"].isin(["ours", "other"])]
    return table[table["condition"].isin(table["condition"].iloc[:1])]


def same_side(table: pd.DataFrame) -> pd.DataFrame:
    if "left_speech" in table:
        return table.assign(left_speech="own", right_speech="other")
    if "left" in table:
        swapped = table[["left", "right"]].apply(sorted, axis=1, result_type="expand")
        return table.assign(left=swapped[0], right=swapped[1])
    return table


def disconnected(table: pd.DataFrame) -> pd.DataFrame:
    """Half of the participants answer about other conditions."""
    names = [name for name in ("participant", "left", "right", "condition") if name in table]
    others = table.copy()
    others[names] = "z" + others[names]
    return pd.concat([table, others])


CHANGES: dict[str, Change] = {
    "empty": lambda table: table.iloc[:0],
    "one participant": lambda table: table[table["participant"] == "p00"],
    "one segment": lambda table: table[table["segment"] == "s3"],
    "one answer": lambda table: table[table["segment"] == "s3"].iloc[:1],
    "few conditions": few_conditions,
    "one answer everywhere": one_answer_everywhere,
    "perfectly separated": separated,
    "always the same side": same_side,
    "half finished": lambda table: table.sample(frac=0.4, random_state=1),
    "practice alone": lambda table: table.assign(kind="practice"),
    "everybody excluded": lambda table: table.assign(excluded="true"),
    "disconnected": disconnected,
    "two sets": lambda table: table.assign(set=(table["segment"] > "s2").map(str)),
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("protocol", TABLES)
def test_every_missing_number_has_a_reason_for_any_answers(
    protocol: str, change: str, tmp_path: Path
) -> None:
    table = CHANGES[change](TABLES[protocol](participants=4, segments=4))
    margin = 0.1 if protocol in ("pairwise", "rating") else None

    report = report_of(table, protocol, tmp_path, margin=margin)
    text = as_json(report.keys())

    assert "NaN" not in text
    assert "Infinity" not in text
    assert list(nulls_without_reason(json.loads(text))) == []


def test_numbers_have_ten_digits_and_no_negative_zero() -> None:
    text = as_json({"third": np.float64(1) / 3, "zero": -0.0, "small": 1.23456789012e-20})
    assert json.loads(text) == {"third": 0.3333333333, "zero": 0.0, "small": 1.23456789e-20}
    assert "-0.0" not in text
