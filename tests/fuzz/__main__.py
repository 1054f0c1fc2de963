"""The fuzzer's command line: a table of outcomes by kind; exit status 1 when any case went wrong."""

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

from tests.fuzz.fuzzer import GOOD, SHARES, Fuzzer, Result, jobs_of_this_machine
from tests.fuzz.sandbox import Outcome


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--cases", type=int, default=5000, help="of all kinds together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kind", choices=SHARES, help="only this kind")
    parser.add_argument("--only", type=int, metavar="CASE", help="only this case of --kind, again")
    parser.add_argument("--out", type=Path, default=Path("runs/fuzz"), help="keeps what went wrong")
    parser.add_argument("--jobs", type=int, default=jobs_of_this_machine(), help="cases at a time")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    fuzzer = Fuzzer(options.out.resolve(), options.seed)
    shares = {options.kind: SHARES[options.kind]} if options.kind else SHARES
    wrong = 0
    print("kind     ", *(f"{outcome.value:>9}" for outcome in Outcome), "  cpu s  longest  wall s")
    for kind, share in shares.items():
        numbers = range(options.cases * share // sum(shares.values()))
        if options.only is not None:
            numbers = range(options.only, options.only + 1)
        began = time.monotonic()
        results = list(fuzzer.run(kind, numbers, options.jobs))
        _print(kind, results, time.monotonic() - began)
        wrong += sum(result.ended.outcome not in GOOD for result in results)
    return 1 if wrong else 0


def _print(kind: str, results: list[Result], wall_s: float) -> None:
    counts = Counter(result.ended.outcome for result in results)
    times = [result.ended.cpu_s for result in results]
    row = " ".join(f"{counts[outcome]:9}" for outcome in Outcome)
    longest = max(times, default=0.0)
    print(f"{kind:9} {row} {sum(times):7.0f} {longest:8.1f} {wall_s:7.0f}", flush=True)
    for result in results:
        if result.ended.outcome not in GOOD:
            last = result.ended.words.strip().rpartition("\n")[2]
            print(f"  {result.ended.outcome} in {result.folder}: {last:.200}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
