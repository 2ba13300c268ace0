#include "bench/stability/laws.h"
#include "bench/paper.h"
#include "bench/promise.h"

#include <stdio.h>
#include <stdlib.h>

#include "bench/stability/oracle.h"
#include "sim/engine.h"
#include "bench/stability/tower.h"
#include "motion/motion_scale.h"
#include "store/output.h"

static const char *const NAMES[] = {CONTACT_LAW_LIST(CHOICE_WORD)};
enum { LAWS = sizeof NAMES / sizeof NAMES[0], N_R = 20 };

typedef struct {
    double oracle, fast;          /* rebound ratio */
    double clamp, lost;           /* share of the energy before the impact */
    double duration, penetration; /* over Hertz's */
} Measured;

static double r_of(int i)
{
    return 0.05 * (i + 1);
}

static Contact contact_of(ContactLaw law, double r)
{
    Settings s;
    Contact c;
    Err err = {0};
    paper_defaults(&s);
    s.contact.law = law;
    s.contact.restitution = r;
    need(contact_make(&c, &s.contact, &err), &err);
    return c;
}

/* One isolated impact at 0.4 m/s, by the oracle and by the engine. */
static Measured measure_impact(ContactLaw law, double r)
{
    const double mass = 2000, v = 0.4;
    const Contact c = contact_of(law, r);
    const double duration = contact_hertz_duration(c.k, mass, v), dt = 50 * duration;
    double accel[3] = {0, -v / dt, 0};
    const Bob bob = {.mass = mass, .gap = 3 * v * dt};
    const Motion motion = {.accel = accel, .n = 3, .dt_s = dt};
    const double closing = 4 * dt, end = closing + 20 * duration, energy = 0.5 * mass * v * v;
    Oracle o;
    oracle_run(&o, &bob, &c, &motion, end, dt / 10, duration / 4000);
    SimModel model;
    SimResult result;
    Err err = {0};
    bobs_model(&model, 1, &bob, 0, &c);
    need(engine_fast(&model, &motion, &(EngineOptions){.duration = end, .accuracy = ACCURACY_FINE}, &result, &err),
         &err);
    model_free(&model);
    return (Measured){.oracle = sqrt(o.kinetic_strain / energy),
                      .fast = sqrt(result.kinetic_strain_j / energy),
                      .clamp = o.clamp / energy,
                      .lost = o.lost / energy,
                      .duration = (o.opened - closing) / duration,
                      .penetration = o.penetration / contact_hertz_indentation(c.k, mass, v)};
}

/* What the law is known to return; NAN: not known, the oracle alone says what is right. A closed form of every law with damping in
 * proportion to k p^1.5 is contact_rebound(a); Jankowski's is fitted to r. */
static double known(ContactLaw law, double r)
{
    switch (law) {
    case LAW_EXACT:
        return r;
    case LAW_PAPER:
        return contact_rebound(1.5 * (1 - r));
    case LAW_LANKARANI_NIKRAVESH:
        return contact_rebound(0.75 * (1 - r * r));
    case LAW_FLORES:
        return contact_rebound(1.6 * (1 - r) / r);
    case LAW_JANKOWSKI:
        return r;
    }
    return NAN;
}

static int check_law(ContactLaw law, double r, const Measured *m)
{
    const double allowed = law == LAW_JANKOWSKI ? 0.01 : 1e-5, should = known(law, r);
    const int wrong = (!isnan(should) && !(fabs(m->oracle - should) <= allowed)) ||
                      !(fabs(m->fast - m->oracle) <= 1e-4 + 1e-3 * m->oracle);
    if (wrong)
        printf("%s at r = %g: oracle %.8g, fast %.8g, known %.8g\n", NAMES[law], r, m->oracle, m->fast, should);
    return wrong;
}

static void write_curves(FILE *f, Measured m[LAWS][N_R])
{
    fprintf(f, "r,law,rebound,rebound_fast,duration_over_hertz,indentation_over_hertz,lost_pct,no_tension_pct\n");
    for (int l = 0; l < LAWS; l++)
        for (int i = 0; i < N_R; i++) {
            const Measured *x = &m[l][i];
            fprintf(f, "%.2f,%s,%.6f,%.6f,%.5f,%.5f,%.2f,%.2g\n", r_of(i), NAMES[l], x->oracle, x->fast, x->duration,
                    x->penetration, 100 * x->lost, 100 * x->clamp);
        }
}

/* The early window: `builtin:sylmar-like`, 0.3 g, stretched by 3, 11 s, the core of Table 1, gaps of 8 mm times the
 * storey's number. */
static SimResult early_window(ContactLaw law, int engine, Accuracy accuracy)
{
    Tower t = {.engine = engine};
    Err err = {0};
    paper_defaults(&t.settings);
    t.settings.core.section = CORE_EFFECTIVE;
    t.settings.contact.law = law;
    t.settings.sim.duration_s = 11;
    t.settings.sim.accuracy = accuracy;
    t.settings.sim.forces = FORCES_YES;
    need(motion_load(&t.motion, "builtin:sylmar-like", UNIT_FROM_FILE, &err), &err);
    need(motion_prepare(&t.motion, 0.3, 3.0, &err), &err);
    for (int j = 0; j < 20; j++)
        t.x[j] = 0.008 * (j + 1);
    t.x[20] = 0.012;
    t.x[21] = 0.0064;
    const SimResult r = bench_tower_run(&t, SCENE_IMPACT);
    bench_tower_close(&t);
    return r;
}

static void write_tower(FILE *f)
{
    fprintf(f, "law,j1_m,j2_m,j3_g,impacts,v0_limited,contact_loss_pct,no_tension_pct\n");
    for (int l = 0; l < LAWS; l++) {
        const SimResult r = early_window((ContactLaw)l, ENGINE_FAST, ACCURACY_FINE);
        fprintf(f, "%s,%.6f,%.6f,%.4f,%ld,%ld,%.2g,%.2g\n", NAMES[l], r.j1_m, r.j2_m, r.j3_g, r.impacts, r.v0_limited,
                100 * r.contact_loss_j / r.input_energy_j, 100 * r.clamp_j / r.input_energy_j);
    }
}

/* ---- every engine under every law -------------------------------------------------------------------------------- */

/* The first is what the others are compared with. */
static const struct {
    int engine;
    Accuracy accuracy;
} COMPARED[] = {{ENGINE_CVODE, ACCURACY_FINE},
                {ENGINE_FAST, ACCURACY_STANDARD},
                {ENGINE_FAST, ACCURACY_FINE},
                {ENGINE_ETDRK4, ACCURACY_FINE}};
enum { N_COMPARED = sizeof COMPARED / sizeof COMPARED[0] };

/* The largest error over what the program promises (bench/promise.h); largest force of a contact: as of J3. */
static double error_over_promise(const SimResult *r, const SimResult *wanted)
{
    double each[BENCH_OBJECTIVES], worst = fabs(r->forces.contact_force_max_n / wanted->forces.contact_force_max_n - 1);
    worst /= PROMISE[2];
    result_errors(r, wanted, each);
    for (int k = 0; k < BENCH_OBJECTIVES; k++) {
        const double share = each[k] / PROMISE[k < PROMISED ? k : PROMISED - 1];
        if (!(share <= worst)) /* keeps NaN */
            worst = share;
    }
    return r->outcome == RUN_OK && wanted->outcome == RUN_OK ? worst : HUGE_VAL;
}

/* Rows of all engines under a law; returns how many are outside the promise. */
static int compare_engines(ContactLaw law, FILE *f)
{
    static const char *const ACCURACIES[] = {"coarse", "standard", "fine"};
    SimResult wanted;
    int outside = 0;
    for (int k = 0; k < N_COMPARED; k++) {
        const SimResult r = early_window(law, COMPARED[k].engine, COMPARED[k].accuracy);
        if (k == 0)
            wanted = r;
        const char *engine = bench_engine(COMPARED[k].engine)->name, *accuracy = ACCURACIES[COMPARED[k].accuracy];
        const double error = error_over_promise(&r, &wanted);
        fprintf(f, "%s,%s,%s,%.6f,%.7f,%.5f,%.0f,%.5f,%.5f,%.5f,%.5f,%ld,%.2g\n", NAMES[law], engine, accuracy, r.j1_m,
                r.j2_m, r.j3_g, r.forces.contact_force_max_n, r.ed1_pct, r.ed5_10_pct, r.edcs_pct,
                100 * r.contact_loss_j / r.input_energy_j, r.impacts, error);
        if (error <= 1)
            continue;
        printf("%s: %s at %s is %.3g times the promise from cvode\n", NAMES[law], engine, accuracy, error);
        outside++;
    }
    return outside;
}

static int write_engines(FILE *f)
{
    int outside = 0;
    fprintf(f, "law,engine,accuracy,j1_m,j2_m,j3_g,contact_force_max_n,ed1_pct,ed5_10_pct,edcs_pct,contact_loss_pct,"
               "impacts,error_over_promise\n");
    for (int l = 0; l < LAWS; l++)
        outside += compare_engines((ContactLaw)l, f);
    printf("contact laws: %d of %d runs are outside the promise\n", outside, LAWS * N_COMPARED);
    return outside;
}

Status laws(const LawTables *tables, Err *err)
{
    static Measured m[LAWS][N_R];
    Output o;
    int wrong = 0, outside = 0;
    for (int l = 0; l < LAWS; l++)
        for (int i = 0; i < N_R; i++) {
            m[l][i] = measure_impact((ContactLaw)l, r_of(i));
            wrong += check_law((ContactLaw)l, r_of(i), &m[l][i]);
        }
    if (tables->curves) {
        TRY(output_open(&o, tables->curves, err));
        write_curves(o.stream, m);
        TRY(output_close(&o, err));
    }
    if (tables->tower) {
        TRY(output_open(&o, tables->tower, err));
        write_tower(o.stream);
        TRY(output_close(&o, err));
    }
    if (tables->engines) {
        TRY(output_open(&o, tables->engines, err));
        outside = write_engines(o.stream);
        TRY(output_close(&o, err));
    }
    printf("contact laws: %d of %d rebound ratios are not what they should be\n", wrong, LAWS * N_R);
    if (wrong)
        return fail(err, STATUS_INTERNAL, "a contact law is not what it should be");
    return outside ? fail(err, STATUS_INTERNAL, "under a contact law an engine is outside the promise") : STATUS_OK;
}
