# Everything runs in .venv, which each target makes for itself. `make help` lists the targets.

SHELL := /bin/bash
PYTHON_VENV := .venv/bin/python
ARGS ?=
ON_ALL_PROCESSORS := --numprocesses auto --dist loadscope --no-loadscope-reorder

.DEFAULT_GOAL := help
.PHONY: demo test test-all study-tests properties mutants bench lint extension release site examples screenshots clean help

demo: .venv/run.stamp  ## better places for a LiDAR and a camera on a sedan: a page to open, the better .blend
	@tools/demo.sh $(ARGS)

# Tests start more than a hundred processes: each would compile the engine anew if none may keep it.
test test-all: export PYTHONDONTWRITEBYTECODE =
# Its threads wait busily for each other, and no test computes what they would make faster.
test test-all: export OPENBLAS_NUM_THREADS = 1
test: .venv/dev.stamp  ## run the tests, ten minutes; ARGS="tests/engine -k prior" for some
	@$(PYTHON_VENV) -m pytest $(ON_ALL_PROCESSORS) $(or $(ARGS),tests)

test-all: export PE_THOROUGH = 1
test-all: .venv/all.stamp  ## run all tests, with more seeds, pages and programs: a quarter of an hour
	@$(PYTHON_VENV) -m pytest $(ON_ALL_PROCESSORS) -m "not trains_detectors" $(or $(ARGS),tests)

study-tests: .venv/studies.stamp  ## train the studies' detectors on little data; installs TensorFlow
	@$(PYTHON_VENV) -m pytest -m trains_detectors $(or $(ARGS),tests/studies)

properties: .venv/dev.stamp  ## what must hold for any rig, on 1,000 random ones: four minutes
	@PE_PROPERTY_RIGS=1000 $(PYTHON_VENV) -m pytest $(or $(ARGS),tests/engine/test_properties.py)

mutants: .venv/all.stamp  ## change the engine line by line: does a test fail? an hour
	@$(PYTHON_VENV) tools/mutants.py $(ARGS)

bench: .venv/all.stamp  ## measure speed
	@$(PYTHON_VENV) -m benchmarks $(ARGS)

lint: .venv/dev.stamp  ## style, format, types, licences
	@.venv/bin/ruff check --quiet .
	@.venv/bin/ruff format --check --quiet . || \
		{ echo "lint: not formatted; run .venv/bin/ruff format ." >&2; exit 1; }
	@.venv/bin/mypy --no-error-summary
	@.venv/bin/reuse lint --quiet || { .venv/bin/reuse lint >&2; exit 1; }
	@echo "lint: clean"

extension: .venv/run.stamp  ## build the Blender extension, dist/perception_entropy-VERSION.zip
	@$(PYTHON_VENV) tools/build_extension.py

release: .venv/release.stamp  ## build and check all that is published, from a clean tree: dist/release-VERSION
	@$(PYTHON_VENV) tools/release.py --install $(ARGS)

# Not --quiet: it silences the warnings that a strict build counts.
site: export NO_MKDOCS_2_WARNING = 1
site: .venv/docs.stamp  ## build the site of the documentation, dist/site; strict: no dead link
	@mkdir -p dist
	@.venv/bin/mkdocs build >dist/site.log 2>&1 || { cat dist/site.log >&2; exit 1; }
	@echo "site: dist/site/index.html"

examples: .venv/dev.stamp  ## make the projects of examples/ again, with their figures; ARGS="city_bus" for some
	@$(PYTHON_VENV) tools/examples.py $(ARGS)

screenshots: .venv/dev.stamp  ## make docs/images in a real window; ARGS="guide" for some, needs a Blender
	@$(PYTHON_VENV) tools/screenshots.py $(ARGS)

# A stamp is made where nothing is missing. run.stamp: what a user needs. dev.stamp: what a developer
# needs on top, in the same environment. all.stamp: what only test-all, mutants and bench need.
.venv/run.stamp: pyproject.toml tools/make_venv.sh
	@tools/make_venv.sh blender $@

# Not after run.stamp, of which it has all: pip would build the project twice.
.venv/dev.stamp: pyproject.toml tools/make_venv.sh
	@tools/make_venv.sh blender,test,meshes,dev $@
	@[ ! -e $@ ] || touch .venv/run.stamp

.venv/all.stamp: .venv/dev.stamp
	@tools/make_venv.sh blender,argoverse,docs,thorough $@

.venv/studies.stamp: .venv/dev.stamp
	@tools/make_venv.sh blender,studies $@

.venv/docs.stamp: .venv/run.stamp
	@tools/make_venv.sh blender,docs,notebook $@

.venv/release.stamp: .venv/run.stamp
	@tools/make_venv.sh blender,release $@

clean:  ## remove the environment and everything made
	@rm -rf .venv build dist demo_output test_output *.egg-info
	@rm -rf .pytest_cache .mypy_cache .ruff_cache
	@find . -name __pycache__ -type d -prune -exec rm -rf {} +

help:  ## this list
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | \
		sed -E 's/^([a-z-]+):.*## (.*)/make \1\t\2/' | expand -t 18
