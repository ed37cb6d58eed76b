"""Applications of tests, which start quickly and do not wait for the disk."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from types import CodeType
from typing import Any

import pytest
from flask import Flask
from jinja2.bccache import Bucket, BytecodeCache
from sqlalchemy import Engine, event

from studyapp.database import sqlite


class _SharedTemplates(BytecodeCache):
    def __init__(self) -> None:
        self._compiled: dict[tuple[str, str], CodeType] = {}

    def load_bytecode(self, bucket: Bucket) -> None:
        bucket.code = self._compiled.get((bucket.key, bucket.checksum))

    def dump_bytecode(self, bucket: Bucket) -> None:
        if bucket.code is not None:
            self._compiled[bucket.key, bucket.checksum] = bucket.code


@contextmanager
def fast_applications() -> Iterator[None]:
    """Let all applications of this process share what they compile, and leave commits in memory.

    They share page templates and SQL statements. A commit to an SQLite file survives the end of a
    process, but not that of the machine.
    """
    sqlite_engine = sqlite.sqlite_engine
    connected: list[Engine] = []

    def fast_engine(*args: Any, **kwargs: Any) -> Engine:
        engine = sqlite_engine(*args, **kwargs)
        event.listen(engine, "connect", _leave_commits_in_memory)
        if connected:
            first = connected[0]
            engine.dialect, engine._compiled_cache = first.dialect, first._compiled_cache
        else:
            # Only a dialect that has been connected knows its server.
            event.listen(engine, "engine_connect", lambda _: connected.append(engine))
        return engine

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("studyapp.database.engine.sqlite_engine", fast_engine)
        patch.setitem(Flask.jinja_options, "bytecode_cache", _SharedTemplates())
        yield


def _leave_commits_in_memory(connection: sqlite3.Connection, _record: object) -> None:
    connection.execute("PRAGMA synchronous = OFF")
