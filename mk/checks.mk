# Checks beyond the tests.

.PHONY: lint deb api-fuzz fuzz fuzz-here fuzz-minute coverage coverage-here torture faults tsan tsan-here asan asan-here valgrind stability \
        laws fresh-debian stranger

lint: ## format, versions, structure, headers, static analysis; LINT_BASE=all: clang-tidy on all files, not the changed ones
	@scripts/setup packages-lint.txt
	@scripts/lint

# Every reader of foreign bytes under libFuzzer; what it finds goes to build/fuzz. Readers of files need a few folders of
# the program, and so are built in seconds: .ci/run fuzzes them for a minute.
FUZZ_S       ?= 600
FUZZ_READERS := settings motion instrument archive table
FUZZ_TARGETS ?= $(FUZZ_READERS) worker database cells
READERS      := $(BUILD)/libreaders.a
FUZZ_FILES   := $(FUZZ_TARGETS:%=$(BUILD)/tests/fuzz/fuzz_%)
OF_READERS   := $(FUZZ_READERS:%=$(BUILD)/tests/fuzz/fuzz_%)
fuzz: ## the readers under libFuzzer (clang), FUZZ_S=600 seconds in all; FUZZ_TARGETS="settings motion" chooses
	@scripts/setup packages-fuzz.txt
	@$(MAKE) --no-print-directory -j$(JOBS) MODE=fuzz CC=clang WARNINGS=-w fuzz-here
	@scripts/fuzz build/fuzz $(FUZZ_S) $(FUZZ_TARGETS)

fuzz-minute:
	@$(MAKE) --no-print-directory fuzz FUZZ_S=60 FUZZ_TARGETS="$(FUZZ_READERS)"

fuzz-here: $(FUZZ_FILES)

$(READERS): $(foreach d,base settings scene motion,$(filter $(BUILD)/src/$(d)/%,$(LIB_OBJ))) $(BUILD)/src/sim/as_built.o $(MATRICES:%=$(BUILD)/%.o)
	@rm -f $@
	$(Q)$(AR) rcs $@ $^

$(BUILD)/tests/fuzz/target_%.o: tests/fuzz/libfuzzer.c
	@mkdir -p $(@D)
	$(Q)$(CC) $(CPPFLAGS) -DFUZZ_TARGET=fuzz_$* $(CFLAGS) -c $< -o $@

$(OF_READERS): %: $(BUILD)/tests/fuzz/targets.o $(READERS)
$(filter-out $(OF_READERS),$(FUZZ_FILES)): %: $(patsubst %,$(BUILD)/tests/fuzz/%.o,targets worker run) $(LIB)
$(FUZZ_FILES): $(BUILD)/tests/fuzz/fuzz_%: $(BUILD)/tests/fuzz/target_%.o
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -fsanitize=fuzzer -o $@ $(filter %.o,$^) $(filter %.a,$^) $(LDLIBS)

coverage: ## branches that the tests take, by folder; T="moga rbf" chooses tests (gcovr)
	@$(MAKE) --no-print-directory -j$(JOBS) MODE=coverage WARNINGS=-w tests
	@find build/coverage -name '*.gcda' -delete
	@$(MAKE) --no-print-directory MODE=coverage run_tests
	@scripts/coverage build/coverage

KILLS ?= 300
torture: ## kill -9 at random moments, every run resumed to its end; KILLS=300
	@$(MAKE) --no-print-directory -j$(JOBS) T=torture tests
	@IMTET=$(abspath $(PROGRAM)) TORTURE_KILLS=$(KILLS) $(BUILD)/tests/some torture

FAULTS ?= 800
faults: ## memory and writes refused one after the other; FAULTS=800 of each kind
	@$(MAKE) --no-print-directory -j$(JOBS) T="faults store_faults" tests
	@for t in faults store_faults; do IMTET=$(abspath $(PROGRAM)) FAULTS=$(FAULTS) $(BUILD)/tests/some $$t || exit 1; done

# LLVM's OpenMP: its tool reports to ThreadSanitizer what a parallel region orders; with gcc's, ThreadSanitizer reports
# races that are none. First a race that it must find.
TSAN_TESTS := async queue replicates moga problem polish rbf
tsan: ## threads under ThreadSanitizer (clang, libomp)
	@$(MAKE) --no-print-directory MODE=tsan CC=clang WARNINGS=-w T="$(TSAN_TESTS)" tests
	@$(MAKE) --no-print-directory MODE=tsan CC=clang WARNINGS=-w tsan-here

tsan-here: export TSAN_OPTIONS := ignore_noninstrumented_modules=1 exitcode=99
tsan-here: export OMP_NUM_THREADS := 3
tsan-here:
	@$(CC) -fopenmp -O1 -g -fsanitize=thread tests/fault/race.c -o $(BUILD)/race
	@if $(BUILD)/race >$(BUILD)/race.log 2>&1; then echo "a race was not found: ThreadSanitizer does not work here"; exit 1; fi
	@scripts/short-run $(PROGRAM)
	@set -e; for t in $(TSAN_TESTS); do echo "== $$t"; IMTET=$(abspath $(PROGRAM)) $(BUILD)/tests/some $$t; done

asan: ## a short round of the commands under AddressSanitizer and UBSan
	@$(MAKE) --no-print-directory MODE=asan asan-here

asan-here: $(PROGRAM)
	@scripts/short-run $(PROGRAM)

VALGRIND := valgrind -q --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite --show-leak-kinds=definite
valgrind: $(PROGRAM) ## the same under valgrind
	@scripts/short-run ./$(PROGRAM) $(VALGRIND)

# docs/measured has the tables of measurements; scripts/tables puts the short ones into their pages.
stability: $(BENCH) ## every engine through every case; ARGS="--long --seconds 600": also those of 1e6 and 1e7 steps
	@$(BENCH) stability $(ARGS) --out docs/measured/stability.csv

stranger: $(PROGRAM) ## how many files a new objective, contact law, device and baseline touch, each built and tried (tests/stranger)
	@scripts/stranger

laws: $(BENCH) ## rebound of the contact laws, engines under each
	@$(BENCH) laws --csv docs/measured/contact-laws.csv --tower docs/measured/contact-laws-tower.csv --engines docs/measured/contact-laws-engines.csv

fresh-debian: ## the steps of the README in a Debian that has nothing but make (root, debootstrap, network)
	@scripts/fresh-debian build/fresh-debian

CALLS ?= 100000
api-fuzz: ## random calls of the library under AddressSanitizer; CALLS=100000
	@$(MAKE) --no-print-directory -j$(JOBS) MODE=asan T=asking tests
	@IMTET=$(CURDIR)/build/asan/imtet API_CALLS=$(CALLS) build/asan/tests/some asking

deb: ## packages imtet, imtet-mpi, libimtet0, libimtet-dev, python3-imtet into build/deb, by debhelper
	@scripts/setup packages-deb.txt
	@REVISION=$(REVISION) scripts/deb build/deb $(VERSION)
