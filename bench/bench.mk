# imtet-bench: engines compared by speed, accuracy and reliability. What only its engines need is linked here alone.

BENCH_SRC    := $(filter-out bench/main.c bench/textbook_worker.c,$(wildcard bench/*.c bench/*/*.c))
BENCH_LIB    := $(BUILD)/libimtetbench.a
BENCH        := $(BUILD)/imtet-bench
BENCH_LDLIBS := -lsundials_arkode -lsundials_sunmatrixdense -lsundials_sunlinsoldense -lsundials_sunnonlinsolnewton

$(BENCH_LIB): $(BENCH_SRC:%.c=$(BUILD)/%.o)
	@rm -f $@
	$(Q)$(AR) rcs $@ $^

$(BENCH): $(BUILD)/bench/main.o $(BENCH_LIB) $(LIB)
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(BENCH_LDLIBS) $(LDLIBS)

# The textbook problems as a worker, for tests and scripts.
TEXTBOOK := $(BUILD)/textbook
$(TEXTBOOK): $(BUILD)/bench/textbook_worker.o $(BUILD)/bench/textbook.o $(LIB)
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LDLIBS)

$(BUILD)/bench/%.o $(BUILD)/tests/%.o: CPPFLAGS += -I. -DBUILD_FOLDER='"$(BUILD)"'
$(BUILD)/bench/engines/%.o: FLAGS = $(FLAGS.sim)
