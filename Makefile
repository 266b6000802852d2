# The main job is `make verify`; `make test` runs the tests. Both set up .venv by themselves.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin

.PHONY: verify convict test test-bare soak lint prove bench docs docs-check clean

verify: $(VENV)/ready
	$(BIN)/stickslip build --bare
	$(BIN)/stickslip verify --fmu build/StickSlip.fmu --pack

# The suite on trial as well: every planted fault must fail a check named in advance. Minutes.
convict: $(VENV)/ready
	$(BIN)/stickslip build --bare
	$(BIN)/stickslip verify --fmu build/StickSlip.fmu --mutants

# On all cores, each worker in its own part of the tests till another one has nothing left to do.
TESTS := $(BIN)/python -m pytest --numprocesses logical --dist worksteal --durations 30
test: $(VENV)/ready-to-test
	$(TESTS)

# The tests that need more than pip brings, as on a machine that has none of it.
test-bare: $(VENV)/ready-to-test
	$(BIN)/python -m tests.bare

# Everything at full size, an hour at most; it prints the time of each part.
soak: $(VENV)/ready-to-test
	tests/soak.sh $(BIN)

lint: $(VENV)/ready-to-test
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/stickslip lint

# The random sets of the specification in full; SEED and FRACTION may be set.
SEED ?= 1
FRACTION ?= 1
prove: $(VENV)/ready
	$(BIN)/stickslip prove --seed $(SEED) --fraction $(FRACTION)

bench: $(VENV)/ready-to-test
	$(BIN)/python -m benchmarks.bench

# Files under docs/ that are made from the code.
docs: $(VENV)/ready
	$(BIN)/stickslip simulate --stop-time 2 --plot docs/stick-slip.png
	$(BIN)/python docs/generate.py
	$(BIN)/python -m examples.feed_axis study

docs-check: $(VENV)/ready
	$(BIN)/python docs/generate.py --check
	$(BIN)/python -m examples.feed_axis study --check

clean:
	rm -rf build report $(VENV)

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/ready: $(VENV)/bin/python pyproject.toml constraints.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable .
	touch $@

$(VENV)/ready-to-test: $(VENV)/ready
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dev,importers,page,pdf]'
	touch $@
