"""Page templates and SQL statements that tests do not compile anew for every application."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from types import CodeType
from typing import Any

import pytest
from flask import Flask
from jinja2.bccache import Bucket, BytecodeCache
from sqlalchemy import Engine, create_engine, event


class _KeptTemplates(BytecodeCache):
    def __init__(self) -> None:
        self._kept: dict[tuple[str, str], CodeType] = {}

    def load_bytecode(self, bucket: Bucket) -> None:
        bucket.code = self._kept.get((bucket.key, bucket.checksum))

    def dump_bytecode(self, bucket: Bucket) -> None:
        if bucket.code is not None:
            self._kept[bucket.key, bucket.checksum] = bucket.code


@contextmanager
def compiled_once() -> Iterator[None]:
    """Let all applications share templates, and all SQLite databases statements."""
    known: list[Engine] = []

    def sharing(*given: Any, **named: Any) -> Engine:
        engine = create_engine(*given, **named)
        if known:
            engine.dialect, engine._compiled_cache = known[0].dialect, known[0]._compiled_cache
        else:
            # Only a dialect that has been connected knows its server.
            event.listen(engine, "engine_connect", lambda _: known.append(engine))
        return engine

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("studyapp.database.sqlite.create_engine", sharing)
        patch.setitem(Flask.jinja_options, "bytecode_cache", _KeptTemplates())
        yield
