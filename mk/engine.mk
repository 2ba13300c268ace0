# The simulator as WebAssembly (src/wasm/engine.c), which the page of a report calls. It is checked in as web/charts.js is:
# `make` needs no clang. After a change of what is simulated `make engine`, else the page computes what the program did before;
# `make test T=browser` compares the two.
WASM_FLAGS := --target=wasm32-wasi -std=gnu17 -msimd128 -Isrc -D_GNU_SOURCE -DFAST_BUILT=1 -Wno-everything $(NO_TRAPS)
# Random123 knows no WebAssembly, but wants to be told what plain C of 32 and 64 bits it may use; building_read is the page's own.
WASM_FLAGS.random        := -D__aarch64__
WASM_FLAGS.building_read := -Dbuilding_read=building_of_files
COMMA := ,
WASM_KERNELS := kernel_base plain_base
# What reads files, draws random motions or needs LAPACK has its stand-in in src/wasm; the linker leaves out what nobody calls.
WASM_SRC := $(wildcard src/wasm/*.c src/sim/*.c) src/sim/fast/fast.c src/report/history.c \
            $(filter-out %/opensees.c %/sheets.c,$(wildcard src/scene/*.c)) $(wildcard src/settings/*.c) \
            $(filter-out %/linalg.c %/text.c %/json.c %/whole_file.c,$(wildcard src/base/*.c)) \
            $(filter-out %/builtin.c %/synthetic.c,$(wildcard src/motion/*.c)) \
            $(addprefix src/evaluate/,consequences.c measures.c portable.c replicates.c scenario.c)
WASM_OBJ := $(WASM_SRC:%.c=build/wasm/%.o) $(WASM_KERNELS:%=build/wasm/%.o)

engine: ## the simulator as a module for the page of a report, web/engine.wasm.gz (clang, lld, wasi-libc)
	@scripts/setup packages-engine.txt
	@$(MAKE) --no-print-directory -j$(JOBS) build/wasm/engine.wasm
	$(Q)gzip -9nc build/wasm/engine.wasm > web/engine.wasm.gz
.PHONY: engine

build/wasm/src/%.o: src/%.c
	@mkdir -p $(@D)
	@echo '  CC  $@'
	$(Q)clang $(WASM_FLAGS) -O2 $(WASM_FLAGS.$(basename $(@F))) -MMD -MP -c $< -o $@

$(WASM_KERNELS:%=build/wasm/%.o): build/wasm/%.o: src/sim/fast/kernel.c
	@mkdir -p $(@D)
	@echo '  CC  $@'
	$(Q)clang $(WASM_FLAGS) -O3 -DFAST_LANES=2 -DFAST_KERNEL=fast_$* -DPLAIN=$(words $(filter plain_%,$*)) -MMD -MP -c $< -o $@

build/wasm/engine.wasm: $(WASM_OBJ)
	@echo '  LD  $@'
	$(Q)clang --target=wasm32-wasi -mexec-model=reactor -Wl,--strip-all,-z,stack-size=4194304 $(addprefix -Wl$(COMMA)--export=engine_,answer room open design ground run histories) $^ -o $@

-include $(WASM_OBJ:.o=.d)
