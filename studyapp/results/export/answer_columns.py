"""The main table of an export: one row for each answer."""

from __future__ import annotations

from typing import Final

from studyapp.results.export.columns import (
    ARM,
    EXCLUSION,
    KIND,
    PART,
    PARTICIPANT,
    POSITION,
    SEGMENT,
    STUDY_SESSION,
    VERSION,
    Column,
    TableColumns,
)

NO_PAIR: Final = "the trial does not show two stimuli to compare"
WHOLE_TRIAL: Final = "the answer is about the whole trial"
NO_VIDEO: Final = "nothing was reported of the videos"

_PAIR: Final = (
    Column(
        "comparison",
        "text",
        "The two conditions that are compared, the reference first.",
        missing=NO_PAIR,
    ),
    Column(
        "reference",
        "text",
        "Of the two conditions, the one that the study puts first; of a catch trial, the "
        "one that is plainly better.",
        missing=NO_PAIR,
    ),
    Column(
        "other",
        "text",
        "The other condition; of a catch trial, the visibly flawed one.",
        missing=NO_PAIR,
    ),
    Column(
        "left_condition", "text", "The condition shown on the left, labelled A.", missing=NO_PAIR
    ),
    Column(
        "right_condition", "text", "The condition shown on the right, labelled B.", missing=NO_PAIR
    ),
    Column(
        "left_speech",
        "text",
        "The segment whose speech was heard with the left video.",
        missing=f"{NO_PAIR}, or it was silent",
    ),
    Column(
        "right_speech",
        "text",
        "The segment whose speech was heard with the right video.",
        missing=f"{NO_PAIR}, or it was silent",
    ),
)

_ABOUT: Final = (
    Column(
        "stimulus",
        "integer",
        "Number of the stimulus that the answer is about: 1 is labelled A, 2 is B, and so on.",
        missing=WHOLE_TRIAL,
    ),
    Column("condition", "text", "The condition of that stimulus.", missing=WHOLE_TRIAL),
    Column(
        "speech",
        "text",
        "The segment whose speech was heard with that stimulus.",
        missing=f"{WHOLE_TRIAL}, or it was silent",
    ),
)

_ANSWER: Final = (
    Column("question", "text", "The question; the codebook has its wording."),
    Column(
        "value",
        "integer",
        "The answer; what its values mean is the question's, and stands with its wording.",
    ),
    Column(
        "reasons",
        "text",
        "Names of the reasons ticked beside the answer, separated by spaces; of an order, "
        "those ticked once for all of it.",
        missing="none was ticked, or none was offered",
    ),
    Column(
        "expected",
        "text",
        "Of a catch trial, where the plainly better stimulus was: left or right of a "
        "pair, else its number.",
        missing="no catch trial",
    ),
    Column(
        "instructed",
        "integer",
        "Of an attention check, the value that the page asked for.",
        missing="no attention check",
    ),
)

_TIME: Final = (
    Column("shown_at", "moment", "When the trial was first shown.", missing="that was not noted"),
    Column("answered_at", "moment", "When the answer was stored."),
    Column(
        "seconds",
        "number",
        "From the first showing of the trial to its answer.",
        unit="s",
        missing="that was not noted",
    ),
)

_WATCHED: Final = (
    Column(
        "watched",
        "number",
        "Share of all the trial's videos that counts as watched, in [0, 1], replays counted once.",
    ),
    Column(
        "watched_each",
        "text",
        "The same for each video, separated by spaces, in the order of the page; the "
        "reference comes first where one is shown.",
        missing=NO_VIDEO,
    ),
    Column(
        "times_played",
        "number",
        "Time played in any way, replays included, over the length of the videos.",
        missing=NO_VIDEO,
    ),
    Column("rate", "number", "Largest playback rate seen; 1 is as recorded.", missing=NO_VIDEO),
    Column(
        "hidden_seconds",
        "number",
        "How long videos played where nobody could see them.",
        unit="s",
        missing=NO_VIDEO,
    ),
    Column(
        "silent_seconds",
        "number",
        "How long videos played where nobody could hear them.",
        unit="s",
        missing=NO_VIDEO,
    ),
    Column(
        "stalls",
        "integer",
        "How often videos waited for data while they were meant to play.",
        missing=NO_VIDEO,
    ),
    Column("stalled_seconds", "number", "How long they waited in all.", unit="s", missing=NO_VIDEO),
)

ANSWERS: Final = TableColumns(
    name="",
    title="One answer to one question of one trial; of ratings and orders, about one stimulus.",
    columns=(
        *(PARTICIPANT, STUDY_SESSION, VERSION, ARM, PART, POSITION, KIND),
        SEGMENT,
        Column("emotion", "text", "With which emotion the segment is spoken."),
        Column(
            "speaker",
            "text",
            "Who speaks in the segment, as the study's table of segments names them.",
            missing="the study has no speech files",
        ),
        *_PAIR,
        *_ABOUT,
        *_ANSWER,
        *_TIME,
        *_WATCHED,
        Column(
            "analysed",
            "boolean",
            "Whether the report's results are computed from this answer: a main or "
            "repeated trial, of a participant who is not left out.",
            missing="the rules were not applied: withdrawn, or an earlier design",
        ),
        *EXCLUSION,
    ),
)
