# Needs a Rust toolchain, make, and Python >= 3.10 for the tests and the figures.
# Python packages go into virtual environments of the build's own, under target/.

CARGO ?= cargo
PYTHON ?= python3

TESTS_VENV := target/venv
FIGURES_VENV := target/venv-figures
PEERS_VENV := target/venv-peers
SITE_VENV := target/venv-site
DIST_VENV := target/venv-dist

# What is off by default is tested too. Everything is built with it, so that it is built once.
FEATURES := --features opm-core/serde

# One target after the other, also with -j: the order is part of what is read on the screen.
.NOTPARALLEL:
.DEFAULT_GOAL := help
.PHONY: docs dist notices help test lint test-rust test-python kills fuzz bench guard guard-store figures web gallery python

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-12s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

test: python lint test-rust test-python ## Check everything: format, lints, documentation, all tests

lint: ## Check format, lints and documentation, warnings being errors
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets $(FEATURES) -- -D warnings
	$(CARGO) clippy -p opm-core --no-default-features -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps $(FEATURES)

# A fixed seed, so that a check passes or fails for what was changed; plain cargo test draws anew.
test-rust: ## Run the Rust tests, build the examples
	PROPTEST_RNG_SEED=20261121 $(CARGO) test --workspace $(FEATURES)

# The module as the Rust tests are built: optimised, without the minutes that linking for release takes. A run for each
# folder: pytest cannot collect two files of one name together.
test-python: $(TESTS_VENV)/made ## Check the Python module, and the program's recordings with public decoders
	MATURIN_PEP517_ARGS="--profile dev $(FEATURES)" $(TESTS_VENV)/bin/python -m pip install --quiet --disable-pip-version-check ./py
	$(TESTS_VENV)/bin/python -m pytest -q --numprocesses 2 --dist worksteal tests/python
	$(TESTS_VENV)/bin/python -m pytest -q --numprocesses 2 --dist worksteal py/tests

# A few dozen are part of test-python.
kills: $(TESTS_VENV)/made ## Kill a thousand runs at random moments, and check what is left
	OPM_KILLS=1000 $(TESTS_VENV)/bin/python -m pytest -q -s tests/python/test_faults.py

# The stored inputs, and changes of them, are part of test-rust. All code but that of zstd is safe Rust, so that no sanitizer
# is needed; checks of overflow are on.
FUZZ_SECONDS ?= 60
fuzz: ## Fuzz each target for a minute; needs a nightly toolchain and cargo-fuzz
	for target in number flags mechanism motion joint_list recording foreign; do \
	  $(CARGO) +nightly fuzz run -s none --debug-assertions $$target -- \
	    -max_total_time=$(FUZZ_SECONDS) -timeout=20 -rss_limit_mb=4096 || exit 1; \
	done

bench: $(PEERS_VENV)/made ## Measure, NumPy and numba too, and write BENCHMARKS.md
	$(PEERS_VENV)/bin/python -m pip install --quiet --disable-pip-version-check ./py
	CARGO="$(CARGO)" PEERS_PYTHON="$(CURDIR)/$(PEERS_VENV)/bin/python" benches/report.sh > target/BENCHMARKS.md
	mv target/BENCHMARKS.md BENCHMARKS.md
	cat BENCHMARKS.md

# Instructions, not seconds: benches/examples/guard.rs says how. Release code, as it is measured.
# With the names of functions, which a release has lost.
guard: ## Check that nothing takes more instructions than are stored; needs valgrind
	$(CARGO) run --quiet --profile profiling -p opm-benches --example guard

guard-store: ## Store the instructions that are taken now, for make guard to compare with
	$(CARGO) run --quiet --profile profiling -p opm-benches --example guard -- --store

figures: $(FIGURES_VENV)/made ## Draw docs/images from recordings made by opm
	$(FIGURES_VENV)/bin/python docs/figures/make_figures.py

web: ## Build the explorer's page; needs node, and a compiler for WebAssembly
	web/build.sh

# As it is built for the tests: optimised, too. Bennett's linkages have no inverse kinematics in closed form, and no page.
gallery: ## Write a page of the explorer for every shipped manipulator, to target/gallery
	$(CARGO) build --quiet --workspace $(FEATURES) --bins
	mkdir -p target/gallery
	for file in crates/opm-core/mechanisms/*.toml; do \
	  name=$$(basename "$$file" .toml); \
	  case $$name in bennett-*) continue;; esac; \
	  $${CARGO_TARGET_DIR:-target}/debug/opm --quiet explore "$$name" -o "target/gallery/$$name.html" || exit 1; \
	done

# The pages are the documents of the repository; docs/site/conf.py says how. The crates' reference and the explorer's
# pages go beside them, and notebooks are run.
docs: $(SITE_VENV)/made gallery ## Build the documentation site, to target/site, and check its links
	$(CARGO) doc --workspace --no-deps --exclude opm-tests --exclude opm-benches --exclude opm-python $(FEATURES)
	rm -rf target/site-extra target/site
	mkdir -p target/site-extra
	cp -R target/doc target/site-extra/rust
	cp -R target/gallery target/site-extra/explorer
	MATURIN_PEP517_ARGS="--profile dev $(FEATURES)" $(SITE_VENV)/bin/python -m pip install --quiet --disable-pip-version-check "./py[plot,design]"
	OPM_NOTEBOOKS=1 $(SITE_VENV)/bin/python -m sphinx -q -W --keep-going -b html -c docs/site . target/site
	$(SITE_VENV)/bin/python docs/site/check_links.py target/site

dist: $(DIST_VENV)/made ## Build and check wheels, the source distribution and the program, in target/dist
	packaging/dist.sh

notices: ## Write the licences of all that is part of opm; needs cargo-about
	$(PYTHON) packaging/notices.py

# Before anything that takes minutes.
python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || \
	  { echo "Python 3.10 or later is needed, and $(PYTHON) is not one; name another: make PYTHON=..." >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || \
	  { echo "$(PYTHON) lacks its venv module; on Debian and Ubuntu: apt-get install python3-venv" >&2; exit 1; }

$(TESTS_VENV)/made: tests/python/requirements.txt docs/site/requirements.txt
$(FIGURES_VENV)/made: docs/figures/requirements.txt
$(PEERS_VENV)/made: benches/peers/requirements.txt
$(SITE_VENV)/made: docs/site/requirements.txt
$(DIST_VENV)/made: packaging/requirements.txt

# Made anew whenever the requirements change; half an environment is not marked as made.
%/made: | python
	rm -rf $*
	$(PYTHON) -m venv $*
	$*/bin/python -m pip install --quiet --disable-pip-version-check --requirement $<
	touch $@
