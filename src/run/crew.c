#include "run/crew.h"

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

Status crew_run(Crew *crew, size_t n, const SimTask tasks[], SimResult results[], Err *err)
{
    Status first_status = STATUS_OK;
    size_t first = n;
#pragma omp parallel for schedule(dynamic, 1) num_threads(crew->n)
    for (size_t i = 0; i < n; i++) {
        Err mine = {0};
        const Status status =
            sim_run(crew->worker[omp_get_thread_num()], tasks[i].kind, tasks[i].x, &results[i], &mine);
        if (status == STATUS_OK)
            continue;
#pragma omp critical(crew_fault)
        if (i < first) { /* the same message whoever came first */
            first = i;
            first_status = fail(err, status, "%s", mine.text);
        }
    }
    return first_status;
}

void crew_free(Crew *crew)
{
    for (int i = 0; crew && i < crew->n; i++)
        sim_worker_free(crew->worker[i]);
    free(crew);
}
