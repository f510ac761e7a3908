# `make demo` and `make test` set everything up themselves; they need Python 3.11 or newer, and make.

VENV := .venv
BIN := $(VENV)/bin
PYTHONS := 3.11 3.12 3.13 3.14
# Of Python code, in percent at least. Only in .ci/run: tracing makes the tests 40 % slower.
COVERAGE := $(if $(CI),--cov --cov-report=term --cov-fail-under=85)
STAMP := $(VENV)/.installed
PEERS := benchmarks/.venv
ROS := .venvs/ros
FIND_PYTHON = for python in python3.11 python3 python3.12 python3.13 python; do \
	$$python -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' 2>/dev/null \
	&& echo $$python && break; done

.PHONY: help setup check test test-ros test-ros-0 test-ros-1 test-all dist docs pictures demo results bench clean

help:
	@echo "make setup   make .venv and install dynastar with its tools into it"
	@echo "make demo    drive across the office; pictures and numbers in out/demo"
	@echo "make test    run the tests (those on public data, too, where DYNASTAR_DATA has it)"
	@echo "make test-ros  those of the ROS 2 nodes alone, in an environment of their own"
	@echo "make test-all  make test with each Python of $(PYTHONS) that is found, installed from the wheel"
	@echo "make check   ruff, mypy, import-linter"
	@echo "make docs    the documentation as a site of HTML, in out/docs"
	@echo "make pictures  the pictures of README and playground anew (needs chromium)"
	@echo "make dist    wheel and source distribution in dist"
	@echo "make results  all tables and pictures of the pages anew (needs DYNASTAR_DATA); about five hours; resumes"
	@echo "make bench   how fast it is, beside others, in an environment of its own"
	@echo "make clean   remove .venv, out and caches"

setup: $(STAMP)

$(STAMP): pyproject.toml
	@python=$$($(FIND_PYTHON)); \
	test -n "$$python" || { echo "dynastar needs Python 3.11 or newer with venv" \
	"(Debian: apt-get install python3 python3-venv)" >&2; exit 2; }; \
	test -x $(BIN)/python || $$python -m venv $(VENV)
	@echo "installing dynastar and its tools into $(VENV)"
	$(BIN)/python -m pip install --disable-pip-version-check -e ".[dev]"
	@touch $@

check: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

test: setup
	$(BIN)/python -m pytest -n 2 --dist worksteal $(COVERAGE)
	@$(MAKE) --no-print-directory test-ros

# In an environment of its own: the wheels of ROS 2 start Python anew to find their libraries.
test-ros: $(ROS)/.installed
	@if test -x $(ROS)/bin/pytest; then $(MAKE) --no-print-directory -j 2 test-ros-0 test-ros-1; \
	else echo "tests of the ROS 2 nodes skipped: their wheels cannot be installed here"; fi

# Two processes, for most of the time is spent waiting; each has a ROS domain of its own.
test-ros-0: ROS_TESTS = tests/ros/nodes --ignore tests/ros/nodes/test_nodes.py
test-ros-1: ROS_TESTS = tests/ros/nodes/test_nodes.py
test-ros-0 test-ros-1:
	@export ROS_TEST_GROUP=$(subst test-ros-,,$@); \
	$(ROS)/bin/pytest -q $(ROS_TESTS) || { test $$? -ge 128 && \
	echo "a library of ROS 2 crashed the tests; once more" && $(ROS)/bin/pytest -q $(ROS_TESTS); }

$(ROS)/.installed: pyproject.toml tests/ros/interfaces/build.sh
	@python=$$($(FIND_PYTHON)); test -x $(ROS)/bin/python || $$python -m venv $(ROS)
	@$(ROS)/bin/python -m pip install --quiet --disable-pip-version-check \
	-e ".[ros]" pytest hypothesis mcap-ros2-support || rm -f $(ROS)/bin/pytest
	@test ! -x $(ROS)/bin/pytest || tests/ros/interfaces/build.sh $(ROS) >$(ROS)/interfaces.log 2>&1 \
	|| echo "tests of Nav2's actions and of tf will be skipped: see $(ROS)/interfaces.log"
	@touch $@

docs: setup
	$(BIN)/python -m sphinx -q -W --keep-going -b html docs out/docs
	@echo "open out/docs/index.html"

pictures: setup
	$(BIN)/python docs/make_pictures.py
	$(BIN)/python docs/bag_picture.py

dist: setup
	rm -rf dist
	$(BIN)/python -m build --outdir dist .

# Tests the wheel, and drives the demo outside of the clone.
test-all: dist
	@for version in $(PYTHONS); do \
	python=$$(command -v python$$version || uv python find --no-project $$version 2>/dev/null); \
	test -n "$$python" || { echo "Python $$version: not found, not tried"; continue; }; \
	venv=$(CURDIR)/.venvs/$$version; \
	test -x $$venv/bin/python || "$$python" -m venv $$venv || exit 1; \
	$$venv/bin/python -m pip install --quiet --disable-pip-version-check --force-reinstall --no-deps dist/*.whl \
	&& $$venv/bin/python -m pip install --quiet --disable-pip-version-check "$$(echo dist/*.whl)[dev]" \
	&& (cd $$venv && bin/dynastar demo --out demo --no-gif </dev/null) \
	&& $$venv/bin/python -m pytest -n 2 --dist worksteal || { echo "Python $$version: failed"; exit 1; }; \
	echo "Python $$version: passed"; done

demo: setup
	@$(BIN)/dynastar demo --out out/demo

results: setup
	@$(BIN)/python -c "import jupedsim, kompass_core" 2>/dev/null || \
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[kompass,pedestrians]"
	$(BIN)/python benchmarks/results.py

$(PEERS)/.installed: benchmarks/requirements.txt $(STAMP)
	test -x $(PEERS)/bin/python || $(BIN)/python -m venv $(PEERS)
	$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check -e . -r benchmarks/requirements.txt
	-$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check --no-build-isolation \
	dynamic-window-approach==1.1.1  # from source; left out where there is no C compiler
	@touch $@

bench: $(PEERS)/.installed
	$(PEERS)/bin/python benchmarks/grids.py --quick $${DYNASTAR_DATA:+--data "$$DYNASTAR_DATA"}
	$(PEERS)/bin/python benchmarks/grids.py --largest 512
	$(PEERS)/bin/python benchmarks/replanning.py
	$(PEERS)/bin/python benchmarks/plan_times.py
	$(PEERS)/bin/python benchmarks/heuristic.py
	$(PEERS)/bin/python benchmarks/memory.py
	$(PEERS)/bin/python benchmarks/memory.py 16384 --maps "random 20%" "rooms 65"
	$(PEERS)/bin/python benchmarks/field.py
	$(PEERS)/bin/python benchmarks/window.py
	$(PEERS)/bin/python benchmarks/tick.py
	@mkdir -p out
	$(PEERS)/bin/python benchmarks/growth.py --out out/growth.png
	$(PEERS)/bin/python benchmarks/startup.py

clean:
	rm -rf $(VENV) .venvs $(PEERS) out build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
	rm -rf .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
