/* Whether this build gives the answers that it should: linear structures, impacts before their predictability horizon,
 * one impact in closed form, a search on a textbook problem. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "cmd/commands.h"
#include "cmd/show.h"
#include "moga/directions.h"
#include "settings/settings.h"
#include "sim/engine.h"
#include "sim/fast/fast.h"
#include "evaluate/measures.h"
#include "evaluate/adapter.h"
#include "study/study.h"

enum { N_CHECKS_MAX = 96 };

typedef struct {
    const char *name, *quantity;
    double value, wanted, tolerance; /* relative */
} Check;

typedef struct {
    int n, n_wrong;
    Check check[N_CHECKS_MAX];
} Selftest;

static int agrees(const Check *c)
{
    return fabs(c->value - c->wanted) <= c->tolerance * fabs(c->wanted); /* 0 for NaN */
}

static void compare(Selftest *t, const char *name, const char *quantity, double value, double wanted, double tolerance)
{
    const Check check = {name, quantity, value, wanted, tolerance};
    t->n_wrong += !agrees(&check);
    t->check[t->n++] = check;
}

/* ---- the tower --------------------------------------------------------------------------------------------------- */

/* All that an answer depends on: a new default is no reason for new answers. */
static const char *const COMMON[] = {
    "building.damping=0.03",
    "building.first_storey_m=5.4864",
    "building.storey_m=3.9624",
    "core.section=box",
    "core.theory=timoshenko",
    "core.side_m=11.3",
    "core.width_m=11.3",
    "core.damping=0.03",
    "core.youngs_modulus_pa=2.1e11",
    "core.poisson=0.3",
    "core.density_kg_m3=7850",
    "contact.law=paper",
    "contact.restitution=0.7",
    "contact.v0_min_m_s=0.001",
    "contact.radius_m=0.1",
    "contact.youngs_modulus_pa=2.1e11",
    "contact.poisson=0.3",
    "motion.pga_g=0.3",
    "motion.stretch=3.1",
    "sim.engine=fast",
    "sim.accuracy=fine",
};

typedef struct {
    const char *name;
    const char *settings[4];
    SceneKind kind;
    double gap_m, wall_m; /* the same at every floor and storey */
    double tolerance;
    double answer[PAPER_OBJECTIVES]; /* as `simulate` prints them */
} TowerCase;

/* Answers: `imtet selftest --answers` with the kernel avx512. Those of the kernels base and avx2 are within 2e-10
 * without impacts and 2e-7 with them: every window ends before the horizon of its design (`imtet horizon`). */
static const TowerCase TOWER[] = {
    {"no core",
     {"building.model=guyan", "motion.record=builtin:kobe-like"},
     SCENE_NO_CORE,
     0,
     0,
     1e-7,
     {1.646113691, 0.1473848287, 0.8986694482, 86.6997593, 0.01044833568, 0, 0}},
    {"rigidly connected",
     {"building.model=appendix", "motion.record=builtin:sylmar-like", "core.theory=euler_bernoulli"},
     SCENE_RIGID,
     0,
     0.02,
     1e-7,
     {0.7268945186, 0.04921706818, 1.515856401, 53.18045795, 0.02596703144, 39.06157883, 572175.9245}},
    {"gaps of 10 mm",
     {"building.model=guyan", "motion.record=builtin:kobe-like", "sim.duration_s=28"},
     SCENE_IMPACT,
     0.01,
     0.02,
     1e-5,
     {0.8115126742, 0.05226552064, 4.407969498, 12.96081955, 0.3677359945, 9.383881178, 572175.9245}},
    {"gaps of 50 mm",
     {"building.model=appendix", "motion.record=builtin:elcentro-like", "sim.duration_s=8", "contact.law=exact"},
     SCENE_IMPACT,
     0.05,
     0.02,
     1e-5,
     {0.8078311797, 0.06887702891, 9.167003244, 13.77227494, 1.565192374, 12.44006187, 572175.9245}},
    {"gaps of 200 mm",
     {"building.model=guyan", "motion.record=builtin:sylmar-like"},
     SCENE_IMPACT,
     0.2,
     0.02,
     1e-5,
     {0.8246970473, 0.08326183464, 13.83492727, 26.62471704, 7.281239473, 32.61952035, 572175.9245}},
};
enum { N_TOWER = sizeof TOWER / sizeof TOWER[0] };

static Status set_all(Settings *s, const char *const assignments[], size_t n_max, Err *err)
{
    for (size_t i = 0; i < n_max && assignments[i]; i++)
        TRY(settings_set(s, assignments[i], err));
    return STATUS_OK;
}

static Status simulate(const Scenario *w, const TowerCase *c, SimResult *r, Err *err)
{
    double x[FLOORS_MAX + 2];
    SimWorker *worker;
    const int n = scene_n_floors(w->scene);
    for (int j = 0; j < n + 2; j++)
        x[j] = j < n ? c->gap_m : c->wall_m;
    TRY(sim_worker_create(&worker, w->scene, err));
    const Status status = sim_run(worker, c->kind, x, r, err);
    sim_worker_free(worker);
    return status;
}

static Status answer_of(const TowerCase *c, double answer[PAPER_OBJECTIVES], Err *err)
{
    Settings s;
    Scenario w;
    SimResult r;
    settings_defaults(&s);
    TRY(set_all(&s, COMMON, sizeof COMMON / sizeof COMMON[0], err));
    TRY(set_all(&s, c->settings, sizeof c->settings / sizeof c->settings[0], err));
    const SceneOptions options = settings_scene(&s);
    TRY(scenario_open(&w, &options, &s.motion, err));
    const Status status = simulate(&w, c, &r, err);
    scenario_close(&w);
    for (int k = 0; status == STATUS_OK && k < PAPER_OBJECTIVES; k++)
        answer[k] = r.outcome == RUN_OK ? measure_value(&r, k) : NAN;
    return status;
}

static Status check_tower(Selftest *t, Err *err)
{
    for (int i = 0; i < N_TOWER; i++) {
        const TowerCase *c = &TOWER[i];
        double answer[PAPER_OBJECTIVES];
        TRY(answer_of(c, answer, err));
        for (int k = 0; k < PAPER_OBJECTIVES; k++)
            compare(t, c->name, measure(k)->name, answer[k], c->answer[k], c->tolerance);
    }
    return STATUS_OK;
}

/* The table's last lines, to be pasted. */
static Status print_answers(Err *err)
{
    for (int i = 0; i < N_TOWER; i++) {
        double answer[PAPER_OBJECTIVES];
        TRY(answer_of(&TOWER[i], answer, err));
        printf("%s:\n     {", TOWER[i].name);
        for (int k = 0; k < PAPER_OBJECTIVES; k++)
            printf("%.10g%s", answer[k], k + 1 < PAPER_OBJECTIVES ? ", " : "}},\n");
    }
    return STATUS_OK;
}

/* ---- one impact ---------------------------------------------------------------------------------------------------- */

/* A free mass beside a wall; a pulse of the ground gives it the speed v, then it is alone with the wall. With Hertz's law,
 * k = 2 E sqrt(R) / (3 (1 - nu^2)), and the exact damping it rebounds with r v; without damping the indentation is
 * (5 m v^2 / 4 k)^(2/5). */
static const double MASS_KG = 1000, GAP_M = 0.1, PULSE_M_S2 = 25, PULSE_DT_S = 0.02;
static const ContactOptions STEEL = {
    .law = LAW_EXACT, .v0_min_m_s = 1e-3, .radius_m = 0.1, .youngs_modulus_pa = 210e9, .poisson = 0.3};

static Status free_mass(SimModel *model, double restitution, Err *err)
{
    ContactOptions contact = STEEL;
    contact.restitution = restitution;
    TRY(model_create(model, 1, 1, err));
    model->nb = model->nc = 1;
    model->m = 2;
    model->m_pad = 8;
    for (int i = 0; i < model->m_pad; i++) {
        model->omega[i] = i >= model->m;
        model->zeta[i] = model->gamma[i] = 0;
        for (int j = 0; j < model->n_pad; j++)
            model->R[i * model->n_pad + j] = model->RT[j * model->m_pad + i] = 0;
    }
    for (int j = 0; j < model->n_pad; j++)
        model->gap[j] = model->mass_eff[j] = 1e300;
    model->gamma[0] = sqrt(MASS_KG);
    model->R[0] = model->RT[0] = 1 / sqrt(MASS_KG);
    model->R[model->n_pad] = model->RT[1] = -1e-30; /* the wall, a core of infinite mass */
    model->gap[0] = GAP_M;
    model->mass_eff[0] = MASS_KG;
    return contact_make(&model->contact[0], &contact, err);
}

static Status impact(double restitution, SimResult *r, Err *err)
{
    SimModel model = {0};
    double pulse[] = {0, PULSE_M_S2, 0};
    const Motion motion = {.accel = pulse, .n = 3, .dt_s = PULSE_DT_S, .name = "pulse"};
    const double v = PULSE_M_S2 * PULSE_DT_S;
    const EngineOptions options = {.duration = 2 * GAP_M / v, .accuracy = ACCURACY_FINE}; /* one gap closes, once */
    Status status = free_mass(&model, restitution, err);
    *r = (SimResult){0};
    if (status == STATUS_OK)
        status = engine_entry(ENGINE_FAST)->run(&model, &motion, &options, r, err);
    model_free(&model);
    return status;
}

static Status check_impact(Selftest *t, Err *err)
{
    SimResult r;
    const double r_wanted = 0.6, v = PULSE_M_S2 * PULSE_DT_S, nu = STEEL.poisson;
    const double k = 2 * STEEL.youngs_modulus_pa * sqrt(STEEL.radius_m) / (3 * (1 - nu * nu));
    TRY(impact(1, &r, err));
    compare(t, "impact", "indentation", r.indentation_max_m, pow(5 * MASS_KG * v * v / (4 * k), 0.4), 1e-4);
    TRY(impact(r_wanted, &r, err));
    compare(t, "impact", "restitution", sqrt(2 * r.kinetic_strain_j / MASS_KG) / v, r_wanted, 1e-4);
    return STATUS_OK;
}

/* ---- a search ------------------------------------------------------------------------------------------------------ */

enum { N_DTLZ2 = 3 };

/* IGD+ of a front against 91 directions on the sphere |f| = 1, the front of DTLZ2. */
typedef struct {
    Directions sphere;
    double igd;
} Distance;

static double distance_to(const SearchView *view, const double w[N_DTLZ2])
{
    double least = INFINITY, norm = 0;
    for (int k = 0; k < N_DTLZ2; k++)
        norm += w[k] * w[k];
    for (size_t i = 0; i < view->n; i++) {
        double square = 0;
        for (int k = 0; k < N_DTLZ2; k++) {
            const double worse = fmax(view->F[i * N_DTLZ2 + (size_t)k] - w[k] / sqrt(norm), 0);
            square += worse * worse;
        }
        if (view->on_front[i])
            least = fmin(least, sqrt(square));
    }
    return least;
}

static int measure_front(const SearchView *view, void *user)
{
    Distance *d = user;
    double sum = 0;
    for (size_t j = 0; j < d->sphere.n; j++)
        sum += distance_to(view, d->sphere.W + j * N_DTLZ2);
    d->igd = sum / (double)d->sphere.n;
    return 0;
}

static Status search(const Settings *s, Distance *d, Err *err)
{
    Adapter *adapter;
    StopReason reason;
    const SearchConfig config = study_search_config(s);
    TRY(adapter_open(&adapter, s, err));
    omp_set_num_threads(adapter_threads(adapter));
    const Status status = search_run(adapter_problem(adapter), &config, measure_front, d, &reason, err);
    adapter_close(adapter);
    return status;
}

/* 200 evaluations reach 0.029 to 0.034 over eight seeds, without surrogate 0.22 to 0.27. */
static Status check_search(Selftest *t, Err *err)
{
    static const char *const SETTINGS[] = {"problem.kind=dtlz2",   "problem.variables=8", "problem.objectives=3",
                                           "search.max_evals=200", "search.seed=1",       "search.threads=1"};
    Settings s;
    Distance d = {.igd = NAN};
    settings_defaults(&s);
    TRY(set_all(&s, SETTINGS, sizeof SETTINGS / sizeof SETTINGS[0], err));
    TRY(directions_create(&d.sphere, N_DTLZ2, 12, 0, err));
    const Status status = search(&s, &d, err);
    directions_free(&d.sphere);
    compare(t, "search", "igd_plus", d.igd, 0.0315, 0.3);
    return status;
}

/* ---- the command --------------------------------------------------------------------------------------------------- */

static json_t *describe(const Selftest *t, double seconds)
{
    json_t *o = json_object(), *checks = json_array();
    for (int i = 0; i < t->n; i++) {
        const Check *c = &t->check[i];
        json_array_append_new(checks,
                              json_pack("{s:s, s:s, s:o, s:o, s:o, s:b}", "case", c->name, "quantity", c->quantity,
                                        "value", json_number(c->value), "stored", json_number(c->wanted), "tolerance",
                                        json_number(c->tolerance), "agrees", agrees(c)));
    }
    json_object_set_new(o, "trusted", json_boolean(t->n_wrong == 0));
    json_object_set_new(o, "kernel", json_string(fast_kernel_name()));
    json_object_set_new(o, "seconds", json_number(seconds));
    json_object_set_new(o, "checks", checks);
    return o;
}

static void print_faults(const Selftest *t)
{
    for (int i = 0; i < t->n; i++) {
        const Check *c = &t->check[i];
        if (!agrees(c))
            printf("%s: %s is %.10g, stored %.10g (relative difference %.1e, allowed %.1e)\n", c->name, c->quantity,
                   c->value, c->wanted, fabs(c->value / c->wanted - 1), c->tolerance);
    }
}

static Status run(const Args *args, Err *err)
{
    Selftest t = {0};
    const double begun = clock_seconds();
    if (args_has(args, "--answers"))
        return print_answers(err);
    TRY(check_tower(&t, err));
    TRY(check_impact(&t, err));
    TRY(check_search(&t, err));
    const double seconds = clock_seconds() - begun;
    if (args_has(args, "--json"))
        TRY(show_json(describe(&t, seconds), err));
    else
        print_faults(&t);
    if (t.n_wrong > 0)
        return fail(err, STATUS_INTERNAL, "this build cannot be trusted: %d of %d answers differ (kernel %s)",
                    t.n_wrong, t.n, fast_kernel_name());
    if (!args_has(args, "--json"))
        printf("this build can be trusted: %d of %d answers agree (kernel %s, %.1f s)\n", t.n, t.n, fast_kernel_name(),
               seconds);
    return STATUS_OK;
}

static const ArgOption OPTIONS[] = {
    {"--answers", NULL, NULL, 0, "the answers of this build as they are stored in the program's source"},
    OPTION_JSON,
    OPTION_END,
};

const Command CMD_SELFTEST = {
    .name = "selftest",
    .group = GROUP_DECIDE,
    .summary = "whether this build gives the stored answers",
    .example = "imtet selftest",
    .details = "Five simulations of the built-in buildings, one impact with a closed form and a search on a textbook "
               "problem are\n"
               "compared with stored answers. Their tolerances hold for every instruction set. Exit status 70 where "
               "one differs.",
    .options = OPTIONS,
    .run = run,
};
