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
#include "evaluate/threads.h"
#include "scene/motion_scale.h"
#include "scene/motion_source.h"
#include "settings/settings.h"
#include "simulator/baselines.h"
#include "simulator/estimate.h"

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
    const int threads = (int)threads_wanted(s->search.threads);
    const long n = (long)e->n_records;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
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

/* ---- simulating -------------------------------------------------------------------------------------------------- */

static Status describe_motion(EvaluatedRun *run, const Scenario *w, Err *err)
{
    size_t length;
    FILE *f = open_memstream(&run->motion, &length);
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

int evaluated_cases(const Evaluations *e, const EvaluatedRun *run)
{
    return e->level || run->record->from_folder ? N_EVALUATED : N_WITH_DEVICES;
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
    problem_close(&p);
    return status;
}

static Status run_one(const Evaluations *e, EvaluatedRun *run, const Settings *s, const double *level, size_t n_var,
                      const double x[], Err *err)
{
    Problem p;
    Settings *own;
    Status status = settings_for(s, run->record->path, level, &own, err);
    if (status == STATUS_OK)
        status = tower_open(&p, own, TOWER_SINGLE, 1, err);
    if (status != STATUS_OK) {
        free(own);
        return status;
    }
    status = describe_motion(run, tower_record(tower_of(&p), 0), err);
    if (status == STATUS_OK)
        status = simulate(&p, n_var, x, run->result, err);
    if (status == STATUS_OK && evaluated_cases(e, run) == N_WITH_DEVICES)
        status = simulate_devices(&p, x, run, err);
    run->error_known = own->sim.engine == ENGINE_FAST && evaluated_cases(e, run) == N_WITH_DEVICES;
    if (status == STATUS_OK && run->error_known)
        status = estimate_designs(own, 1, &(SimTask){SCENE_IMPACT, x}, run->result, run->error, err);
    if (status == STATUS_OK && e->replicates > 0)
        status = replicate(own, e->replicates, x, run, err);
    free(own);
    problem_close(&p);
    return status;
}

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

/* Every run whose record can be read; of several faults that of the first run is reported. */
static Status run_all(Evaluations *e, const Settings *s, size_t n_var, const double x[], Progress *progress, Err *err)
{
    const int threads = (int)threads_wanted(s->search.threads);
    const long n = (long)(e->n_records * e->n_levels);
    long first_bad = n;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
    for (long i = 0; i < n; i++) {
        Err why = {0};
        EvaluatedRun *run = &e->run[i];
        Status status = STATUS_OK;
        run->record = &e->record[i / (long)e->n_levels];
        if (run->record->readable == STATUS_OK)
            status = run_one(e, run, s, e->level ? &e->level[i % (long)e->n_levels] : NULL, n_var, x, &why);
#pragma omp critical(evaluations)
        {
            if (run->record->readable == STATUS_OK)
                tell(progress);
            if (status != STATUS_OK && i < first_bad) {
                first_bad = i;
                *err = why;
            }
        }
    }
    return first_bad < n ? err->code : STATUS_OK;
}

Status evaluations_run(Evaluations *e, const Settings *s, size_t n_var, const double x[], FILE *progress, Err *err)
{
    const double now = clock_seconds();
    Progress p = {.out = progress, .all = e->n_read * e->n_levels, .began_s = now, .told_s = now};
    e->run = calloc(e->n_records * e->n_levels, sizeof *e->run);
    if (!e->run)
        return fail(err, STATUS_NO_MEMORY, "no memory for %zu simulations", e->n_records * e->n_levels * N_EVALUATED);
    const Status status = run_all(e, s, n_var, x, &p, err);
    if (p.has_line)
        fprintf(progress, "\r%60s\r", "");
    return status;
}

void evaluations_free(Evaluations *e)
{
    for (size_t i = 0; e->run && i < e->n_records * e->n_levels; i++)
        free(e->run[i].motion);
    for (size_t i = 0; i < e->n_records; i++)
        free(e->record[i].path);
    free(e->run);
    free(e->record);
}
