#include "cmd/evaluations.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/clock.h"
#include "base/units.h"
#include "cmd/show.h"
#include "evaluate/queue.h"
#include "evaluate/threads.h"
#include "motion/motion_scale.h"
#include "motion/motion_source.h"
#include "analysis/baselines.h"
#include "evaluate/recipe.h"
#include "analysis/estimate.h"

const struct EvaluationCase EVALUATION_CASES[N_WITH_DEVICES] = {{SCENE_IMPACT, "with core", "with_core"},
                                                                {SCENE_RIGID, "rigidly connected", "rigid"},
                                                                {SCENE_NO_CORE, "no core", "no_core"},
                                                                {SCENE_TMD, "tuned mass damper", "tmd"},
                                                                {SCENE_LINKS, "viscous links", "links"}};

const char *evaluated_name(const EvaluatedRecord *r)
{
    const char *slash = strrchr(r->path, '/');
    return slash ? slash + 1 : r->path;
}

/* ---- which records ----------------------------------------------------------------------------------------------- */

Status evaluations_add(Evaluations *e, const char *path, int from_folder, Err *err)
{
    EvaluatedRecord *more = realloc(e->record, (e->n_records + 1) * sizeof *more);
    if (!more)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu records", e->n_records + 1);
    e->record = more;
    more[e->n_records] = (EvaluatedRecord){.path = strdup(path), .from_folder = from_folder};
    if (!more[e->n_records].path)
        return fail(err, STATUS_NO_MEMORY, "no memory for a path");
    e->n_records++;
    return STATUS_OK;
}

static int is_visible(const struct dirent *e)
{
    return e->d_name[0] != '.';
}

static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name); /* the same order in every language */
}

Status evaluations_add_folder(Evaluations *e, const char *folder, Err *err)
{
    struct dirent **names = NULL;
    Status status = STATUS_OK;
    const int n = scandir(folder, &names, is_visible, by_name);
    if (n < 0)
        return fail(err, status_of_errno(errno, STATUS_MISSING), "--records %s: %s", folder, strerror(errno));
    for (int i = 0; i < n; i++) {
        char path[PATH_MAX];
        struct stat there;
        const int length = snprintf(path, sizeof path, "%s/%s", folder, names[i]->d_name);
        if (status == STATUS_OK && length < PATH_MAX && (stat(path, &there) != 0 || !S_ISDIR(there.st_mode)))
            status = evaluations_add(e, path, 1, err);
        free(names[i]);
    }
    free(names);
    return n > 0 ? status : fail(err, STATUS_BAD_DATA, "--records %s: is empty", folder);
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

/* The settings for one of them; free releases. */
static Status settings_for(const Settings *s, const char *path, const double *level, Settings **out, Err *err)
{
    Settings *own = malloc(sizeof *own);
    *out = own;
    if (!own)
        return fail(err, STATUS_NO_MEMORY, "no memory for settings");
    *own = *s;
    if (level) {
        motion_unscale(&own->motion);
        own->motion.pga_g = *level;
    }
    return option_put_path(own->motion.record, path, err);
}

static Status try_record(const Settings *s, const char *path, const double *level, Err *err)
{
    Motion m = {0};
    Settings *own;
    Status status = settings_for(s, path, level, &own, err);
    if (status == STATUS_OK)
        status = motion_open(&m, &own->motion, err);
    if (status == STATUS_OK)
        status = motion_scale(&m, &own->motion, err);
    motion_free(&m);
    free(own);
    return status;
}

Status evaluations_read(Evaluations *e, const Settings *s, Err *err)
{
    const long n = (long)e->n_records;
#pragma omp parallel for schedule(dynamic) num_threads((int)threads_wanted(s->search.threads))
    for (long i = 0; i < n; i++)
        e->record[i].readable = try_record(s, e->record[i].path, e->level, &e->record[i].why);
    for (long i = 0; i < n; i++) {
        const EvaluatedRecord *r = &e->record[i];
        e->n_read += r->readable == STATUS_OK;
        if (r->readable != STATUS_OK && (!r->from_folder || r->readable == STATUS_NO_MEMORY))
            return fail(err, r->readable, "%s", r->why.text);
    }
    return STATUS_OK;
}

/* ---- one run, a task of the queue -------------------------------------------------------------------------------- */

typedef struct {
    char path[OPTION_TEXT_MAX];
    int from_folder;
} SweepRecord;

/* All runs, plain bytes for any process: task i is run i. */
typedef struct {
    RecipeKind kind; /* RECIPE_EVALUATIONS */
    Settings settings;
    long replicates;
    int has_levels;
    size_t n_var, n_records, n_levels, size;
    double bytes[]; /* levels (n_levels), then SweepRecord (n_records) */
} Sweep;

static const SweepRecord *record_of(const Sweep *s, size_t run)
{
    return (const SweepRecord *)(s->bytes + s->n_levels) + run / s->n_levels;
}

static const double *level_of(const Sweep *s, size_t run)
{
    return s->has_levels ? &s->bytes[run % s->n_levels] : NULL;
}

static Status describe_motion(EvaluatedRun *run, const Scenario *w, Err *err)
{
    FILE *f = fmemopen(run->motion, sizeof run->motion, "w");
    if (!f)
        return fail(err, STATUS_NO_MEMORY, "no memory for a line");
    show_motion(f, &w->motion, w->options.sim.duration_s);
    fclose(f);
    run->pga_g = motion_peak(&w->motion) / GRAVITY;
    run->scale = w->motion.scale;
    run->stretch = w->motion.stretch;
    return STATUS_OK;
}

static Status simulate(const Problem *p, size_t n_var, const double x[], SimResult results[], Err *err)
{
    SimTask tasks[N_EVALUATED];
    if (p->n_var != n_var)
        return fail(err, STATUS_BAD_DATA, "the front has designs of %zu variables, this building has %zu", n_var,
                    p->n_var);
    for (int i = 0; i < N_EVALUATED; i++)
        tasks[i] = (SimTask){EVALUATION_CASES[i].kind, x};
    return tower_simulate(p, N_EVALUATED, tasks, results, err);
}

static int cases_of(int has_levels, int from_folder)
{
    return has_levels || from_folder ? N_EVALUATED : N_WITH_DEVICES;
}

int evaluated_cases(const Evaluations *e, const EvaluatedRun *run)
{
    return cases_of(e->level != NULL, run->record->from_folder);
}

static Status simulate_devices(const Problem *p, const double x[], EvaluatedRun *run, Err *err)
{
    const SimResult *alone = &run->result[EVALUATED_NO_CORE];
    const double no_core[3] = {alone->j1_m, alone->j2_m, alone->j3_g};
    SimWorker *w = tower_worker(tower_of(p), 0, 0);
    for (int i = EVALUATED_TMD; i <= EVALUATED_LINKS; i++) {
        TRY(baseline_tune(tower_of(p), 0, i == EVALUATED_TMD ? BASELINE_TMD : BASELINE_LINKS, x, no_core,
                          &run->device[i], err));
        sim_worker_device(w, &run->device[i]);
        TRY(sim_run(w, EVALUATION_CASES[i].kind, x, &run->result[i], err));
    }
    return STATUS_OK;
}

/* The words of a summary where they go with it to another process. */
static void keep_words(EvaluatedRun *run)
{
    const char *const words[] = {run->replicates.rule, run->replicates.spread};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        snprintf(run->words[i], sizeof run->words[i], "%s", words[i] ? words[i] : "");
}

static void point_at_words(EvaluatedRun *run)
{
    run->replicates.rule = run->words[0];
    run->replicates.spread = run->words[1];
    run->replicates.shown = NULL;
}

/* The same record with replicates. */
static Status replicate(const Settings *s, long n, const double x[], EvaluatedRun *run, Err *err)
{
    Problem p;
    SimResult shown;
    Settings own = *s;
    own.sim.replicates = n;
    snprintf(own.motion.records, sizeof own.motion.records, "none");
    TRY(tower_open(&p, &own, TOWER_AS_SET, 1, err));
    const Status status = tower_replicate(&p, 1, x, &shown, &run->replicates, err);
    keep_words(run);
    problem_close(&p);
    return status;
}

static Status run_on(const Problem *p, const Sweep *s, const Settings *own, int n_cases, const double x[],
                     EvaluatedRun *run, Err *err)
{
    TRY(describe_motion(run, tower_record(tower_of(p), 0), err));
    TRY(simulate(p, s->n_var, x, run->result, err));
    if (n_cases == N_WITH_DEVICES)
        TRY(simulate_devices(p, x, run, err));
    run->error_known = own->sim.engine == ENGINE_FAST && n_cases == N_WITH_DEVICES;
    if (run->error_known)
        TRY(estimate_designs(own, 1, &(SimTask){SCENE_IMPACT, x}, run->result, run->error, err));
    return s->replicates > 0 ? replicate(own, s->replicates, x, run, err) : STATUS_OK;
}

static Status run_one(void *self, size_t worker, const Task *task, Err *err)
{
    const Sweep *s = self;
    const size_t i = (size_t)task->variant;
    const SweepRecord *record = record_of(s, i);
    Problem p;
    Settings *own;
    (void)worker;
    memset(task->result, 0, sizeof(EvaluatedRun));
    Status status = settings_for(&s->settings, record->path, level_of(s, i), &own, err);
    if (status == STATUS_OK)
        status = tower_open(&p, own, TOWER_SINGLE, 1, err);
    if (status == STATUS_OK) {
        status = run_on(&p, s, own, cases_of(s->has_levels, record->from_folder), task->x, task->result, err);
        problem_close(&p);
    }
    free(own);
    return status;
}

static const Simulator SWEEP = {run_one, NULL, NULL};

Status evaluations_open(Problem *p, const void *recipe, size_t size, Err *err)
{
    const Sweep *s = recipe;
    if (size < sizeof *s || size != s->size)
        return fail(err, STATUS_INTERNAL, "runs of %zu bytes instead of %zu", size, s->size);
    *p = (Problem){.n_var = s->n_var,
                   .simulator = &SWEEP,
                   .self = (void *)s,
                   .n_parts = 1,
                   .part_size = sizeof(EvaluatedRun),
                   .n_workers = threads_wanted(s->settings.search.threads),
                   .recipe = recipe,
                   .recipe_size = size};
    executor_choose(p);
    return STATUS_OK;
}

/* To be freed. */
static Status sweep_of(const Evaluations *e, const Settings *settings, size_t n_var, Sweep **out, Err *err)
{
    const size_t size = sizeof **out + e->n_levels * sizeof(double) + e->n_records * sizeof(SweepRecord);
    Sweep *s = calloc(1, size);
    *out = s;
    if (!s)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu records", e->n_records);
    s->kind = RECIPE_EVALUATIONS;
    s->settings = *settings;
    s->replicates = e->replicates;
    s->has_levels = e->level != NULL;
    s->n_var = n_var;
    s->n_records = e->n_records;
    s->n_levels = e->n_levels;
    s->size = size;
    if (e->level)
        memcpy(s->bytes, e->level, e->n_levels * sizeof *e->level);
    SweepRecord *record = (SweepRecord *)(s->bytes + e->n_levels);
    for (size_t i = 0; i < e->n_records; i++) {
        record[i].from_folder = e->record[i].from_folder;
        TRY(option_put_path(record[i].path, e->record[i].path, err));
    }
    return STATUS_OK;
}

/* ---- all runs ---------------------------------------------------------------------------------------------------- */

typedef struct {
    FILE *out;
    size_t done, all;
    double began_s, told_s;
    int has_line;
} Progress;

/* A line in place of the one before, four times a second. */
static void tell(Progress *p)
{
    const double now = clock_seconds();
    p->done++;
    if (!p->out || now - p->began_s < 1 || (now - p->told_s < 0.25 && p->done < p->all))
        return;
    p->told_s = now;
    p->has_line = 1;
    fprintf(p->out, "\r%zu of %zu simulations, %.0f s left ", p->done * N_EVALUATED, p->all * N_EVALUATED,
            (now - p->began_s) * (double)(p->all - p->done) / (double)p->done);
    fflush(p->out);
}

/* Every run whose record can be read, a few more at a time than there are workers. */
static Status run_all(Evaluations *e, Queue *q, const double x[], Progress *progress, Err *err)
{
    const size_t n = e->n_records * e->n_levels, pending = 2 * queue_problem(q)->n_workers;
    Finished done;
    for (size_t i = 0; i < n || queue_pending(q) > 0;) {
        EvaluatedRun *run = &e->run[i];
        if (i < n && queue_pending(q) < pending) {
            run->record = &e->record[i / e->n_levels];
            if (run->record->readable == STATUS_OK)
                TRY(queue_ask(q, &(Asked){.x = x, .variant = (int)i, .only_first = 1, .note = &(double){(double)i}},
                              err));
            i++;
            continue;
        }
        TRY(queue_next(q, &done, err));
        run = &e->run[(size_t)*done.note];
        const EvaluatedRecord *record = run->record;
        memcpy(run, done.parts, sizeof *run);
        run->record = record;
        point_at_words(run);
        tell(progress);
    }
    return STATUS_OK;
}

static Status run_sweep(Evaluations *e, const Sweep *s, const double x[], Progress *progress, Err *err)
{
    Problem p;
    Queue *q;
    TRY(evaluations_open(&p, s, s->size, err));
    TRY(queue_open(&q, &p, QUEUE_AS_ASKED, 1, 0, err));
    const Status status = run_all(e, q, x, progress, err);
    queue_close(q);
    return status;
}

Status evaluations_run(Evaluations *e, const Settings *s, size_t n_var, const double x[], FILE *progress, Err *err)
{
    const double now = clock_seconds();
    Progress p = {.out = progress, .all = e->n_read * e->n_levels, .began_s = now, .told_s = now};
    Sweep *sweep = NULL;
    e->run = calloc(e->n_records * e->n_levels, sizeof *e->run);
    if (!e->run)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu simulations", e->n_records * e->n_levels * N_EVALUATED);
    Status status = sweep_of(e, s, n_var, &sweep, err);
    if (status == STATUS_OK)
        status = run_sweep(e, sweep, x, &p, err);
    free(sweep);
    if (p.has_line)
        fprintf(progress, "\r%60s\r", "");
    return status;
}

void evaluations_free(Evaluations *e)
{
    for (size_t i = 0; i < e->n_records; i++)
        free(e->record[i].path);
    free(e->run);
    free(e->record);
}
