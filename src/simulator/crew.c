#include "simulator/crew.h"

#include <omp.h>
#include <stdlib.h>

struct Crew {
    int n;
    SimWorker *worker[]; /* (n) */
};

Status crew_create(Crew **out, const Scene *scene, long threads, Err *err)
{
    const int n = threads > 0 ? (int)threads : omp_get_num_procs();
    Crew *c = calloc(1, sizeof *c + (size_t)n * sizeof c->worker[0]);
    *out = NULL;
    if (!c)
        return fail(err, STATUS_NO_MEMORY, "no memory for %d workers", n);
    c->n = n;
    for (int i = 0; i < n; i++) {
        const Status status = sim_worker_create(&c->worker[i], scene, err);
        if (status != STATUS_OK) {
            crew_free(c);
            return status;
        }
    }
    *out = c;
    return STATUS_OK;
}

/* What ends a batch: of faults the one of the first task, so that the message is the same whoever came first; a fault
 * of the watch or a stop only where there is no other. */
typedef struct {
    size_t first;
    Status status;
} End;

static void note_end(End *end, size_t i, Status status, const char *text, Err *err)
{
    if (i < end->first || end->status == STATUS_OK) {
        end->first = i;
        end->status = fail(err, status, "%s", text);
    }
}

Status crew_run_watched(Crew *crew, size_t n, const SimTask tasks[], SimResult results[], const Watch *watch, Err *err)
{
    End end = {n, STATUS_OK};
    int over = 0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(crew->n)
    for (size_t i = 0; i < n; i++) {
        int is_over;
#pragma omp atomic read
        is_over = over;
        if (is_over)
            continue;
        Err mine = {0};
        const int wanted = watch_go_on(watch);
        Status status = wanted
                            ? sim_run(crew->worker[omp_get_thread_num()], tasks[i].kind, tasks[i].x, &results[i], &mine)
                            : fail(&mine, STATUS_STOPPED, "stopped");
        const size_t rank = status == STATUS_OK || !wanted ? n : i;
#pragma omp critical(crew_end)
        {
            if (status == STATUS_OK)
                status = watch_done(watch, i, &mine);
            if (status != STATUS_OK)
                note_end(&end, rank, status, mine.text, err);
        }
        if (status != STATUS_OK && rank == n) {
#pragma omp atomic write
            over = 1;
        }
    }
    return end.status;
}

Status crew_run(Crew *crew, size_t n, const SimTask tasks[], SimResult results[], Err *err)
{
    return crew_run_watched(crew, n, tasks, results, NULL, err);
}

int crew_size(const Crew *crew)
{
    return crew->n;
}

Status crew_run_alone(Crew *crew, int worker, size_t n, const SimTask tasks[], SimResult results[], const Watch *watch,
                      Err *err)
{
    for (size_t i = 0; i < n; i++) {
        if (!watch_go_on(watch))
            return fail(err, STATUS_STOPPED, "stopped");
        TRY(sim_run(crew->worker[worker], tasks[i].kind, tasks[i].x, &results[i], err));
        TRY(watch_done(watch, i, err));
    }
    return STATUS_OK;
}

void crew_free(Crew *crew)
{
    for (int i = 0; crew && i < crew->n; i++)
        sim_worker_free(crew->worker[i]);
    free(crew);
}
