# `make render` on a bare Debian or Ubuntu with Python 3.11 or newer: sets everything up and draws a picture.
# PYTHON=/path/to/python chooses the interpreter for a new .venv; SECONDS_=30 shortens `make render`.
PYTHON ?=
SECONDS_ ?= 150
BIN = .venv/bin
KERNELS = $(wildcard cl_kernels/*/*.cl)
# one worker a core: a CPU compiler works on one core while another worker's kernels run; a file's tests share its compiles
WORKERS = -n auto --dist loadfile
SETUP = PYTHON="$(PYTHON)" sh tools/setup.sh

.PHONY: help render test test-long lint format setup setup-dev clean

help:
	@echo "make render     set up (.venv, pylmc, OpenCL) and draw out/keyhole.exr, .png and .json"
	@echo "make test       set up and run the tests"
	@echo "make test-long  set up and run all tests, the long ones too"
	@echo "make lint       set up and run ruff, clang-format and mypy, which change nothing"
	@echo "make format     set up and have ruff and clang-format lay out Python and kernels"
	@echo "make clean      remove what the above made (.venv, .opencl, caches; pictures in out/ stay)"

setup:
	@$(SETUP)

setup-dev:
	@$(SETUP) --dev

render: setup
	@mkdir -p out
	$(BIN)/pylmc render keyhole -o out/keyhole.exr --seconds $(SECONDS_)

test: setup-dev
	$(BIN)/python -m pytest -m "not long" $(WORKERS)

test-long: setup-dev
	$(BIN)/python -m pytest $(WORKERS)

lint: setup-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check --quiet .
	$(BIN)/clang-format --dry-run -Werror $(KERNELS)
	$(BIN)/mypy

format: setup-dev
	$(BIN)/ruff format .
	$(BIN)/clang-format -i $(KERNELS)

clean:
	rm -rf .venv .opencl build dist *.egg-info .pytest_cache .ruff_cache .mypy_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
