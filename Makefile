# make run    the viewer on a simulated camera, with a hand that moves the board by itself
# make test   every check and every test
# Only python3 and make are assumed; the rest is set up once, inside this folder. System packages
# come by apt where that is allowed, and are named in one line where it is not.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SETUP := PYTHON="$(PYTHON)" sh scripts/setup.sh
PINS := pyproject.toml constraints.txt constraints-3.14.txt scripts/setup.sh

.DEFAULT_GOAL := help
.PHONY: help run test test-all lint format docs gallery pace soak soak-live speed clean

help:
	@sed -n 's/^# \(make .*\)/\1/p' Makefile
	@echo "make lint   ruff, pyright and the import directions only"
	@echo "make test-all   make test, and the engine's tests on OpenCV 4"
	@echo "make docs   build the documentation as a site, site/index.html"
	@echo "make gallery   take the screenshots of docs/gallery.md anew"
	@echo "make pace   measure how steadily the page is served"
	@echo "make soak   100,000 frames through the live guide; memory, threads, handles stay flat"
	@echo "make speed   time the bundle adjustment beside OpenCV's, and the detection of each kind"
	@echo "make format   let ruff put the code in order"
	@echo "make clean   remove what the other commands made"

run: $(VENV)/.ready-run
	$(BIN)/venus3d guide sim --autopilot

# A browser takes most of a core, so two at a time; more starve each other. Of everything else some
# waits and some computes: three workers keep two cores busy.
test: lint
	@failed=0; \
	echo "pytest -n 3 -m 'not browser'"; \
	$(BIN)/pytest -n 3 -m "not browser" || failed=1; \
	echo "pytest -n 2 -m browser"; $(BIN)/pytest -n 2 -m browser || failed=1; \
	exit $$failed

lint: $(VENV)/.ready-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/pyright
	$(BIN)/lint-imports

# The lowest OpenCV that pyproject.toml allows, so that the range is true at both ends.
test-all: test .venv-opencv4/.ready
	.venv-opencv4/bin/pytest tests/engine

# Minutes of failing live sources, and a session on a network camera that is cut off.
soak-live: $(VENV)/.ready-test
	@$(SETUP) system-soak
	$(BIN)/python -m tests.sources.soak.live_sources
	$(BIN)/python -m tests.sources.soak.session

docs: $(VENV)/.ready-test
	$(BIN)/python scripts/docs.py

gallery: $(VENV)/.ready-test
	$(BIN)/python scripts/gallery.py

pace: $(VENV)/.ready-test
	$(BIN)/python scripts/pace.py

# An hour or more; FRAMES=10000 is a tenth of it.
soak: $(VENV)/.ready-test
	$(BIN)/python -m tests.soak --frames $(or $(FRAMES),100000)

speed: $(VENV)/.ready-test
	$(BIN)/python scripts/adjustment_speed.py
	$(BIN)/python scripts/detection_speed.py

format: $(VENV)/.ready-test
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

$(VENV)/.ready-run: $(PINS)
	@$(SETUP) system-run
	@$(SETUP) venv $(VENV) '-e.[study]'
	@touch $@

$(VENV)/.ready-test: $(PINS)
	@$(SETUP) system-test
	@$(SETUP) venv $(VENV) '-e.[test]'
	@touch $@ $(VENV)/.ready-run

.venv-opencv4/.ready: $(PINS)
	@$(SETUP) venv .venv-opencv4 '-e.[test]' opencv-contrib-python-headless==4.14.0.94
	@touch $@

clean:
	rm -rf site .venv .venv-opencv4 .pytest_cache .ruff_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
