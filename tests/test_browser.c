/* The report and the page of imtet serve in headless Chromium, driven by node: tests/report/drive.mjs and
 * tests/serve/drive.mjs, in one browser. */
#include "program.h"

#define TOWER                                                                                                          \
    "optimize configs/quick.ini " SIX_FLOORS "--threads 1 --set motion.stretch=0.5 --set sim.duration_s=4 --set "      \
    "search.population=16 --set search.initial=40 "
#define JUDGED                                                                                                         \
    "--max-evals 60 --set building.yield_drift=0.001 --set 'core.foundation=soil=C radius=5' --set "                   \
    "search.objectives=j1_m,j2_m,j3_g,ed1_pct,edcs_pct,drift_ratio,mcore_kg --set "                                    \
    "'search.limits=core_stress_pa<=1e10' "

TEST(a_browser_shows_reports_follows_a_run_and_asks_what_if)
{
    if (!has_browser() || system("command -v node >/dev/null") != 0)
        skip();
    FOR_EACH (const char *, each, TOWER JUDGED "--set search.seed=2 --out @/runs/a",
              TOWER JUDGED "--set search.seed=3 --out @/runs/b",
              "optimize configs/quick.ini " DTLZ2(
                  5, 3) "--max-evals 90 --set search.population=16 --set search.initial=40 --out @/runs/c",
              TOWER
              "--set design.step_thickness_m=0.01,0.02,0.03 --max-evals 40 --set sim.replicates=2 "
              "--set search.fidelity=replicates --set sim.gap_tolerance_m=0.003 --set sim.uncertain=restitution=0.05 "
              "--set motion.records=builtin:elcentro-like --set motion.pga_g=0 --set motion.factor=0.5 --out @/runs/d",
              "report @/runs/a --out @/a.html", "report @/runs/c --out @/c.html")
        expect(0, "", *each);
    expect_shell("d='%s'; node tests/serve/drive.mjs '%s' $d $d/a.html $d/c.html >$d/tried 2>&1 || { cat $d/tried; "
                 "exit 1; }; grep ' ms' $d/tried",
                 place.folder, getenv("IMTET"));
}

SUITE(make_place, clear_place)
