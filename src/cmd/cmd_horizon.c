#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/show.h"
#include "analysis/horizon.h"
#include "evaluate/tower.h"
#include "settings/options.h"

enum { REPLICATES = 16 };
static const double CHANGE = 1e-12; /* of the gaps, between the two runs that are compared */

static Status find(const Problem *p, const double x[], Horizon *h, ReplicateSummary *r, SimResult *shown, Err *err)
{
    TRY(horizon_find(tower_record(tower_of(p), 0), x, CHANGE, h, err));
    return tower_replicate(p, 1, x, shown, r, err);
}

static Status print_json(const Horizon *h, const ReplicateSummary *r, Err *err)
{
    json_t *o = json_object();
    json_object_set_new(o, "end_s", json_number(h->end_s));
    json_object_set_new(o, "distance", json_numbers(HORIZON_LEVELS, HORIZON_LEVEL));
    json_object_set_new(o, "reached_s", json_numbers(HORIZON_LEVELS, h->reached_s));
    json_object_set_new(o, "distance_at_end", json_number(h->distance_at_end));
    json_object_set_new(o, "replicates", json_replicates(r));
    return show_json(o, err);
}

static void print_table(const Scenario *w, const MeasureOrder *order, const Horizon *h, const ReplicateSummary *r)
{
    show_motion(stdout, &w->motion, w->options.sim.duration_s);
    printf("\ntwo runs whose gaps differ by %g of themselves are apart by\n", CHANGE);
    for (int i = 0; i < HORIZON_LEVELS; i++)
        if (isnan(h->reached_s[i]))
            printf("  %-8g never (the run ends at %.4g s)\n", HORIZON_LEVEL[i], h->end_s);
        else
            printf("  %-8g after %.4g s\n", HORIZON_LEVEL[i], h->reached_s[i]);
    printf("distance: root of energy of the difference over largest energy so far; at the end %.2g\n\n",
           h->distance_at_end);
    show_result_names("", order);
    show_replicates(0, order, r);
}

static Status answer(const Args *args, const Problem *p, const double x[], Err *err)
{
    Horizon h;
    ReplicateSummary r;
    SimResult shown;
    TRY(find(p, x, &h, &r, &shown, err));
    if (args_has(args, "--json"))
        return print_json(&h, &r, err);
    print_table(tower_record(tower_of(p), 0), tower_measures(tower_of(p)), &h, &r);
    return STATUS_OK;
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    Problem p;
    Designs d;
    const char *path = args_value(args, "--design");
    if (!path)
        return fail(err, STATUS_USAGE, "--design FILE is missing");
    TRY(args_settings(args, &s, NULL, NULL, err));
    if (s.sim.engine != ENGINE_FAST)
        return fail(err, STATUS_USAGE, "horizon: only the engine fast shows its states; leave sim.engine as it is");
    s.sim.replicates = REPLICATES;
    s.sim.gap_tolerance_m = 0; /* chaos alone */
    s.uncertain = (UncertainOptions){0};
    TRY(tower_open(&p, &s, TOWER_AS_SET, SIZE_MAX, err));
    Status status = designs_take_one(&d, path, tower_design(tower_of(&p)), err);
    if (status == STATUS_OK) {
        status = answer(args, &p, d.x, err);
        design_free(&d);
    }
    problem_close(&p);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--design", "FILE", NULL, 0, DESIGN_WORDS}, OPTIONS_MOTION, OPTION_DURATION, OPTION_JSON, OPTION_SET, OPTION_END,
};

const Command CMD_HORIZON = {
    .name = "horizon",
    .reads = READS_SCENE,
    .unread = "sim.replicates sim.gap_tolerance_m uncertain",
    .operand = "CONFIG",
    .summary = "predictability horizon: the time until perturbed runs diverge; standard deviation of every result",
    .example = "imtet horizon configs/quick.ini --design my-design.csv",
    .details =
        "Impacts magnify differences: two runs that differ in the last digit part ways after some hundreds of them.\n"
        "Before the predictability horizon results can be compared digit by digit, after it only by mean and spread.",
    .options = OPTIONS,
    .run = run,
};
