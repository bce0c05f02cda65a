# Two commands do all there is to do on a machine with Python 3.11 and make:
#   make test        sets everything up, then passes the tests
#   make reproduce   sets everything up, then computes Figures 2-7 and the verdict on every claim
PYTHON ?= python3.11
QUALITY ?= quick
OUT ?= $(if $(filter full,$(QUALITY)),reproduction-full,reproduction)
BIN := .venv/bin

.PHONY: setup test slow lint reproduce bench clean

setup: .venv/ready

.venv/ready: pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable ".[test]"
	touch $@

test: setup
	$(BIN)/python -m pytest -n 2 --dist loadfile  # a file's tests share compiled kernels

slow: setup
	$(BIN)/python -m pytest -m slow

lint: setup
	$(BIN)/ruff check src tests benchmarks
	$(BIN)/mypy
	$(BIN)/lint-imports

reproduce: setup
	$(BIN)/whirlmap reproduce --quality $(QUALITY) --out $(OUT)

bench: setup
	$(BIN)/whirlmap bench

clean:
	rm -rf .venv build dist
