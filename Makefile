# Two commands do all the set-up: `make demo` and `make test`. Both work in .venv.

PYTHON ?= python3
BIN := .venv/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
PIP := $(BIN)/python -m pip --quiet --disable-pip-version-check
# what is pinned by version and hash, then this package with nothing else
INSTALL_PINNED := $(PIP) install --no-deps --require-hashes --requirement
INSTALL_THIS := $(PIP) install --no-deps --no-build-isolation --editable .
PIN := $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-header --no-annotate
# a file's tests stay in one process; where a process crashes, its test fails and the rest is not tried
PARALLEL := --numprocesses=auto --dist=loadfile --max-worker-restart=0
COPY := $(CURDIR)/build/checkout
PACKAGED := src fmus sims pyproject.toml README.md LICENSE THIRD_PARTY.md
FIGURES := $(CURDIR)/tests/validation/tables/attack.csv
VERDICTS := $(CURDIR)/tests/validation/tables/verdicts.csv
VALIDATE := PYTHONPATH=tests $(BIN)/python -m validation

# tests start hundreds of processes: each would compile the package again, which takes longer than most that it does
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test tests test-all coverage check stress attack verdicts bench foreign docs site validation wheel runtime pins clean

demo: .venv/installed
	$(BIN)/loomfmu run sims/wl680_3600.toml

# both at once: mypy takes one core
test: .venv/installed-for-tests
	$(MAKE) --no-print-directory --jobs=2 check tests

tests: .venv/installed-for-tests
	$(BIN)/python -m pytest $(PARALLEL)

# all tests, with all of Hypothesis' examples: the slow ones, stress and the attack as well. Hours
test-all: .venv/installed-for-tests check
	$(BIN)/python -m pytest $(PARALLEL) --all

# the lines that the tests of `make test` run; fewer than that share fails
coverage: .venv/installed-for-tests
	$(BIN)/python -m pytest $(PARALLEL) --cov --cov-report=term --cov-fail-under=90

check: .venv/installed-for-tests
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# the stress tests and the attack, the long ones included
stress: .venv/installed-for-tests
	$(BIN)/python -m pytest tests/stress tests/attack --all

# kills, hostile files from a generator and random calls, the long sets included; their figures go into the report
attack: .venv/installed-for-tests
	rm -f $(FIGURES)
	ATTACK_FIGURES=$(FIGURES) $(BIN)/python -m pytest tests/attack tests/native/test_hosts.py -s --all
	$(VALIDATE)

# verdicts on random scenes beside the truth by far finer steps; their figures go into the report. Half an hour
verdicts: .venv/installed-for-tests
	PYTHONPATH=tests $(BIN)/python -m verdicts --list-wrong --output $(VERDICTS); \
	status=$$?; $(VALIDATE) && exit $$status

# run time against error, side by side with other masters: about a quarter of an hour
bench: .venv/installed-for-tests
	$(BIN)/python tests/benchmarks

# our FMUs in the other tools that are installed, and FMUs of other makers (FOREIGN_FMUS=DIRECTORY) in ours;
# writes results/foreign.md. Ten minutes
foreign: .venv/installed-for-tests
	PYTHONPATH=tests $(BIN)/python tests/foreign

# the tables of variables in the READMEs of the FMUs, and their reference results
docs: .venv/installed
	$(BIN)/python docs/write_fmu_pages.py

# the documentation site, in build/site: open index.html, no server is needed
site: .venv/installed-for-tests
	$(BIN)/python docs/build_site.py

# the report that compares everything published with what is computed
validation: .venv/installed-for-tests
	$(VALIDATE)

# what is linked of the C library, of the installed version of the compiler
runtime: .venv/installed
	$(BIN)/python -m loomfmu.fmi.native.runtime

# a package that brings native FMUs and its other libraries for all platforms: who installs it needs no compiler;
# built in a copy, since what an interrupted build leaves in src would be run
wheel: .venv/installed
	@echo "building the package: native FMUs and libraries for Linux, Windows and macOS, which takes up to ten minutes"
	rm -rf $(COPY) && mkdir -p $(COPY)
	cp -R $(PACKAGED) $(COPY)
	$(BIN)/python -c "from loomfmu.commit import commit; print(commit())" > $(COPY)/src/loomfmu/commit.txt
	PYTHONPATH=$(COPY)/src $(BIN)/python -c "from loomfmu.fmi.shipping import build_all; build_all()"
	@echo "packing it into dist"
	$(PIP) wheel --no-deps --no-build-isolation --wheel-dir dist $(COPY)
	rm -r $(COPY)

.venv/created:
	@echo "making an environment in .venv"
	$(PYTHON) -c "import sys; sys.exit('loomfmu needs Python 3.11 or newer, this is ' + sys.version.split()[0] if sys.version_info < (3, 11) else 0)"
	$(PYTHON) -m venv .venv
	touch $@

# with all that the README's commands need
.venv/installed: .venv/created pyproject.toml pins/run.txt
	@echo "installing the packages of pins/run.txt, which takes about a minute"
	$(INSTALL_PINNED) pins/run.txt
	$(INSTALL_THIS)
	touch $@

.venv/installed-for-tests: .venv/created pyproject.toml pins/test.txt
	@echo "installing the packages of pins/test.txt, which takes a minute or two"
	$(INSTALL_PINNED) pins/test.txt
	$(INSTALL_THIS)
	touch .venv/installed $@

# for all platforms and Pythons; versions that are pinned stay: delete a line to have a newer one
pins: .venv/created
	$(PIP) install uv
	$(PIN) pyproject.toml --group build --extra test --output-file pins/test.txt
	$(PIN) pyproject.toml --group build --extra all --constraint pins/test.txt --output-file pins/run.txt

clean:
	rm -rf .venv build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis .coverage
