# The main job is `make verify`; `make test` runs the tests. Both set up .venv by themselves.

PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin

.PHONY: verify native native-platforms dist try-wheel faults test test-bare soak coverage lint bench site check-notebooks docs docs-check check-generated check-suite clean

# Both FMUs: StickSlip.fmu under Coulomb's friction law, StickSlipStribeck.fmu under friction that
# depends on the speed.
verify: $(VENV)/ready
	$(BIN)/stickslip build --bare
	$(BIN)/stickslip verify --fmu build/StickSlip.fmu --pack
	$(BIN)/stickslip build --bare --law stribeck
	$(BIN)/stickslip verify --fmu build/StickSlipStribeck.fmu --pack -o report/stribeck

# The FMUs that need no Python, for this machine: gcc or clang compiles them. STRIBECK may name
# options of the verdict under that law, whose truth takes minutes.
STRIBECK ?=
native: $(VENV)/ready
	$(BIN)/stickslip build --native --this-machine --bare
	$(BIN)/stickslip verify --fmu build/StickSlip_native.fmu --pack
	$(BIN)/stickslip build --native --this-machine --bare --law stribeck
	$(BIN)/stickslip verify --fmu build/StickSlipStribeck_native.fmu --pack -o report/stribeck $(STRIBECK)
	$(BIN)/stickslip verify --law lugre -o report/lugre
	$(BIN)/stickslip verify --law rate_state -o report/rate_state

# The native FMU for all platforms: its libraries are read, and run on Linux ARM64 and on Windows as
# far as qemu and wine are installed (CONTRIBUTING.md). It installs ziglang, 411 MB, whose first build
# for Windows takes minutes.
native-platforms: $(VENV)/ready-with-compiler
	$(BIN)/python -m pytest --durations 30 tests/native/platforms

# What a user downloads, in dist/: the wheel, each FMU with the verdict on all cases, and checksums.
dist: $(VENV)/ready-with-compiler
	rm -rf dist
	$(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --wheel-dir dist .
	for law in coulomb stribeck; do for options in '' '--native' '--fmi 3'; do \
	    $(BIN)/stickslip build --bare -o dist --law $$law $$options || exit; done; done
	for fmu in dist/*.fmu; do $(BIN)/stickslip verify --fmu $$fmu --pack || exit; done
	$(MAKE) try-wheel
	cd dist && sha256sum *.fmu *.whl > SHA256SUMS

# The wheel in an environment of its own, with the first commands of docs/start/simulator.md.
TRIED := build/wheel
try-wheel:
	rm -rf $(TRIED)
	$(PYTHON) -m venv $(TRIED)
	$(TRIED)/bin/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt dist/*.whl
	cd $(TRIED) && PATH=$$PWD/bin:$$PATH sh -ec "$$(sed -n '/^```bash/,/^```$$/{/^```/d;p}' $(CURDIR)/docs/start/simulator.md)"

# The suite on trial as well: every planted fault must fail a check named in advance.
faults: $(VENV)/ready
	$(BIN)/stickslip build --bare
	$(BIN)/python -m stickslip_verification faults build/StickSlip.fmu -o report/faults
	$(BIN)/stickslip build --bare --law stribeck
	$(BIN)/python -m stickslip_verification faults build/StickSlipStribeck.fmu -o report/faults/stribeck

# On all cores, each worker in its own part of the tests till another one has nothing left to do.
# TESTS may name a part of the tests, and options: --gate adds what the gate adds. It ends with the
# CPU seconds of user and system, those of all child processes in the second line.
TESTS ?= tests
RUN ?=
PYTEST := -m pytest -p no:nbval -p no:zarr --numprocesses logical --dist worksteal --durations 20
test: $(VENV)/ready-to-test
	@$(BIN)/python tools/reaper.py sh -c '$(BIN)/python $(RUN) $(PYTEST) $(TESTS); code=$$?; \
	    echo "CPU time, user and system:"; times; exit $$code'

# The tests of the gate that need more than pip brings, as on a machine that has none of it, and as
# on one that has it by half.
test-bare: $(VENV)/ready-to-test
	$(BIN)/python -m tests.bare none
	$(BIN)/python -m tests.bare half

# Everything at full size, an hour or two; it prints the time of each part.
soak: $(VENV)/ready-to-test
	tests/soak.sh $(BIN)

# Lines and branches that the tests run, package by package. The block and the reference must have
# 95 %, in C as well. What runs inside FMUs counts for fmu_src/.
coverage: $(VENV)/ready-to-test
	$(BIN)/python -m coverage erase
	$(MAKE) test RUN="-m coverage run" TESTS="$(TESTS)"
	$(BIN)/python -m coverage combine --quiet
	-$(BIN)/python -m coverage report --include='workbench/*' | tail -n 1
	-$(BIN)/python -m coverage report --include='verification/*' | tail -n 1
	$(BIN)/python -m coverage report --include='src/*' --show-missing --fail-under=95
	$(BIN)/python -m coverage report --include='fmu_src/*' --show-missing --fail-under=95
	$(BIN)/python -m tests.native.coverage

lint: $(VENV)/ready-to-test
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo --no-cache

bench: $(VENV)/ready-to-test
	$(BIN)/python -m benchmarks.bench

# The site from docs/, in build/site: it opens from a folder, and asks for nothing on a network. With
# SITE=https://... in the environment a link to its live page shows a picture.
site: $(VENV)/ready-for-site
	$(BIN)/sphinx-build -W --keep-going -q -d build/doctrees docs build/site

# The notebooks of the site print what they hold.
check-notebooks: $(VENV)/ready-for-site
	$(BIN)/python -m pytest --nbval --nbval-current-env docs/tutorials docs/gallery.ipynb

# Files under docs/ that are made from the code.
docs: $(VENV)/ready
	$(BIN)/stickslip simulate --stop-time 2 --plot docs/stick-slip.png
	$(BIN)/python docs/generate.py
	$(BIN)/python -m examples.feed_axis
	cp build/feed_axis/run.svg docs/feed-axis.svg
	$(BIN)/python -m examples.memory docs/memory.png

# Both run on one core, and so beside each other.
docs-check: $(VENV)/ready
	$(MAKE) --jobs 2 --output-sync check-generated check-suite

# With REPORTS of both FMUs, as `make verify` and `make faults` write them, it verifies none anew.
REPORTS ?=
check-generated: $(VENV)/ready
	$(BIN)/python docs/generate.py --check $(REPORTS)

check-suite: $(VENV)/ready
	$(BIN)/python -m stickslip_verification lint

clean:
	rm -rf build dist report $(VENV)

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/ready: $(VENV)/bin/python pyproject.toml constraints.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[studies]'
	@# Where Python may write no bytecode, each of some hundred processes would compile all anew.
	$(BIN)/python -m compileall -q fmu_src src verification workbench examples
	touch $@

$(VENV)/ready-to-test: $(VENV)/ready
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[dev,importers,page,cluster]'
	touch $@

$(VENV)/ready-for-site: $(VENV)/ready
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[site]'
	touch $@

$(VENV)/ready-with-compiler: $(VENV)/ready-to-test
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[native-platforms]'
	touch $@
