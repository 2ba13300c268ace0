#include "cmd/demands.h"

#include "base/units.h"
#include "cmd/document.h"

static void put(json_t *row, const char *type, int place, double value, const char *unit)
{
    char column[32];
    snprintf(column, sizeof column, "1-%s-%d-1", type, place);
    json_object_set_new(row, column, isnan(value) ? json_string(unit) : json_real(value));
}

static double storey_m(const SimResult *r, int j)
{
    return r->peak_drift_m[j] / r->drift_ratio[j];
}

/* Of all kinds one after the other; r NULL: the units. */
static void put_pelicun(json_t *row, const SimResult *r, double pga_g, int n_floors, int yields)
{
    put(row, "PFA", 0, pga_g, "g");
    for (int j = 0; j < n_floors; j++)
        put(row, "PFA", j + 1, r ? r->peak_acceleration_g[j] : NAN, "g");
    for (int j = 0; j < n_floors; j++)
        put(row, "PID", j + 1, r ? r->drift_ratio[j] : NAN, "unitless");
    for (int j = 0; j < n_floors && yields; j++)
        put(row, "RID", j + 1, r ? fabs(r->residual_drift_m[j]) / storey_m(r, j) : NAN, "unitless");
}

Status demands_write(const Evaluations *e, const char *path, Err *err)
{
    const int is_response = strcmp(basename(path), "response.csv") == 0;
    json_t *table = json_array();
    size_t n = 0;
    for (size_t i = 0; i < e->n_records; i++) {
        const SimResult *r = &e->run[i].result[SCENE_IMPACT];
        if (e->record[i].readable != STATUS_OK)
            continue;
        if (r->outcome != RUN_OK) {
            fprintf(stderr, "%s: not in %s: %s\n", e->record[i].path, path, r->reason);
            continue;
        }
        if (n == 0 && !is_response)
            put_pelicun(json_put(figures_row(table), "=%s", "Units"), NULL, NAN, r->n_floors, r->yields);
        json_t *row = figures_row(table);
        json_object_set_new(row, is_response ? "id" : "", json_integer((json_int_t)(n++) + is_response));
        if (!is_response) {
            put_pelicun(row, r, e->run[i].pga_g, r->n_floors, r->yields);
            continue;
        }
        double height_m = 0;
        put(row, "PFA", 0, GRAVITY * e->run[i].pga_g, "");
        for (int j = 0; j < r->n_floors; j++) {
            put(row, "PFA", j + 1, GRAVITY * r->peak_acceleration_g[j], "");
            put(row, "PFD", j + 1, r->peak_displacement_m[j], "");
            put(row, "PID", j + 1, r->drift_ratio[j], "");
            height_m += storey_m(r, j);
        }
        put(row, "PRD", 1, r->peak_displacement_m[r->n_floors - 1] / height_m, "");
    }
    return rows_write(table, path, err);
}
