"""Validity of the report's numbers: ``python -m benchmarks.validity``.

Simulates studies with known truth and prints, for every headline number and for the tests in
papers, the rate of false positives, the coverage of the 95% interval, and the power, each with its
Monte-Carlo error.
"""

import argparse
import multiprocessing
import os
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from itertools import repeat
from pathlib import Path
from typing import Final

import numpy as np

from benchmarks.validity.conclusions.conclusion import Protocol
from benchmarks.validity.document import section, write_section
from benchmarks.validity.experiments import EXPERIMENTS, Experiment
from benchmarks.validity.realised import Realised, Row, Tally, tally
from benchmarks.validity.studies import Design

BLOCK: Final = 20
"""Studies per task of one process."""


def measure(
    experiment: Experiment, *, studies: int, seed: int, pool: Executor | None = None
) -> list[Row]:
    """Simulate `studies` studies of each design without an effect and as many with one.

    The result depends on `seed` but not on the number of processes in `pool`.
    """
    map_ = pool.map if pool else map
    count = _count(experiment, studies)
    rows = []
    for number, design in enumerate(experiment.designs):
        counted = []
        for which, effect in enumerate(experiment.protocol.effects):
            with_effect = replace(design, effect=effect)
            truths = experiment.protocol.truths(with_effect)
            seeds = np.random.SeedSequence([seed, number, which]).spawn(count)
            blocks = [seeds[start : start + BLOCK] for start in range(0, count, BLOCK)]
            total: dict[str, Tally] = {}
            for part in map_(
                _simulated, repeat(experiment.protocol), repeat(with_effect), repeat(truths), blocks
            ):
                total = {
                    name: total.get(name, Tally()) + measured_rows
                    for name, measured_rows in part.items()
                }
            counted.append(total)
        for name, without in counted[0].items():
            rows.append(
                Row(
                    experiment=experiment.name,
                    design=design,
                    number=name,
                    naive=name in experiment.protocol.naive,
                    realised=Realised.of(without, counted[1][name]),
                )
            )
    return rows


def _count(experiment: Experiment, studies: int) -> int:
    return max(1, round(studies * experiment.share))


def main(arguments: Sequence[str] | None = None) -> None:
    """Simulate, and print the tables, their verdicts, and the last lines."""
    parser = argparse.ArgumentParser(description="Simulate studies with a known truth.")
    parser.add_argument("--studies", type=int, default=600, help="studies per design and effect")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    names = [experiment.name for experiment in EXPERIMENTS]
    parser.add_argument("--only", choices=names, nargs="+", default=names, help="kinds of studies")
    parser.add_argument(
        "--write", type=Path, metavar="FILE", help="put the tables into this document"
    )
    args = parser.parse_args(arguments)
    began = time.monotonic()
    rows: list[Row] = []
    with _processes(args.processes) as pool:
        for experiment in EXPERIMENTS:
            if experiment.name in args.only:
                measured_rows = measure(experiment, studies=args.studies, seed=args.seed, pool=pool)
                rows += measured_rows
                count = _count(experiment, args.studies)
                text = section(experiment.name, measured_rows, studies=count, seed=args.seed)
                print(text, flush=True)
                if args.write:
                    write_section(args.write, experiment.name, text)
    numbers: dict[tuple[str, str], list[Realised]] = {}
    for row in rows:
        numbers.setdefault((row.experiment, row.number), []).append(row.realised)
    for (name, number), outcomes in numbers.items():
        key = re.sub(r"[^a-z0-9]+", "_", f"{name} {number}".lower().replace("'", "")).strip("_")
        print(f"{key}_most_false_positives: {max(r.false_positives.value for r in outcomes):.3f}")
        if not np.isnan(outcomes[0].coverage.value):
            print(f"{key}_least_coverage: {min(r.coverage.value for r in outcomes):.3f}")
    print(f"studies: {args.studies}")
    print(f"seconds: {time.monotonic() - began:.0f}")


def _simulated(
    protocol: Protocol,
    design: Design,
    truths: Mapping[str, float],
    seeds: Sequence[np.random.SeedSequence],
) -> dict[str, Tally]:
    return tally(protocol, design, truths, map(np.random.default_rng, seeds))


@contextmanager
def _processes(count: int) -> Iterator[Executor | None]:
    """Yield processes of one thread each; None for this process alone."""
    if count < 2:
        yield None
        return
    # New processes, not forks: the number of threads is read when the libraries load.
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(count, mp_context=context) as pool:
        yield pool
