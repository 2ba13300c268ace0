#include "cmd/sensitivities.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd/designs.h"
#include "cmd/show.h"
#include "analysis/sensitivity.h"

static json_t *describe(const Sensitivity *s)
{
    json_t *slopes = json_object();
    for (int k = 0; k < N_MEASURES; k++)
        if (isfinite(s->slope[k]))
            json_object_set_new(
                slopes, measure(k)->name,
                json_pack("{s:o, s:o}", "slope", json_number(s->slope[k]), "error", json_number(s->error[k])));
    return json_pack("{s:s, s:f, s:f, s:o}", "parameter", s->name, "value", s->value, "step", s->step, "slopes",
                     slopes);
}

static json_t *rows_of(size_t n, const Sensitivity list[])
{
    json_t *table = json_array();
    for (size_t i = 0; i < n; i++) {
        json_t *row = figures_row(table);
        json_object_set_new(row, "parameter", json_string(list[i].name));
        json_object_set_new(row, "value", json_number(list[i].value));
        json_object_set_new(row, "step", json_number(list[i].step));
        put_measures(row, "_slope", list[i].slope, "_error", list[i].error);
    }
    return table;
}

/* Change of J1, J2, J3 for one step of the parameter. */
static void print_table(size_t n, const Sensitivity list[])
{
    static const MeasureId SHOWN[] = {MEASURE_J1, MEASURE_J2, MEASURE_J3};
    json_t *table = json_array();
    for (size_t i = 0; i < n; i++) {
        const Sensitivity *s = &list[i];
        json_t *row = figures_row(table);
        json_object_set_new(row, "parameter", json_string(s->name));
        json_object_set_new(row, "value", json_number(s->value));
        json_object_set_new(row, "step", json_number(s->step));
        for (size_t k = 0; k < sizeof SHOWN / sizeof SHOWN[0]; k++)
            figures_put(row, measure(SHOWN[k])->name, s->slope[SHOWN[k]] * s->step, s->error[SHOWN[k]] * s->step, NAN);
    }
    puts("change for one step, with the error of the replicates and of halving the step");
    figures_print(table);
}

static Status show(const Args *args, size_t n, const Sensitivity list[], Err *err)
{
    json_t *all = json_array();
    if (args_has(args, "--csv"))
        TRY(figures_csv(rows_of(n, list), args_value(args, "--csv"), err));
    for (size_t i = 0; i < n; i++)
        json_array_append_new(all, describe(&list[i]));
    if (args_has(args, "--json"))
        return show_json(all, err);
    json_decref(all);
    if (!args_has(args, "--csv"))
        print_table(n, list);
    return STATUS_OK;
}

/* For design_free. */
static Status take_design(const Args *args, const Settings *s, Designs *d, Err *err)
{
    DesignSpace space;
    const char *word = args_value(args, "--design");
    if (!word || strcmp(word, "none") == 0 || args_has(args, "--rigid"))
        return fail(err, STATUS_USAGE, "--sensitivity needs --design with gaps, neither none nor --rigid");
    TRY(tower_space(s, &space, err));
    return designs_take_one(d, word, &space, err);
}

Status show_sensitivities(const Args *args, const Settings *s, size_t n_replicates, Err *err)
{
    Designs d = {0};
    Sensitivity *list;
    size_t n;
    TRY(take_design(args, s, &d, err));
    const Status status = sensitivity_find(s, d.x, n_replicates, &list, &n, err);
    design_free(&d);
    TRY(status);
    const Status shown = show(args, n, list, err);
    free(list);
    return shown;
}
