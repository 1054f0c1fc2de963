# Two commands on a fresh machine: make demo, make test. Needs Python 3.11+, make, git, a package index.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: setup demo test check fast slow live campaign bench compose-demo clean

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dev]'
	touch $@

demo: setup  ## a recorded mission of nine processes, its summary and its figure
	$(BIN)/onehop run scenarios/map1.toml --out runs/demo

test: check fast slow live  ## everything that CI runs, fast first

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

fast: setup
	$(BIN)/pytest -q -m 'not slow and not live'

slow: setup
	$(BIN)/pytest -q -m 'slow and not live and not campaign'

live: setup
	$(BIN)/pytest -q -m live

campaign: setup  ## what takes minutes and stays out of CI
	$(BIN)/pytest -q -m campaign
	for seed in 1 2 3 4 5 6 7 8 9 10; do \
	    ONEHOP_SEQUENCES=1000 $(BIN)/pytest -q --hypothesis-seed=$$seed tests/agent/team/test_team_machine.py \
	    || exit 1; done

bench: setup
	for program in bench/*.py; do $(BIN)/python $$program || exit 1; done

compose-demo: setup  ## the same mission as containers; makes a local base image where no registry is reached
	./docker/compose-demo.sh

clean:
	rm -rf $(VENV) runs build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
