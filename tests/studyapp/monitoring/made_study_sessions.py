"""Study sessions for tests of pure functions."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import Any

from studyapp.monitoring.study_sessions import SessionProgress, Standing

NOON = datetime(2026, 5, 4, 12, tzinfo=UTC)


def session_progress(standing: Standing, settled: int = 0, **changes: Any) -> SessionProgress:
    """Return a study session of ten trials that began at noon."""
    values: dict[str, Any] = {
        "id": 1,
        "arm": "a-b",
        "present": True,
        "standing": standing,
        "consented_at": NOON,
        "started_at": NOON,
        "last_active_at": NOON,
        "completed_at": NOON + timedelta(minutes=10) if standing == "done" else None,
        "trials": 10,
        "settled": settled,
    }
    return SessionProgress(**(values | changes))
