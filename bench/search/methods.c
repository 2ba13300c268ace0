#include "bench/search/methods.h"

#include "moga/search.h"
#include "study/study.h"

static int note(const SearchView *v, void *user)
{
    Course *c = user;
    while (c->n < v->n && c->n < c->n_max) {
        const size_t i = c->n;
        course_add(c, v->Y + i * c->n_obj, v->ok[i] && violation_of(v->n_con, v->H + i * v->n_con) == 0.0);
    }
    return 0;
}

static Status run_search(const Settings *settings, SurrogateUse use, SelectionKind selection, const Problem *p,
                         Course *c, Err *err)
{
    Settings s = *settings;
    StopReason reason;
    s.search.max_evals = (long)c->n_max;
    s.search.generations = 1000000;
    s.search.surrogate = use;
    s.search.survival = selection;
    const SearchConfig config = study_search_config(&s);
    return search_run(p, &config, note, c, &reason, err);
}

static Status run_imtet(const Settings *s, const Problem *p, Course *c, Err *err)
{
    return run_search(s, SURROGATE_ON, s->search.survival, p, c, err);
}

static Status run_plain(const Settings *s, const Problem *p, Course *c, Err *err)
{
    return run_search(s, SURROGATE_OFF, SELECTION_NSGA3, p, c, err);
}

static Status run_rvea(const Settings *s, const Problem *p, Course *c, Err *err)
{
    return run_search(s, SURROGATE_OFF, SELECTION_RVEA, p, c, err);
}

static const Method METHODS[] = {{"imtet", run_imtet}, {"plain", run_plain},   {"rvea", run_rvea},
                                 {"moead", run_moead}, {"parego", run_parego}, {"krvea", run_krvea}};

size_t method_count(void)
{
    return sizeof METHODS / sizeof *METHODS;
}

const Method *method(size_t i)
{
    return &METHODS[i];
}
