from __future__ import annotations

import json
import math
from dataclasses import dataclass

import numpy as np
import pytest

from analysis.results.plain import as_json, plain


@dataclass(frozen=True)
class Result:
    b: float
    a: tuple[int, ...]


def test_missing_numbers_become_null() -> None:
    assert plain([math.nan, math.inf, np.float64("nan"), None]) == [None] * 4


def test_numbers_have_ten_digits_and_no_negative_zero() -> None:
    text = as_json({"third": np.float64(1) / 3, "zero": -0.0, "small": 1.23456789012e-20})
    assert json.loads(text) == {"third": 0.3333333333, "zero": 0.0, "small": 1.23456789e-20}
    assert "-0.0" not in text


def test_fields_keep_their_order() -> None:
    assert list(plain(Result(b=1.0, a=(np.int64(2),)))) == ["b", "a"]  # type: ignore[arg-type]


def test_what_json_does_not_know_is_refused() -> None:
    with pytest.raises(TypeError, match="set has no form in JSON"):
        plain({"who": {1, 2}})
