# make run     the workflow on data/meshes, which is filled with examples if it is empty
# make test    the tests
# make test-faults ROUNDS=300    runs that are killed, starved and meddled with, held against undisturbed ones
# make test-readers    the files of a model, read by programs too heavy for the tests (docs/readers.md)
# make check   the graphs in results/, held against their meshes by check.py (docs/theorem.md)
# make docs    the documentation as pages for a browser, build/docs/index.html; its examples run, and any warning is an error
# make lint    what holds of the text of the code: format, rules, types, imports between rooms
# make test-slurm  the workflow through a SLURM that it brings up here and takes down again (root, Debian)
# make tables  docs/tables.md, after a change of the schemas
# make audit   ask whether a locked package is known to be vulnerable; skipped where the service is not reached
# make fuzz    read 20,000 damaged files (FILES=...): only meshes, tables and sentences may come of them
# make lock    pin all packages, with the hashes of their files, after a change of pyproject.toml (UPGRADE=1: anew)
# make clean   remove the environment and what was compiled, never results
#
# Needs Python 3.11 or newer (PYTHON=...), make, and once a package index.

PYTHON ?= python3
CORES ?= 2
ROUNDS ?= 300
FILES ?= 20000
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

.PHONY: run test test-faults test-readers lint docs tables lock clean check audit fuzz test-slurm

run: $(READY) data/meshes
	$(BIN)/snakemake --cores $(CORES)
	@echo "Open in a browser: $(CURDIR)/results/corpus/report.html"

test: $(READY)
	$(BIN)/python -m pytest -n $(CORES) --dist loadfile

test-faults: $(READY)
	$(BIN)/python tests/faults.py $(ROUNDS)

test-readers: $(READY)
	PYTHONPATH=tests:workflow/scripts $(BIN)/python tests/readers/read_outputs.py

check: $(READY)
	$(BIN)/python check.py results

test-slurm: $(READY)
	$(BIN)/python tests/cluster/run_on_slurm.py

# The lint of Snakemake parses the workflow, which wants a folder with a mesh.
lint: $(READY) data/meshes
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/snakemake --lint
	$(BIN)/mypy
	PYTHONPATH=workflow/scripts $(BIN)/lint-imports

docs: $(READY)
	$(BIN)/python -m sphinx --quiet --fail-on-warning --keep-going -b html docs build/docs
	@echo "Documentation: $(CURDIR)/build/docs/index.html"

# The environment follows the lock whenever that is newer.
$(READY): requirements.lock
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "$(PYTHON) is older than Python 3.11; name a newer one: make PYTHON=python3.11 ..."; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	touch $(READY)

# Written aside and renamed, so that a half-made set is never taken for whole.
data/meshes: | $(READY)
	rm -rf data/meshes.part
	$(BIN)/python workflow/scripts/make_examples.py data/meshes.part
	mv data/meshes.part data/meshes

tables: $(READY)
	$(BIN)/python docs/make_tables.py

audit: $(READY)
	$(BIN)/python .ci/audit.py requirements.lock

fuzz: $(READY)
	$(BIN)/python tests/fuzz_readers.py --rounds $(FILES)

# For every system and Python that pyproject.toml allows; what is pinned stays, unless UPGRADE is set.
lock: $(READY)
	cp requirements.lock requirements.lock.part
	$(BIN)/uv pip compile pyproject.toml --all-extras --universal --python-version 3.11 --generate-hashes --no-annotate --quiet \
	  --custom-compile-command "make lock" $(if $(UPGRADE),--upgrade) -o requirements.lock.part
	mv requirements.lock.part requirements.lock

clean:
	rm -rf $(VENV) .pytest_cache .hypothesis
	find workflow tests -name __pycache__ -type d -prune -exec rm -rf {} +
