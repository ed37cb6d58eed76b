"""Applications of tests, which start quickly and do not wait for the disk."""

import os
import sqlite3
import tempfile
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from types import CodeType
from typing import Any
from uuid import uuid4

import pytest
from flask import Flask
from jinja2.bccache import Bucket, BytecodeCache
from sqlalchemy import Engine, event
from werkzeug.routing import Rule

from studyapp.database import sqlite
from studyapp.database.engine import Database, sqlite_url


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

    They share page templates, routes and SQL statements; a new SQLite database begins as a copy of
    one that has the newest schema. A commit to such a file survives the end of a process, but not
    that of the machine.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(Flask.jinja_options, "bytecode_cache", _SharedTemplates())
        patch.setattr(Rule, "_compile_builder", _shared_routes(Rule._compile_builder))
        patch.setattr("studyapp.database.engine.sqlite_engine", _fast_engines())
        # The first one is migrated before others become its copies.
        content = _newest_database()
        patch.setattr("studyapp.database.engine.keep_private", _copied_from(content))
        yield


def _shared_routes(compile_builder: Callable[..., Any]) -> Callable[..., Any]:
    compiled: dict[tuple[object, ...], Any] = {}

    def shared(rule: Rule, append_unknown: bool = True) -> Any:
        key = (rule.rule, rule.subdomain, repr(rule.defaults), append_unknown)
        if key not in compiled:
            compiled[key] = compile_builder(rule, append_unknown)
        return compiled[key]

    return shared


def _fast_engines() -> Callable[..., Engine]:
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

    return fast_engine


def _leave_commits_in_memory(connection: sqlite3.Connection, _record: object) -> None:
    connection.execute("PRAGMA synchronous = OFF")


def _newest_database() -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "new.db"
        with closing(Database.open(sqlite_url(file))):
            pass
        return file.read_bytes()


def _copied_from(content: bytes) -> Callable[[Path], None]:
    keep_private = sqlite.keep_private

    def copy_or_keep(file: Path) -> None:
        if not file.exists() and file.parent.is_dir():
            copy = file.with_name(f"{uuid4()}.db")
            copy.write_bytes(content)
            # Another process made the file first.
            with suppress(FileExistsError):
                os.link(copy, file)
            copy.unlink()
        keep_private(file)

    return copy_or_keep
