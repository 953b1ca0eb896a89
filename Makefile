# The commands of README and CI. Each installs the Debian packages that it needs and that are missing.
# JOBS=n sets the number of parallel jobs, MOTTLE_WERROR=ON makes warnings errors.
JOBS ?= $(shell nproc)
MOTTLE_WERROR ?= OFF
FUZZ_SECONDS ?= 60
ATTACK_HOURS ?= 8
ATTACK_OPTIONS ?=
# ON: with the tests that are too long for every change (label nightly).
NIGHTLY ?= OFF
CTEST_FLAGS ?=
LINT_FLAGS ?=
PYTHON ?= /usr/bin/python3
INSTALL = tools/install_packages.sh
# Threads start in these layers; the rest runs below them or not in threads at all.
TSAN_LAYERS = core linalg model drivers updating study

configure = cmake --preset $(1) -DMOTTLE_WERROR=$(MOTTLE_WERROR)
build = cmake --build --preset $(1) -j $(JOBS)
ctest = ctest --preset $(1) -j $(JOBS) $(CTEST_FLAGS)
alternatives = $(subst $() ,|,$(strip $(1)))
long_ones = $(if $(filter ON,$(NIGHTLY)),no_label,nightly)
# The tests of a build; those that depend on time, load or chance come last and are repeated once before they fail.
run_tests = $(call both,$(call ctest,$(1)) --label-exclude "timed|python|$(long_ones)",\
  $(call ctest,$(1)) --label-regex timed --label-exclude "python|$(long_ones)" --repeat until-pass:2)
# Fails where one of them does; both run, unless the first failure ends all.
both = $(1)$(if $(findstring stop-on-failure,$(CTEST_FLAGS)), && $(2),; code=$$?; $(2) && exit $$code)
as_root = $(if $(filter 0,$(shell id -u)),,sudo)
with_python = -DMOTTLE_BUILD_PYTHON=ON -DPython3_EXECUTABLE=$(PYTHON)
four_ranks = mpirun -n 4 --oversubscribe --allow-run-as-root
tsan_options = TSAN_OPTIONS="suppressions=$(CURDIR)/tools/tsan.supp $$TSAN_OPTIONS"

.PHONY: build demo test style lint asan asan-all tsan coverage fuzz attack python notebook deb try-deb bench clean plain
.DEFAULT_GOAL := build

build:
	$(INSTALL) --build
	$(call configure,release) -DMOTTLE_BUILD_TESTS=OFF
	$(call build,release)

demo: build
	build/release/mottle update examples/01-three-masses/case1.toml
	build/release/mottle update examples/01-three-masses/shapes.toml
	@echo "The paper's case, frequencies alone: $(CURDIR)/examples/01-three-masses/case1.mottle/report.html"
	@echo "Shapes measured beside them:         $(CURDIR)/examples/01-three-masses/shapes.mottle/report.html"

# The tests run on what users get, the optimised build; assertions are on in the asan, tsan and coverage builds.
test:
	$(INSTALL) --test
	$(call configure,release) -DMOTTLE_BUILD_TESTS=ON -DMOTTLE_BUILD_NIGHTLY_TESTS=$(NIGHTLY)
	$(call build,release)
	$(call run_tests,release)

# What needs no build.
style:
	$(INSTALL) --ci
	tools/check_style.sh

lint: style
	$(INSTALL) --ci --python
	tools/lint.sh $(LINT_FLAGS)

# The layers that read what others wrote or keep memory by hand, with their tests and the fuzzers' kept inputs, and the
# command with its tests; the other layers are those of the optimised build.
sanitized_layers = core linalg formats drivers study report
asan: build
	$(INSTALL) --test
	$(call configure,asan) "-DMOTTLE_SANITIZED_LAYERS=$(subst $() ,;,$(sanitized_layers))"
	$(call build,asan) --target mottle_app --target mottle_apps_tests --target mottle_fuzz_tests $(foreach layer,$(sanitized_layers),--target mottle_$(layer)_tests)
	MOTTLE_TEST_PATIENCE=5 $(call ctest,asan) --label-regex "^($(call alternatives,$(sanitized_layers))|apps|attack|fuzz)$$" \
	  --label-exclude "packaging|browser|timed|mpi|nightly"

# Every layer, the command and the Python package, but for tests of memory's size, of other programs and of time.
sanitised_tests = MOTTLE_TEST_PATIENCE=5 $(call ctest,$(1)) --label-exclude "packaging|browser|timed|mpi|nightly" \
  --exclude-regex "^python_(figures|leaks|notebooks|package|typing)$$"
asan-all:
	$(INSTALL) --test --python
	$(call configure,asan-all) $(with_python)
	$(call build,asan-all)
	$(call sanitised_tests,asan-all)

tsan:
	$(INSTALL) --test
	$(call configure,tsan)
	$(call build,tsan) --target mottle_app --target mottle_mpi $(foreach layer,$(TSAN_LAYERS),--target mottle_$(layer)_tests)
	$(tsan_options) $(call ctest,tsan) --label-regex "^($(call alternatives,$(TSAN_LAYERS)))$$"
	$(tsan_options) build/tsan/mottle update examples/01-three-masses/case1.toml --threads 4 --quiet --out build/tsan/case1.mottle
	$(tsan_options) $(four_ranks) build/tsan/mottle update examples/02-airframe/study.toml --set update.samples=300 --threads 2 \
	  --quiet --out build/tsan/airframe.mottle
	$(tsan_options) $(four_ranks) build/tsan/mottle propagate examples/04-any-solver/study.toml --quiet --out build/tsan/tower.mottle

# The Python package with its tests, in build/release/python.
python:
	$(INSTALL) --test --python
	$(call configure,release) -DMOTTLE_BUILD_TESTS=ON $(with_python)
	$(call build,release) --target mottle_app --target mottle_python
	$(call both,$(call ctest,release) --label-regex "^python$$" --label-exclude "timed|$(long_ones)",\
	  $(call ctest,release) --label-regex "^python$$" --label-regex timed --label-exclude "$(long_ones)" --repeat until-pass:2)

# As asan-all, and the lines of the library that the tests reach (tests, the command and outside headers do not count): one
# build for both, since that build is most of the cost.
coverage:
	$(INSTALL) --ci --python
	$(call configure,coverage) $(with_python)
	$(call build,coverage)
	find build/coverage -name '*.gcda' -delete
	$(call sanitised_tests,coverage)
	gcovr -j $(JOBS) --root . --filter src/ --filter include/ --exclude-throw-branches --print-summary \
	  --fail-under-line 90 build/coverage

# Every source read by itself, by clang and without precompiled headers, so that one that includes too little is found.
plain:
	$(INSTALL) --test --clang --python
	$(call configure,plain) $(with_python)
	ninja -C build/plain -j $(JOBS) $$(ninja -C build/plain -t targets all | sed -n 's/[.]o: .*/.o/p')

# A short search for inputs that the readers do not survive; make fuzz FUZZ_SECONDS=3600 for a long one.
fuzz:
	$(INSTALL) --test --clang
	$(call configure,fuzz)
	$(call build,fuzz) --target nastran_fuzz csv_fuzz uff_fuzz matrix_fuzz solver_output_fuzz mat_fuzz hdf5_fuzz \
	  calculix_fuzz gmsh_fuzz umbridge_fuzz report_fuzz study_fuzz
	tools/fuzz.sh build/fuzz $(FUZZ_SECONDS)

# The long forms of tests/attack: mutated inputs, kills, faulty solvers; its table is validation/attack/RESULTS.md. Stopped, it goes
# on with make attack ATTACK_OPTIONS=--resume.
attack: build
	python3 validation/attack/run.py build/release/mottle --hours $(ATTACK_HOURS) $(ATTACK_OPTIONS)

deb:
	$(INSTALL) --deb --python
	$(call configure,release) $(with_python)
	$(call build,release)
	cd build/release && cpack -G DEB

# Installs python3-mottle, which needs root, and runs the first notebook with it.
notebook:
	$(INSTALL) --deb --python
	$(call configure,release) -DMOTTLE_BUILD_TESTS=OFF $(with_python)
	$(call build,release)
	cd build/release && cpack -G DEB -D CPACK_COMPONENTS_ALL=python
	$(as_root) apt-get install -q -y --reinstall ./build/release/python3-mottle_*.deb
	$(PYTHON) -m nbconvert --to html --execute --output-dir build/release/notebooks examples/07-python/three_masses.ipynb
	@echo "The notebook with its results: $(CURDIR)/build/release/notebooks/three_masses.html"

# The packages on a machine that has nothing but Debian's base system; needs root.
try-deb: deb
	tools/try_deb.sh build/release

bench:
	$(INSTALL) --bench
	$(call configure,release) -DMOTTLE_BUILD_BENCHMARKS=ON
	$(call build,release)
	for benchmark in build/release/benchmarks/mottle_*_benchmark; do "$$benchmark" || exit 1; done

clean:
	rm -rf build
