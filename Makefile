# Every target sets the environment up by itself: a fresh clone needs Python 3.11 or newer and a package index.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
STAMP  := $(VENV)/.installed
RUNS   := runs

# Two workers on two cores: more BLAS threads would only fight each other.
WORKERS ?= 2
export OMP_NUM_THREADS      ?= 1
export OPENBLAS_NUM_THREADS ?= 1
export MKL_NUM_THREADS      ?= 1
export MPLBACKEND           ?= Agg
export OPENMDAO_REPORTS     ?= 0
export JAX_PLATFORMS        ?= cpu

PYTEST := $(BIN)/python -m pytest

.DEFAULT_GOAL := help
.PHONY: help install mdo test slow mutations validation interaction bench lint format clean

help: ## list the targets
	@grep -E '^[a-z]+:.*## ' $(firstword $(MAKEFILE_LIST)) | sed -E 's/:.*## /\t/' | expand -t 12

install: $(STAMP) ## set up .venv from requirements.lock, once

$(STAMP): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "hera_om needs Python 3.11 or newer: make PYTHON=python3.11 ...")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --requirement requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	touch $@

mdo: $(STAMP) ## optimise the shipped aircraft and write the report of the run
	mkdir -p $(RUNS)
	$(BIN)/hera-om mdo hera_like --db $(RUNS)/mdo.db
	$(BIN)/hera-om report $(RUNS)/mdo.db --out $(RUNS)/mdo.html

test: $(STAMP) ## run the tests, the slow ones excepted
	$(PYTEST) -q -n $(WORKERS)

slow: $(STAMP) ## run the slow tests
	$(PYTEST) -q -n $(WORKERS) -m slow

mutations: $(STAMP) ## switch each effect off and see its validation test fail
	$(PYTEST) -q -n $(WORKERS) -m mutation

validation: $(STAMP) ## write docs/validation.md from the functions of the tests
	$(BIN)/python docs/make_validation.py

interaction: $(STAMP) ## write docs/interaction.md: what rotors, wing and tail do to each other, with pictures
	$(BIN)/python docs/make_interaction.py

bench: $(STAMP) ## time the benchmarks
	@for script in $(sort $(wildcard benchmarks/bench_*.py)); do \
	    echo "== $$script"; $(BIN)/python $$script || exit 1; \
	done

lint: $(STAMP) ## check style, types and layers
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright
	$(BIN)/lint-imports

format: $(STAMP) ## mend what ruff can mend
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean: ## remove what tools left behind; .venv and runs/ stay
	rm -rf build dist *.egg-info *_out reports .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find . -path ./$(VENV) -prune -o -type d -name __pycache__ -exec rm -rf {} +
