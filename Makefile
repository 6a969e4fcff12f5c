# Two commands do everything: `make demo` and `make test`.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
PIP    := $(BIN)/python -m pip --disable-pip-version-check install -q -c constraints.txt

.PHONY: help demo test test-peers lint docs bench bank mazes release-check clean
help:
	@echo "make demo   environment + plan through the shipped level-3 maze -> out/demo.png, out/demo.json"
	@echo "make test   environment + lint + all tests"
	@echo "make test-peers  tests against OMPL, coal, pinocchio, Klamp't and Planner Arena (installs their wheels)"
	@echo "make lint   ruff and mypy"
	@echo "make docs   the pages as a site -> out/docs/index.html"
	@echo "make bench  the slow tables and timings -> out/bench/"
	@echo "make bank   rebuild (or finish) the shipped point sets"
	@echo "make mazes  redraw the shipped mazes"
	@echo "make release-check  build the wheels and try them in an empty environment, as a new user would"
	@echo "make clean  remove the environment and out/"

# A stamp a file that pip finished: a stopped install is taken up again, a finished one costs nothing.
$(VENV)/.core: pyproject.toml studies/pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "evenroad needs Python >= 3.11; set PYTHON=")'
	$(PYTHON) -m venv $(VENV)
	$(PIP) -e . -e ./studies
	@touch $@

$(VENV)/.dev: $(VENV)/.core
	$(PIP) -e '.[dev]' -e './studies[dask]'
	@touch $@

$(VENV)/.peers: $(VENV)/.dev
	$(PIP) -e '.[dev,peers]' -e './studies[dask]'
	@touch $@

demo: $(VENV)/.core
	@mkdir -p out
	$(BIN)/evenroad demo --out out/demo

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

test: lint
	$(BIN)/pytest -n 2

test-peers: $(VENV)/.peers
	$(BIN)/pytest tests_peers

docs: $(VENV)/.dev
	$(BIN)/python -m sphinx -q -W --keep-going -d out/doctrees docs out/docs
	@echo "out/docs/index.html"

bench: $(VENV)/.peers
	@mkdir -p out/bench
	$(BIN)/python -m studies.benchmarks --out out/bench
	$(BIN)/evenroad bench paper --runs 400 --store out/bench/paper.db
	$(BIN)/evenroad bench fair --runs 400 --store out/bench/fair.db
	$(BIN)/evenroad report out/bench/paper.db -o out/bench/paper
	$(BIN)/evenroad report out/bench/fair.db -o out/bench/fair

bank: $(VENV)/.dev
	$(BIN)/python -m evenroad_studies.training.bank

mazes: $(VENV)/.dev
	$(BIN)/python studies/tools/draw_mazes.py

release-check: $(VENV)/.core
	$(BIN)/python tools/release_check.py

clean:
	rm -rf $(VENV) out
