#include "bench/schedule.h"

#include <math.h>
#include <stdlib.h>

#include "base/stat.h"
#include "evaluate/adapter.h"
#include "evaluate/race.h"
#include "store/run_read.h"

enum { WORKERS_MAX = 4096 };

/* Share of choosing that is as if one processor did it alone: selection, commits, and that there are as many fits as
 * objectives (stages of Kobe 800, timed). */
static const double ALONE = 0.2;

typedef struct {
    const SchedulePlan *plan;
    const Run *run;
    size_t n, n_parts, n_cheap; /* designs of the search; tasks of one, of one that is screened */
    double *end;                /* (n) [s] when they are there */
    double *choose;             /* (n_generations) [s] of one processor for the questions of each */
    double worker[WORKERS_MAX]; /* [s] when each is free */
} Replay;

typedef struct {
    double reached;                    /* [s] when the designs of plan->from were there */
    double time, work, choosing, idle; /* [s] in all; of all processors; while the search chose; of workers together */
} Replayed;

/* Tasks of a design, and the seconds of each; one that is finished has them of its cheap level too. */
static size_t tasks_of(const Replay *r, size_t row, double *each_s)
{
    const Evaluation *e = &r->run->table.row[row];
    const size_t n = e->kind == KIND_SCREENED ? r->n_cheap : r->n_parts;
    *each_s = e->seconds / (double)n;
    return e->kind == KIND_FINISHED ? n - r->n_cheap : n;
}

/* What the search took before each group: the time from step to step less the simulations in between, which one thread
 * does in the order of the questions. */
static void find_choosing(Replay *r)
{
    const Run *run = r->run;
    double before = 0.0;
    long row = 0;
    for (size_t g = 0; g < run->n_generations; g++) {
        double simulated = 0.0, each_s;
        for (; row < run->generation[g].simulated; row++)
            simulated += (double)tasks_of(r, (size_t)row, &each_s) * each_s;
        r->choose[g] = fmax(run->generation[g].seconds - before - simulated, 0.0);
        before = run->generation[g].seconds;
    }
}

/* A group is asked at `now`, in order: each task goes to the worker that is free first. */
static void simulate(Replay *r, size_t *next, long group, double now, size_t n_workers, double began, Replayed *out)
{
    for (; *next < r->n && r->run->table.row[*next].generation <= group; (*next)++) {
        double each_s;
        r->end[*next] = 0.0;
        for (size_t n = tasks_of(r, *next, &each_s); n > 0; n--) {
            double *w = r->worker;
            for (size_t i = 1; i < n_workers; i++)
                w = r->worker[i] < *w ? &r->worker[i] : w;
            const double start = fmax(*w, now);
            out->idle += fmax(start - fmax(*w, began), 0.0);
            *w = start + each_s;
            out->work += fmax(*w - fmax(start, began), 0.0);
            r->end[*next] = fmax(r->end[*next], *w);
        }
    }
}

/* What is done from `began` on. */
static Replayed replay(Replay *r, size_t n_workers, double began)
{
    const size_t n_apart = (size_t)r->plan->apart, n_choosing = n_apart > 0 ? n_apart : n_workers;
    Replayed out = {0};
    size_t next = 0, entered = 0;
    double now = 0.0;
    memset(r->worker, 0, n_workers * sizeof *r->worker);
    for (size_t g = 0; g < r->run->n_generations; g++) {
        const double alone = ALONE * r->choose[g], shared = (r->choose[g] - alone) / (double)n_choosing;
        for (size_t i = 0; i < n_workers && n_apart == 0; i++) /* what the search takes of each processor */
            r->worker[i] += shared + alone / (double)n_workers;
        out.work += now >= began && n_apart == 0 ? r->choose[g] : 0.0;
        out.choosing += now >= began ? alone + shared : 0.0;
        now += alone + shared;
        simulate(r, &next, (long)g, now, n_workers, began, &out);
        for (; entered < (size_t)r->run->generation[g].simulated; entered++) {
            now = fmax(now, r->end[entered]);
            out.reached = entered < (size_t)r->plan->from ? now : out.reached;
        }
    }
    out.time = now - began;
    return out;
}

Status schedule(const SchedulePlan *plan, FILE *out, Err *err)
{
    static const size_t WORKERS[] = {1, 2, 4, 8, 14, 16, 32, 64};
    Run run;
    Adapter *a = NULL;
    TRY(run_read(&run, plan->folder, err));
    Replay r = {.plan = plan, .run = &run, .n = run.n_finished};
    Status status = adapter_open(&a, run.settings, err);
    if (status == STATUS_OK) { /* with replicates the first of each record is cheap */
        const Problem *p = adapter_problem(a);
        const size_t n_records = p->n_cheap > 0 ? p->n_cheap : p->n_parts;
        r.n_parts = p->n_parts;
        r.n_cheap = run.settings->search.fidelity == FIDELITY_RECORDS ? race_first(n_records) : n_records;
    }
    adapter_close(a);
    r.end = calloc(r.n + 1, sizeof *r.end);
    r.choose = calloc(run.n_generations + 1, sizeof *r.choose);
    THEN(status, r.end && r.choose ? STATUS_OK : fail_memory(err, r.n, "designs"));
    if (status == STATUS_OK && (run.n_sessions != 1 || run.session[0].threads != 1))
        status = bad_data(err, "%s: was not made in one session with --threads 1", plan->folder);
    if (status == STATUS_OK && (size_t)plan->from >= r.n)
        status = bad_data(err, "%s: --from %ld: it has %zu finished designs", plan->folder, plan->from, r.n);
    if (status == STATUS_OK) {
        find_choosing(&r);
        const double critical = replay(&r, WORKERS_MAX, replay(&r, WORKERS_MAX, 0.0).reached).time;
        fputs("workers,search_s,efficiency,critical_s,choosing,idle\n", out);
        for (size_t i = 0; i < N_OF(WORKERS); i++) {
            const Replayed p = replay(&r, WORKERS[i], replay(&r, WORKERS[i], 0.0).reached);
            const double all = (double)WORKERS[i] * p.time;
            fprintf(out, "%zu,%.4g,%.3f,%.4g,%.3f,%.3f\n", WORKERS[i], p.time, p.work / all, critical,
                    p.choosing / p.time, p.idle / all);
        }
    }
    free(r.end);
    free(r.choose);
    run_free(&run);
    return status;
}
