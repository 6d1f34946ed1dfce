# Everything a fresh Debian machine needs, from system packages to the tests: `make test`.
PYTHON ?= python3
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
PYTEST_ARGS ?=

VENV := .venv
RUN := $(VENV)/bin/python
APT_PACKAGES := g++ cmake ninja-build libeigen3-dev libsundials-dev doctest-dev python3-venv python3-dev

PACKAGE_SOURCES := $(shell find cpp/stickslip cpp/bindings python cmake \
	-name __pycache__ -prune -o -print) CMakeLists.txt pyproject.toml

# tomllib came with Python 3.11; before that pip carries the same module.
PRINT_BUILD_REQUIRES := import importlib, sys; \
	toml = importlib.import_module("tomllib" if sys.version_info >= (3, 11) else "pip._vendor.tomli"); \
	print(*toml.load(open("pyproject.toml", "rb"))["build-system"]["requires"])

# The virtual environment comes first, so that a cmake from PyPI serves where the system has none.
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)
export CMAKE_BUILD_PARALLEL_LEVEL := $(JOBS)
export PIP_DISABLE_PIP_VERSION_CHECK := 1

.DEFAULT_GOAL := help
.PHONY: help system install test test-cpp test-python nightly demo docs bench bench-promises bench-plane bench-stepping bench-controllers bench-steering bench-diagnosis bench-laws bench-before bench-mutations blind drops scoreboard fuzz fuzz-sanitized bench-peers lint format tidy wheel wheels sizes clean

help: ## show this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /\1\t/' | expand -t 14

system:
	@missing=""; \
	if command -v dpkg >/dev/null; then \
	    for package in $(APT_PACKAGES); do \
	        dpkg -s $$package >/dev/null 2>&1 || missing="$$missing $$package"; \
	    done; \
	else \
	    for tool in g++ cmake ninja; do \
	        command -v $$tool >/dev/null || missing="$$missing $$tool"; \
	    done; \
	fi; \
	if [ -z "$$missing" ]; then exit 0; fi; \
	if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	    echo "Installing system packages:$$missing"; \
	    export DEBIAN_FRONTEND=noninteractive; \
	    { apt-get update -qq && apt-get install -y -qq --no-install-recommends $$missing >/dev/null; } \
	        || echo "apt-get failed; going on with the tools that are there"; \
	else \
	    echo "Not root: if a step below fails, install these packages:$$missing"; \
	fi

# A python3 without ensurepip (Debian without python3-venv, and not root) can still have virtualenv.
$(VENV)/.created: | system
	@$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); $(PYTHON) -m virtualenv -q $(VENV); } || \
	    { rm -rf $(VENV); echo "Cannot create $(VENV): install python3-venv or virtualenv"; exit 1; }
	@touch $@

# Built without pip's isolation: an isolated build gets new include paths each time and so compiles
# everything again. `make wheel` is the isolated build.
$(VENV)/.build-tools: pyproject.toml $(VENV)/.created
	@echo "Installing the build tools"
	@$(RUN) -m pip install --quiet $$($(RUN) -c '$(PRINT_BUILD_REQUIRES)')
	@command -v cmake >/dev/null || $(RUN) -m pip install --quiet cmake ninja
	@touch $@

$(VENV)/.installed: $(PACKAGE_SOURCES) $(VENV)/.build-tools
	@echo "Building and installing stickslip (some minutes the first time)"
	@$(RUN) -m pip install --quiet --no-build-isolation ".[test]"
	@echo "Installed in $(VENV): try $(VENV)/bin/stickslip run"
	@touch $@

install: $(VENV)/.installed ## build the package into .venv

test: test-cpp test-python ## all tests: C++ under the sanitizers, then Python on all processors

test-cpp: $(VENV)/.build-tools | system ## C++ tests under the address and undefined-behaviour sanitizers
	@mkdir -p build
	@cmake --preset asan >build/asan-configure.log 2>&1 || { cat build/asan-configure.log; exit 1; }
	@cmake --build --preset asan
	@ctest --preset asan -j $(JOBS)

# A worker begins with its share of the tests in order, so that few fixtures are made twice, and takes
# over from another when it is done.
test-python: install ## Python tests (PYTEST_ARGS="-m 'not slow'" leaves out the slow ones)
	@$(RUN) -m pytest -n $(JOBS) --dist worksteal --durations=10 $(PYTEST_ARGS)

nightly: install ## Python tests that take minutes: all pairs of effects, all frozen runs
	@$(RUN) -m pytest -n $(JOBS) --dist worksteal --durations=10 -m nightly $(PYTEST_ARGS)

demo: install ## a short tour
	@$(RUN) -m stickslip.demo

# What the extra `docs` names, as PRINT_BUILD_REQUIRES does for the build.
PRINT_DOCS_REQUIRES := import importlib, sys; \
	toml = importlib.import_module("tomllib" if sys.version_info >= (3, 11) else "pip._vendor.tomli"); \
	print(*toml.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"]["docs"])

$(VENV)/.docs-tools: pyproject.toml $(VENV)/.created
	@echo "Installing Sphinx"
	@$(RUN) -m pip install --quiet $$($(RUN) -c '$(PRINT_DOCS_REQUIRES)')
	@touch $@

docs: install $(VENV)/.docs-tools ## the documentation, into docs/_build/html
	@$(RUN) -m sphinx --quiet --fail-on-warning --keep-going -b html docs docs/_build/html
	@echo "written: docs/_build/html/index.html"

bench: install ## speed of both integrators at equal accuracy, into bench/results/
	@$(RUN) bench/bench.py

BEFORE ?= f99d6ef

bench-promises: install ## promises about time: import, Ctrl-C, long runs, sweeps; fails if one is broken
	@OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(RUN) bench/promises.py

bench-plane: install ## speed of runs in the whole plane beside those in one; fails below what is asked
	@OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(RUN) bench/plane.py

bench-before: install ## speed beside an earlier commit, which is built into build/before (BEFORE=<commit>)
	@$(RUN) bench/before.py --before $(BEFORE)

bench-stepping: install ## restores without a changed bit, cost of steps and rollouts
	@OPENBLAS_NUM_THREADS=1 $(RUN) bench/stepping.py

bench-controllers: install ## a coarse and a fine controller, judged on fresh draws of 256 robots
	@OPENBLAS_NUM_THREADS=1 $(RUN) bench/controllers.py

bench-steering: install ## a figure of eight, followed through a camera by 100 robots that differ
	@OPENBLAS_NUM_THREADS=1 $(RUN) bench/steering_follow.py

COST_DATA ?= bench/results/diagnosis-data

bench-diagnosis: install ## CPU time and simulations of diagnoses (COST_DATA=<folder of data sets>)
	@test -d $(COST_DATA) || PYTHONPATH=bench $(RUN) -m blind --first 21000 --write $(COST_DATA) \
	    --kinds "single;pair;hiding;law" --seeds 3
	@OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(RUN) bench/diagnosis.py $(COST_DATA)

bench-laws: install ## laws hidden in a model of one's own, and what is said of them
	@OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(RUN) bench/free_laws.py

bench-mutations: install ## whether the table of effects sees an effect that one way to run has lost
	@$(RUN) bench/mutations.py --jobs $(JOBS)

BLIND_ARGS ?= --seeds 4

blind: install ## blind study of the diagnosis, into bench/results/blind/ (BLIND_ARGS="--jobs 2 --minutes 600")
	@PYTHONPATH=bench OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(RUN) -m blind $(BLIND_ARGS)

DROPS ?= tests/data/square_drops.csv.gz

drops: install ## real drops beside the core, into bench/results/ (DROPS=<file>)
	@OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 PYTHONPATH=bench $(RUN) -m real.drops $(DROPS)

scoreboard: install ## measured sets with a known answer, diagnosed, into bench/results/ (DROPS=<file>)
	@OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 PYTHONPATH=bench $(RUN) -m real.scoreboard --drops $(DROPS)

FUZZ_ARGS ?= --minutes 5 --seed 0

fuzz: install ## random scenarios and damaged files, into bench/results/fuzz/
	@PYTHONPATH=bench OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(RUN) -m fuzz $(FUZZ_ARGS)

fuzz-sanitized: install # the same scenarios through the core under the sanitizers
	@mkdir -p build
	@cmake --preset asan >build/asan-configure.log 2>&1 || { cat build/asan-configure.log; exit 1; }
	@cmake --build --preset asan --target stickslip_fuzz
	@PYTHONPATH=bench $(RUN) -m fuzz --check sanitized --out bench/results/fuzz-sanitized $(FUZZ_ARGS)

# The peers have an environment of their own; bench/peers/README.md says what is measured.
BENCH_VENV := .venv-bench
BENCH_RUN := $(BENCH_VENV)/bin/python

$(BENCH_VENV)/.created: | system
	@$(PYTHON) -m venv $(BENCH_VENV) || $(PYTHON) -m virtualenv -q $(BENCH_VENV)
	@echo '*' >$(BENCH_VENV)/.gitignore
	@touch $@

$(BENCH_VENV)/.installed: $(VENV)/.installed $(BENCH_VENV)/.created
	@rm -rf build/bench
	@$(RUN) -m pip wheel --quiet --no-build-isolation --no-deps --wheel-dir build/bench .
	@$(BENCH_RUN) -m pip install --quiet build/bench/*.whl
	@$(BENCH_RUN) -m pip install --quiet --no-deps --force-reinstall build/bench/*.whl
	@touch $@

# A peer that cannot be installed is left out, and tried again next time.
$(BENCH_VENV)/.peers: $(BENCH_VENV)/.created
	@all=yes; for peer in scipy heyoka mujoco magpylib; do \
	    echo "Installing $$peer for the benchmark"; \
	    $(BENCH_RUN) -m pip install --quiet $$peer || all=no; \
	done; if [ $$all = yes ]; then touch $@; fi

bench-peers: $(BENCH_VENV)/.installed $(BENCH_VENV)/.peers ## speed and accuracy beside SciPy, heyoka, MuJoCo and magpylib
	@PYTHONPATH=bench OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BENCH_RUN) -m peers

lint: $(VENV)/.created ## ruff, and clang-format where it is installed
	@test -x $(VENV)/bin/ruff || $(RUN) -m pip install --quiet ruff
	@$(VENV)/bin/ruff check .
	@$(VENV)/bin/ruff format --check .
	@if command -v clang-format >/dev/null; then \
	    clang-format --dry-run --Werror $$(find cpp -name '*.cpp' -o -name '*.hpp'); \
	else echo "clang-format is not installed: C++ layout not checked"; fi

format: $(VENV)/.created ## rewrite the layout of all sources
	@test -x $(VENV)/bin/ruff || $(RUN) -m pip install --quiet ruff
	@$(VENV)/bin/ruff check --fix --quiet . || true
	@$(VENV)/bin/ruff format --quiet .
	@if command -v clang-format >/dev/null; then \
	    clang-format -i $$(find cpp -name '*.cpp' -o -name '*.hpp'); fi

tidy: | system ## clang-tidy over the core (needs clang-tidy)
	@cmake --preset tidy && cmake --build --preset tidy

wheel: $(VENV)/.created ## an isolated build of the wheel, into dist/
	@$(RUN) -m pip wheel --quiet --no-deps --wheel-dir dist .
	@ls dist/*.whl

PYTHONS ?= $(PYTHON)
WHEEL_TESTS ?= tests/test_run.py tests/test_cli.py tests/test_simulator.py tests/test_bad_input.py \
	"tests/test_documentation.py::test_the_code_of_a_page_runs_and_prints_what_it_says[README.md]"

# The base is installed where no compiler is to be found, as a user's machine may be, and tried before
# the extras are there. The tests know no other stickslip than that of the wheel.
wheels: | system ## wheels for PYTHONS="python3.10 python3.12", each installed without a compiler and tested
	@set -e; for python in $(PYTHONS); do \
	    folder=build/wheels/$$($$python -c 'import sys; print("cp%d%d" % sys.version_info[:2])'); \
	    rm -rf $$folder; $$python -m venv $$folder || $$python -m virtualenv -q $$folder; \
	    bin=$(CURDIR)/$$folder/bin; \
	    $$bin/python -m pip wheel --quiet --no-deps --wheel-dir $$folder .; \
	    wheel=$$(ls $$folder/*.whl); echo "$$(du -k $$wheel | cut -f 1) kB  $$wheel"; \
	    PATH=$$bin CC=false CXX=false $$bin/python -m pip install --quiet --only-binary :all: $$wheel; \
	    $$bin/stickslip init $$folder/smoke.toml; \
	    $$bin/stickslip run $$folder/smoke.toml --out $$folder/smoke.csv; \
	    $$bin/python -m pip install --quiet "$$wheel[test]"; \
	    $$bin/python -m pytest -q -n $(JOBS) $(WHEEL_TESTS); \
	    mkdir -p dist; cp $$wheel dist; \
	done

EXTRAS := "" "[netcdf]" "[plot]" "[diagnosis]" "[optimise]" "[all]"

sizes: wheel ## what an installation with each extra takes with its dependencies, in MB
	@for extra in $(EXTRAS); do \
	    rm -rf build/sizes; \
	    $(RUN) -m pip install --quiet --target build/sizes "$$(ls -t dist/*.whl | head -1)$$extra"; \
	    echo "$$(du -sm build/sizes | cut -f 1) MB  stickslip$$extra"; \
	done

clean: ## remove everything that can be built again
	rm -rf build dist docs/_build docs/_pictures $(VENV) $(BENCH_VENV) .pytest_cache .ruff_cache .mypy_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
