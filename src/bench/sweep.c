#include "bench/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double REFERENCE_RTOL = 1e-12;

typedef struct {
    Accuracy accuracy;
    double knob;
} Setting;

static const Setting STEPS_PER_CONTACT[] = {{ACCURACY_COARSE, 0},   {ACCURACY_STANDARD, 0}, {ACCURACY_STANDARD, 2},
                                            {ACCURACY_STANDARD, 4}, {ACCURACY_STANDARD, 8}, {ACCURACY_STANDARD, 16},
                                            {ACCURACY_FINE, 20},    {ACCURACY_FINE, 40},    {ACCURACY_FINE, 0},
                                            {ACCURACY_COARSE, -1}};
static const Setting TOLERANCES[] = {{0, 1e-2}, {0, 1e-3}, {0, 3e-4}, {0, 1e-4}, {0, 3e-5},
                                     {0, 1e-5}, {0, 1e-6}, {0, 1e-7}, {0, 1e-8}, {0, -1}};
static const Setting STEPS[] = {{0, 1e-2}, {0, 5e-3}, {0, 2e-3}, {0, 1e-3}, {0, 5e-4}, {0, 2e-4},
                                {0, 1e-4}, {0, 5e-5}, {0, 2e-5}, {0, 1e-5}, {0, -1}};

static const Setting *settings_of(Engine engine)
{
    switch (engine_entry(engine)->tolerance) {
    case TOLERANCE_STEP:
        return STEPS;
    case TOLERANCE_RELATIVE:
        return TOLERANCES;
    default:
        return STEPS_PER_CONTACT;
    }
}

static SweepRow *next_row(Sweep *s)
{
    if (s->n == s->n_max) {
        const size_t n_max = s->n_max ? 2 * s->n_max : 64;
        SweepRow *rows = realloc(s->rows, n_max * sizeof *rows);
        if (!rows)
            return NULL;
        s->rows = rows;
        s->n_max = n_max;
    }
    return &s->rows[s->n];
}

static void name_knob(const Setting *setting, char text[16])
{
    static const char *const WORDS[] = {"coarse", "standard", "fine"};
    if (setting->knob > 0)
        snprintf(text, 16, "%g", setting->knob);
    else
        snprintf(text, 16, "%s", WORDS[setting->accuracy]);
}

static Status sweep_engine(Sweep *s, const Stage *stage, Engine engine, const Observed *reference, double limit_s,
                           Err *err)
{
    int slow = 0;
    for (const Setting *setting = settings_of(engine); setting->knob >= 0; setting++) {
        SweepRow *row = next_row(s);
        if (!row)
            return fail(err, STATUS_NO_MEMORY, "bench: no memory for another row");
        row->scene = stage->scene;
        row->engine = engine;
        name_knob(setting, row->knob);
        row->accuracy = setting->accuracy;
        row->knob_value = setting->knob;
        TRY(observe(stage, engine, setting->accuracy, setting->knob, &row->seen, err));
        row->error = errors_between(stage, &row->seen, reference);
        s->n++;
        slow += row->seen.seconds > limit_s;
        if (slow > 0 && (row->seen.result.outcome == RUN_OK || slow > 1))
            break;
    }
    return STATUS_OK;
}

/* Two methods that share nothing with CVODE's, and each other only the flow of a free mode; the nearer one counts. */
static const struct {
    Engine engine;
    double knob;
} SECOND[] = {{ENGINE_FAST, 320}, {ENGINE_ETDRK4, 1e-5}};

static Status find_reference(Sweep *s, int scene, const Stage *stage, Observed *reference, FILE *progress, Err *err)
{
    TRY(observe(stage, ENGINE_CVODE, ACCURACY_FINE, REFERENCE_RTOL, reference, err));
    if (reference->result.outcome != RUN_OK)
        return fail(err, STATUS_INTERNAL, "bench: %s: the reference failed: %s", stage->scene->name,
                    reference->result.reason);
    fprintf(progress, "%-11s %.3g s from %.4g s, %ld impacts; cvode at %g agrees with", stage->scene->name,
            stage->duration, stage->start, reference->result.impacts, REFERENCE_RTOL);
    s->agreement[scene] = HUGE_VAL;
    for (size_t k = 0; k < sizeof SECOND / sizeof SECOND[0]; k++) {
        Observed other;
        TRY(observe(stage, SECOND[k].engine, ACCURACY_FINE, SECOND[k].knob, &other, err));
        const Errors e = errors_between(stage, &other, reference);
        if (other.result.outcome == RUN_OK)
            s->agreement[scene] = fmin(s->agreement[scene], fmax(e.objectives, 1e-16));
        fprintf(progress, " %s at %g to %.1e (state %.1e)", engine_entry(SECOND[k].engine)->name, SECOND[k].knob,
                e.objectives, e.state);
    }
    fputc('\n', progress);
    s->impacts[scene] = reference->result.impacts;
    s->duration[scene] = stage->duration;
    return STATUS_OK;
}

Status sweep_scene(Sweep *s, int scene, const Stage *stage, const SweepPlan *plan, FILE *progress, Err *err)
{
    Observed *reference = malloc(sizeof *reference);
    if (!reference)
        return fail(err, STATUS_NO_MEMORY, "bench: out of memory");
    Status status = find_reference(s, scene, stage, reference, progress, err);
    for (int k = 0; k < ENGINE_COUNT && status == STATUS_OK; k++) {
        if (!(plan->engines >> k & 1))
            continue;
        const double start = processor_seconds();
        status = sweep_engine(s, stage, (Engine)k, reference, plan->limit_s, err);
        fprintf(progress, "  %-20s %.1f s\n", engine_entry((Engine)k)->name, processor_seconds() - start);
    }
    free(reference);
    return status;
}

void sweep_free(Sweep *s)
{
    free(s->rows);
    memset(s, 0, sizeof *s);
}

double sweep_floor(const Sweep *s, int scene)
{
    return 10 * s->agreement[scene];
}
