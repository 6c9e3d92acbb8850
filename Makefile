# make run     the workflow on data/meshes, which is filled with examples if it is empty
# make test    the tests
# make test-faults ROUNDS=300    runs that are killed, starved and meddled with, held against undisturbed ones
# make lint    what holds of the text of the code: format, rules, types, imports between rooms
# make tables  docs/tables.md, after a change of the schemas
# make lock    pin what is installed in .venv, after a change of pyproject.toml
# make clean   remove the environment and what was compiled, never results
#
# Needs Python 3.11 or newer (PYTHON=...), make, and once a package index.

PYTHON ?= python3
CORES ?= 2
ROUNDS ?= 300
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

.PHONY: run test test-faults lint tables lock clean

run: $(READY) data/meshes
	$(BIN)/snakemake --cores $(CORES)
	@echo "Results of every model: $(CURDIR)/results/models/"
	@echo "Table of all models:    $(CURDIR)/results/corpus/models.parquet"

test: $(READY)
	$(BIN)/python -m pytest -n $(CORES) --dist loadfile

test-faults: $(READY)
	$(BIN)/python tests/faults.py $(ROUNDS)

# The lint of Snakemake parses the workflow, which wants a folder with a mesh.
lint: $(READY) data/meshes
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/python .ci/lint_workflow.py
	$(BIN)/mypy
	PYTHONPATH=workflow/scripts $(BIN)/lint-imports

# The environment follows the lock whenever that is newer.
$(READY): requirements.lock
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
	  || { echo "$(PYTHON) is older than Python 3.11; name a newer one: make PYTHON=python3.11 ..."; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.lock
	touch $(READY)

# Written aside and renamed, so that a half-made set is never taken for whole.
data/meshes: | $(READY)
	rm -rf data/meshes.part
	$(BIN)/python workflow/scripts/make_examples.py data/meshes.part
	mv data/meshes.part data/meshes

tables: $(READY)
	$(BIN)/python docs/make_tables.py

lock: $(READY)
	$(BIN)/python -m pip install --quiet --upgrade --upgrade-strategy only-if-needed -e .[formats,workflow,test]
	$(BIN)/python .ci/lock.py > requirements.lock.part
	mv requirements.lock.part requirements.lock
	touch $(READY)

clean:
	rm -rf $(VENV) .pytest_cache .hypothesis
	find workflow tests -name __pycache__ -type d -prune -exec rm -rf {} +
