#include "bench/problem.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "api/search_config.h"
#include "bench/textbook.h"
#include "evaluate/schema.h"
#include "evaluate/tasks.h"
#include "settings/settings.h"
#include "store/output.h"
#include "study/search_loop.h"

/* The table under way. */
typedef struct {
    const Problem *problem;
    FILE *f;
    int noisy;
    size_t n_front, n;
    double seconds;
} Writing;

static void write_row(const Writing *w, const double x[], const double f[])
{
    double exact[TEXTBOOK_OBJ_MAX];
    textbook_exact(w->problem, x, exact);
    print_number(w->f, x[0]);
    print_cells(w->f, w->problem->n_var - 1, x + 1);
    print_cells(w->f, w->noisy ? w->problem->n_obj : 0, f);
    print_cells(w->f, w->problem->n_obj, exact);
    fputc('\n', w->f);
}

static void write_header(const Writing *w)
{
    for (size_t j = 0; j < w->problem->n_var; j++)
        fprintf(w->f, "%sx%zu", j > 0 ? "," : "", j + 1);
    for (int pass = !w->noisy; pass < 2; pass++)
        for (size_t k = 0; k < w->problem->n_obj; k++)
            fprintf(w->f, ",%sf%zu", pass ? "" : "seen_", k + 1);
    fputc('\n', w->f);
}

static int write_new(const SearchView *view, const SearchTime *time, void *user)
{
    Writing *w = user;
    const Archive *a = view->all;
    for (size_t i = w->n; i < a->n; i++)
        write_row(w, a->X + i * a->n_var, a->Y + i * a->n_obj);
    w->n = a->n;
    w->n_front = a->n_front;
    w->seconds = time->all;
    return 0;
}

static Status search(const Args *args, const Settings *s, const Problem *p, Err *err)
{
    Output o;
    StopReason reason;
    const SearchConfig config = search_config_of(s);
    TRY(output_open(&o, args_value(args, "--csv"), err));
    Writing w = {.problem = p, .f = o.stream, .noisy = s->problem.noisy == NOISY_YES};
    write_header(&w);
    omp_set_num_threads((int)threads_wanted(s->search.threads));
    const Status status = search_run(p, &config, NULL, write_new, &w, &reason, err);
    if (status != STATUS_OK) {
        output_abandon(&o);
        return status;
    }
    fprintf(stderr, "%s: %zu evaluated, %zu nondominated, %.2f s (%s)\n", args->operand, w.n, w.n_front, w.seconds,
            stop_reason_words(reason));
    return output_close(&o, err);
}

Status problem_run(const Args *args, Err *err)
{
    Settings s;
    Problem p;
    TextbookOptions o = {.name = args->operand};
    if (!args_has(args, "--csv"))
        return misused(err, "--csv FILE is missing: where the table goes");
    TRY(args_number(args, "--noise", 0, 1, 0, &o.noise, err));
    settings_defaults(&s);
    TRY(args_apply(args, &s, NULL, NULL, err));
    s.problem.noisy = o.noise > 0 ? NOISY_YES : NOISY_NO;
    o.n_var = s.problem.variables;
    o.n_obj = s.problem.objectives;
    o.kinds = s.problem.kinds;
    o.seed = (uint32_t)s.search.seed;
    TRY(settings_check(&s, err));
    TRY(textbook_open(&p, &o, err));
    p.is_noisy = schema_is_noisy(&s);
    const Status status = search(args, &s, &p, err);
    problem_close(&p);
    return status;
}
