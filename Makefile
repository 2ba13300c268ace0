# make            builds ./imtet                      make run        set-up, build, quick study
# make test       every test, plain and sanitized     make bench      what the README's figures are made with
# make MODE=debug|asan|tsan ...                       make format     clang-format over the sources
# make install PREFIX=/usr/local DESTDIR=
# make fuzz FUZZ_S=600                            the readers under libFuzzer (clang)

V       ?= 0                                         # V=1 shows every command
Q       := $(if $(filter 1,$(V)),,@)
MODE    ?= release
BUILD   := build/$(MODE)
PREFIX  ?= /usr/local
VERSION := 0.1.0
REVISION := $(shell git describe --always --dirty 2>/dev/null || echo unknown)

CC      ?= cc
CFLAGS.release := -O2 -g
CFLAGS.debug   := -O0 -g3
CFLAGS.asan    := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
CFLAGS.tsan    := -O1 -g -fsanitize=thread -fno-omit-frame-pointer
CFLAGS.fuzz    := -O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer

CFLAGS.coverage := -O1 -g --coverage -fprofile-update=atomic

WARNINGS := -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wstrict-prototypes -Wmissing-prototypes -Wvla -Werror
CPPFLAGS += -Isrc -MMD -MP -D_GNU_SOURCE
# Contraction to fused multiply-add is rounding once instead of twice; NaN and Inf stay what they are.
CFLAGS   += -std=c17 -fopenmp -ffp-contract=fast $(WARNINGS) $(CFLAGS.$(MODE))
LDFLAGS  += -fopenmp $(CFLAGS.$(MODE))
LDLIBS   += -lsundials_cvode -lsundials_arkode -lsundials_nvecserial -lsundials_sunmatrixdense -lsundials_sunlinsoldense \
            -lsundials_sunnonlinsolnewton -lsundials_sunnonlinsolfixedpoint \
            -lnlopt -llapacke -lopenblas -linih -ljansson -lsqlite3 -lm
# Our own kernels are written for the vectorizer; everything else is happy with -O2.
$(BUILD)/src/sim/%.o: CFLAGS.release := -O3 -g

$(BUILD)/src/rbf/%.o $(BUILD)/src/moga/infill.o: CFLAGS.release := -O3 -g -fno-math-errno -fno-trapping-math

KERNELS := base avx2 avx512
KERNEL_FLAGS.base   := -DFAST_LANES=2
KERNEL_FLAGS.avx2   := -DFAST_LANES=4 -march=x86-64-v3 -mtune=haswell
KERNEL_FLAGS.avx512 := -DFAST_LANES=8 -march=x86-64-v4 -mtune=skylake-avx512 -mprefer-vector-width=512
ifneq ($(shell uname -m),x86_64)
KERNELS := base
endif

SRC     := $(filter-out src/sim/fast/kernel.c,$(wildcard src/*/*.c src/*/*/*.c))
MATRICES := $(wildcard configs/sac20/guyan/*.csv configs/sac20/appendix/*.csv)
LIB_OBJ := $(SRC:%.c=$(BUILD)/%.o) $(KERNELS:%=$(BUILD)/src/sim/fast/kernel_%.o) $(MATRICES:%=$(BUILD)/%.o) $(BUILD)/web/page.o
LIB     := $(BUILD)/libimtet.a
TEST_SRC := $(wildcard tests/test_*.c)
TESTS   := $(TEST_SRC:%.c=$(BUILD)/%)
STABILITY     := $(BUILD)/tests/stability/stability
STABILITY.asan := --engine fast
STABILITY_OBJ := $(patsubst %.c,$(BUILD)/%.o,$(wildcard tests/stability/*.c))
PROGRAM := $(if $(filter release,$(MODE)),imtet,$(BUILD)/imtet)

.PHONY: tests tsan tsan-here asan asan-here valgrind torture coverage coverage-here faults fuzz fuzz-here all web report-bench setup setup-browser fresh-debian run test test-here compare stability stability-long laws bench chart format install clean .FORCE pictures
.SECONDARY:
all: $(PROGRAM)

setup:
	@scripts/setup

# Only for the report's tests in a browser, its bundle of charts and its times.
setup-browser:
	@scripts/setup packages-browser.txt

run: setup
	@$(MAKE) --no-print-directory -j2 all
	./imtet optimize configs/quick.ini

# The README's steps in a Debian that has nothing but make; wants root, debootstrap and a network.
fresh-debian:
	@scripts/fresh-debian build/fresh-debian

test: setup
	@$(MAKE) --no-print-directory -j2 MODE=release test-here
	@$(MAKE) --no-print-directory -j2 MODE=asan test-here

# Builds every test without running one.
tests: $(PROGRAM) $(TESTS) $(STABILITY)

# A test finds the program under test in $$IMTET and the repository in its working directory.
test-here: $(PROGRAM) $(TESTS) $(STABILITY)
	@set -e; export IMTET=$(abspath $(PROGRAM)); for t in $(TESTS); do echo "== $$t"; $$t; done; \
	echo "== $(STABILITY)"; $(STABILITY) --quick --seconds 3 $(STABILITY.$(MODE)); $(STABILITY) --laws

# Every engine through every case; stability-long has the cases of 1e6 and 1e7 steps. The page is theirs.
stability: $(STABILITY)
	@$(STABILITY) --out docs/stability.md

stability-long: $(STABILITY)
	@$(STABILITY) --long --seconds 600 --out docs/stability.md

# The rebound curves of the contact laws, and what the floor under v0 changes.
laws: $(STABILITY)
	@$(STABILITY) --laws --out docs/contact-laws.md --csv $(BUILD)/contact-laws.csv
	@scripts/plot-laws $(BUILD)/contact-laws.csv docs/contact-laws

# Every reader of foreign bytes under libFuzzer for FUZZ_S seconds in all; what it finds goes to build/fuzz.
FUZZ_S       ?= 600
FUZZ_OBJ     := $(patsubst %,$(BUILD)/tests/fuzz/%.o,targets worker run)
FUZZ_TARGETS := settings motion table worker database cells
fuzz:
	@$(MAKE) --no-print-directory MODE=fuzz CC=clang WARNINGS=-w fuzz-here
	@scripts/fuzz build/fuzz $(FUZZ_S) $(FUZZ_TARGETS)

fuzz-here: $(FUZZ_TARGETS:%=$(BUILD)/tests/fuzz/fuzz_%)

$(BUILD)/tests/fuzz/target_%.o: tests/fuzz/libfuzzer.c
	@mkdir -p $(@D)
	$(Q)$(CC) $(CPPFLAGS) -DFUZZ_TARGET=fuzz_$* $(CFLAGS) -c $< -o $@

$(BUILD)/tests/fuzz/fuzz_%: $(BUILD)/tests/fuzz/target_%.o $(FUZZ_OBJ) $(LIB)
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -fsanitize=fuzzer -o $@ $^ $(LDLIBS)

# Branches that the tests take, by folder, and for readers, settings and store by file; COVER chooses tests.
COVER ?= $(notdir $(TEST_SRC:%.c=%))
coverage:
	@$(MAKE) --no-print-directory MODE=coverage WARNINGS=-w coverage-here

coverage-here: $(PROGRAM) $(TESTS)
	@find $(BUILD) -name '*.gcda' -delete
	@printf '%s\n' $(COVER) | IMTET=$(abspath $(PROGRAM)) xargs -P $$(nproc) -I % sh -c \
	'echo "== %"; $(BUILD)/tests/% >$(BUILD)/%.log 2>&1 || { cat $(BUILD)/%.log; exit 1; }'
	@scripts/coverage $(BUILD)

# kill -9 at random moments, every run resumed to its end; KILLS says how often.
KILLS ?= 300
torture: $(PROGRAM) $(BUILD)/tests/test_torture
	@IMTET=$(abspath $(PROGRAM)) TORTURE_KILLS=$(KILLS) $(BUILD)/tests/test_torture

# Threads: clang with LLVM's OpenMP, whose tool tells ThreadSanitizer what a parallel region promises; with gcc's it would
# see races that are none. First a race that it must find.
TSAN_TESTS := test_async test_ensemble test_moga test_problem test_polish test_rbf
tsan:
	@$(MAKE) --no-print-directory MODE=tsan CC=clang WARNINGS=-w tsan-here

tsan-here: export TSAN_OPTIONS := ignore_noninstrumented_modules=1 exitcode=99
tsan-here: export OMP_NUM_THREADS := 3
tsan-here: $(PROGRAM) $(TSAN_TESTS:%=$(BUILD)/tests/%)
	@$(CC) -fopenmp -O1 -g -fsanitize=thread tests/fault/race.c -o $(BUILD)/race
	@if $(BUILD)/race >$(BUILD)/race.log 2>&1; then echo "a race was not found: ThreadSanitizer does not work here"; exit 1; fi
	@scripts/short-run $(PROGRAM)
	@set -e; for t in $(TSAN_TESTS); do echo "== $$t"; IMTET=$(abspath $(PROGRAM)) $(BUILD)/tests/$$t; done

asan:
	@$(MAKE) --no-print-directory MODE=asan asan-here

asan-here: $(PROGRAM)
	@scripts/short-run $(PROGRAM)

VALGRIND := valgrind -q --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite --show-leak-kinds=definite
valgrind: $(PROGRAM)
	@scripts/short-run ./$(PROGRAM) $(VALGRIND)

# Memory and writes refused one after the other, at most FAULTS of each kind in each of ten short commands.
FAULTS ?= 800
faults: $(PROGRAM) $(BUILD)/tests/test_faults
	@IMTET=$(abspath $(PROGRAM)) FAULTS=$(FAULTS) $(BUILD)/tests/test_faults

$(BUILD)/tests/test_faults: $(BUILD)/tests/fault/nomem.so

$(BUILD)/tests/fault/nomem.so: tests/fault/nomem.c
	@mkdir -p $(@D)
	$(Q)$(CC) -D_GNU_SOURCE -std=c17 -O1 $(WARNINGS) -shared -fPIC -o $@ $<

$(BUILD)/tests/test_fuzz_corpus: $(FUZZ_OBJ)

WRAPPED := sqlite3_step sqlite3_exec sqlite3_prepare_v2 sqlite3_open_v2 sqlite3_errcode sqlite3_extended_errcode calloc malloc \
           realloc open_memstream fopen fflush rename
$(BUILD)/tests/test_store_faults: LDFLAGS += $(WRAPPED:%=-Wl,--wrap=%)

$(PROGRAM): $(BUILD)/src/main.o $(LIB)
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LDLIBS)

$(LIB): $(LIB_OBJ)
	@rm -f $@
	$(Q)$(AR) rcs $@ $^

$(BUILD)/tests/%: $(BUILD)/tests/%.o $(LIB)
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $(filter %.o,$^) $(LIB) -lcmocka $(LDLIBS)

$(STABILITY): $(STABILITY_OBJ) $(LIB)
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ -lcmocka $(LDLIBS)

$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	@echo '  CC  $@'
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) -c $< -o $@

# The fast engine's kernel, once per instruction set; fast.c chooses at run time.
$(BUILD)/src/sim/fast/kernel_%.o: src/sim/fast/kernel.c
	@mkdir -p $(@D)
	@echo '  CC  $@'
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) -fno-math-errno -fno-trapping-math -Wno-psabi $(KERNEL_FLAGS.$*) -DFAST_KERNEL=fast_kernel_$* -c $< -o $@

# The two 20-floor buildings are part of the program: a file becomes the symbols _binary_PATH_start and _end.
$(BUILD)/%.csv.o: %.csv
	@mkdir -p $(@D)
	$(Q)$(LD) -r -b binary -z noexecstack -o $@ $<

# So is the page of the report, its style and scripts inside. web/charts.js is what `make web` bundles from npm.
build/web/page.html: web/assemble web/page.html web/style.css web/charts.js $(wildcard web/app/*.js)
	@mkdir -p $(@D)
	$(Q)web/assemble > $@.part && mv $@.part $@

$(BUILD)/web/page.o: build/web/page.html
	@mkdir -p $(@D)
	$(Q)$(LD) -r -b binary -z noexecstack -o $@ $<

web: setup-browser
	@cd web && npm ci --ignore-scripts --no-audit --no-fund --silent && node bundle.mjs

$(BUILD)/src/store/provenance.o: CPPFLAGS += -DIMTET_VERSION='"$(VERSION)"' \
    -DIMTET_REVISION='"$(REVISION)"' -DIMTET_CFLAGS='"-std=c17 -fopenmp -ffp-contract=fast $(CFLAGS.$(MODE)), src/sim -O3"'

# Compiled again when version or revision changed, so that a run's folder names the sources that it came from.
$(BUILD)/revision: .FORCE
	@mkdir -p $(@D)
	@echo '$(VERSION) $(REVISION)' | cmp -s - $@ || echo '$(VERSION) $(REVISION)' > $@
$(BUILD)/src/store/provenance.o: $(BUILD)/revision

# Figures of speed; a record that is not there is replaced by the built-in motion. Both want a quiet machine.
BENCH_RECORD ?= $(or $(wildcard ../shared/records/kobe_jma_ns.csv),builtin:kobe-like)
bench: $(PROGRAM)
	@bench/guard $(abspath $(PROGRAM))
	@$(abspath $(PROGRAM)) bench --throughput --record $(BENCH_RECORD)

chart: $(PROGRAM)
	@$(abspath $(PROGRAM)) bench --record $(BENCH_RECORD) --csv docs/chart.csv --markdown docs/chart.md
	@scripts/plot-chart docs/chart.csv docs/chart

# The search on problems from textbooks and on the tower, with and without surrogate; CELLS and SEEDS choose a part of it,
# KEEP is a folder in which runs stay and are not repeated.
compare: $(PROGRAM)
	@scripts/compare --program ./$(PROGRAM) --out docs/search.md $(if $(CELLS),--cells $(CELLS)) $(if $(SEEDS),--seeds $(SEEDS)) $(if $(KEEP),--keep $(KEEP))

# The pictures of a study in docs/pictures: make pictures RUN=results/kobe RECORDS="elcentro.csv sylmar.csv"
pictures: $(PROGRAM)
	@./$(PROGRAM) plot $(RUN) $(RECORDS:%=--record %) --out $(BUILD)/pictures
	@./$(PROGRAM) report $(RUN) $(RECORDS:%=--record %) --out $(BUILD)/pictures/report.html
	@cp $(foreach p,front peaks modes energies sway elsewhere,$(BUILD)/pictures/$p.png) docs/pictures
	@node tests/report/picture.mjs $(BUILD)/pictures/report.html docs/pictures/report-front.jpg '#front' 1180 'J3 acceleration [g] to=6' 'J1 sway [m] to=0.8'
	@node tests/report/picture.mjs $(BUILD)/pictures/report.html docs/pictures/report-design.jpg '#design' 2250

# How long a report of 10,000 designs takes to be painted and brushed.
report-bench: setup-browser $(PROGRAM)
	@tests/report/bench $(abspath $(PROGRAM)) build/report-bench

format:
	clang-format -i $(wildcard src/*.c src/*/*.[ch] src/*/*/*.[ch] tests/*.[ch] tests/*/*.[ch])

# Manual pages and completion are written by the program itself.
SHARE := $(DESTDIR)$(PREFIX)/share
install: all
	install -D -m 755 imtet $(DESTDIR)$(PREFIX)/bin/imtet
	@for f in $$(cd configs && find . -type f); do install -D -m 644 configs/$$f $(SHARE)/imtet/configs/$$f; done
	@install -d $(SHARE)/man/man1 $(SHARE)/bash-completion/completions
	@./imtet --man > $(SHARE)/man/man1/imtet.1
	@for c in $$(./imtet --commands); do ./imtet --man $$c > $(SHARE)/man/man1/imtet-$$c.1; done
	@./imtet --completion > $(SHARE)/bash-completion/completions/imtet
	@for f in LICENSE CITATION.cff README.md CHANGELOG.md results/README.md docs/*.* docs/pictures/*; do install -D -m 644 $$f $(SHARE)/doc/imtet/$$f; done
	@for f in $(wildcard web/licences/* web/LICENSES*); do install -D -m 644 $$f $(SHARE)/doc/imtet/$$f; done

clean:
	rm -rf build imtet

# What the compiler wrote is up to date: make need not ask its built-in rules how to link one.
%.d: ;
-include $(shell find build -name '*.d' 2>/dev/null)
