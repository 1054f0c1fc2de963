"""Onehop's radio beside ns-3 3.44, case by case, with confidence intervals: Markdown on stdout.

    python bench/ns3.py --python VENV/bin/python --docs docs/radio-validation.md
    python bench/ns3.py 'hidden/*' 'chain/4*' --seeds 5

ns-3 is optional: `pip install ns3==3.44` into any environment of Python 3.11, whose interpreter --python
names. Without it this program says so and exits with status 77. What ns-3 said is kept in the file of
--ns3-results, run by run, and simulated again only if the run has changed, so with that file at hand no
ns-3 is needed. Onehop's side is always simulated anew.

With --docs the tables replace what is between the marks of that page; the figure is written beside it.
"""

import argparse
import hashlib
import json
import os
import platform
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from datetime import UTC, datetime
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from radio_validation import cases, ours
from radio_validation.figure import draw
from radio_validation.measures import measures
from radio_validation.peer import NOT_INSTALLED, Ns3, installed
from radio_validation.tables import Row, markdown

import onehop

RESULTS_BEGIN, RESULTS_END = "<!-- results of bench/ns3.py -->", "<!-- end of results -->"
Key = tuple[str, int]
Lines = dict[Key, dict[str, Any]]


def digest(run: cases.Run) -> str:
    """Names a run: results of another one do not count for it."""
    return hashlib.sha256(json.dumps(run.as_json(), sort_keys=True).encode()).hexdigest()[:16]


def kept(path: Path, runs: dict[Key, cases.Run]) -> Lines:
    """What ns-3 said earlier about these very runs."""
    if not path.exists():
        return {}
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    return {
        key: line
        for line in lines
        if (key := (line["case"], line["seed"])) in runs and line["run"] == digest(runs[key])
    }


def ask_ns3(
    python: str, version: str, todo: dict[Key, cases.Run], jobs: int
) -> Iterator[dict[str, Any]]:
    """Simulate runs on ns-3, in as many processes as there are jobs."""
    workers: SimpleQueue[Ns3] = SimpleQueue()
    every = [Ns3(python) for _ in range(jobs)]
    for worker in every:
        workers.put(worker)

    def line(key: Key) -> dict[str, Any]:
        run, worker = todo[key], workers.get()
        said = worker.simulate(run.as_json())
        workers.put(worker)
        result = {"error": said["error"]} if "error" in said else {"figures": measures(run, said)}
        about = {"case": key[0], "seed": key[1], "run": digest(run), "version": version}
        return about | result | {"cpu_s": said.get("cpu_s")}

    with ThreadPoolExecutor(jobs) as pool:
        yield from pool.map(line, todo)
    for worker in every:
        worker.close()


def our_figures(run: cases.Run) -> dict[str, float | None]:
    """The figures of a run on Onehop."""
    return measures(run, ours.simulate(run))


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def tabulated(options: argparse.Namespace, rows: list[Row], versions: set[str]) -> str:
    """The tables under a line that says when, with what, and from how many seeds."""
    python, peer = platform.python_version(), ", ".join(sorted(versions))
    about = (
        f"{datetime.now(UTC):%Y-%m-%d}: Onehop {onehop.__version__} on Python {python}, ns-3 {peer}, "
        f"{options.seeds} seeds a case.\n\n"
    )
    return about + "\n".join(markdown(rows))


def write_page(page: Path, text: str) -> None:
    """Put the results between the marks of the page."""
    before, _, rest = page.read_text().partition(RESULTS_BEGIN)
    _, _, after = rest.partition(RESULTS_END)
    page.write_text(f"{before}{RESULTS_BEGIN}\n\n{text}\n{RESULTS_END}{after}")


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("cases", nargs="*", help="names of cases, as shell patterns (default: all)")
    parser.add_argument("--list", action="store_true", help="print the names of the cases")
    parser.add_argument("--python", default=sys.executable, help="the interpreter that has ns-3")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--ns3-results", type=Path, default=Path("runs/ns3.jsonl"), metavar="FILE")
    parser.add_argument("--our-results", type=Path, metavar="FILE", help="write ours as JSON lines")
    parser.add_argument("--docs", type=Path, metavar="PAGE.md")
    return parser.parse_args()


def what_ns3_said(options: argparse.Namespace, runs: dict[Key, cases.Run]) -> Lines | None:
    """Of every run: kept from earlier or simulated now; None without ns-3 when something is missing."""
    theirs = kept(options.ns3_results, runs)
    todo = {key: run for key, run in runs.items() if key not in theirs}
    if not todo:
        return theirs
    version = installed(options.python)
    if version is None:
        return None
    options.ns3_results.parent.mkdir(parents=True, exist_ok=True)
    with options.ns3_results.open("a") as file:
        for number, line in enumerate(ask_ns3(options.python, version, todo, options.jobs), 1):
            print(json.dumps(line), file=file, flush=True)
            theirs[line["case"], line["seed"]] = line
            say(f"ns-3 {number} of {len(todo)}: {line['case']}, seed {line['seed']}")
    return theirs


def main() -> int:
    options = arguments()
    chosen = cases.chosen(options.cases)
    if options.list:
        print("\n".join(case.name for case in chosen))
        return 0
    seeds = range(1, options.seeds + 1)
    runs = {(case.name, seed): case.of(seed) for seed in seeds for case in chosen}
    theirs = what_ns3_said(options, runs)
    if theirs is None:
        say(f"ns-3 is not installed for {options.python}: pip install ns3==3.44, or --python PATH")
        return NOT_INSTALLED
    with ProcessPoolExecutor(options.jobs) as pool:
        own = dict(zip(runs, pool.map(our_figures, runs.values(), chunksize=4), strict=True))
    if options.our_results:
        with options.our_results.open("w") as file:
            for (name, seed), figures in own.items():
                print(json.dumps({"case": name, "seed": seed, "figures": figures}), file=file)
    rows = [
        Row(
            case.name,
            tuple(theirs[case.name, seed].get("figures", {}) for seed in seeds),
            tuple(own[case.name, seed] for seed in seeds),
        )
        for case in chosen
    ]
    text = tabulated(options, rows, {line["version"] for line in theirs.values()})
    if options.docs:
        write_page(options.docs, text)
        draw(rows, options.docs.with_suffix(".svg"))
    else:
        print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
