
#include "base/json.h"
#include "base/units.h"
#include "cmd/asked.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/show.h"
#include "cmd/time_files.h"
#include "analysis/estimate.h"
#include "analysis/horizon.h"
#include "analysis/sensitivity.h"
#include "evaluate/tower.h"
#include "motion/suite.h"
#include "settings/options.h"

typedef struct {
    SceneKind kind;
    Designs designs;
    size_t n;
    SimTask *tasks;            /* (n) */
    SimResult *results;        /* (n) */
    double *error, *sd;        /* (n, N_MEASURES) of analysis/estimate.h; NULL: no estimate */
    Known known[N_MEASURES];   /* of the one design that a run names */
    double every_s;            /* --every */
    int has_parts;             /* replicates or further records, summed up by the rule of a study */
    ReplicateSummary *summary; /* (n) where there are some */
} Job;

/* Which case, and options that are wrong or would be left aside. */
static Status take_options(const Args *args, Job *job, Err *err)
{
    static const char *const WITH_GAPS[] = {"--contacts", "--horizon", "--sensitivity", "sim.replicates"};
    const char *path = args_value(args, "--design");
    if (!path)
        return misused(err, "--design FILE is missing (--design none: the building alone)");
    const int none = strcmp(path, "none") == 0, rigid = args_has(args, "--rigid");
    if (none && rigid)
        return misused(err, "--rigid needs a core: give --design FILE instead of none");
    job->kind = none ? SCENE_NO_CORE : rigid ? SCENE_RIGID : SCENE_IMPACT;

    /* From 1e-5 s on: 100 s are ten million rows, some 20 GB for 20 floors. */
    TRY(args_number(args, "--every", 1e-5, 1e6, 0, &job->every_s, err));
    for (size_t i = 0; i < N_OF(WITH_GAPS) && job->kind != SCENE_IMPACT; i++)
        if (args_has(args, WITH_GAPS[i]) || args_gives(args, WITH_GAPS[i]))
            return misused(err, "%s needs a design with gaps, not none or --rigid", WITH_GAPS[i]);
    if (args_has(args, "--every") && !args_has(args, "--history"))
        return misused(err, "--every needs --history FILE, whose spacing it is");
    TRY(args_alone(args, "--horizon", "--csv --sensitivity --history --contacts --floor-spectra", err));
    return args_alone(args, "--sensitivity", "--history --contacts --floor-spectra", err);
}

/* The designs; of one that a run names also its steps, into the settings. */
static Status take_designs(const Args *args, Settings *s, Job *job, Err *err)
{
    DesignSpace space;
    const char *word = args_value(args, "--design");
    const int one = args_has(args, "--horizon") || args_has(args, "--sensitivity");
    job->n = 1;
    if (job->kind == SCENE_NO_CORE)
        return STATUS_OK;
    TRY(tower_space(s, &space, err));
    TRY((one ? designs_take_one : designs_take)(&job->designs, word, &space, s, !args_gives(args, "sim.accuracy"),
                                                job->known, err));
    warn_of_designs(&job->designs, word, warn_on_stderr, NULL);
    job->n = job->designs.n;
    return STATUS_OK;
}

/* Of design i, of an array of all designs. */
static const double *row_of(const double *all, size_t i)
{
    return all ? all + i * N_MEASURES : NULL;
}

/* All designs as objects, as rows and as lines. */
static Status give(const Args *args, const Job *job, const Settings *s, const Tower *t, Err *err)
{
    const Motion *m = &tower_record(t, 0)->motion;
    const MeasureOrder *order = tower_measures(t);
    const char *missing = measures_missing(order, s->search.objectives, tower_design(t)->n_floors);
    char label[DESIGN_LABEL_MAX], damage[DAMAGE_WORDS_MAX];
    Document d = {.data = json_array(), .rows = json_array()};
    if (m->warning[0] && (args_has(args, "--csv") || args_has(args, "--json"))) /* where no table says it */
        fprintf(stderr, "%s: warning: %s\n", m->name, m->warning);
    for (size_t i = 0; i < tower_n_records(t); i++)
        document_motion(&d, &tower_record(t, i)->motion, tower_record(t, i)->options.sim.duration_s);
    if (missing && strcmp(s->search.objectives, "auto") != 0)
        document_say(&d, "%s", missing);
    if (job->kind == SCENE_RIGID)
        document_say(&d, "rigidly connected");
    json_t *table = document_table(&d);
    for (size_t i = 0; i < job->n; i++) {
        const SimResult *r = &job->results[i];
        const double *error = row_of(job->error, i), *sd = row_of(job->sd, i);
        const long number = design_number(&job->designs, i);
        json_t *o = json_of("design=%ld record=%s pga_g=%g scale=%g stretch=%g processed=%s", number, m->name,
                            motion_peak(m) / GRAVITY, m->scale, m->stretch, m->processed),
               *row = json_put(figures_row(d.rows), "design=%ld", number);
        json_object_update_new(o, json_result(order, job->kind, r));
        json_array_append_new(d.data, o);
        put_measures(row, order, "", measured(r).value, NULL, NULL);
        design_label(&job->designs, args_value(args, "--design"), i, label);
        figures_result(table, label, order, r, error, sd);
        if (error)
            put_errors(o, error, sd);
        if (job->has_parts) {
            json_put(o, "replicates=%p", json_replicates(order, &job->summary[i]));
            put_replicates(row, order, &job->summary[i]);
            figures_replicates(table, order, &job->summary[i], error);
        }
        json_put(row, "outcome=%s", outcome_word((Outcome)r->outcome));
    }
    d.data = json_only(d.data);
    if (job->n == 1 && *damage_words(job->results, damage))
        document_say(&d, "%s; under %s", damage, m->name);
    return document_give(&d, args, err);
}

/* -- the predictability horizon ------------------------------------------------------------------------------------ */

enum { HORIZON_REPLICATES = 16 };
static const double HORIZON_CHANGE = 1e-12; /* of the gaps, between the two runs that are compared */

/* Two runs whose gaps differ by HORIZON_CHANGE; then replicates whose gaps differ by what nobody can measure, and
 * nothing else: enough to find a contact that grazes. */
static Status show_horizon(const Args *args, Settings *s, const double x[], Err *err)
{
    Problem p;
    Horizon h;
    ReplicateSummary r;
    SimResult as_designed;
    if (s->sim.engine != ENGINE_FAST)
        return misused(err, "--horizon needs sim.engine = fast");
    s->sim.replicates = HORIZON_REPLICATES;
    s->sim.gap_tolerance_m = ESTIMATE_GAP_M;
    s->sim.uncertain = (UncertainOptions){0};
    TRY(tower_open(&p, s, TOWER_AS_SET, SIZE_MAX, err));
    const Scenario *w = tower_record(tower_of(&p), 0);
    Status status = horizon_find(w, x, HORIZON_CHANGE, &h, err);
    THEN(status, tower_replicate(&p, 1, x, &as_designed, &r, err));
    if (status == STATUS_OK) {
        r.spread = "gaps 1 um off";
        Document d = {.data = json_of("end_s=%g distance=%p reached_s=%p distance_at_end=%g replicates=%p", h.end_s,
                                      json_numbers(HORIZON_LEVELS, HORIZON_LEVEL),
                                      json_numbers(HORIZON_LEVELS, h.reached_s), h.distance_at_end,
                                      json_replicates(NULL, &r))};
        document_motion(&d, &w->motion, w->options.sim.duration_s);
        document_say(&d, "two runs whose gaps differ by %g of themselves are apart by", HORIZON_CHANGE);
        for (int i = 0; i < HORIZON_LEVELS; i++)
            if (isnan(h.reached_s[i]))
                document_say(&d, "  %-8g never (the run ends at %.4g s)", HORIZON_LEVEL[i], h.end_s);
            else
                document_say(&d, "  %-8g after %.4g s", HORIZON_LEVEL[i], h.reached_s[i]);
        document_say(&d,
                     "distance: root of the energy of the difference over the largest energy so far; at the end %.2g",
                     h.distance_at_end);
        figures_replicates(document_table(&d), tower_measures(tower_of(&p)), &r, NULL);
        status = document_give(&d, args, err);
    }
    problem_close(&p);
    return status;
}

/* -- sensitivities ------------------------------------------------------------------------------------------------- */

static Status show_sensitivities(const Args *args, const Settings *s, const double x[], Err *err)
{
    Sensitivity *list;
    size_t n;
    TRY(sensitivity_find(s, x, s->sim.replicates, &list, &n, err));
    Document d = {.rows = json_array(), .data = json_array()};
    for (size_t i = 0; i < n; i++) {
        const Sensitivity *l = &list[i];
        json_t *row = json_put(figures_row(d.rows), "parameter=%s value=%g step=%g", l->name, l->value, l->step),
               *one = json_copy(row), *slopes = json_of("j3_g=%p", json_null());
        put_measures(row, NULL, "_slope", l->slope, "_error", l->error);
        for (int k = 0; k < MEASURES_LISTED; k++)
            if (isfinite(l->slope[k]))
                json_object_set_new(slopes, measure(k)->name, json_of("slope=%g error=%g", l->slope[k], l->error[k]));
        json_array_append_new(d.data, json_put(one, "slopes=%p", slopes));
    }
    document_slopes(&d, n, list);
    free(list);
    return document_give(&d, args, err);
}

/* ------------------------------------------------------------------------------------------------------------------ */

static Status answer(const Args *args, const Settings *s, const Problem *p, Job *job, Err *err)
{
    static const char *const TIMES[N_TIME_FILES] = {"--contacts", "--history", "--floor-spectra"};
    const Scenario *w = tower_record(tower_of(p), 0);
    const size_t n = job->n;
    warn_of_settings(s, warn_on_stderr, NULL);
    building_warnings(scene_building(w->scene), warn_on_stderr, NULL);
    TRY_ROOM(job->tasks, n, "simulations", err);
    TRY_ROOM(job->results, n, "simulations", err);
    TRY_ROOM(job->summary, n, "simulations", err);
    for (size_t i = 0; i < n; i++)
        job->tasks[i] =
            (SimTask){.kind = job->kind, .x = job->designs.x ? &job->designs.x[i * job->designs.space.n_var] : NULL};
    TRY(job->has_parts ? tower_replicate(p, n, job->designs.x, job->results, job->summary, err)
                       : tower_simulate(p, n, job->tasks, job->results, err));
    for (size_t i = 0; i < n; i++)
        if (job->results[i].outcome != RUN_OK)
            fprintf(stderr, "design %ld failed: %s\n", design_number(&job->designs, i), job->results[i].reason);
    /* Rows have no errors: whoever asks for them alone need not wait for these. */
    if (s->sim.engine == ENGINE_FAST && (args_has(args, "--json") || !args_has(args, "--csv"))) {
        TRY_ROOM(job->error, 2 * n * N_MEASURES, "estimated errors", err);
        job->sd = job->error + n * N_MEASURES;
        TRY(estimate_designs(p, n, job->tasks, job->results, job->error, job->sd, err));
        known_raise(job->known, job->results, job->sd);
    }
    TRY(give(args, job, s, tower_of(p), err));
    const TimeJob times = {.scene = w->scene,
                           .motion = &w->motion,
                           .n = n,
                           .tasks = job->tasks,
                           .results = job->results,
                           .designs = &job->designs,
                           .every_s = job->every_s};
    for (TimeFile k = 0; k < N_TIME_FILES; k++)
        if (args_has(args, TIMES[k]))
            TRY(time_file_write(&times, k, args_value(args, TIMES[k]), err));
    return n > 1 || job->results[0].outcome == RUN_OK
               ? STATUS_OK
               : fail(err, STATUS_INTERNAL, "the simulation failed: %s", job->results[0].reason);
}

static Status show_responses(const Args *args, Settings *s, Job *job, Err *err)
{
    Problem p;
    if (args_has(args, "--json") || args_has(args, "--csv") || args_has(args, "--contacts"))
        s->sim.forces = FORCES_YES;
    size_t n_records;
    TRY(suite_size(&s->motion, &n_records, err));
    job->has_parts = job->kind == SCENE_IMPACT && (s->sim.replicates > 1 || n_records > 1);
    TRY(tower_open(&p, s, job->has_parts ? TOWER_AS_SET : TOWER_SINGLE, job->kind == SCENE_NO_CORE ? 1 : SIZE_MAX,
                   err));
    const Status status = answer(args, s, &p, job, err);
    problem_close(&p);
    return status;
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    Job job = {0};
    TRY(take_options(args, &job, err));
    TRY(args_settings(args, &s, NULL, NULL, err));
    if (s.problem.kind != PROBLEM_TOWER)
        return asked_simulate(args, &s, err);
    Status status = take_designs(args, &s, &job, err);
    THEN(status, args_has(args, "--horizon")       ? show_horizon(args, &s, job.designs.x, err)
                 : args_has(args, "--sensitivity") ? show_sensitivities(args, &s, job.designs.x, err)
                                                   : show_responses(args, &s, &job, err));
    free(job.tasks);
    free(job.results);
    free(job.error);
    free(job.summary);
    design_free(&job.designs);
    return status;
}

const Command CMD_SIMULATE = {
    .name = "simulate",
    .group = GROUP_STUDY,
    .operand = "CONFIG",
    .summary = "the response of given designs to one ground motion",
    .example = "imtet simulate configs/quick.ini --design none",
    .details =

        "Simulates every row of a design file: a CSV with the header gap_01_m..gap_NN_m,t_base_m,t_top_m\n"
        "holds one gap per floor from the bottom, then the core's wall in the first and in the last storey\n"
        "[m]. A front.csv or a design of a run works too: --design results/quick:knee, results/quick:417,\n"
        "results/quick:best_j1_m.\n\n"
        "For other problems the design goes to the simulator, such as an external worker, as in a study.\n"
        "With sim.replicates above 1, or with motion.records, the first row is the design as designed under\n"
        "motion.record; the next rows are the aggregate that the study optimizes (sim.robust) and its\n"
        "standard deviation.\n\n"
        "--json gives one object for one design and a list for several. The number after +- is the error of\n"
        "the integration, which 95 % of all figures keep; a second run with twice the steps estimates it\n"
        "(docs/promise.md). Digits beyond it are not shown.\n\n"
        "--horizon: impacts amplify differences, so two runs that differ in the last digit diverge after some\n"
        "hundreds of impacts. Before the predictability horizon results can be compared digit by digit. After\n"
        "it only mean and standard deviation can be compared; they come from 16 runs, gaps perturbed by 1 um.",
    .options =
        {
            VALUE("--design", "FILE", DESIGN_WORDS "; none: the building alone"),
            SWITCH("--rigid", "floors and core rigidly connected (zero gap): a linear building"),
            SETTING("--replicates", "N", "sim.replicates",
                    "replicates as in a study, under motion.record and motion.records: mean and standard deviation"),
            SWITCH("--sensitivity",
                   "how each result changes with gaps, thickness, contact and damping; --replicates reduces its error"),
            SWITCH("--horizon",
                   "time until two nearly equal runs diverge; standard deviation of every result with gaps 1 um off"),
            OPTIONS_MOTION,
            OPTION_JSON,
            OPTION_CSV,
            VALUE("--contacts", "FILE", "one row per contact: time, floor, side, speeds, force, duration, energy lost"),
            VALUE("--history", "FILE",
                  "time histories: floors, nodes of the core, contact forces, energies; -: standard output"),
            VALUE("--every", "DT", "largest step of --history [s], reached by halving the record's step"),
            VALUE("--floor-spectra", "FILE", "response spectra of every floor's acceleration, 5 % damped"),
            OPTION_SET,
        },
    .run = run,
};
