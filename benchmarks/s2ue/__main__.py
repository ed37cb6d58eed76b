"""Speech2UnifiedExpressions: its speed, its seams, and its ablations as in the paper's Table 1.

``python -m benchmarks.s2ue speed`` generates motion for a minute of noise with a tiny network, from
samples to clip, on one thread. ``python -m benchmarks.s2ue seams CHECKPOINT SPEECH…`` compares
accelerations at the seams of windows with those elsewhere. ``python -m benchmarks.s2ue draws CORPUS
FOLDER NETWORK…`` measures whether draws of the speaker change face and body together. ``python -m
benchmarks.s2ue table CORPUS FOLDER`` trains the full model and the seven ablations on a synthetic
corpus for the same number of steps, and measures them on windows of test takes with recorded seeds.
"""

import argparse
import math
from pathlib import Path

from benchmarks.s2ue.draws import drawn_together
from benchmarks.s2ue.measures import seams, speed
from benchmarks.s2ue.table import table, windows_of
from generators.s2ue.config import ABLATIONS
from generators.s2ue.model import load_network
from motion.body.face_landmarks import FaceLandmarks
from tools.markdown import write_part
from training.data.folders import read_takes
from training.device import torch_threads


def main() -> None:
    """Run the requested benchmark."""
    parser = argparse.ArgumentParser(description=__doc__)
    kinds = parser.add_subparsers(dest="what", required=True)
    fast = kinds.add_parser("speed")
    fast.add_argument("--rounds", type=int, default=5)
    smooth = kinds.add_parser("seams")
    smooth.add_argument("checkpoint", type=Path)
    smooth.add_argument("speech", type=Path, nargs="+")
    drawn = kinds.add_parser("draws")
    drawn.add_argument("corpus", type=Path)
    drawn.add_argument("folder", type=Path, help="the table's folder")
    drawn.add_argument("networks", type=Path, nargs="+")
    tables = kinds.add_parser("table")
    tables.add_argument("corpus", type=Path)
    tables.add_argument("folder", type=Path)
    tables.add_argument("--steps", type=int, default=150)
    tables.add_argument("--seeds", type=int, default=3, help="training runs of each variant")
    tables.add_argument("--only", nargs="+", choices=list(ABLATIONS), default=list(ABLATIONS))
    tables.add_argument("--write", type=Path, metavar="FILE", help="a page with marks for it")
    args = parser.parse_args()
    if args.what == "speed":
        speed(args.rounds)
        return
    if args.what == "seams":
        for seam in seams(args.checkpoint, args.speech):
            low, high = seam.interval or (math.nan, math.nan)
            print(f"{seam.name}: {seam.value:.2f} ({low:.2f} to {high:.2f}), {seam.n} seams")
        return
    if args.what == "draws":
        windows = windows_of(read_takes(args.corpus), args.folder, "test", stride=34)
        face = FaceLandmarks.of_default_body()
        for path in args.networks:
            print(f"{path.stem}: {drawn_together(load_network(path, face), windows):.3f}")
        return
    lines = []
    with torch_threads(1):
        rows = table(
            args.corpus,
            args.folder,
            steps=args.steps,
            seeds=args.seeds,
            ablations=args.only,
        )
        for line in rows:
            print(line, flush=True)
            lines.append(line)
    if args.write is not None:
        write_part(args.write, "ablations", "\n".join(lines))


if __name__ == "__main__":
    main()
