#include "bench/problem.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "api/search_config.h"
#include "evaluate/textbook.h"
#include "store/output.h"
#include "study/search_loop.h"
#include "evaluate/adapter.h"
#include "settings/settings.h"

/* The table under way. */
typedef struct {
    const Adapter *adapter;
    FILE *f;
    int noisy;
    size_t n_front, n;
    double seconds;
} Writing;

static void write_row(const Writing *w, const double x[], const double f[])
{
    const Schema *schema = adapter_schema(w->adapter);
    double exact[OBJECTIVES_MAX];
    textbook_exact(adapter_problem(w->adapter), x, exact);
    print_number(w->f, x[0]);
    print_cells(w->f, schema->n_var - 1, x + 1);
    print_cells(w->f, w->noisy ? schema->n_obj : 0, f);
    print_cells(w->f, schema->n_obj, exact);
    fputc('\n', w->f);
}

static void write_header(const Writing *w)
{
    const Schema *schema = adapter_schema(w->adapter);
    fputs(schema->column[0].name, w->f);
    for (size_t j = 1; j < schema->n_var; j++)
        fprintf(w->f, ",%s", schema->column[j].name);
    for (int pass = !w->noisy; pass < 2; pass++)
        for (size_t k = 0; k < schema->n_obj; k++)
            fprintf(w->f, ",%s%s", pass ? "" : "seen_", schema_objective(schema, k)->name);
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

static Status search(const Args *args, const Settings *s, const Adapter *adapter, Err *err)
{
    Output o;
    StopReason reason;
    const SearchConfig config = search_config_of(s);
    TRY(output_open(&o, args_value(args, "--csv"), err));
    Writing w = {.adapter = adapter, .f = o.stream, .noisy = s->problem.noise > 0.0};
    write_header(&w);
    omp_set_num_threads(adapter_threads(adapter));
    const Status status = search_run(adapter_problem(adapter), &config, write_new, &w, &reason, err);
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
    const char *names[16];
    int n_names = 0, known = 0;
    Settings s;
    Adapter *adapter;
    for (; textbook(n_names); n_names++) {
        names[n_names] = textbook(n_names)->name;
        known |= strcmp(args->operand, names[n_names]) == 0;
    }
    if (!known)
        return args_unknown("problem", args->operand, names, n_names, "`imtet-bench problem --help`", err);
    if (!args_has(args, "--csv"))
        return misused(err, "--csv FILE is missing: where the table goes");
    settings_defaults(&s);
    TRY(settings_put(&s, "problem.kind", args->operand, err));
    TRY(args_apply(args, &s, NULL, NULL, err));
    TRY(settings_put(&s, "problem.kind", args->operand, err)); /* whatever --set says: the operand is the problem */
    TRY(settings_check(&s, err));
    TRY(adapter_open(&adapter, &s, err));
    const Status status = search(args, &s, adapter, err);
    adapter_close(adapter);
    return status;
}
