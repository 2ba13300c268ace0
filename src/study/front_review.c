#include "study/front_review.h"

#include "base/linalg.h"
#include "evaluate/tasks.h"
#include "settings/options.h"
#include "evaluate/tower.h"
#include "study/record_paths.h"

enum { SIMULATED_MAX = 16 };

/* Of the range: so near a gap is on its bound. */
static const double ON_BOUND = 1e-9;

FrontReview front_review(const Run *run)
{
    FrontReview r = {.n_front = run->n_front};
    const double *bound = run->settings->design.gap_m.at, near = ON_BOUND * (bound[1] - bound[0]);
    for (size_t i = 0; i < run->n_front && run->schema.order.n_obj > 0; i++) {
        const size_t row = run->front[i];
        r.n_gaps = 0;
        for (size_t j = 0; j < run->schema.n_var && r.n_gaps < SIDES * FLOORS_MAX; j++)
            if (strncmp(schema_variable(&run->schema, j)->name, "gap_", 4) == 0) {
                r.at_smallest[r.n_gaps] += run_x(run, row)[j] <= bound[0] + near;
                r.at_largest[r.n_gaps++] += run_x(run, row)[j] >= bound[1] - near;
            }
        r.n_beyond += schema_value(&run->schema, MEASURE_BEYOND_LAW, run_f(run, row), run->table.row[row].extra) > 0.0;
    }
    return r;
}

Status front_review_closings(const Problem *tower, const Run *run, FrontReview *out, Err *err)
{
    size_t rows[SIMULATED_MAX];
    SimTask tasks[SIMULATED_MAX];
    *out = front_review(run);
    const size_t n = run_spread_out(run, SIMULATED_MAX, 1, rows);
    SimResult *results;
    TRY_ROOM(results, SIMULATED_MAX, "simulations", err);
    for (size_t i = 0; i < n; i++)
        tasks[i] = (SimTask){.kind = SCENE_IMPACT, .x = run_x(run, rows[i])};
    const Status status = n > 0 ? tower_simulate(tower, n, tasks, results, err) : STATUS_OK;
    for (size_t i = 0; i < n && status == STATUS_OK; i++) {
        Design d;
        design_of(&run->schema.design, tasks[i].x, &d);
        for (int j = 0; j < results[i].n_floors; j++) {
            out->has_stop[j] |= design_gap(&d, j) < DESIGN_OPEN_M;
            out->closes[j] += results[i].closings[j] > 0;
        }
    }
    out->n_floors = n > 0 ? results[0].n_floors : 0;
    out->n_simulated = n;
    free(results);
    return status;
}

Status front_review_of_run(const Run *run, FrontReview *out, Err *err)
{
    Problem p;
    Settings s = *run->settings;
    TRY(linalg_room(threads_wanted(s.search.threads), err));
    TRY(record_paths_find(&s, run->provenance, &(RecordPaths){0}, err));
    TRY(tower_open(&p, &s, TOWER_SINGLE, SIMULATED_MAX, err));
    const Status status = front_review_closings(&p, run, out, err);
    problem_close(&p);
    return status;
}
