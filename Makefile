# 'make help' lists what there is. Everything is installed into .venv and a cache folder of the user.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STUDY ?= demo-study
.DEFAULT_GOAL := help
.PHONY: help develop rehearsal-tables setup setup-browser setup-engines setup-database setup-proxies demo serve test check messages size format bench bench-adaptive bench-amuse bench-diffsheg bench-learned-motion bench-metrics bench-s2ue bench-render bench-report bench-serve bench-statistics bench-validity soak soak-render pictures screens engines pages guide desk-way three-systems worked-examples clean

help:  ## List the targets.
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:[^#]*## /\t/' | expand -t 16

setup: $(VENV)/.installed  ## Install the program with everything to make motion, render, serve and report.
	@scripts/debian-packages espeak-ng libosmesa6

develop: setup $(VENV)/.developed  ## Install the additional needs of tests, checks and benchmarks.

setup-browser: develop
	@scripts/debian-packages chromium-headless-shell fonts-dejavu-core fonts-ipafont-gothic

setup-engines: develop
	@scripts/debian-packages firefox-esr webkit2gtk-driver xvfb gstreamer1.0-plugins-good gstreamer1.0-plugins-bad gstreamer1.0-libav

setup-database: develop
	@scripts/debian-packages postgresql

setup-proxies: develop
	@scripts/debian-packages --unpack build/proxies caddy nginx

$(VENV)/.installed: pyproject.toml constraints.txt
	@scripts/debian-packages --for-python $(PYTHON)
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet -c constraints.txt -e '.[motion]'
	@touch $@

$(VENV)/.developed: $(VENV)/.installed
	$(BIN)/pip install --quiet -c constraints.txt -e '.[dev]'
	@touch $@

demo: setup  ## Run the whole pipeline on synthetic speech and write a report.
	$(BIN)/motionjury demo demo-study

serve: setup  ## Serve a study (STUDY=demo-study) to take part in it yourself.
	$(BIN)/motionjury serve $(STUDY) --try

# The tests start Python hundreds of times; what is compiled is kept even where the environment says otherwise.
test: export PYTHONDONTWRITEBYTECODE =
# Five processes run tests on two cores, since browsers and servers often wait; more threads would only wait for each other.
test: export OMP_NUM_THREADS = 1
test: export OPENBLAS_NUM_THREADS = 1
test: setup-browser setup-engines setup-database setup-proxies  ## Run all tests, including those in real browsers.
	$(BIN)/pytest -n 5 --dist loadfile --no-loadscope-reorder --max-worker-restart 0

check: $(VENV)/.developed  ## Check format, lint, types and layers.
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

messages: $(VENV)/.developed  ## Update the translation catalogues from the pages' texts.
	$(BIN)/python -m tools.message_catalogues

size: $(VENV)/.developed  ## Update the table of files and lines of code in CONTRIBUTING.md.
	$(BIN)/python -m tools.code_size

format: $(VENV)/.developed  ## Format the code.
	$(BIN)/ruff check --fix --select I .
	$(BIN)/ruff format .

bench: bench-render  ## Measure rendering speed and, briefly, the validity of the statistics.
	$(BIN)/python -m benchmarks.validity --studies 100

bench-adaptive: develop  ## Simulate how much sooner adaptive pairs find an order, and plot it.
	$(BIN)/python -m benchmarks.adaptive_pairs docs/adaptive.png

bench-amuse: develop  ## Compare AMUSE's released sizes with a plain implementation.
	$(BIN)/python -m benchmarks.amuse

bench-diffsheg: develop  ## Compare DiffSHEG's full network with a plain loop over the same evaluations.
	$(BIN)/python -m benchmarks.diffsheg

bench-learned-motion: develop  ## Train DiffSHEG and AMUSE on the synthetic corpus and compare them, for docs/learned-motion.md.
	$(BIN)/python -m benchmarks.learned_motion --write docs/learned-motion.md

bench-s2ue: develop  ## Time Speech2UnifiedExpressions, from samples to clip.
	$(BIN)/python -m benchmarks.s2ue speed

bench-metrics: develop  ## Time the Fréchet distance against a matrix square root, and all metrics of 10,000 clips.
	$(BIN)/python -m benchmarks.metrics.frechet_distance
	$(BIN)/python -m benchmarks.metrics.many_clips

bench-render: develop  ## Compare rendering speed with a plain pyrender loop and x264 alone.
	$(BIN)/python -m benchmarks.rendering

bench-statistics: develop  ## Compare the statistics with R's ordinal and choix, which it installs.
	@scripts/debian-packages r-cran-ordinal || echo "Without R's ordinal, only the rest is compared."
	@test -d build/choix || $(BIN)/pip install --quiet --no-deps --target build/choix choix==0.4.1
	OPENBLAS_NUM_THREADS=1 PYTHONPATH=build/choix $(BIN)/python -m benchmarks.statistics

bench-validity: develop  ## Simulate studies with known truth: false positives, coverage and power of every headline.
	$(BIN)/python -m benchmarks.validity

bench-report: develop  ## Measure reports of a million answers, from tables and from a study's database.
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m benchmarks.report

rehearsal-tables: develop  ## Simulate rehearsals of the pairwise template, and write the results to docs/rehearsal.md.
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m benchmarks.rehearsal_recovery --write docs/rehearsal.md

bench-serve: develop setup-database  ## Measure the study's server under simulated participants.
	$(BIN)/python -m benchmarks.server
	$(BIN)/python -m benchmarks.server.job_beside

soak: develop setup-database  ## Kill the study's server at random, and send it 100,000 malformed requests.
	$(BIN)/python -m benchmarks.server.soak

soak-render: develop  ## Render 10,000 frames and print whether memory use stays flat.
	$(BIN)/python -m benchmarks.rendering.soak

pictures: setup-browser  ## Retake the pictures in docs/ from demo-study.
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m tools.pictures demo-study

screens: setup-browser  ## Take screenshots of every page of every protocol, in every size, light and dark.
	SCREENSHOTS=$(CURDIR)/screens $(BIN)/pytest -q tests/functional/test_every_page_in_browser.py

engines: setup-engines  ## Take part in a study and watch it in Firefox and WebKit, with screenshots.
	SCREENSHOTS=$(CURDIR)/screens $(BIN)/pytest -q tests/functional/test_engines.py

pages: $(VENV)/.developed  ## Update what the code writes into docs/: commands, findings of check, files of a server.
	$(BIN)/python -m tools.handbook.command_pages
	$(BIN)/python -m tools.handbook.check_page
	$(BIN)/python -m tools.handbook.deploy_page

guide: setup-browser  ## Run docs/guide.md and the commands' examples in a new folder, and insert their output.
	rm -rf build/guide
	$(BIN)/python -m tools.handbook.guide build/guide
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m tools.guide_pictures build/guide

desk-way: setup-browser  ## Go through the desk in a browser, and take the pictures of docs/desk-way.md.
	$(BIN)/python -m tools.desk_way

three-systems: setup  ## Make the study of all three learned systems on the synthetic corpus, and docs/three-systems.md.
	$(BIN)/python -m tools.three_systems --write docs/three-systems.md

worked-examples: $(VENV)/.developed  ## Recompute the worked examples in docs/ from published numbers.
	$(BIN)/python -m tools.worked_examples.page docs/worked-examples.md

clean:  ## Remove everything installed and generated here (your studies stay).
	rm -rf $(VENV) demo-study screens build *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
