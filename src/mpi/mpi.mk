# imtet_mpi: the same program over the ranks of MPI. What src/mpi defines takes the place of src/evaluate/alone.c.

.PHONY: mpi tests-mpi test-mpi test-mpi-here slurm-test

MPICC       ?= mpicc
MPI_PROGRAM := $(if $(filter release,$(MODE)),imtet_mpi,$(BUILD)/imtet_mpi)
MPI_OBJ     := $(patsubst %.c,$(BUILD)/%.o,$(wildcard src/mpi/*.c))

mpi: $(MPI_PROGRAM) ## builds ./imtet_mpi for clusters (scripts/setup-mpi, docs/cluster.md)

$(MPI_OBJ): $(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	@echo '  CC  $@'
	$(Q)$(MPICC) $(CPPFLAGS) $(CFLAGS) $(WARNINGS) -c $< -o $@

$(MPI_PROGRAM): $(BUILD)/src/main.o $(MPI_OBJ) $(LIB)
	@echo '  LD  $@'
	$(Q)$(MPICC) $(LDFLAGS) -o $@ $^ $(LDLIBS)

# A program that differs by its revision alone.
$(BUILD)/other/provenance.o: src/store/provenance.c $(BUILD)/revision
	@mkdir -p $(@D)
	$(Q)$(CC) $(CPPFLAGS) $(CFLAGS) -DIMTET_REVISION='"other"' -c $< -o $@

$(BUILD)/other/imtet_mpi: $(BUILD)/src/main.o $(BUILD)/other/provenance.o $(MPI_OBJ) $(LIB)
	@echo '  LD  $@'
	$(Q)$(MPICC) $(LDFLAGS) -o $@ $^ $(LDLIBS)

slurm-test: $(PROGRAM) ## configs/slurm on a Slurm of its own, two minutes; skipped where Slurm or MPI are not installed
	@if command -v $(MPICC) >/dev/null; then $(MAKE) --no-print-directory mpi; fi
	@scripts/slurm-test

RANKS ?= 4
test-mpi: ## tests of imtet_mpi with RANKS=4 at most; skipped where there is no mpicc
	@if command -v $(MPICC) >/dev/null; then $(MAKE) --no-print-directory test-mpi-here; \
	 else echo 'test-mpi: skipped, there is no $(MPICC); scripts/setup-mpi installs it'; fi

tests-mpi: $(PROGRAM) $(TEXTBOOK) $(MPI_PROGRAM) $(BUILD)/other/imtet_mpi $(BUILD)/tests/mpi

test-mpi-here: tests-mpi
	@echo '$(MODE) mpi $(BUILD)/tests/mpi mpi "$(CASE)"' | \
	 IMTET_MPI=$(abspath $(MPI_PROGRAM)) IMTET_MPI_OTHER=$(abspath $(BUILD)/other/imtet_mpi) \
	 MPI_RANKS=$(RANKS) TEST_LIMIT_S=1500 scripts/run-tests 1
