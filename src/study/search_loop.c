#include "study/search_loop.h"

#include <malloc.h>

#include "base/clock.h"
#include "evaluate/queue.h"

typedef struct {
    const Problem *problem;
    const SearchConfig *config;
    Search *search;
    Queue *queue;
    const Evaluation *known; /* (n_known) by ascending number; before next_known none is asked for again */
    size_t n_known, next_known;
    double start;
    SearchTime time;
} Loop;

/* Until the search ends, or the observer wants no more. */
static Status run(Loop *l, ObserveFn observe, void *user, StopReason *reason, Err *err)
{
    for (SearchMove move = SEARCH_ASKS; move != SEARCH_ENDS;) {
        Question q;
        Finished done;
        const double before = clock_seconds();
        Status status = search_ask(l->search, &move, &q, err);
        l->time.choosing += clock_seconds() - before;
        TRY(status);
        if (move == SEARCH_ASKS) { /* a design, whose answer may be known from before */
            while (l->next_known < l->n_known && l->known[l->next_known].id < (long)q.number)
                l->next_known++;
            const Evaluation *known = &l->known[l->next_known];
            const int is_known = l->next_known < l->n_known && known->id == (long)q.number &&
                                 memcmp(known->x, q.x, l->problem->n_var * sizeof *q.x) == 0;
            TRY(is_known ? search_tell(l->search, q.number, known, NULL, err)
                         : queue_ask(l->queue,
                                     &(Asked){.id = (long)q.number,
                                              .x = q.x,
                                              .repeat = q.repeat,
                                              .kind = q.kind,
                                              .n_parts = q.n_parts,
                                              .cheap_parts = q.cheap_parts},
                                     err));
        } else if (move == SEARCH_WAITS) {
            const double asked = clock_seconds();
            status = queue_next(l->queue, &done, err);
            l->time.waiting += clock_seconds() - asked;
            TRY(status);
            TRY(search_tell(l->search, (size_t)done.evaluation->id, done.evaluation, done.parts, err));
        } else if (move == SEARCH_STEPS) { /* the end of a generation */
            const double most = l->config->max_seconds;
            l->time.all = clock_seconds() - l->start;
            if (most > 0.0 && l->time.all >= most)
                search_stop(l->search, STOP_TIME);
            const SearchView view = search_look(l->search);
            if (observe && observe(&view, &l->time, user) && view.reason == STOP_NONE) {
                *reason = STOP_ASKED;
                return STATUS_OK;
            }
        }
    }
    *reason = search_look(l->search).reason;
    return STATUS_OK;
}

Status search_run(const Problem *problem, const SearchConfig *config, const SearchStart *start, ObserveFn observe,
                  void *user, StopReason *reason, Err *err)
{
    Loop l = {.problem = problem, .config = config, .start = clock_seconds()};
    *reason = STOP_NONE;
    Status status = search_create(&l.search, problem, config, start, err);
    if (start) {
        l.n_known = start->n_later;
        l.known = start->row + (start->each ? 0 : start->n);
    }
    THEN(status, queue_open(&l.queue, problem, err));
    THEN(status, run(&l, observe, user, reason, err));
    queue_close(l.queue);
    search_free(l.search);
    malloc_trim(0); /* its small pieces, which the C library would keep, make room for the run that is read next */
    return status;
}
