#include "report/report.h"

#include <stdio.h>
#include <string.h>

Status report_open(Report *r, const char *folder, const char *design, const DetailWish *wish, Err *err)
{
    memset(r, 0, sizeof *r);
    TRY(run_settings(&r->settings, folder, err));
    TRY(front_read(&r->front, folder, err));
    snprintf(r->folder, sizeof r->folder, "%s", folder);
    Status status = front_pick(&r->front, folder, design, &r->chosen, err);
    if (status == STATUS_OK) {
        r->knee = front_knee(&r->front);
        status = convergence_read(&r->front, folder, &r->convergence, err);
    }
    r->has_detail = r->settings.problem.kind == PROBLEM_TOWER;
    if (status == STATUS_OK && r->has_detail)
        status = detail_make(&r->settings, r->front.n_var, front_x(&r->front, r->chosen), wish, &r->detail, err);
    if (status != STATUS_OK)
        report_close(r);
    return status;
}

void report_close(Report *r)
{
    detail_free(&r->detail);
    convergence_free(&r->convergence);
    front_free(&r->front);
    memset(r, 0, sizeof *r);
}
