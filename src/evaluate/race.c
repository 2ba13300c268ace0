#include "evaluate/race.h"

/* R^2 of a column of y on that of x, as a mean over those whose y differs; 0: none does. */
static double mean_explained(size_t n_designs, size_t n_obj, const double x[], const double y[])
{
    double sum = 0, n_columns = 0;
    for (size_t k = 0; k < n_obj; k++) {
        double n = 0, mean_x = 0, mean_y = 0, xx = 0, xy = 0, yy = 0;
        for (size_t i = k; i < n_designs * n_obj; i += n_obj)
            if (isfinite(x[i]) && isfinite(y[i])) {
                n++;
                mean_x += (x[i] - mean_x) / n;
                mean_y += (y[i] - mean_y) / n;
            }
        for (size_t i = k; i < n_designs * n_obj; i += n_obj)
            if (isfinite(x[i]) && isfinite(y[i])) {
                xx += (x[i] - mean_x) * (x[i] - mean_x);
                xy += (x[i] - mean_x) * (y[i] - mean_y);
                yy += (y[i] - mean_y) * (y[i] - mean_y);
            }
        if (yy > 0) {
            sum += xx > 0 ? xy * xy / (xx * yy) : 0;
            n_columns++;
        }
    }
    return n_columns > 0 ? sum / n_columns : 0;
}

static void swap(size_t order[], size_t i, size_t j)
{
    const size_t was = order[i];
    order[i] = order[j];
    order[j] = was;
}

Status race_order(size_t n_records, size_t n_designs, size_t n_obj, RaceResults *results, void *user, size_t order[],
                  Err *err)
{
    double *y;
    TRY_ROOM(y, 2 * n_designs * n_obj, "results of records", err);
    double *x = y + n_designs * n_obj;
    for (size_t r = 0; r < n_records; r++)
        order[r] = r;
    results(n_records, order, y, user);
    for (size_t n = 0; n < race_first(n_records); n++) {
        size_t best = n;
        double most = -1;
        for (size_t j = n; j < n_records; j++) {
            swap(order, n, j);
            results(n + 1, order, x, user);
            const double share = mean_explained(n_designs, n_obj, x, y);
            swap(order, n, j);
            best = share > most ? j : best;
            most = fmax(most, share);
        }
        swap(order, n, best);
    }
    free(y);
    return STATUS_OK;
}
