# Build, test, install. `make help` lists every target; the checks stand in mk/checks.mk, figures and pages in mk/figures.mk.
#
#   MODE=release|debug|asan|tsan|coverage     objects of different modes lie in different folders of build/
#   V=1                                       shows every command
#   T="moga rbf"                              with test: these tests only, in MODE

VERSION  := 0.2.0
# Of the manual pages: the day of the last commit; without history the newest day of the changelog.
DATE     ?= $(shell git log -1 --format=%cs 2>/dev/null || grep -om1 '20[0-9][0-9]-[0-9][0-9]-[0-9][0-9]' CHANGELOG.md)
REVISION ?= $(shell git describe --always --dirty 2>/dev/null || echo unknown)
MODE     ?= release
BUILD    := build/$(MODE)
PREFIX   ?= /usr/local
LIBDIR   ?= $(PREFIX)/lib
JOBS     ?= $(shell nproc)
TEST_JOBS ?= $(shell expr 2 + $(JOBS))# tests at a time: many wait more than they compute
V        ?= 0
Q        := $(if $(filter 1,$(V)),,@)

# ---- flags -----------------------------------------------------------------------------------------------------------

SANITIZE := -fno-sanitize-recover=undefined -fno-omit-frame-pointer
CFLAGS.release  := -O2 -g
CFLAGS.debug    := -O0 -g3
CFLAGS.asan     := -O1 -g -fsanitize=address,undefined $(SANITIZE)
CFLAGS.tsan     := -O1 -g -fsanitize=thread -fno-omit-frame-pointer
CFLAGS.fuzz     := -O1 -g -fsanitize=fuzzer-no-link,address,undefined $(SANITIZE)
# Counters that are not atomic are ten times as fast; what they lose between threads leaves a branch that was taken taken.
CFLAGS.coverage := -O1 -g --coverage -fprofile-update=single

CC       ?= cc
WARNINGS := -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wstrict-prototypes -Wmissing-prototypes -Wvla $(if $(findstring clang,$(CC)),-Wno-c2x-extensions) -Werror
CPPFLAGS += -Isrc -Iinclude -isystem /usr/include/tcl8.6 -MMD -MP -D_GNU_SOURCE
# Contraction to fused multiply-add rounds once instead of twice; NaN and Inf stay what they are.
# Hidden: a function of ours never takes the place of one of the same name inside a shared library.
CFLAGS   += -std=c17 -fopenmp -ffp-contract=fast -fvisibility=hidden $(CFLAGS.$(MODE))
LDFLAGS  += -fopenmp $(CFLAGS.$(MODE))
LDLIBS   += -lsundials_cvode -lsundials_nvecserial -lsundials_sunnonlinsolfixedpoint -lnlopt -llapacke -lopenblas -ljansson -lsqlite3 -larchive -lmseed -lmicrohttpd -lz -lstdc++ -lm

# Loops over floors, modes and centres are written for the vectorizer; the rest does not gain from -O3. Sanitized, the
# simulator takes 0.55 of its time at -O2. These flags come last; provenance.json quotes them by the same variables.
NO_TRAPS     := -fno-math-errno -fno-trapping-math
FAST.release := -O3
FAST.asan    := -O2 -g1
FAST.coverage := -O2
FLAGS.sim    := $(FAST.$(MODE))
FLAGS.rbf    := $(FAST.$(MODE)) $(NO_TRAPS)
FLAGS.kernel := $(FLAGS.sim) $(NO_TRAPS) -Wno-psabi
FLAGS.base   := -DFAST_LANES=2
FLAGS.avx2   := -DFAST_LANES=4 -march=x86-64-v3 -mtune=haswell
FLAGS.avx512 := -DFAST_LANES=8 -march=x86-64-v4 -mtune=skylake-avx512 -mprefer-vector-width=512
# Sets of kernels, a bit each: 1 base, 2 AVX2, 4 AVX-512, which gains 15 % at most, and that in plain scenes. Sanitized, the
# widest that this processor has is enough: the source of all is one.
CPU_FLAGS    := $(shell grep -m1 ^flags /proc/cpuinfo)
SETS.asan    := $(lastword 1 $(if $(filter avx2,$(CPU_FLAGS)),2) $(if $(filter avx512dq,$(CPU_FLAGS)),4))
FAST_BUILT   := $(or $(SETS.$(MODE)),$(if $(filter x86_64,$(shell uname -m)),7,1))
KERNELS.1    := kernel_base plain_base
KERNELS.2    := kernel_avx2 plain_avx2
KERNELS.4    := kernel_avx2 plain_avx512
KERNELS.7    := $(sort $(KERNELS.1) $(KERNELS.2) $(KERNELS.4))
KERNELS      := $(KERNELS.$(FAST_BUILT))
KERNEL_OBJ   := $(KERNELS:%=$(BUILD)/src/sim/fast/%.o)

flags_of   = $(if $(2),; $(1): $(filter-out -W% -ffile-prefix-map=%,$(2)))
FLAGS_LIST := $(filter-out -W% -ffile-prefix-map=%,$(CFLAGS)) $(call flags_of,src/sim,$(FLAGS.sim)) \
              $(call flags_of,src/rbf src/moga/infill.c,$(FLAGS.rbf)) \
              $(foreach kernel,$(KERNELS),$(call flags_of,$(kernel),$(FLAGS.kernel) $(FLAGS.$(lastword $(subst _, ,$(kernel))))))
SPACE      := $() $()
FLAGS_TEXT := $(subst $(SPACE);,;,$(FLAGS_LIST))

# ---- what is built ---------------------------------------------------------------------------------------------------

SRC      := $(filter-out src/sim/fast/kernel.c src/mpi/% src/wasm/% src/opensees/%,$(wildcard src/*/*.c src/*/*/*.c))
MATRICES := $(wildcard configs/sac20/guyan/*.csv configs/sac20/appendix/*.csv configs/sac20/frame/*.csv) src/motion/builtin.csv
LIB_OBJ  := $(SRC:%.c=$(BUILD)/%.o) $(BUILD)/src/store/digits.o $(KERNEL_OBJ) $(MATRICES:%=$(BUILD)/%.o) $(BUILD)/web/page.o $(BUILD)/web/live.o
LIB      := $(BUILD)/libprogram.a
# What stands alone: no SQLite, no server, nothing printed. `make lib-alone` links it so.
CORE     := $(BUILD)/libimtet.a
CORE_OBJ := $(sort $(foreach d,base settings scene motion sim rbf moga evaluate api,$(filter $(BUILD)/src/$(d)/%,$(LIB_OBJ))) $(filter %.csv.o,$(LIB_OBJ)))
SONAME   := libimtet.so.0
SHARED   := $(BUILD)/libimtet.so.$(VERSION)
EXAMPLES := $(patsubst %.c,$(BUILD)/%,$(wildcard examples/*.c))
PROGRAM  := $(if $(filter release,$(MODE)),imtet,$(BUILD)/imtet)
# Beside the program: what reads OpenSees models for it and for the library.
READER   := $(PROGRAM)-opensees
# The program's engines in its tests; `make stability` has all.
STABILITY := fast cvode

.PHONY: all help setup run test test-sanitized tests format install install-library uninstall uninstall-library clean lib-alone .FORCE
.SECONDARY:
all: $(PROGRAM) $(READER) $(SHARED) $(CORE) ## builds ./imtet, and libimtet in build/release

help: ## this list
	@awk -F ' ## ' '/^[a-z-]+:.* ## / { sub(/:.*/, "", $$1); printf "  make %-16s %s\n", $$1, $$2 }' $(filter-out %.d,$(MAKEFILE_LIST))
	@sed -n 's/^#   /  /p' Makefile

setup: ## installs the Debian packages of scripts/packages.txt that are missing
	@scripts/setup

# `make all` that says how much of it is done: "17 of 180" on one line of a terminal.
COUNTED = n=$$($(MAKE) -n all 2>/dev/null | grep -c "^echo '  [ACL]"); rm -f build/unbuilt; test -t 1 && end='\033[K\r' || end='\n'; \
    { $(MAKE) --no-print-directory -j$(JOBS) all || { mkdir -p build && touch build/unbuilt; }; } | \
    awk -v n=$$n -v end="$$end" '/^  [ACL]/ { printf "  %d of %d %s" end, ++i, n, $$2; fflush(); next } { print }'; \
    test ! -e build/unbuilt || exit 2; echo

run: setup ## the README's first command: packages, build, self-test, quick study
	@$(COUNTED)
	./imtet check --self
	./imtet optimize configs/quick.ini

$(PROGRAM): $(BUILD)/src/main.o $(LIB)
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LDLIBS)

$(READER): $(BUILD)/src/opensees/main.o $(BUILD)/src/opensees/model.tcl.o
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ -ltcl8.6

$(LIB): $(LIB_OBJ)
	@rm -f $@
	$(Q)$(AR) rcs $@ $^

# The library, of which others see the functions of include/ alone: the archive is one object whose other names are local.
$(CORE): $(CORE_OBJ) Makefile
	@echo '  AR  $@'
	$(Q)$(LD) -r -o $(BUILD)/libimtet.o $(CORE_OBJ)
	$(Q)objcopy -w --keep-global-symbol='imtet_*' $(BUILD)/libimtet.o
	@rm -f $@
	$(Q)$(AR) rcs $@ $(BUILD)/libimtet.o

CORE_LIBS := $(filter-out -lnlopt -lsqlite3 -lmicrohttpd -lz,$(LDLIBS))
$(SHARED): $(CORE_OBJ) include/imtet.map
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -shared -Wl,-soname,$(SONAME) -Wl,--version-script=include/imtet.map -Wl,--as-needed -Wl,-z,defs \
	    -o $@ $(CORE_OBJ) $(CORE_LIBS)
	@ln -sf libimtet.so.$(VERSION) $(BUILD)/$(SONAME)
	@ln -sf $(SONAME) $(BUILD)/libimtet.so

# What the examples are is what a user writes: compiled with the headers alone, against the shared library.
$(BUILD)/examples/%: examples/%.c $(SHARED) include/imtet.h include/imtet_scene.h
	@mkdir -p $(@D)
	@echo '  CC  $@'
	$(Q)$(CC) -std=c17 -O1 -Iinclude $(WARNINGS) $(CFLAGS.$(MODE)) -o $@ $< -L$(BUILD) -limtet -Wl,-rpath,'$$ORIGIN/..' -lm -lpthread

$(BUILD)/alone: examples/ask_tell.c $(CORE)
	@echo '  LD  $@'
	$(Q)$(CC) -std=c17 -Iinclude $(LDFLAGS) -o $@ $^ $(CORE_LIBS)

lib-alone: $(BUILD)/alone ## links an example with libimtet.a, without SQLite and libmicrohttpd, and runs it
	@$(BUILD)/alone

$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	@echo '  CC  $@'
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) $(WARNINGS) $(FLAGS) -c $< -o $@

# The one function of C++ that C lacks.
$(BUILD)/%.o: %.cpp
	@mkdir -p $(@D)
	@echo '  CXX $@'
	$(Q)$(if $(findstring clang,$(CC)),clang++,g++) $(CPPFLAGS) -std=c++17 -fvisibility=hidden -fno-exceptions -fno-rtti \
	    $(CFLAGS.$(MODE)) -Wall -Wextra -Werror -c $< -o $@

# Objects of the library stand in the program and in the shared library alike: with hidden names PIC costs nothing.
# The stamp has objects that were compiled without it compiled again.
$(CORE_OBJ): CFLAGS += -fPIC
$(CORE_OBJ): $(BUILD)/pic
$(BUILD)/pic:
	@mkdir -p $(@D)
	@touch $@
$(BUILD)/src/sim/%.o: FLAGS = $(FLAGS.sim)
$(BUILD)/src/sim/fast/fast.o: CPPFLAGS += -DFAST_BUILT=$(FAST_BUILT)
$(BUILD)/src/rbf/%.o $(BUILD)/src/moga/infill.o: FLAGS = $(FLAGS.rbf)

# The fast engine's kernel, for all scenes and for plain ones, once per instruction set; fast.c chooses at run time.
$(KERNEL_OBJ): $(BUILD)/src/sim/fast/%.o: src/sim/fast/kernel.c
	@mkdir -p $(@D)
	@echo '  CC  $@'
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) $(WARNINGS) $(FLAGS.kernel) $(FLAGS.$(lastword $(subst _, ,$*))) -DFAST_KERNEL=fast_$* -DPLAIN=$(words $(filter plain_%,$*)) -c $< -o $@

# The two 20-floor buildings and the built-in motions are part of the program: a file becomes the symbols _binary_PATH_start and _end.
$(BUILD)/%.csv.o: %.csv
	@mkdir -p $(@D)
	$(Q)$(LD) -r -b binary -z noexecstack -o $@ $<
$(BUILD)/%.tcl.o: %.tcl
	@mkdir -p $(@D)
	$(Q)$(LD) -r -b binary -z noexecstack -o $@ $<

# So are the page of the report, its style and scripts inside, and that of `imtet serve`, which has live parts too.
# web/charts.js is what `make web` bundles from npm.
build/web/page.html build/web/live.html: web/assemble web/page.html web/style.css web/first.js web/charts.js web/engine.wasm.gz $(wildcard web/app/*.js web/live/*)
	@mkdir -p $(@D)
	$(Q)web/assemble $(filter live,$(basename $(@F))) > $@.part && mv $@.part $@

$(BUILD)/web/%.o: build/web/%.html
	@mkdir -p $(@D)
	$(Q)$(LD) -r -b binary -z noexecstack -o $@ $<

# Compiled again when version, revision or flags changed, so that a run's folder names the sources that it came from.
BUILT_FROM := $(VERSION) $(REVISION) $(FLAGS_TEXT)
$(BUILD)/revision: .FORCE
	@mkdir -p $(@D)
	@echo '$(BUILT_FROM)' | cmp -s - $@ || echo '$(BUILT_FROM)' > $@
$(BUILD)/src/store/provenance.o: $(BUILD)/revision
$(BUILD)/src/store/provenance.o: CPPFLAGS += -DIMTET_VERSION='"$(VERSION)"' -DIMTET_REVISION='"$(REVISION)"' \
                                             -DIMTET_CFLAGS='"$(FLAGS_TEXT)"'

$(BUILD)/src/cmd/manual.o: $(BUILD)/revision
$(BUILD)/src/cmd/manual.o: CPPFLAGS += -DIMTET_DATE='"$(DATE)"'

include bench/bench.mk src/mpi/mpi.mk

# ---- tests -----------------------------------------------------------------------------------------------------------

# Every file of tests runs once, where it proves most: what reads foreign bytes, keeps runs, or talks to others under
# AddressSanitizer and UBSan, on short runs; physics, search and numbers as users run them, where the sanitizers would find
# little and take three times as long. The library's is run in both: what is installed is not sanitized. Longest first.
NAMES.asan    := commands workers cli serve store asking damage disk store_faults shared run_read manual \
                 import motion_formats motion queue library safety asked job_limit settings table fuzz_corpus
NAMES.release := browser check resume torture
OTHERS        := library $(filter-out mpi $(NAMES.asan) $(NAMES.release),$(patsubst tests/test_%.c,%,$(wildcard tests/test_*.c)))
NAMES.release += $(OTHERS)
NAMES         := $(sort $(NAMES.release) $(NAMES.asan))
# Other modes, as coverage, have all of them.
IN_MODE       := $(or $(T),$(NAMES.$(MODE)),$(NAMES))

# What a test computes itself is little.
TEST_CFLAGS.release := -O1
TEST_CFLAGS.asan    := -O0
$(BUILD)/tests/%.o: FLAGS = $(TEST_CFLAGS.$(MODE))
# gold takes half the time of the usual linker, where it is installed.
GOLD := $(if $(shell command -v ld.gold),-fuse-ld=gold)
WRAPPED.store_faults := sqlite3_step sqlite3_exec sqlite3_prepare_v2 sqlite3_open_v2 sqlite3_errcode sqlite3_extended_errcode \
                        calloc malloc realloc fopencookie fopen fflush rename
WRAPPED.shared       := statfs
PARTS.fuzz_corpus    := $(patsubst %,$(BUILD)/tests/fuzz/%.o,targets worker run)

# Of what runs sanitized nothing needs more of the bench than the textbook problems.
bench_of     = $(if $(filter-out $(NAMES.asan),$(1)),$(BENCH_LIB),$(BUILD)/bench/textbook.o)
# $(call test_link,NAMES): links these files of tests.
test_objects = $(BUILD)/tests/main.o $(foreach name,$(1),$(BUILD)/tests/test_$(name).o $(PARTS.$(name)))
test_link    = $(Q)$(CC) $(LDFLAGS) $(GOLD) $(foreach name,$(1),$(WRAPPED.$(name):%=-Wl,--wrap=%)) -o $@ $(call test_objects,$(1)) \
               $(call bench_of,$(1)) $(LIB) -lcmocka $(BENCH_LDLIBS) $(LDLIBS)
TEST_PROGRAM := $(BUILD)/tests/$(if $(T),some,all)
$(TEST_PROGRAM): $(call test_objects,$(IN_MODE)) $(call bench_of,$(IN_MODE)) $(LIB) $(if $(T),.FORCE)
	@echo '  LD  $@'
	$(call test_link,$(IN_MODE))

$(BUILD)/tests/mpi: $(call test_objects,mpi) $(BENCH_LIB) $(LIB)
	@echo '  LD  $@'
	$(call test_link,mpi)

$(BUILD)/tests/fault/nomem.so: tests/fault/nomem.c
	@mkdir -p $(@D)
	$(Q)$(CC) -D_GNU_SOURCE -std=c17 -O1 $(WARNINGS) -shared -fPIC -o $@ $<

# What tests run beside the program.
BESIDE.faults  := $(BUILD)/tests/fault/nomem.so
BESIDE.library := $(if $(filter release,$(MODE)),$(SHARED) $(CORE) $(EXAMPLES))

# One line per job: mode, name, command.
JOBS_OF = $(foreach name,$(IN_MODE),'$(MODE) $(name) $(TEST_PROGRAM) $(name) "$(CASE)"')
ifeq ($(MODE)$(T),release)
BESIDE.release := $(BENCH)
JOBS_OF += $(foreach e,$(STABILITY),'release stability_$(e) $(BENCH) stability --quick --seconds 3 --engine $(e)') 'release laws $(BENCH) laws'
else ifeq ($(MODE)$(T),asan)
JOBS_OF += 'asan short-run scripts/short-run $(PROGRAM)'
endif

tests: $(PROGRAM) $(READER) $(TEST_PROGRAM) $(TEXTBOOK) $(foreach name,$(IN_MODE),$(BESIDE.$(name))) $(BESIDE.$(MODE)) ## builds the tests of MODE without running one

# A file of tests runs in the mode that it belongs to, or in that which the command gives.
GIVEN := $(filter command environment,$(origin MODE))
modes = $(if $(GIVEN),$(MODE),$(foreach mode,release asan,$(if $(filter $(T),$(NAMES.$(mode))),$(mode))))
names_in = $(if $(GIVEN),$(T),$(filter $(T),$(NAMES.$(mode))))
test_in = { $(MAKE) --no-print-directory -j$(JOBS) MODE=$(1) T="$(2)" tests && $(MAKE) --no-print-directory MODE=$(1) T="$(2)" run_tests; }
run_tests:
	@printf '%s\n' $(JOBS_OF) | scripts/run-tests $(TEST_JOBS)

UNKNOWN := $(filter-out $(NAMES),$(T))
ifdef T
test: ## every test of physics, search and numbers; T="moga rbf": these files of any kind; CASE=front: their tests so named
	$(if $(UNKNOWN),$(error T=$(UNKNOWN): there is no tests/test_$(firstword $(UNKNOWN)).c that `make test` runs))
	@code=0; $(foreach mode,$(modes),$(call test_in,$(mode),$(names_in)) || code=1;) exit $$code
else
test: setup
	@$(MAKE) --no-print-directory -j$(JOBS) tests
	@$(MAKE) --no-print-directory run_tests
endif

test-sanitized: setup ## readers, runs, workers, server and command line under AddressSanitizer and UBSan
	@$(MAKE) --no-print-directory -j$(JOBS) MODE=asan tests
	@$(MAKE) --no-print-directory MODE=asan run_tests

include mk/checks.mk mk/figures.mk mk/engine.mk

# ---- install ---------------------------------------------------------------------------------------------------------

format: ## clang-format over the sources
	clang-format -i $(wildcard include/*.h examples/*.c src/*.[ch] src/*/*.[ch] src/*/*/*.[ch] src/*/*/*.inc bench/*.[ch] bench/*/*.[ch] tests/*.[ch] tests/*/*.[ch])

# Manual pages are written by the program itself; completion asks it, that of zsh and fish through that of bash.
SHARE := $(DESTDIR)$(PREFIX)/share
COMPLETIONS := bash-completion/completions/imtet fish/vendor_completions.d/imtet.fish \
               zsh/$(if $(filter /usr,$(PREFIX)),vendor-completions,site-functions)/_imtet
install: all install-library ## program, library, manual pages, completion, examples; PREFIX=/usr/local DESTDIR=
	install -D -m 755 imtet $(DESTDIR)$(PREFIX)/bin/imtet
	@if [ -e imtet_mpi ]; then install -m 755 imtet_mpi scripts/imtet-mpirun $(DESTDIR)$(PREFIX)/bin; fi
	@for f in $$(cd configs && find . -type f); do install -D -m 644 configs/$$f $(SHARE)/imtet/configs/$$f; done
	@install -d $(SHARE)/man/man1 $(dir $(COMPLETIONS:%=$(SHARE)/%))
	@./imtet --man > $(SHARE)/man/man1/imtet.1
	@for c in $$(./imtet --commands); do ./imtet --man $$c > $(SHARE)/man/man1/imtet-$$c.1; done
	@for f in $(COMPLETIONS); do sed 's|@SHARE@|$(PREFIX)/share|' scripts/completion.$${f%%[-/]*} > $(SHARE)/$$f; done
	@for f in LICENSE CITATION.cff README.md CHANGELOG.md results/README.md docs/*.* docs/pictures/* examples/* python/README.md python/examples/*.py; do install -D -m 644 $$f $(SHARE)/doc/imtet/$$f; done
	@for f in $(wildcard web/licences/* web/LICENSES*); do install -D -m 644 $$f $(SHARE)/doc/imtet/$$f; done

# The library alone: libimtet, headers, imtet.pc and, where Python is, its package.
INCLUDED := imtet.h imtet_scene.h
# Where the Python of Debian looks.
PYTHON_DIR ?= $(PREFIX)/lib/$(if $(filter /usr,$(PREFIX)),python3,$(shell /usr/bin/python3 -c 'import sys; print("python3.%d" % sys.version_info[1])' 2>/dev/null || echo python3))/dist-packages
PYTHON_PACKAGE := $(patsubst python/%,%,$(wildcard python/imtet/*.py)) imtet/py.typed
install-library: $(SHARED) $(CORE) $(READER) ## libimtet.so, .a, headers, imtet.pc, the Python package
	install -d $(DESTDIR)$(LIBDIR)/pkgconfig
	install -D -m 755 $(READER) $(DESTDIR)$(PREFIX)/bin/imtet-opensees
	install -m 644 $(SHARED) $(CORE) $(DESTDIR)$(LIBDIR)
	ln -sf $(notdir $(SHARED)) $(DESTDIR)$(LIBDIR)/$(SONAME)
	ln -sf $(SONAME) $(DESTDIR)$(LIBDIR)/libimtet.so
	@sed 's|@PREFIX@|$(PREFIX)|; s|@LIBDIR@|$(LIBDIR)|; s|@VERSION@|$(VERSION)|; s|@LIBS@|-fopenmp $(CORE_LIBS)|' include/imtet.pc.in \
	    > $(DESTDIR)$(LIBDIR)/pkgconfig/imtet.pc
	@for f in $(INCLUDED); do install -D -m 644 include/$$f $(DESTDIR)$(PREFIX)/include/$$f; done
	@for f in $(PYTHON_PACKAGE); do install -D -m 644 python/$$f $(DESTDIR)$(PYTHON_DIR)/$$f; done
	@[ "$(DESTDIR)$(PREFIX)" != /usr/local ] || ldconfig 2>/dev/null || true # so that programs find the library

uninstall-library:
	rm -f $(addprefix $(DESTDIR)$(LIBDIR)/,$(notdir $(SHARED)) $(SONAME) libimtet.so libimtet.a pkgconfig/imtet.pc) $(DESTDIR)$(PREFIX)/bin/imtet-opensees \
	    $(addprefix $(DESTDIR)$(PREFIX)/include/,$(INCLUDED)) $(addprefix $(DESTDIR)$(PYTHON_DIR)/,$(PYTHON_PACKAGE))

uninstall: uninstall-library ## removes what install has put under PREFIX
	rm -f $(addprefix $(DESTDIR)$(PREFIX)/bin/,imtet imtet_mpi imtet-mpirun) $(SHARE)/man/man1/imtet.1 $(SHARE)/man/man1/imtet-*.1 \
	    $(COMPLETIONS:%=$(SHARE)/%)
	rm -rf $(SHARE)/imtet $(SHARE)/doc/imtet

clean: ## removes build/ and ./imtet
	rm -rf build imtet imtet_mpi

# What the compiler wrote is up to date: make need not ask its built-in rules how to link one.
%.d: ;
-include $(shell find build -path 'build/fresh-*' -prune -o -name '*.d' -print 2>/dev/null)
