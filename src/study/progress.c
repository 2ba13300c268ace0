#include "study/progress.h"

#include <time.h>

double progress_rate(const Progress *p)
{
    if (p->session_simulated > 0 && p->session_s > 0.0)
        return (double)p->session_simulated / p->session_s;
    return p->simulated > 0 && p->all_s > 0.0 ? (double)p->simulated / p->all_s : NAN;
}

double progress_left(const Progress *p, const SearchOptions *o)
{
    double left = ((double)o->max_evals - (double)p->simulated) / progress_rate(p);
    if (!isfinite(left))
        return NAN;
    if (o->max_hours > 0.0)
        left = fmin(left, 3600.0 * o->max_hours - p->session_s);
    return fmax(left, 0.0);
}

void duration_words(double seconds, char text[32])
{
    const long s = (long)fmin(seconds, 1e8);
    if (!isfinite(seconds))
        snprintf(text, 32, "-");
    else if (s < 3600)
        snprintf(text, 32, "%ld:%02ld min", s / 60, s % 60);
    else
        snprintf(text, 32, "%ld:%02ld h", s / 3600, s / 60 % 60);
}

const char *state_words(RunState state)
{
    static const char *const WORDS[] = {[RUN_RUNNING] = "running",
                                        [RUN_FINISHED] = "finished",
                                        [RUN_PAUSED] = "stopped",
                                        [RUN_INTERRUPTED] = "interrupted"};
    return WORDS[state];
}

/* Thread-seconds of a session's simulations. */
static double simulated_seconds(const Run *run, size_t number)
{
    const size_t n = run_first_polished(run), first = run->session[number].simulated_before;
    const size_t next = number + 1 < run->n_sessions ? (size_t)run->session[number + 1].simulated_before : n;
    double seconds = 0.0;
    for (size_t i = first; i < next && i < n; i++)
        if (isfinite(run->table.row[i].seconds))
            seconds += run->table.row[i].seconds;
    return seconds;
}

Effort effort_of(const Run *run, size_t session)
{
    const RunSession *s = &run->session[session];
    Effort e = {.waiting = s->waited_s / s->search_s, .surrogate = s->surrogate_s / s->search_s};
    e.search = 1.0 - e.waiting - e.surrogate;
    const double simulated = simulated_seconds(run, session);
    e.busy = simulated > 0.0 ? simulated / (s->search_s * fmax((double)s->threads, 1.0)) : NAN;
    return e;
}

NamedCost named_cost(const Run *run)
{
    NamedCost c = {.n = run->finer.n};
    double search = 0.0, named = 0.0;
    for (size_t i = 0; i < run->table.n; i++)
        search += isfinite(run->table.row[i].seconds) ? run->table.row[i].seconds : 0.0;
    for (size_t i = 0; i < c.n; i++) {
        c.n_unpredictable += run->finer.row[i].reason[0] != 0;
        named += run->finer.row[i].seconds;
    }
    c.share = named / search;
    return c;
}

/* As stored; of a session that was killed until its last generation at most, and at least what its simulations took. */
static double session_seconds(const Run *run, size_t number)
{
    const RunSession *s = &run->session[number];
    const double stored = isfinite(s->seconds) ? s->seconds : 0.0;
    if (*s->ended)
        return stored;
    return fmax(stored, simulated_seconds(run, number) / fmax((double)s->threads, 1.0));
}

void standing_of(Standing *out, const char *folder, const Run *run)
{
    const size_t n = run_first_polished(run);
    Progress *p = &out->progress;
    *out = (Standing){.hypervolume = NAN, .max_evals = run->settings->search.max_evals};
    const RunSession *last = run->n_sessions > 0 ? &run->session[run->n_sessions - 1] : NULL;
    out->state = folder_is_held(folder, &out->holder) ? RUN_RUNNING
                 : last && last->is_final             ? RUN_FINISHED
                 : last && *last->ended               ? RUN_PAUSED
                                                      : RUN_INTERRUPTED;
    for (size_t i = 0; i < run->table.n; i++) {
        const int polished = run->table.row[i].kind == KIND_POLISHED;
        out->n_polished += polished != 0;
        out->n_failed += !polished && !run->place[i].ok;
    }
    p->simulated = run_evaluations(run, 0);
    out->n_lost = out->state != RUN_RUNNING && out->holder.n_stored > n ? out->holder.n_stored - n : 0;
    if (run->n_generations > 0)
        out->hypervolume = run->generation[run->n_generations - 1].hypervolume;
    for (size_t i = 0; i < run->n_sessions; i++)
        out->seconds += session_seconds(run, i);
    if (last) { /* the run's newest session; one that runs has lasted longer than is stored */
        struct tm begun = {0};
        const double stored = p->session_s = session_seconds(run, run->n_sessions - 1);
        if (out->state == RUN_RUNNING) {
            p->session_s =
                strptime(last->started, "%Y-%m-%dT%H:%M:%SZ", &begun) ? difftime(time(NULL), timegm(&begun)) : NAN;
            out->seconds += fmax(p->session_s - stored, 0.0);
        }
        p->all_s = out->seconds;
        p->session_simulated = run_evaluations(run, last->simulated_before);
    }
    out->left_s = out->state == RUN_FINISHED ? 0.0 : progress_left(p, &run->settings->search);
}
