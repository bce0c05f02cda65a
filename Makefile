# Two commands do all there is to do on a machine with Python 3.11 or newer and make:
#   make test        sets everything up, then passes the tests
#   make reproduce   sets everything up, then computes Figures 2-7 and the verdict on every claim
# make setup alone installs the program into .venv. PYTHON=... chooses another Python than the first that is new enough.
NEW_ENOUGH := import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))
PYTHON ?= $(shell for p in python3 python3.11 python3.12 python3.13 python3.14 python; do \
  "$$p" -c '$(NEW_ENOUGH)' >/dev/null 2>&1 && echo "$$p" && break; done)
QUALITY ?= quick
OUT ?= $(if $(filter full,$(QUALITY)),reproduction-full,reproduction)
BIN := .venv/bin

.PHONY: setup python test slow validation lint docs reproduce bench clean

setup: .venv/ready
	@echo "whirlmap is installed in .venv. Call it as $(BIN)/whirlmap, or first activate it:  . $(BIN)/activate"

python:
	@"$(PYTHON)" -c '$(NEW_ENOUGH)' 2>/dev/null || { \
	  echo "whirlmap needs Python 3.11 or newer, with venv and pip (on Debian and Ubuntu: apt install python3-venv)."; \
	  echo "Found: $$("$(or $(PYTHON),python3)" --version 2>&1 || echo none). With another one:  make PYTHON=/path/to/python3.12 setup"; \
	  exit 1; } >&2

.venv/ready: pyproject.toml constraints.txt | python
	"$(PYTHON)" -m venv .venv
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable .
	touch $@

.venv/tested: .venv/ready
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable ".[test]"
	touch $@

test: .venv/tested
	$(BIN)/python -m pytest -n 2 --dist loadfile  # a file's tests share compiled kernels

slow: .venv/tested
	$(BIN)/python -m pytest -m slow

validation: .venv/tested  # docs/validation.md, out of the tests that compare with known answers: some ten minutes
	$(BIN)/python -m pytest -m "" -n 2 --dist loadfile --validation docs/validation.md

lint: .venv/tested
	$(BIN)/ruff check src tests benchmarks docs
	$(BIN)/mypy
	$(BIN)/lint-imports

.venv/documented: .venv/ready
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable ".[docs]"
	touch $@

docs: .venv/documented  # the site, build/docs/index.html; once installed it needs no network
	$(BIN)/python -m sphinx --fail-on-warning --keep-going -b html docs build/docs

reproduce: .venv/ready
	$(BIN)/whirlmap reproduce --quality $(QUALITY) --out $(OUT)

bench: .venv/tested
	$(BIN)/whirlmap bench

clean:
	rm -rf .venv build dist docs/examples docs/reference/generated
