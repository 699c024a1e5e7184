# Galewood: `make run` shows a swaying forest, `make test` proves it. `make help` lists the rest.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
PORT ?= 8000
HOST ?= 127.0.0.1
GALEWOOD_DATA_DIR ?= data
export PORT HOST GALEWOOD_DATA_DIR
# Compiled modules are kept too: the tests start hundreds of processes, each of which would compile them again.
unexport PYTHONDONTWRITEBYTECODE
# Compiled kernels are kept beside the data, so that a second start does not compile again.
export NUMBA_CACHE_DIR ?= $(CURDIR)/build/numba
PIP_INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes --no-deps
PYTEST ?= $(BIN)/python -m pytest
QUIETLY := --reporter=dot --silent=passed-only
# in the order of tests/conftest.py, not by the number of tests in a file, so that none of the longest starts last
# the log ends with the longest tests
IN_PARALLEL := --quiet -n 3 --dist loadfile --no-loadscope-reorder --durations=60 --durations-min=4
# What a step prints goes to build/log, and is shown if it fails.
STEP := @$(PYTHON) scripts/step.py
# All that a wheel is made of, beside the page.
WHEEL_SOURCES := $(shell find precompute server assets -type f -not -path '*/__pycache__/*' 2>/dev/null) \
	pyproject.toml setup.py README.md LICENSE NOTICE
KERNEL_SOURCES := precompute/galewood/constants.py $(shell grep -rl numba precompute/galewood --include='*.py' 2>/dev/null)
WEB_SOURCES := $(shell find web/src web/public web/player/src -type f 2>/dev/null) web/index.html web/vite.config.ts tsconfig.json \
	web/player/package.json

GROWER_SOURCES := $(shell find tools/species -type f -not -path '*/dist/*' 2>/dev/null) web/player/src/core/constants.ts
PLAYER_SOURCES := $(shell find web/player/src web/player/*.mjs web/player/*.json -type f 2>/dev/null)

.PHONY: help run develop build player trees wheel test test-long test-all check coverage docs test-python test-python-long test-python-versions test-release test-wheel test-distributed test-containers test-web test-tools test-e2e test-e2e-long test-javascript-long browser bench format species constants golden page-types audit clean

help: ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

# ---- set-up: each stamp is newer than the lock file it was made from -------------------------------
$(VENV)/.base: requirements/base.txt pyproject.toml setup.py
	@echo "Setting up Python packages (once)"
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@$(PIP_INSTALL) -r requirements/base.txt
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

$(VENV)/.dev: requirements/dev.txt requirements/client.txt $(VENV)/.base
	@echo "Setting up development packages (once)"
	@$(PIP_INSTALL) -r requirements/dev.txt
	@$(PIP_INSTALL) -r requirements/client.txt
	@touch $@

node_modules/.stamp: package-lock.json
	@echo "Setting up the page's packages (once)"
	@npm ci --no-audit --no-fund --loglevel=error >/dev/null
	@touch $@

web/dist/index.html: node_modules/.stamp $(WEB_SOURCES)
	@cd web && npm run --silent build -- --logLevel warn

web/player/dist/core.js: node_modules/.stamp $(PLAYER_SOURCES)
	@cd web && npm run --silent build:player

tools/species/dist/grower.mjs: node_modules/.stamp $(GROWER_SOURCES)
	@npm run --silent build --prefix tools/species

# The longest step of a first build.
build/.kernels: $(VENV)/.base $(KERNEL_SOURCES)
	@echo "Compiling the numeric kernels (once)"
	@mkdir -p build
	$(STEP) kernels $(BIN)/galewood compile
	@touch $@

SITE := build/.kernels web/dist/index.html web/player/dist/core.js tools/species/dist/grower.mjs

# ---- everyday --------------------------------------------------------------------------------------
player: web/player/dist/core.js ## the npm package for other pages, in web/player/dist

trees: node_modules/.stamp ## the npm package of the built-in trees, in build/npm
	@mkdir -p build/npm && cd web/trees && npm pack --silent --offline --pack-destination ../../build/npm

develop: build player $(VENV)/.dev ## what tests and checks need as well

build: $(VENV)/.base ## set everything up, compile the kernels and build the page
	@$(MAKE) --no-print-directory --jobs 2 --output-sync=line build/.kernels web/dist/index.html tools/species/dist/grower.mjs

wheel: build/wheel/.made ## one wheel with everything to install elsewhere, in build/wheel

build/wheel/.made: $(VENV)/.base web/dist/index.html web/player/dist/core.js tools/species/dist/grower.mjs $(WHEEL_SOURCES)
	@rm -rf build/wheel
	@$(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps --no-build-isolation --wheel-dir build/wheel .
	@touch $@

run: ## serve the forest at http://127.0.0.1:8000 (PORT, HOST, GALEWOOD_DATA_DIR change where)
	@# the service compiles the kernels itself, beside its first visitors
	@$(MAKE) --no-print-directory --jobs 2 --output-sync=line $(VENV)/.base web/dist/index.html
	@$(BIN)/galewood serve

test: ## set everything up and run the tests of what the software promises; test-long has the others
	@# more steps than cores: the tests of the browser and the service wait for much of their time
	@$(MAKE) --no-print-directory --jobs 3 build/.kernels check test-python test-e2e test-web

test-long: $(VENV)/.dev $(SITE) ## the tests that `make test` leaves out: the wheel, whole builds, random damage, bundlers
	@# two rows of steps that take about as long as each other
	@$(MAKE) --no-print-directory --jobs 2 test-python-long test-javascript-long

test-all: test test-long ## every test but those of test-release, test-distributed and test-containers

check: $(VENV)/.dev node_modules/.stamp docs ## linters, formatters and type checkers of both languages, of the container files and the documents too
	$(STEP) ruff $(BIN)/ruff check .
	$(STEP) format $(BIN)/ruff format --check .
	$(STEP) imports $(BIN)/lint-imports --no-cache
	$(STEP) page-types $(BIN)/python scripts/write_page_types.py --check
	$(STEP) constants $(BIN)/python -m scripts.check_constants
	$(STEP) structure $(BIN)/python -m scripts.structure
	$(STEP) vulture $(BIN)/vulture
	@# a larger young generation: an eighth less CPU time
	$(STEP) pyright env NODE_OPTIONS=--max-semi-space-size=128 node_modules/.bin/pyright
	$(STEP) biome npm run --silent lint
	$(STEP) knip npm run --silent unused
	$(STEP) tsc npm run --silent typecheck
	$(STEP) compose $(BIN)/check-jsonschema --builtin-schema vendor.compose-spec docker-compose.yml
	$(STEP) workflow $(BIN)/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/ci.yml
	$(STEP) citation $(BIN)/check-jsonschema --builtin-schema vendor.citation-file-format CITATION.cff
	$(STEP) hadolint $(BIN)/hadolint Dockerfile .devcontainer/Dockerfile

test-python: $(VENV)/.dev build/.kernels web/dist/index.html tools/species/dist/grower.mjs ## the Python tests
	@# the tests of the browser take longest, so they come first
	$(STEP) $@ nice $(PYTEST) $(IN_PARALLEL) -m "not long and not release"

test-python-long: $(VENV)/.dev build/.kernels wheel
	$(STEP) $@ $(PYTEST) $(IN_PARALLEL) -m "long and not release"

test-release: $(VENV)/.dev ## what a release needs as well: the built-in trees in every unseen wind, their models built again (half an hour)
	$(PYTEST) -m release -rP

test-wheel: $(VENV)/.dev wheel ## what is declared, and the wheel installed far from the repository
	$(PYTEST) tests/package

test-python-versions: ## a part of the tests with Python 3.12 and 3.13, where they are installed (eight minutes each)
	$(PYTHON) tests/package/python_versions.py

test-distributed: $(VENV)/.dev ## the service on PostgreSQL, an S3-compatible store and a Dask cluster elsewhere
	$(BIN)/python scripts/test-distributed

test-containers: ## start the containers and build a tree through the proxy; needs Docker with Compose
	scripts/compose-smoke

test-web: node_modules/.stamp web/player/dist/core.js ## the TypeScript unit tests
	$(STEP) $@ npm test --silent -- $(QUIETLY) --exclude 'tests/tools/**'

test-tools: node_modules/.stamp ## the tests of the species generator, which grows all species again
	$(STEP) $@ npm test --silent -- $(QUIETLY) tests/tools

test-e2e: $(SITE) browser ## the page in a real Chromium against a real server
	$(STEP) $@ npm run --silent e2e -- --grep-invert @long

test-javascript-long:
	@$(MAKE) --no-print-directory test-tools
	@$(MAKE) --no-print-directory test-e2e-long

test-e2e-long: $(SITE) browser
	$(STEP) $@ npm run --silent e2e -- --grep @long

coverage: $(VENV)/.dev $(SITE) wheel ## lines and branches that the tests run, long ones too, in build/coverage; fails if they become fewer
	@rm -rf build/coverage && mkdir -p build/coverage/python
	$(STEP) coverage-web npm test --silent -- $(QUIETLY) --coverage
	$(STEP) coverage-run $(BIN)/coverage run -m pytest $(IN_PARALLEL) -m "not release"
	@$(BIN)/coverage combine --quiet && $(BIN)/coverage html --quiet
	@$(BIN)/coverage report

browser: node_modules/.stamp ## a Chromium for the tests, where the machine has none
	@scripts/install-browser

bench: build browser ## speed and memory, as ratios to named rivals; writes build/bench.json and build/bench-web.json
	@mkdir -p build
	$(BIN)/galewood bench --json build/bench.json
	@cd web && npm run --silent bench

docs: $(VENV)/.dev ## build the documentation site into build/docs; fails on broken links
	$(STEP) $@ env NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

format: $(VENV)/.dev node_modules/.stamp ## rewrite the sources in the project's format
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	npm run --silent format

species: node_modules/.stamp build/.kernels ## grow all species again, and build their shipped tables
	cd tools/species && npm run --silent grow
	$(BIN)/galewood ship

page-types: $(VENV)/.base ## write the page's types of the REST interface again
	$(BIN)/python scripts/write_page_types.py

constants: $(VENV)/.dev ## write the modules of the constants that Python and TypeScript share, from spec/constants.json
	$(BIN)/python -m scripts.write_constants

# on one thread, like the fits of the tests: with several, sums differ in the last digit, and so does the result of a fit
golden: export OPENBLAS_NUM_THREADS := 1
golden: $(VENV)/.dev ## write the golden files again
	$(BIN)/python -m tests.golden.make
	$(BIN)/python -m tests.golden.make_drawn
	$(BIN)/python -m tests.golden.make_gusts
	$(BIN)/python -m tests.golden.make_levels
	$(BIN)/python -m tests.golden.make_linear
	$(BIN)/python -m tests.golden.make_pull
	$(BIN)/python -m tests.golden.make_reach
	$(BIN)/python -m tests.golden.make_walks
	$(BIN)/python -m tests.golden.make_wind
	$(BIN)/python -m tests.golden.make_wire

audit: build/audit/.made ## look the locked packages up in the databases of known advisories (needs the registries)
	PATH="$(CURDIR)/build/audit/bin:$$PATH" python scripts/audit

# its packages are not the project's, and stay apart from them
build/audit/.made: requirements/audit.txt
	@rm -rf build/audit
	@$(PYTHON) -m venv build/audit
	@build/audit/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes --no-deps -r $<
	@touch $@

clean: ## remove what the targets above made (not the data directory)
	rm -rf build dist web/dist web/player/dist web/trees/dist node_modules $(VENV) *.egg-info .pytest_cache .ruff_cache tests/e2e/results tests/e2e/report
