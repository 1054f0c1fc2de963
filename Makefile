# Two commands on a fresh machine: make demo, make test. Needs Python 3.11+, make, git, a package index.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
LOWEST_PYTHON ?= python3.11
LOWEST := .venv-lowest
LOWEST_STAMP := $(LOWEST)/.installed
PIP := -m pip install --quiet --disable-pip-version-check --no-compile

# A mission is nine new processes: where bytecode is not kept, each compiles all its modules anew.
unexport PYTHONDONTWRITEBYTECODE

# Tests in which other people's packages have a part: formats, kernels, figures; the bus, pages, a cluster.
FOREIGN := tests/world tests/onehop/analysis tests/onehop/commands tests/onehop/contracts \
    tests/onehop/live tests/onehop/maps tests/onehop/mission tests/onehop/plugins tests/onehop/ros2 \
    tests/onehop/scenario tests/onehop/wire tests/onehop/test_*.py
FOREIGN_PROCESSES := tests/live/test_live_server.py tests/onehop/campaign

.PHONY: setup demo test check fast slow live lowest lowest-foreign lowest-constraints campaign study rust bench fuzz compose-demo compose-faults clean

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python $(PIP) --constraint constraints.txt --editable '.[dev]'
	touch $@

demo: setup  ## a recorded mission of nine processes, its summary and its figure, and that it kept every promise
	$(BIN)/onehop run scenarios/map1.toml --out runs/demo
	$(BIN)/onehop check runs/demo/mission.mcap

test: check fast slow live  ## all checks and tests, fast first

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

fast: setup
	$(BIN)/pytest -q -n auto --dist loadscope -m 'not slow and not live'

slow: setup
	$(BIN)/pytest -q -n auto --dist loadscope --no-loadscope-reorder -m 'slow and not live and not campaign'

live: setup
	$(BIN)/pytest -q -n 3 --dist loadfile --no-loadscope-reorder -m 'live and not campaign'

lowest: $(LOWEST_STAMP)  ## the fast tests with the lowest Python and the lowest versions that are promised
	NUMBA_CACHE_DIR=$(LOWEST)/compiled $(LOWEST)/bin/pytest -q -m 'not slow and not live'

lowest-foreign: $(LOWEST_STAMP)  ## what of them can differ with the versions, and processes that speak to each other
	NUMBA_CACHE_DIR=$(LOWEST)/compiled $(LOWEST)/bin/pytest -q -m 'not slow and not live' $(FOREIGN)
	NUMBA_CACHE_DIR=$(LOWEST)/compiled $(LOWEST)/bin/pytest -q -m 'not campaign' $(FOREIGN_PROCESSES)

$(LOWEST_STAMP): pyproject.toml constraints-lowest.txt
	$(LOWEST_PYTHON) -m venv --clear $(LOWEST)
	$(LOWEST)/bin/python $(PIP) --constraint constraints-lowest.txt --editable '.[dev]'
	touch $@

lowest-constraints:  ## write constraints-lowest.txt anew after a bound in pyproject.toml has changed
	$(LOWEST_PYTHON) -m venv --clear $(LOWEST)
	$(LOWEST)/bin/python .ci/lowest.py pyproject.toml > $(LOWEST)/bounds.txt
	$(LOWEST)/bin/python $(PIP) --constraint $(LOWEST)/bounds.txt --editable '.[dev]'
	$(LOWEST)/bin/python -m pip freeze --exclude-editable > constraints-lowest.txt
	touch $(LOWEST_STAMP)

campaign: setup  ## what takes minutes and stays out of CI
	$(BIN)/pytest -q -m campaign
	for seed in 1 2 3 4 5 6 7 8 9 10; do \
	    ONEHOP_SEQUENCES=1000 $(BIN)/pytest -q --hypothesis-seed=$$seed tests/agent/team/test_team_machine.py \
	    || exit 1; done

study: setup  ## chapter 4 of the thesis and the phase diagram of its gain policy, with few seeds: minutes
	$(BIN)/onehop study thesis --seeds 3 --out runs/study-thesis
	$(BIN)/onehop study policies --seeds 3 --k-rho-min 0.1,0.3,1 --hold 10,20 --out runs/study-policies

rust:  ## the robot in Rust of docs/wire.md; needs cargo
	cargo build --locked --manifest-path examples/rust_robot/Cargo.toml

bench: setup
	for program in bench/*.py; do $(BIN)/python $$program || [ $$? = 77 ] || exit 1; done  # 77: no ns-3 here

fuzz: setup  ## 5,000 mutated scenarios, maps, logs and messages; what went wrong stays in runs/fuzz
	$(BIN)/python -m tests.fuzz --cases 5000 --seed 1

compose-faults: setup  ## containers killed, paused, restarted and cut off while a mission runs, after compose-demo
	$(BIN)/python docker/try_faults.py

compose-demo: setup  ## the same mission as containers; makes a local base image where no registry is reached
	./docker/compose-demo.sh

clean:
	rm -rf $(VENV) $(LOWEST) runs build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
