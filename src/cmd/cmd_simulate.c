
#include "base/json.h"
#include "base/units.h"
#include "cmd/asked.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/outputs.h"
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
    int has_parts;             /* replicates or further records, summed up by the rule of a study */
    ReplicateSummary *summary; /* (n) where there are some */
} Job;

static Status choose_kind(const Args *args, Job *job, Err *err)
{
    const char *path = args_value(args, "--design");
    if (!path)
        return misused(err, "--design FILE is missing (--design none: the building alone)");
    const int none = strcmp(path, "none") == 0, rigid = args_has(args, "--rigid");
    if (none && rigid)
        return misused(err, "--rigid needs a core: give --design FILE instead of none");
    job->kind = none ? SCENE_NO_CORE : rigid ? SCENE_RIGID : SCENE_IMPACT;
    return STATUS_OK;
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

static Status lay_out_job(Job *job, Err *err)
{
    TRY_ROOM(job->tasks, job->n, "simulations", err);
    TRY_ROOM(job->results, job->n, "simulations", err);
    TRY_ROOM(job->summary, job->n, "simulations", err);
    for (size_t i = 0; i < job->n; i++)
        job->tasks[i] =
            (SimTask){.kind = job->kind, .x = job->designs.x ? &job->designs.x[i * job->designs.space.n_var] : NULL};
    return STATUS_OK;
}

static Status simulate(const Problem *p, Job *job, Err *err)
{
    TRY(job->has_parts ? tower_replicate(p, job->n, job->designs.x, job->results, job->summary, err)
                       : tower_simulate(p, job->n, job->tasks, job->results, err));
    for (size_t i = 0; i < job->n; i++)
        if (job->results[i].outcome != RUN_OK)
            fprintf(stderr, "design %ld failed: %s\n", design_number(&job->designs, i), job->results[i].reason);
    return STATUS_OK;
}

static Status estimate(const Problem *p, const Settings *s, Job *job, Err *err)
{
    if (s->sim.engine != ENGINE_FAST)
        return STATUS_OK;
    const size_t n = job->n * N_MEASURES;
    TRY_ROOM(job->error, 2 * n, "estimated errors", err);
    job->sd = job->error + n;
    TRY(estimate_designs(p, job->n, job->tasks, job->results, job->error, job->sd, err));
    known_raise(job->known, job->results, job->sd);
    return STATUS_OK;
}

/* Of design i, of an array of all designs. */
static const double *row_of(const double *all, size_t i)
{
    return all ? all + i * N_MEASURES : NULL;
}

static json_t *describe(const Job *job, size_t i, const Tower *t)
{
    const Motion *m = &tower_record(t, 0)->motion;
    json_t *o =
        json_of("design=%ld record=%s pga_g=%g scale=%g stretch=%g processed=%s", design_number(&job->designs, i),
                m->name, motion_peak(m) / GRAVITY, m->scale, m->stretch, m->processed);
    json_object_update_new(o, json_result(tower_measures(t), job->kind, &job->results[i]));
    if (job->error)
        put_errors(o, row_of(job->error, i), row_of(job->sd, i));
    if (job->has_parts)
        json_put(o, "replicates=%p", json_replicates(tower_measures(t), &job->summary[i]));
    return o;
}

static Status print_json(const Job *job, const Tower *t, Err *err)
{
    if (job->n == 1)
        return show_json(describe(job, 0, t), err);
    json_t *all = json_array();
    for (size_t i = 0; i < job->n; i++)
        json_array_append_new(all, describe(job, i, t));
    return show_json(all, err);
}

static Status write_csv(const Job *job, const MeasureOrder *order, const char *path, Err *err)
{
    json_t *table = json_array();
    for (size_t i = 0; i < job->n; i++) {
        const Measured m = measured(&job->results[i]);
        json_t *row = json_put(figures_row(table), "design=%ld", design_number(&job->designs, i));
        put_measures(row, order, "", m.value, NULL, NULL);
        if (job->has_parts)
            put_replicates(row, order, &job->summary[i]);
        json_put(row, "outcome=%s", outcome_word((Outcome)m.outcome));
    }
    return figures_csv(table, path, err);
}

static void print_table(const Args *args, const Job *job, const Settings *s, const Tower *t)
{
    const MeasureOrder *order = tower_measures(t);
    const char *missing = measures_missing(order, s->search.objectives, tower_n_floors(t));
    json_t *table = json_array();
    char label[DESIGN_LABEL_MAX], damage[DAMAGE_WORDS_MAX];
    for (size_t i = 0; i < tower_n_records(t); i++)
        show_motion(stdout, &tower_record(t, i)->motion, tower_record(t, i)->options.sim.duration_s);
    if (missing && strcmp(s->search.objectives, "auto") != 0)
        puts(missing);
    puts(job->kind == SCENE_RIGID ? "\nrigidly connected" : "");
    for (size_t i = 0; i < job->n; i++) {
        design_label(&job->designs, args_value(args, "--design"), i, label);
        figures_result(table, label, order, &job->results[i], row_of(job->error, i), row_of(job->sd, i));
        if (job->has_parts)
            figures_replicates(table, order, &job->summary[i], row_of(job->error, i));
    }
    figures_print(table);
    if (job->n == 1 && *damage_words(job->results, damage))
        printf("\n%s; under %s\n", damage, tower_record(t, 0)->motion.name);
}

static Status print(const Args *args, const Job *job, const Settings *s, const Tower *t, Err *err)
{
    const Motion *m = &tower_record(t, 0)->motion;
    if (m->warning[0] && (args_has(args, "--csv") || args_has(args, "--json"))) /* where no table says it */
        fprintf(stderr, "%s: warning: %s\n", m->name, m->warning);
    if (args_has(args, "--csv"))
        TRY(write_csv(job, tower_measures(t), args_value(args, "--csv"), err));
    if (args_has(args, "--json"))
        return print_json(job, t, err);
    if (!args_has(args, "--csv") && !outputs_standard(args, 0))
        print_table(args, job, s, t);
    return STATUS_OK;
}

/* -- responses over time ------------------------------------------------------------------------------------------- */

/* From 1e-5 s on: 100 s are ten million rows, some 20 GB for 20 floors. */
static Status every_of(const Args *args, double *every_s, Err *err)
{
    return args_number(args, "--every", 1e-5, 1e6, 0, every_s, err);
}

static Status write_times(const Args *args, const Job *job, const Scenario *w, Err *err)
{
    const char *contacts = args_value(args, "--contacts"), *history = args_value(args, "--history");
    const char *spectra = args_value(args, "--floor-spectra");
    TimeJob times = {.scene = w->scene,
                     .motion = &w->motion,
                     .n = job->n,
                     .tasks = job->tasks,
                     .results = job->results,
                     .designs = &job->designs};
    TRY(every_of(args, &times.every_s, err));
    TRY(contacts ? write_contacts(&times, contacts, err) : STATUS_OK);
    TRY(history ? write_histories(&times, history, err) : STATUS_OK);
    return spectra ? write_floor_spectra(&times, spectra, err) : STATUS_OK;
}

/* Options that are wrong or would be left aside. */
static Status check_times(const Args *args, const Job *job, Err *err)
{
    static const char *const WITH_GAPS[] = {"--contacts", "--horizon", "--sensitivity", "sim.replicates"};
    double every_s;
    TRY(every_of(args, &every_s, err));
    for (size_t i = 0; i < N_OF(WITH_GAPS) && job->kind != SCENE_IMPACT; i++)
        if (args_has(args, WITH_GAPS[i]) || args_gives(args, WITH_GAPS[i]))
            return misused(err, "%s needs a design with gaps, not none or --rigid", WITH_GAPS[i]);
    if (args_has(args, "--every") && !args_has(args, "--history"))
        return misused(err, "--every is the spacing of --history FILE, which is not asked for");
    TRY(args_alone(args, "--horizon", "--csv --sensitivity --history --contacts --floor-spectra", err));
    return args_alone(args, "--sensitivity", "--history --contacts --floor-spectra", err);
}

/* -- the predictability horizon ------------------------------------------------------------------------------------ */

enum { HORIZON_REPLICATES = 16 };
static const double HORIZON_CHANGE = 1e-12; /* of the gaps, between the two runs that are compared */

static Status print_horizon_json(const Horizon *h, const ReplicateSummary *r, Err *err)
{
    return show_json(json_of("end_s=%g distance=%p reached_s=%p distance_at_end=%g replicates=%p", h->end_s,
                             json_numbers(HORIZON_LEVELS, HORIZON_LEVEL), json_numbers(HORIZON_LEVELS, h->reached_s),
                             h->distance_at_end, json_replicates(NULL, r)),
                     err);
}

static void print_horizon(const Scenario *w, const MeasureOrder *order, const Horizon *h, const ReplicateSummary *r)
{
    json_t *table = json_array();
    show_motion(stdout, &w->motion, w->options.sim.duration_s);
    printf("\ntwo runs whose gaps differ by %g of themselves are apart by\n", HORIZON_CHANGE);
    for (int i = 0; i < HORIZON_LEVELS; i++)
        if (isnan(h->reached_s[i]))
            printf("  %-8g never (the run ends at %.4g s)\n", HORIZON_LEVEL[i], h->end_s);
        else
            printf("  %-8g after %.4g s\n", HORIZON_LEVEL[i], h->reached_s[i]);
    printf("distance: root of energy of the difference over largest energy so far; at the end %.2g\n\n",
           h->distance_at_end);
    figures_replicates(table, order, r, NULL);
    figures_print(table);
}

static Status find_horizon(const Args *args, const Problem *p, const double x[], Err *err)
{
    const Scenario *w = tower_record(tower_of(p), 0);
    Horizon h;
    ReplicateSummary r;
    SimResult as_designed;
    TRY(horizon_find(w, x, HORIZON_CHANGE, &h, err));
    TRY(tower_replicate(p, 1, x, &as_designed, &r, err));
    r.spread = "gaps 1 um off";
    if (args_has(args, "--json"))
        return print_horizon_json(&h, &r, err);
    print_horizon(w, tower_measures(tower_of(p)), &h, &r);
    return STATUS_OK;
}

/* Replicates whose gaps differ by what nobody can measure, and nothing else: enough to find a contact that grazes. */
static Status show_horizon(const Args *args, Settings *s, const double x[], Err *err)
{
    Problem p;
    if (s->sim.engine != ENGINE_FAST)
        return misused(err, "--horizon: only the engine fast shows its states; leave sim.engine as it is");
    s->sim.replicates = HORIZON_REPLICATES;
    s->sim.gap_tolerance_m = ESTIMATE_GAP_M;
    s->sim.uncertain = (UncertainOptions){0};
    TRY(tower_open(&p, s, TOWER_AS_SET, SIZE_MAX, err));
    const Status status = find_horizon(args, &p, x, err);
    problem_close(&p);
    return status;
}

/* -- sensitivities ------------------------------------------------------------------------------------------------- */

static json_t *describe_slopes(const Sensitivity *s)
{
    json_t *slopes = json_of("j3_g=%p", json_null());
    for (int k = 0; k < MEASURES_LISTED; k++)
        if (isfinite(s->slope[k]))
            json_object_set_new(slopes, measure(k)->name, json_of("slope=%g error=%g", s->slope[k], s->error[k]));
    return json_of("parameter=%s value=%g step=%g slopes=%p", s->name, s->value, s->step, slopes);
}

static json_t *rows_of(size_t n, const Sensitivity list[])
{
    json_t *table = json_array();
    for (size_t i = 0; i < n; i++) {
        json_t *row =
            json_put(figures_row(table), "parameter=%s value=%g step=%g", list[i].name, list[i].value, list[i].step);
        put_measures(row, NULL, "_slope", list[i].slope, "_error", list[i].error);
    }
    return table;
}

/* Change of J1 and J2 for one step of the parameter. */
static void print_slopes(size_t n, const Sensitivity list[])
{
    static const MeasureId SHOWN[] = {MEASURE_J1, MEASURE_J2};
    json_t *table = json_array();
    for (size_t i = 0; i < n; i++) {
        const Sensitivity *s = &list[i];
        json_t *row = json_put(figures_row(table), "parameter=%s value=%g step=%g", s->name, s->value, s->step);
        for (size_t k = 0; k < N_OF(SHOWN); k++)
            figures_put(row, measure(SHOWN[k])->name, s->slope[SHOWN[k]] * s->step, s->error[SHOWN[k]] * s->step, NAN);
    }
    puts("change for one step, with the error of the replicates and of halving the step");
    figures_print(table);
}

static Status give_slopes(const Args *args, size_t n, const Sensitivity list[], Err *err)
{
    json_t *all = json_array();
    if (args_has(args, "--csv"))
        TRY(figures_csv(rows_of(n, list), args_value(args, "--csv"), err));
    for (size_t i = 0; i < n; i++)
        json_array_append_new(all, describe_slopes(&list[i]));
    if (args_has(args, "--json"))
        return show_json(all, err);
    json_decref(all);
    if (!args_has(args, "--csv"))
        print_slopes(n, list);
    return STATUS_OK;
}

static Status show_sensitivities(const Args *args, const Settings *s, const double x[], Err *err)
{
    Sensitivity *list;
    size_t n;
    TRY(sensitivity_find(s, x, s->sim.replicates, &list, &n, err));
    const Status shown = give_slopes(args, n, list, err);
    free(list);
    return shown;
}

/* ------------------------------------------------------------------------------------------------------------------ */

static Status answer(const Args *args, const Settings *s, const Problem *p, Job *job, Err *err)
{
    const Scenario *w = tower_record(tower_of(p), 0);
    warn_of_settings(s, warn_on_stderr, NULL);
    building_warnings(scene_building(w->scene), warn_on_stderr, NULL);
    TRY(lay_out_job(job, err));
    TRY(simulate(p, job, err));
    if (args_has(args, "--json") || !args_has(args, "--csv")) /* the only form that has no errors */
        TRY(estimate(p, s, job, err));
    TRY(print(args, job, s, tower_of(p), err));
    TRY(write_times(args, job, w, err));
    return job->n > 1 || job->results[0].outcome == RUN_OK
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
    TRY(choose_kind(args, &job, err));
    TRY(check_times(args, &job, err));
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

static const ArgOption OPTIONS[] = {
    VALUE("--design", "FILE", DESIGN_WORDS "; none: the building alone"),
    SWITCH("--rigid", "floors and core rigidly connected (zero gap): a linear building"),
    SETTING(
        "--replicates", "N", "sim.replicates",
        "N replicates as a study simulates them, under motion.record and motion.records: mean and standard deviation"),
    SWITCH("--sensitivity",
           "how each result changes with gaps, thickness, contact and damping, with its error; --replicates makes it "
           "smaller"),
    SWITCH("--horizon",
           "predictability horizon: the time until two runs that hardly differ diverge; standard deviation of every "
           "result with gaps 1 um off"),
    OPTIONS_MOTION,
    OPTION_JSON,
    OPTION_CSV,
    VALUE("--contacts", "FILE", "one row per contact: time, floor, side, speeds, force, duration, energy lost"),
    VALUE("--history", "FILE",
          "time histories: floors, nodes of the core, contact forces, energies; - is standard output"),
    VALUE("--every", "DT", "of --history: a row every DT s at most, by halving the record's step"),
    VALUE("--floor-spectra", "FILE", "response spectra of every floor's acceleration, 5 % damped"),
    OPTION_SET,
    OPTION_END,
};

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
        "results/quick:best_j1_m.\n"
        "For other problems the design goes to the simulator, such as an external worker, as in a study.\n"
        "With sim.replicates above 1, or with motion.records, the first row is the design as designed under\n"
        "motion.record; the next rows are the aggregate that the study optimizes (sim.robust) and its\n"
        "standard deviation.\n"
        "--json gives one object for one design and a list for several. The number after +- is the error of\n"
        "the integration, which 95 % of all figures keep; a second run with twice the steps estimates it\n"
        "(docs/promise.md). Digits beyond it are not shown.\n"
        "--horizon: impacts amplify differences, so two runs that differ in the last digit diverge after some\n"
        "hundreds of impacts. Before the predictability horizon results can be compared digit by digit. After\n"
        "it only mean and standard deviation can be compared; they come from 16 runs, gaps perturbed by 1 um.",
    .options = OPTIONS,
    .run = run,
};
