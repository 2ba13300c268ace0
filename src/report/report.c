#include "report/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "store/saved.h"
#include "settings/settings.h"

/* From the database, or the file beside it. */
static Status take_provenance(Report *r, Err *err)
{
    char path[PATH_MAX];
    Err none;
    Saved h;
    size_t length;
    if (!saved_path(r->folder, path, sizeof path)) {
        if (snprintf(path, sizeof path, "%s/provenance.json", r->folder) < (int)sizeof path &&
            file_read(path, &r->provenance, &length, &none) != STATUS_OK)
            r->provenance = NULL;
        return STATUS_OK;
    }
    TRY(saved_read(&h, r->folder, err));
    r->provenance = h.provenance;
    h.provenance = NULL;
    saved_free(&h);
    return STATUS_OK;
}

Status report_open(Report *r, const char *folder, const char *design, const DetailWish *wish, Err *err)
{
    memset(r, 0, sizeof *r);
    TRY(run_settings(&r->settings, folder, err));
    TRY(front_read(&r->front, folder, err));
    snprintf(r->folder, sizeof r->folder, "%s", folder);
    Status status = front_pick(&r->front, folder, design, &r->chosen, err);
    if (status == STATUS_OK) {
        r->knee = front_knee(&r->front);
        status = convergence_read(folder, &r->convergence, err);
    }
    if (status == STATUS_OK)
        status = take_provenance(r, err);
    if (status == STATUS_OK)
        status = moved_find(&r->settings, r->provenance, &wish->moved, err);
    r->has_detail = r->settings.problem.kind == PROBLEM_TOWER;
    r->is_robust = r->has_detail && (r->settings.sim.ensemble > 1 || strcmp(r->settings.motion.records, "none") != 0);
    if (status == STATUS_OK && r->has_detail)
        status = detail_make(&r->settings, r->front.n_var, front_x(&r->front, r->chosen), wish, &r->detail, err);
    if (status != STATUS_OK)
        report_close(r);
    return status;
}

void report_close(Report *r)
{
    free(r->provenance);
    detail_free(&r->detail);
    convergence_free(&r->convergence);
    front_free(&r->front);
    memset(r, 0, sizeof *r);
}
