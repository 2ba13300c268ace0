#include "bench/schedule.h"

#include <math.h>
#include <stdlib.h>

#include "base/stat.h"
#include "store/run_read.h"

enum { WORKERS_MAX = 4096 };

typedef struct {
    const SchedulePlan *plan;
    const Run *run;
    size_t n;                         /* designs of the search */
    double *end;                      /* (n) [s] when they are there */
    double *choose;                   /* (n_generations) [s] of one processor for the questions of each */
    double work, worker[WORKERS_MAX]; /* worker: [s] when each is free */
} Replay;

typedef struct {
    double time, choosing, idle; /* [s] in all; while the search chose; of the workers together */
} Replayed;

/* What the search took before each group: the time from step to step less the simulations in between, which one thread
 * does in the order of the questions. */
static void find_choosing(Replay *r)
{
    const Run *run = r->run;
    double before = 0.0;
    long row = 0;
    for (size_t g = 0; g < run->n_generations; g++) {
        double simulated = 0.0;
        for (; row < run->generation[g].simulated; row++)
            simulated += run->table.row[row].seconds;
        r->choose[g] = fmax(run->generation[g].seconds - before - simulated, 0.0);
        before = run->generation[g].seconds;
        r->work += simulated + r->choose[g];
    }
}

static size_t first_free(const double worker[], size_t n)
{
    size_t first = 0;
    for (size_t i = 1; i < n; i++)
        if (worker[i] < worker[first])
            first = i;
    return first;
}

/* A group is asked at `now`, in order: each design goes to the worker that is free first. */
static void simulate(Replay *r, size_t *next, long group, double now, double worker[], size_t n_workers, double *idle)
{
    for (; *next < r->n && r->run->table.row[*next].generation <= group; (*next)++) {
        double *w = &worker[first_free(worker, n_workers)];
        *idle += fmax(now - *w, 0.0);
        *w = r->end[*next] = fmax(*w, now) + r->run->table.row[*next].seconds;
    }
}

static Replayed replay(Replay *r, size_t n_workers)
{
    double *worker = r->worker;
    const Run *run = r->run;
    Replayed out = {0};
    double now = 0.0;
    size_t next = 0, entered = 0;
    for (size_t i = 0; i < n_workers; i++)
        worker[i] = 0.0;
    for (size_t g = 0; g < run->n_generations; g++) {
        const double alone = r->plan->serial * r->choose[g], shared = (r->choose[g] - alone) / (double)n_workers;
        for (size_t i = 0; i < n_workers; i++) /* what the search takes of each processor */
            worker[i] += shared + alone / (double)n_workers;
        now += alone + shared;
        out.choosing += alone + shared;
        simulate(r, &next, (long)g, now, worker, n_workers, &out.idle);
        for (; entered < (size_t)run->generation[g].simulated; entered++)
            now = fmax(now, r->end[entered]);
    }
    out.time = now;
    return out;
}

static void write_row(Replay *r, size_t n_workers, double critical, FILE *out)
{
    const Replayed p = replay(r, n_workers);
    const double ends = fmax(r->plan->ends / (double)n_workers, r->plan->chain), whole = p.time + ends;
    fprintf(out, "%zu,%.4g,%.3f,%.4g,%.3f,%.4g,%.3f,%.3f\n", n_workers, p.time, r->work / ((double)n_workers * p.time),
            whole, (r->work + r->plan->ends) / ((double)n_workers * whole), critical, p.choosing / p.time,
            p.idle / ((double)n_workers * p.time));
}

Status schedule(const SchedulePlan *plan, FILE *out, Err *err)
{
    static const size_t WORKERS[] = {1, 2, 4, 8, 14, 16, 32, 64};
    Run run;
    TRY(run_read(&run, plan->folder, err));
    Replay r = {.plan = plan, .run = &run, .n = run.n_finished};
    r.end = calloc(r.n + 1, sizeof *r.end);
    r.choose = calloc(run.n_generations + 1, sizeof *r.choose);
    Status status = r.end && r.choose ? STATUS_OK : fail_memory(err, r.n, "designs");
    if (status == STATUS_OK && (run.n_sessions != 1 || run.session[0].threads != 1))
        status = bad_data(err, "%s: was not made in one session with --threads 1", plan->folder);
    if (status == STATUS_OK) {
        find_choosing(&r);
        const double critical = replay(&r, WORKERS_MAX).time;
        fputs("workers,search_s,search_efficiency,whole_s,whole_efficiency,critical_s,choosing,idle\n", out);
        for (size_t i = 0; i < N_OF(WORKERS); i++)
            write_row(&r, WORKERS[i], critical, out);
    }
    free(r.end);
    free(r.choose);
    run_free(&run);
    return status;
}
