"""Straining the study's server: ``python -m benchmarks.server.soak``.

Kills its workers, the process that starts them and the database's server at random moments during
study sessions, on SQLite and on PostgreSQL; then sends malformed requests. Prints ``name: value``
lines, and ends with status 1 if anything fails, is lost or doubled, or is wrongly stored.
"""

import argparse
import sys

from benchmarks.server.databases import BACKENDS
from benchmarks.server.kill_soak import Strain, kill_soak
from benchmarks.server.malformed_soak import malformed_soak


def main() -> None:
    """Run the soak, print its outcome, and fail if there is a problem."""
    args = _arguments()
    problems: list[str] = []
    for backend in BACKENDS:
        strain = Strain(
            sessions=args.sessions, trials=args.trials, kills=args.kills, seed=args.seed
        )
        killed = kill_soak(backend, strain)
        for what, count in sorted(killed.killed.items()):
            print(f"{backend}_killed_{what}: {count}")
        print(f"{backend}_requests_sent_again: {killed.sent_again}")
        print(f"{backend}_answers_acknowledged: {killed.acknowledged}", flush=True)
        problems += [f"{backend}: {problem}" for problem in killed.problems]
    malformed = malformed_soak("sqlite", requests=args.malformed, seed=args.seed)
    for status, count in sorted(malformed.answers.items()):
        print(f"malformed_answered_{status}: {count}")
    problems += malformed.problems
    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"seed: {args.seed}")
    print(f"problems: {len(problems)}")
    sys.exit(1 if problems else 0)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Strain the study's server.")
    parser.add_argument("--sessions", type=int, default=200, help="study sessions at once")
    parser.add_argument("--trials", type=int, default=12, help="trials in each of them")
    parser.add_argument("--kills", type=int, default=40, help="kills on each database")
    parser.add_argument("--malformed", type=int, default=100_000, help="malformed requests")
    parser.add_argument("--seed", type=int, default=1)
    return parser.parse_args()


if __name__ == "__main__":
    main()
