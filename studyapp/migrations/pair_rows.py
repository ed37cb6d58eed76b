"""Rows of the first schema, which knew pairs only, in the second one's shape and back."""

from __future__ import annotations

from typing import Any, Final

from studyapp.migrations.carrying import Row, Rows

SIDES: Final = ("left", "right")
OLD_KINDS: Final = ("practice", "main", "repeat", "catch")


def with_arms(old: Rows) -> Rows:
    """Return the rows of the first schema as the second one holds them, parents first.

    The design of what there is was never noted: version 1 has an empty digest until the study
    is served again.
    """
    numbers = {row["study_session_id"]: row["number"] for row in old["places"]}
    sessions = [_with_arm(row, numbers.get(row["id"])) for row in old["study_sessions"]]
    return {
        "study_versions": _unknown_version(sessions),
        "study_sessions": sessions,
        "places": [
            {
                "id": row["id"],
                "arm": row["comparison"],
                "design": "",
                "number": row["number"],
                "study_session_id": row["study_session_id"],
            }
            for row in old["places"]
        ],
        "trials": [_with_token(row) for row in old["trials"]],
        "videos": [
            {
                "id": row["id"],
                "trial_id": row["id"],
                "number": 1,
                "token": row["media_token"],
                "duration": row["duration"],
            }
            for row in old["trials"]
        ],
        "trial_stimuli": [shown for row in old["trials"] for shown in _stimuli(row)],
        "responses": [{**row, "stimulus": None, "reasons": []} for row in old["responses"]],
        "watch_batches": [
            {**_without(row, "trial_id"), "video_id": row["trial_id"]}
            for row in old["watch_batches"]
        ],
    }


def without_arms(new: Rows) -> Rows:
    """Return rows of the second schema as the first one holds them, parents first.

    Raises
    ------
    ValueError
        If something is stored that the first schema has no room for.
    """
    if new["form_answers"] or any(row["number"] > 1 for row in new["study_versions"]):
        raise ValueError("answers to forms, or more than one version, would be lost")
    conditions = {row["id"]: row["conditions"] for row in new["study_sessions"]}
    arms = {row["arm"]: row["conditions"] for row in new["study_sessions"]}
    if any(len(compared) != len(SIDES) for compared in conditions.values()):
        raise ValueError("study sessions that compare other than two conditions would be lost")
    videos, shown = _by_trial(new["videos"]), _by_trial(new["trial_stimuli"])
    trial_of = {row["id"]: row["trial_id"] for row in new["videos"]}
    return {
        "study_sessions": [
            {
                **_without(row, "version_id", "arm", "arm_design", "number", "conditions"),
                "comparison": row["arm"],
                "reference": row["conditions"][0],
                "other": row["conditions"][1],
            }
            for row in new["study_sessions"]
        ],
        "places": [
            {
                **_without(row, "arm", "design"),
                "comparison": row["arm"],
                "reference": arms[row["arm"]][0],
                "other": arms[row["arm"]][1],
            }
            # Places of an arm that nobody has entered are opened anew when they are needed.
            for row in new["places"]
            if row["arm"] in arms
        ],
        "trials": [
            _without_token(row, videos.get(row["id"], []), shown.get(row["id"], []))
            for row in new["trials"]
        ],
        "responses": [_without(row, "stimulus", "reasons") for row in new["responses"]],
        "watch_batches": [
            {**_without(row, "video_id"), "trial_id": trial_of[row["video_id"]]}
            for row in new["watch_batches"]
        ],
    }


def _unknown_version(sessions: list[Row]) -> list[Row]:
    if not sessions:
        return []
    opened = min(row["consented_at"] for row in sessions)
    version: Row = {"id": 1, "number": 1, "design": "", "definition": "", "operation": {}}
    return [{**version, "opened_at": opened}]


def _with_arm(row: Row, number: int | None) -> Row:
    return {
        **_without(row, "comparison", "reference", "other"),
        "version_id": 1,
        "arm": row["comparison"],
        "arm_design": "",
        "number": number,
        "conditions": [row["reference"], row["other"]],
    }


def _with_token(row: Row) -> Row:
    gone = ("left_condition", "right_condition", "duration", "media_token")
    expected = SIDES.index(row["expected"]) + 1 if row["expected"] else None
    return {
        **_without(row, *gone),
        "token": row["media_token"],
        "part": "",
        "expected": expected,
        "instructed": None,
    }


def _stimuli(row: Row) -> list[Row]:
    return [
        {
            "id": 2 * row["id"] + number - 2,
            "trial_id": row["id"],
            "video_id": row["id"],
            "number": number,
            "condition": row[f"{side}_condition"],
            "segment": row["segment"],
            "speech": row["segment"],
        }
        for number, side in enumerate(SIDES, start=1)
    ]


def _by_trial(rows: list[Row]) -> dict[int, list[Row]]:
    found: dict[int, list[Row]] = {}
    for row in rows:
        found.setdefault(row["trial_id"], []).append(row)
    return found


def _without_token(row: Row, videos: list[Row], shown: list[Row]) -> Row:
    if len(videos) != 1 or len(shown) != len(SIDES) or row["kind"] not in OLD_KINDS:
        raise ValueError("trials that are no composed pair would be lost")
    sides: Row = {f"{SIDES[s['number'] - 1]}_condition": s["condition"] for s in shown}
    expected = SIDES[row["expected"] - 1] if row["expected"] else ""
    return {
        **_without(row, "token", "part", "instructed"),
        **sides,
        "expected": expected,
        "duration": videos[0]["duration"],
        "media_token": videos[0]["token"],
    }


def _without(row: Row, *keys: str) -> dict[str, Any]:
    return {key: value for key, value in row.items() if key not in keys}
