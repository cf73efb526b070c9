# Everything a newcomer needs: make demo, make test, make lint, make types, make bench.
# Makes its own environment in .venv; needs nothing but Python 3.11 or newer and make.

.RECIPEPREFIX = >
SHELL := /bin/sh
VENV := .venv
RUN := $(VENV)/bin/python
STAMP := $(VENV)/.installed
SAMPLE := samples/flat
PYTHON ?= $(shell for p in python3.12 python3.11 python3.13 python3 python; do \
    $$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && break; done)

.PHONY: demo test lint types bench clean

demo: $(STAMP)
> mkdir -p demo
> $(VENV)/bin/floorplan build $(SAMPLE) --work demo/work --dxf demo/plan.dxf --svg demo/plan.svg --png demo/plan.png --report demo/plan.html

test: $(STAMP)
> $(RUN) -m pytest --numprocesses auto --dist loadfile

lint: $(STAMP)
> $(VENV)/bin/ruff check .

types: $(STAMP)
> $(VENV)/bin/mypy

bench: $(STAMP)
> $(RUN) -m tests.bench

clean:
> rm -rf $(VENV) demo

$(STAMP): pyproject.toml
> @test -n "$(PYTHON)" || { echo "Python 3.11 or newer is needed; give its path: make PYTHON=/path/to/python3" >&2; exit 1; }
> $(PYTHON) -m venv $(VENV)
> $(RUN) -m pip install --quiet --upgrade "pip>=25.1"
> $(RUN) -m pip install --quiet --editable . --group dev
> touch $@
