#include "cmd/sensitivities.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cmd/designs.h"
#include "cmd/show.h"
#include "analysis/sensitivity.h"
#include "store/output.h"

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

static Status write_csv(const char *path, size_t n, const Sensitivity list[], Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    fprintf(o.stream, "parameter,value,step");
    for (int k = 0; k < N_MEASURES; k++)
        fprintf(o.stream, ",%s_slope,%s_error", measure(k)->name, measure(k)->name);
    for (size_t i = 0; i < n; i++) {
        fprintf(o.stream, "\n%s", list[i].name);
        print_cells(o.stream, 2, (double[]){list[i].value, list[i].step});
        for (int k = 0; k < N_MEASURES; k++)
            print_cells(o.stream, 2, (double[]){list[i].slope[k], list[i].error[k]});
    }
    fputc('\n', o.stream);
    return output_close(&o, err);
}

/* Change of J1, J2, J3 for one step of the parameter. */
static void print_table(size_t n, const Sensitivity list[])
{
    static const MeasureId SHOWN[] = {MEASURE_J1, MEASURE_J2, MEASURE_J3};
    printf("change for one step\n%-28s %10s %10s", "parameter", "value", "step");
    for (size_t k = 0; k < sizeof SHOWN / sizeof SHOWN[0]; k++)
        printf(" %11s %9s ", measure(SHOWN[k])->name, "+-");
    putchar('\n');
    for (size_t i = 0; i < n; i++) {
        const Sensitivity *s = &list[i];
        printf("%-28s %10.4g %10.3g", s->name, s->value, s->step);
        for (size_t k = 0; k < sizeof SHOWN / sizeof SHOWN[0]; k++) {
            const double change = s->slope[SHOWN[k]] * s->step, error = s->error[SHOWN[k]] * s->step;
            printf(" %+11.3g %9.2g%c", change, error, fabs(change) > 2 * error ? '*' : ' ');
        }
        putchar('\n');
    }
    puts("*: more than twice its error, which is that of the replicates and of halving the step");
}

static Status show(const Args *args, size_t n, const Sensitivity list[], Err *err)
{
    json_t *all;
    if (args_has(args, "--csv"))
        TRY(write_csv(args_value(args, "--csv"), n, list, err));
    if (!args_has(args, "--json")) {
        if (!args_has(args, "--csv"))
            print_table(n, list);
        return STATUS_OK;
    }
    all = json_array();
    for (size_t i = 0; i < n; i++)
        json_array_append_new(all, describe(&list[i]));
    return show_json(all, err);
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
