/* Properties of the tower and its core, through the door that a user takes. */
#include "bench/stability/tower.h"
#include "bench/stability/trial.h"

#include <complex.h>
#include <stdlib.h>

#include "scene/core_beam.h"
#include "sim/fast/fast.h"
#include "sim/fast/kernel.h"

static void open_tower(const Trial *t, Tower *tower, double seconds)
{
    bench_tower_open(tower, seconds);
    tower->engine = t->engine;
    tower->settings.sim.accuracy = t->accuracy;
}

static double seconds_for(const Trial *t, double full)
{
    return t->size != SIZE_QUICK ? full : t->engine == ENGINE_FAST ? full / 3 : full / 6;
}

/* The errors that accuracy `standard` promises, times `factor`. */
static void compare_objectives(Trial *t, const SimResult *r, const SimResult *wanted, double factor, const char *what)
{
    factor *= trial_slack(t);
    trial_close(t, r, r->j1_m, wanted->j1_m, 1e-3 * factor, "%s: J1", what);
    trial_close(t, r, r->j2_m, wanted->j2_m, 3e-3 * factor, "%s: J2", what);
    trial_close(t, r, r->j3_g, wanted->j3_g, 2e-2 * factor, "%s: J3", what);
    trial_close(t, r, r->damped_building_j, wanted->damped_building_j, 1e-2 * factor,
                "%s: energy damped in the building", what);
    if (wanted->damped_core_j > 0)
        trial_close(t, r, r->damped_core_j, wanted->damped_core_j, 1e-2 * factor, "%s: energy damped in the core",
                    what);
}

static SimResult finest(const Tower *tower, SceneKind kind)
{
    Tower fine = *tower;
    fine.engine = ENGINE_FAST;
    fine.settings.sim.accuracy = ACCURACY_FINE;
    return bench_tower_run(&fine, kind);
}

/* ---- gaps ------------------------------------------------------------------------------------------------------ */

static void zero_gap(Trial *t)
{
    Tower tower;
    t->accuracy = ACCURACY_STANDARD;
    open_tower(t, &tower, seconds_for(t, 6));
    bench_tower_set_gaps(&tower, 0);
    const SimResult touching = bench_tower_run(&tower, SCENE_IMPACT), tied = finest(&tower, SCENE_LINKS);
    trial_close(t, &touching, touching.j1_m, tied.j1_m, 0.03, "J1 against the rigidly connected building");
    trial_close(t, &touching, touching.input_energy_j, tied.input_energy_j, 0.05,
                "input energy against the rigidly connected building");
    /* A storm of events would be one for every oscillation of every mode: kHz times floors. */
    trial_note(t, &touching, (double)touching.impacts / (20 * (double)(tower.motion.n - 1) * tower.motion.dt_s), 200,
               "contact onsets per floor and second");
    trial_remark(t, "J2 %.2g %% off, J3 %.3g g (rigidly connected %.3g g), %ld contact onsets, %ld steps, %.2g s",
                 100 * (touching.j2_m / tied.j2_m - 1), touching.j3_g, tied.j3_g, touching.impacts, touching.steps,
                 touching.seconds);
    bench_tower_close(&tower);
}

/* Largest displacement of the building alone: every mode in closed form on every straight stretch of the record, looked
 * at 200 times per stretch. */
static double largest_displacement(const Tower *tower)
{
    enum { LOOKS = 200 };
    Building b;
    Err err = {0};
    need(building_load(&b, &tower->settings.building, &err), &err);
    const double zeta = tower->settings.building.damping.at[0], dt = tower->motion.dt_s;
    double q[FLOORS_MAX] = {0}, v[FLOORS_MAX] = {0}, most = 0;
    for (size_t k = 0; k + 1 < tower->motion.n; k++) {
        double u[LOOKS + 1][FLOORS_MAX] = {{0}};
        for (int i = 0; i < b.n; i++) {
            const double w = b.omega[i], a0 = tower->motion.accel[k], rate = (tower->motion.accel[k + 1] - a0) / dt;
            /* q = s0 + s1 t + Re(c exp(lambda t)) */
            const double s1 = -b.gamma[i] * rate / (w * w), s0 = (-b.gamma[i] * a0 - 2 * zeta * w * s1) / (w * w);
            const double complex lambda = w * (-zeta + I * sqrt(1 - zeta * zeta));
            const double x = q[i] - s0, xd = v[i] - s1;
            const double complex c = x - I * (xd + zeta * w * x) / cimag(lambda);
            for (int l = 0; l <= LOOKS; l++) {
                const double at = dt * l / LOOKS;
                const double complex z = c * cexp(lambda * at);
                q[i] = s0 + s1 * at + creal(z);
                v[i] = s1 + creal(lambda * z);
                for (int j = 0; j < b.n; j++)
                    u[l][j] += b.phi[j * b.n + i] * q[i];
            }
        }
        for (int l = 0; l <= LOOKS; l++)
            for (int j = 0; j < b.n; j++)
                most = fmax(most, fabs(u[l][j]));
    }
    building_free(&b);
    return most;
}

static void huge_gap(Trial *t)
{
    TRIAL_EACH_ACCURACY(t)
    {
        Tower tower;
        open_tower(t, &tower, seconds_for(t, 6));
        bench_tower_set_gaps(&tower, 50);
        const SimResult r = bench_tower_run(&tower, SCENE_IMPACT);
        const double wanted = largest_displacement(&tower);
        trial_close(t, &r, r.j1_m, wanted, trial_allowed(t, 1e-5, 1e-3), "J1 against the closed form");
        trial_note(t, &r, (double)r.impacts, 0, "contact onsets");
        bench_tower_close(&tower);
    }
}

/* ---- the core --------------------------------------------------------------------------------------------------- */

static void compare_with_finest(Trial *t, const Tower *tower, const char *what)
{
    const SimResult r = bench_tower_run(tower, SCENE_IMPACT), wanted = finest(tower, SCENE_IMPACT);
    trial_remark(t, "%s: %ld contact onsets, energy-balance error %.1e; ", what, r.impacts, r.energy_balance_error);
    trial_close(t, &r, r.j1_m, wanted.j1_m, 3e-3 * trial_slack(t), "%s: J1", what);
    trial_close(t, &r, r.j2_m, wanted.j2_m, 1e-2 * trial_slack(t), "%s: J2", what);
    trial_close(t, &r, r.input_energy_j, wanted.input_energy_j, 1e-2, "%s: input energy", what);
}

/* Times the record, which peaks at 0.3 g: 1000 gal and more. */
static const double STRONG[] = {3.5, 1};

static void open_shaken(const Trial *t, Tower *tower, double factor)
{
    open_tower(t, tower, seconds_for(t, 3));
    for (size_t k = 0; k < tower->motion.n; k++)
        tower->motion.accel[k] *= factor;
}

static void hard_and_soft_ground(Trial *t)
{
    static const char *const GROUND[] = {"rotation=1e4", "g=1e6 radius=4", "soil=D radius=10", "g=1e12 radius=100"};
    t->accuracy = ACCURACY_STANDARD;
    for (int i = 0; i < 8; i += t->size == SIZE_QUICK ? 5 : 1) {
        Tower tower;
        char what[60];
        open_shaken(t, &tower, STRONG[i % 2]);
        snprintf(tower.settings.core.foundation, sizeof tower.settings.core.foundation, "%s", GROUND[i / 2]);
        snprintf(what, sizeof what, "%s, record x %g", GROUND[i / 2], STRONG[i % 2]);
        compare_with_finest(t, &tower, what);
        bench_tower_close(&tower);
    }
}

/* With the dashpot of the half-space and without, at its edge and far beyond. */
static void lifting_mat(Trial *t)
{
    static const char *const GROUND[] = {"soil=D radius=10 anchors=1", "soil=C radius=6 weight=1e6 anchors=1",
                                         "rotation=1e11 radius=6 anchors=1",
                                         "rotation=1e11 radius=6 weight=1e7 anchors=3"};
    t->accuracy = ACCURACY_STANDARD;
    for (int i = 0; i < 8; i += t->size == SIZE_QUICK || t->engine == ENGINE_CVODE ? 5 : 1) {
        Tower tower;
        char what[80];
        if (t->engine != ENGINE_FAST && t->engine != ENGINE_CVODE) /* the others know no mat */
            return;
        open_shaken(t, &tower, STRONG[i % 2]);
        snprintf(tower.settings.core.foundation, sizeof tower.settings.core.foundation, "%s", GROUND[i / 2]);
        snprintf(what, sizeof what, "%s, record x %g", GROUND[i / 2], STRONG[i % 2]);
        tower.settings.sim.forces = FORCES_YES;
        const SimResult r = bench_tower_run(&tower, SCENE_IMPACT);
        trial_note(t, &r, r.energy_balance_error, 1e-3, "%s: energy through lifting and landing", what);
        trial_note(t, &r, r.forces.uplift_ratio > 1 && r.mat_rotation_rad > 0 ? 0 : 1, 0.5, "%s: lifts", what);
        compare_with_finest(t, &tower, what);
        bench_tower_close(&tower);
    }
}

static void stiff_and_soft_core(Trial *t)
{
    static const double FACTOR[] = {1e-6, 1e-3, 1e3, 1e6};
    t->accuracy = ACCURACY_STANDARD;
    for (int i = 0; i < 4; i += t->size == SIZE_QUICK ? 3 : 1) {
        Tower tower;
        char what[40];
        open_tower(t, &tower, seconds_for(t, 3));
        tower.settings.core.youngs_modulus_pa *= FACTOR[i];
        snprintf(what, sizeof what, "core stiffness x %g", FACTOR[i]);
        compare_with_finest(t, &tower, what);
        bench_tower_close(&tower);
    }
}

static void weak_storeys(Trial *t)
{
    static const double YIELD_DRIFT[] = {1e-4, 1e-3, 0.01};
    static const char *const HYSTERESIS[] = {HYSTERESIS_LIST(CHOICE_WORD)};
    t->accuracy = ACCURACY_STANDARD;
    for (int i = 0; i < 12; i += t->size == SIZE_QUICK ? 7 : 1) {
        Tower tower;
        char what[60];
        const Hysteresis hysteresis = i / 2 % 2 ? HYSTERESIS_BOUC_WEN : HYSTERESIS_BILINEAR;
        open_shaken(t, &tower, STRONG[i % 2]);
        tower.settings.building.yield_drift = YIELD_DRIFT[i / 4];
        tower.settings.building.hysteresis = hysteresis;
        snprintf(what, sizeof what, "%s, yield drift %g, record x %g", HYSTERESIS[hysteresis], YIELD_DRIFT[i / 4],
                 STRONG[i % 2]);
        compare_with_finest(t, &tower, what);
        bench_tower_close(&tower);
    }
}

/* ---- the record -------------------------------------------------------------------------------------------------- */

static void mirrored(Trial *t)
{
    Tower tower;
    t->accuracy = ACCURACY_STANDARD;
    open_tower(t, &tower, seconds_for(t, 6));
    const SimResult there = bench_tower_run(&tower, SCENE_IMPACT);
    for (size_t i = 0; i < tower.motion.n; i++)
        tower.motion.accel[i] *= -1;
    const SimResult back = bench_tower_run(&tower, SCENE_IMPACT);
    /* difference quotients of a Jacobian know left from right: such an engine agrees as far as it promises anything */
    const int exact = trial_slack(t) == 1;
    compare_objectives(t, &back, &there, exact ? 1e-4 : 1, "mirrored");
    trial_note(t, &back, fabs((double)(back.impacts - there.impacts)), exact ? 0 : 0.02 * (double)there.impacts,
               "contact onsets");
    bench_tower_close(&tower);
}

static void resize_motion(Motion *m, size_t front, size_t back)
{
    double *longer = calloc(m->n + front + back, sizeof *longer);
    memcpy(longer + front, m->accel, m->n * sizeof *longer);
    free(m->accel);
    m->accel = longer;
    m->n += front + back;
}

static void padded(Trial *t)
{
    Tower tower;
    t->accuracy = ACCURACY_STANDARD;
    open_tower(t, &tower, seconds_for(t, 6));
    const double duration = (double)(tower.motion.n - 1) * tower.motion.dt_s;
    tower.motion.accel[tower.motion.n - 1] = 0; /* else a ramp to zero would be put in */
    const SimResult bare = bench_tower_run(&tower, SCENE_IMPACT);
    resize_motion(&tower.motion, 0, 37);
    tower.settings.sim.duration_s = duration;
    const SimResult behind = bench_tower_run(&tower, SCENE_IMPACT);
    compare_objectives(t, &behind, &bare, 1e-4, "zeros behind");
    resize_motion(&tower.motion, 37, 0);
    tower.settings.sim.duration_s = duration + 37 * tower.motion.dt_s;
    const SimResult before = bench_tower_run(&tower, SCENE_IMPACT);
    compare_objectives(t, &before, &bare, 1, "zeros before");
    bench_tower_close(&tower);
}

static void strength(Trial *t)
{
    static const double SCALE[] = {1e-12, 1e-6, 1e-3, 10, 100, 1000};
    t->accuracy = ACCURACY_STANDARD;
    SimResult first = {0};
    for (int i = 0; i < 6; i += t->size == SIZE_QUICK && i % 3 == 0 ? 2 : 1) {
        Tower tower;
        open_tower(t, &tower, seconds_for(t, 3));
        for (size_t k = 0; k < tower.motion.n; k++)
            tower.motion.accel[k] *= SCALE[i];
        const SimResult r = bench_tower_run(&tower, SCENE_IMPACT);
        if (i == 0)
            first = r;
        const double f = SCALE[i] / SCALE[0];
        if (SCALE[i] < 1) {
            trial_close(t, &r, r.j1_m / f, first.j1_m, 1e-3, "strength x %g: J1 over strength", SCALE[i]);
            trial_close(t, &r, r.input_energy_j / (f * f), first.input_energy_j, 1e-4,
                        "strength x %g: input energy over its square", SCALE[i]);
            trial_note(t, &r, (double)r.impacts, 0, "strength x %g: contact onsets", SCALE[i]);
            trial_note(t, &r, r.j1_m > 0 ? 0 : 1, 0.5, "strength x %g: moves", SCALE[i]);
        } else {
            trial_remark(t, "x %g: indentation %.3g of the radius%s; ", SCALE[i], r.indentation_ratio,
                         r.outcome != RUN_OK      ? " (refused)"
                         : beyond_contact_law(&r) ? " (flagged)"
                                                  : "");
            trial_note(t, &r, r.energy_balance_error, 1e-3, "strength x %g: energy-balance error", SCALE[i]);
            if (SCALE[i] >= 100)
                trial_note(t, &r, beyond_contact_law(&r) ? 0 : 1, 0.5, "strength x %g: flagged as too deep", SCALE[i]);
        }
        bench_tower_close(&tower);
    }
}

/* ---- machines ---------------------------------------------------------------------------------------------------- */

static void vector_width(Trial *t)
{
    if (t->engine != ENGINE_FAST) /* one kernel: nothing to compare */
        return;
    TRIAL_EACH_ACCURACY(t)
    {
        Tower tower;
        Building b;
        CoreBeam core;
        SimModel model;
        FastWork *work;
        SimResult first = {0};
        Err err = {0};
        open_tower(t, &tower, seconds_for(t, 3));
        const SceneOptions options = settings_scene(&tower.settings);
        need(building_load(&b, &tower.settings.building, &err), &err);
        need(core_beam_make(&core, &tower.settings.core, b.n, b.storey_m, tower.x[20], tower.x[21], &err), &err);
        need(model_create(&model, b.n, b.n, &err), &err);
        need(model_set(&model, &options, &b, &core, tower.x, &err), &err);
        need(fast_create(&work, b.n, b.n, 0, 0, &err), &err);
        const EngineOptions run = {.duration = (double)(tower.motion.n - 1) * tower.motion.dt_s};
        const FastTolerances tolerances = fast_tolerances(t->accuracy);
        for (int i = 0; i < 2 * FAST_SETS; i++) {
            const FastKernels *set = fast_kernels(i / 2);
            SimResult r;
            if (!set)
                continue;
            (i % 2 ? set->plain : set->run)(work, &model, &tower.motion, &run, &tolerances, &r);
            if (first.steps == 0)
                first = r;
            trial_close(t, &r, r.j1_m, first.j1_m, 1e-8, "%s against the first: J1", set->name);
            trial_close(t, &r, r.j3_g, first.j3_g, trial_allowed(t, 1e-6, 1e-4), "%s against the first: J3", set->name);
            trial_close(t, &r, r.input_energy_j, first.input_energy_j, 1e-8, "%s against the first: input energy",
                        set->name);
        }
        fast_free(work);
        model_free(&model);
        building_free(&b);
        bench_tower_close(&tower);
    }
}

static const Case CASES[] = {
    {"zero-gap", "no gap on any floor tends to the rigidly connected building, without a storm of events", zero_gap},
    {"huge-gap", "a gap that never closes gives the closed form of the building alone", huge_gap},
    {"core-stiffness", "a core 1e-6 to 1e6 times as stiff, against `fast` at fine", stiff_and_soft_core},
    {"storeys",
     "storeys that yield at next to nothing, bilinear and Bouc-Wen, under 0.3 g and 1 g, against `fast` at fine",
     weak_storeys},
    {"ground", "a core on ground from next to nothing to rock, under 0.3 g and 1 g, against `fast` at fine",
     hard_and_soft_ground},
    {"uplift",
     "a mat that lifts, with and without the ground's dashpot, under 0.3 g and 1 g: energy, and against `fast` at fine",
     lifting_mat},
    {"mirrored-record", "a mirrored record gives the mirrored response", mirrored},
    {"zero-padded-record", "zeros before or behind the record change no objective", padded},
    {"strength", "strength x 1e-12 to 1e3: linear until the first contact, flagged when too deep", strength},
    {"vector-width", "the kernels for SSE2, AVX2 and AVX-512 agree", vector_width}};

const CaseGroup TOWER_CASES = {CASES, sizeof CASES / sizeof CASES[0]};
