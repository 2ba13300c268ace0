#include "report/report.h"

#include "motion/suite.h"
#include "settings/options.h"

/* The chosen design simulated with the run's own settings, its records where they are now. */
static Status take_detail(Report *r, const DetailOptions *options, Err *err)
{
    Settings s = *r->run->settings;
    TRY(record_paths_find(&s, r->run->provenance, &options->moved, err));
    run_steps(r->run, r->chosen, &s.sim);
    if (!r->has_detail)
        return STATUS_OK;
    DetailOptions of_run = *options;
    of_run.run = r->run;
    of_run.row = r->chosen;
    TRY(detail_make(&s, (int)r->run->schema.n_var, run_x(r->run, r->chosen), &of_run, &r->detail, err));
    /* A design that the study named has errors of its own, which are better known: one figure has one error. */
    const double *known = r->is_robust ? NULL : r->run->table.row[r->chosen].err;
    for (size_t k = 0; known && k < r->run->schema.n_obj + r->run->schema.n_extra; k++)
        if (isfinite(known[k]))
            r->detail.error[r->run->schema.order.of[k]] = known[k];
    return STATUS_OK;
}

Report report_brief(const Run *run)
{
    const Settings *s = run->settings;
    const int is_tower = s->problem.kind == PROBLEM_TOWER;
    return (Report){.run = run,
                    .has_detail = is_tower,
                    .is_robust = is_tower && (s->sim.replicates > 1 || suite_count(&s->motion) > 1)};
}

Status report_open(Report *r, const Run *run, size_t chosen, const DetailOptions *options, Err *err)
{
    *r = report_brief(run);
    r->chosen = chosen;
    if (run->n_front == 0)
        return run_why_empty(run, err);
    r->knee = run_knee(run);
    const Status status = take_detail(r, options, err);
    if (status != STATUS_OK)
        report_close(r);
    return status;
}

void report_close(Report *r)
{
    detail_free(&r->detail);
    json_decref(r->scene);
    memset(r, 0, sizeof *r);
}
