#include "report/report.h"

#include "motion/suite.h"
#include "settings/options.h"

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
    Settings s = *run->settings;
    DetailOptions of_run = *options;
    *r = report_brief(run);
    r->chosen = of_run.row = chosen;
    of_run.run = run;
    if (run->n_front == 0)
        return run_why_empty(run, err);
    r->knee = run_knee(run);

    /* The chosen design simulated with the run's own settings, its records where they are now. */
    Status status = record_paths_find(&s, run->provenance, &options->moved, err);
    run_steps(run, chosen, &s.sim);
    if (r->has_detail)
        THEN(status, detail_make(&s, (int)run->schema.n_var, run_x(run, chosen), &of_run, &r->detail, err));

    /* A design that the study named has errors of its own, which are better known: one figure has one error. */
    const double *known = r->is_robust || !r->has_detail ? NULL : run->table.row[chosen].err;
    for (size_t k = 0; known && k < run->schema.n_obj + run->schema.n_extra; k++)
        if (isfinite(known[k]))
            r->detail.error[run->schema.order.of[k]] = known[k];
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
