# `make test` is all that a fresh machine needs: it installs, builds and tests.
PYTHON ?= python3
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
PYTEST_ARGS ?=
MINUTES ?= 600
NAME ?= speed
ARGS ?=

VENV := .venv
RUN := $(VENV)/bin/python
BUILD := build/release
APT_PACKAGES := g++ cmake ninja-build libeigen3-dev libsundials-dev doctest-dev python3-venv python3-dev
SOURCES := $(shell find cpp/stickslip cpp/bindings cpp/machines python cmake -name __pycache__ -prune -o -type f -print) \
	CMakeLists.txt pyproject.toml
# tomllib came with Python 3.11; pip carries the same module.
BUILD_REQUIRES = $$($(RUN) -c 'from pip._vendor import tomli; \
	print(*tomli.load(open("pyproject.toml", "rb"))["build-system"]["requires"])')
CXX_FILES = $$(find cpp -name '*.cpp' -o -name '*.hpp')

# The virtual environment comes first: a cmake from PyPI serves where the system has none.
export PATH := $(CURDIR)/$(VENV)/bin:$(PATH)
export CMAKE_BUILD_PARALLEL_LEVEL := $(JOBS)
export CMAKE_CXX_COMPILER_LAUNCHER ?= $(shell command -v ccache 2>/dev/null)
export PIP_DISABLE_PIP_VERSION_CHECK := 1

.DEFAULT_GOAL := help
.PHONY: help system tools install test coverage demo pictures play docs lint format bench nightly wheel clean

help: ## show this list
	@grep -hE '^[a-z]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## /\1\t/' | expand -t 10

system: ## install the system packages of Debian and its kin (as root)
	apt-get update -qq
	DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $(APT_PACKAGES) >/dev/null

# Without the rights, or without apt, the step that needs a missing tool says what it lacks.
tools:
	@command -v dpkg >/dev/null || exit 0; \
	missing=$$(for each in $(APT_PACKAGES); do dpkg -s $$each >/dev/null 2>&1 || echo $$each; done); \
	test -z "$$missing" || { echo "Missing system packages:" $$missing; \
	    test "$$(id -u)" != 0 || $(MAKE) --no-print-directory system || echo "Going on without them."; }

# A python3 without ensurepip can still have virtualenv.
$(VENV)/.created: | tools
	@$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); $(PYTHON) -m virtualenv -q $(VENV); } || \
	    { rm -rf $(VENV); echo "Cannot create $(VENV): install python3-venv or virtualenv"; exit 1; }
	@touch $@

# Built without isolation: an isolated build has new include paths each time and compiles everything
# again. `make wheel` is the isolated build.
$(VENV)/.requirements: pyproject.toml $(VENV)/.created
	@echo "Installing into $(VENV) from PyPI: build tools, test tools, all extras"
	@$(RUN) -m pip install --quiet "pip>=25.1"
	@$(RUN) -m pip install --quiet $(BUILD_REQUIRES) --group test
	@command -v cmake >/dev/null || $(RUN) -m pip install --quiet cmake ninja
	@touch $@

$(VENV)/.installed: $(SOURCES) $(VENV)/.requirements
	@echo "Building stickslip (two to five minutes the first time)"
	@$(RUN) -m pip install --quiet --no-build-isolation -C build-dir=$(BUILD) ".[all]"
	@echo "Installed in $(VENV): try $(VENV)/bin/stickslip run examples/walk.toml"
	@touch $@

install: $(VENV)/.installed ## build the package into .venv

# The tests in C++ link the core that the package was built from. Rewriting all assertions takes each
# process a third of its start: only those that failed are run again to tell their values.
test: install ## all tests but those of `make nightly`
	@cmake -S . -B $(BUILD) -DSTICKSLIP_BUILD_TESTS=ON >$(BUILD)/configure.log 2>&1 || { cat $(BUILD)/configure.log; exit 1; }
	@cmake --build $(BUILD) --target stickslip_tests
	@ctest --test-dir $(BUILD) --output-on-failure -j $(JOBS)
	@$(RUN) -m pytest -n $(JOBS) --dist worksteal --durations=10 --assert=plain $(PYTEST_ARGS) || \
	    { $(RUN) -m pytest -q --last-failed --last-failed-no-failures=none; exit 1; }

# A package of its own, whose core counts its lines; .venv keeps the fast one.
COVERAGE := build/coverage
coverage: install ## lines of both languages that the Python tests reach (PYTEST_ARGS chooses tests)
	@$(RUN) -m pip install --quiet --group coverage
	@rm -rf $(COVERAGE)/package && $(RUN) -m pip install --quiet --no-build-isolation --no-deps \
	    -C build-dir=$(COVERAGE)/core -C cmake.build-type=Debug -C install.strip=false \
	    -C cmake.define.CMAKE_CXX_FLAGS="-O1 --coverage" --target $(COVERAGE)/package .
	@PYTHONPATH=$(COVERAGE)/package $(RUN) -m pytest -n $(JOBS) --cov=stickslip \
	    --cov-report=term --cov-report=markdown-append:$(COVERAGE)/report.md $(PYTEST_ARGS)
	@gcovr --root . --filter cpp/ --exclude cpp/tests/ --print-summary \
	    --markdown-summary $(COVERAGE)/core.md $(COVERAGE)/core
	@cat $(COVERAGE)/core.md >> $(COVERAGE)/report.md

demo: install ## a short tour: a film, four walks as a table, pictures, into demo_output
	@mkdir -p demo_output
	stickslip run examples/walk.toml --plot demo_output/walk.png --animate demo_output/walk.webp
	stickslip sweep examples/walk.toml --vary drive.frequency=30,50,70,100 \
	    --plot demo_output/walks.png

pictures: install ## the pictures of README and documentation, into docs/images
	@$(RUN) docs/pictures.py

play: ## the page to play with, docs/play/index.html (needs em++)
	@$(PYTHON) cpp/web/build.py

docs: install ## the documentation, into docs/_build/html
	@$(RUN) -m pip install --quiet --group docs
	@$(RUN) -m sphinx --quiet --fail-on-warning --keep-going -b html docs docs/_build/html
	@echo "written: docs/_build/html/index.html"

lint: install ## ruff, mypy, stubtest, clang-format, clang-tidy, codespell
	@$(RUN) -m pip install --quiet --group lint
	@ruff check . && ruff format --check . && mypy && codespell
	@stubtest stickslip._core stickslip._machines --concise --allowlist cpp/bindings/stubtest.txt
	@clang-format --dry-run --Werror $(CXX_FILES)
	@cmake --preset tidy >/dev/null && cmake --build --preset tidy

format: $(VENV)/.requirements ## rewrite the layout of all sources
	@$(RUN) -m pip install --quiet --group lint
	@ruff check --fix --quiet . || true
	@ruff format --quiet . && clang-format -i $(CXX_FILES)

bench: install ## a benchmark or study (NAME=speed ARGS="..."; NAME=list lists them)
	@test $(NAME) != peers || $(RUN) -m pip install --quiet --group bench
	@$(RUN) -m bench $(NAME) $(ARGS)

nightly: install ## what `make test` leaves out, in a rotation (MINUTES=n)
	@$(RUN) -m pip install --quiet --group nightly
	@$(RUN) tests/nightly.py --minutes $(MINUTES) $(ARGS)

wheel: $(VENV)/.created ## an isolated build of the wheel, tried without a compiler
	@$(RUN) -m pip wheel --quiet --no-deps --wheel-dir dist .
	@rm -rf build/wheel && $(PYTHON) -m venv build/wheel
	@PATH=$(CURDIR)/build/wheel/bin CC=false CXX=false \
	    pip install --quiet --only-binary :all: $$(ls -t dist/*.whl | head -1)
	@cd build/wheel && PATH=$(CURDIR)/build/wheel/bin python ../../tests/check_run.py

clean: ## remove everything that can be built again
	rm -rf build dist docs/_build $(VENV) .pytest_cache .ruff_cache .mypy_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
