"""Straight-lining: participants who give the same answer again and again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd


@dataclass(frozen=True, kw_only=True)
class StraightLine:
    """How alike one participant's answers are.

    Attributes
    ----------
    participant : str
        Whose.
    answers : int
        How many were given.
    longest_run : int
        Most equal answers to one question in a row.
    run_share : float
        That run as a share of the answers to that question, in (0, 1].
    commonest : int
        The most frequent answer; of equally frequent ones, the smallest.
    commonest_share : float
        Its share of all answers, in (0, 1].
    """

    participant: str
    answers: int
    longest_run: int
    run_share: float
    commonest: int
    commonest_share: float


def straight_lining(answers: pd.DataFrame) -> tuple[StraightLine, ...]:
    """Measure how alike each participant's answers are, in the order of appearance.

    Parameters
    ----------
    answers : DataFrame
        Columns `participant`, `question` and `value`, as it was chosen on the page (the side, not
        the condition); rows in the order of answering within each participant and question.
    """
    if answers.empty:
        return ()
    people, names = pd.factorize(answers["participant"])
    questions = pd.factorize(answers["question"])[0]
    values = answers["value"].to_numpy(np.int64)
    lists = people * (questions.max() + 1) + questions
    order = np.argsort(lists, kind="stable")
    lists, values, people = lists[order], values[order], people[order]
    starts = np.flatnonzero(
        np.concatenate([[True], (np.diff(values) != 0) | (np.diff(lists) != 0)])
    )
    runs = pd.DataFrame(
        {
            "participant": people[starts],
            "list": lists[starts],
            "length": np.diff(np.append(starts, len(values))),
        }
    )
    runs["share"] = runs["length"] / runs.groupby("list")["length"].transform("sum")
    longest = runs.sort_values(["participant", "length", "share"]).groupby("participant").last()
    counts = pd.DataFrame({"participant": people, "value": values}).value_counts()
    commonest = (
        counts.rename("count")
        .reset_index()
        .sort_values(["participant", "count", "value"], ascending=[True, False, True])
        .groupby("participant")
        .first()
    )
    return tuple(
        StraightLine(
            participant=str(name),
            answers=int(total),
            longest_run=int(run),
            run_share=float(share),
            commonest=int(value),
            commonest_share=float(count / total),
        )
        for name, total, run, share, value, count in zip(
            names,
            np.bincount(people),
            longest["length"].to_numpy(np.int64),
            longest["share"].to_numpy(np.float64),
            commonest["value"].to_numpy(np.int64),
            commonest["count"].to_numpy(np.int64),
            strict=True,
        )
    )
