# Figures and pictures of README and docs. Those of time want a quiet machine.

.PHONY: setup-figures bench promise pages paper chart pictures ladder study web setup-browser report-bench serve-bench

# A record that is not there is replaced by the built-in motion.
BENCH_RECORD ?= $(or $(wildcard ../shared/records/kobe_jma_ns.csv),builtin:kobe-like)
bench: $(BENCH) ## simulations per second, and whether they became more work
	@bench/guard $(BENCH)
	@$(BENCH) throughput --record $(BENCH_RECORD)

# Errors of the accuracies, in SCENES of each kind of gaps (10 take a minute); the fronts are those of three short studies.
PROMISE_RECORDS = $(wildcard $(patsubst %,../shared/records/%.csv,kobe_jma_ns elcentro_ns northridge_sylmar_ns hachinohe_ns))
promise: $(BENCH) $(PROGRAM) ## how often every accuracy holds what it promises
	@rm -rf build/promise build/promise.csv
	@for s in 1 2 3; do ./$(PROGRAM) optimize configs/kobe.ini --record $(BENCH_RECORD) --max-evals 1000 --set search.seed=$$s --out build/promise/$$s; \
	  ./$(PROGRAM) export build/promise/$$s --csv - | awk 'NR == 1 || NR % 5 == 0' | cut -d, -f2-23 | sed "$$([ $$s = 1 ] || echo 1d)" >> build/promise.csv; done
	@$(BENCH) promise $(PROMISE_RECORDS:%=--record %) $(if $(SCENES),--scenes $(SCENES)) --front build/promise.csv --out docs/measured/promise.csv

chart: $(BENCH) ## speed against accuracy of every engine
	@$(BENCH) sweep --record $(BENCH_RECORD) --csv docs/measured/chart.csv
	@scripts/plot-chart docs/measured/chart.csv docs/chart

paper: $(PROGRAM) $(BENCH) setup-figures ## docs/paper.md: the numbers and pictures of the paper item by item, with its records where they are at hand; ARGS="--evals N"
	@scripts/paper --program ./$(PROGRAM) --bench $(BENCH) $(ARGS)
	@scripts/tables paper

pictures: $(PROGRAM) ## docs/pictures, those of a study: RUN=results/kobe RECORDS="elcentro.csv sylmar.csv"
	@mkdir -p $(BUILD)/pictures
	@./$(PROGRAM) report $(RUN) $(RECORDS:%=--record %) --out $(BUILD)/pictures/report.html
	@./$(PROGRAM) report $(RUN) $(RECORDS:%=--record %) --pictures $(BUILD)/pictures
	@cp $(foreach p,front gaps peaks modes energies displacement elsewhere,$(BUILD)/pictures/$p.png) docs/pictures
	@$(REPORT_PICTURE)/report-first.jpg '#summary' 880
	@$(REPORT_PICTURE)/report-front.jpg '#front' 880 'J3 acceleration [g] to=6' 'J1 displacement [m] to=0.8'
	@$(REPORT_PICTURE)/report-pairs.jpg '#all-pairs-of-objectives-with-their-rank-correlations' 1000
	@$(REPORT_PICTURE)/report-variables.jpg '#which-variables-matter' 600
	@$(REPORT_PICTURE)/report-design.jpg '#design' 1500
	@d=$$(mktemp -d) && cp -r $(RUN) $$d/kobe && node tests/serve/drive.mjs $(abspath $(PROGRAM)) --pictures $$d docs/pictures; rm -r $$d
REPORT_PICTURE = node tests/report/picture.mjs $(BUILD)/pictures/report.html docs/pictures

ladder: $(PROGRAM) ## docs/ladder.md: which effects five scenes need
	@scripts/ladder $(ARGS)
	@scripts/tables ladder

study: $(PROGRAM) setup-figures ## docs/study.md: the studies of the paper, what has to be defended, bumpers; ARGS="--evals N front ida"
	@scripts/study --program ./$(PROGRAM) $(ARGS)
	@scripts/tables study

pages: promise study paper ## every page that names designs, of one study and one program

web: setup-browser ## web/charts.js bundled anew from npm
	@cd web && npm ci --ignore-scripts --no-audit --no-fund --silent && node bundle.mjs

setup-figures: ## packages for the tables of the search and the figures of docs
	@scripts/setup packages-figures.txt

setup-browser: ## packages for the report's tests in a browser, its bundle of charts and its times
	@scripts/setup packages-browser.txt

report-bench: setup-browser $(PROGRAM) ## how long a report of 10,000 designs takes to be painted and brushed
	@tests/report/bench $(abspath $(PROGRAM)) build/report-bench

serve-bench: setup-browser $(PROGRAM) ## how long an update takes while a slider of imtet serve is dragged; RUN=results/quick
	@node tests/serve/drive.mjs $(abspath $(PROGRAM)) --bench $(or $(RUN),results/quick)
