#include "bench/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "evaluate/measures.h"

static const double REFERENCE_RTOL = 1e-12;

typedef struct {
    Accuracy accuracy;
    double tolerance;
} Setting;

static const Setting STEPS_PER_CONTACT[] = {{ACCURACY_COARSE, 0},   {ACCURACY_STANDARD, 0}, {ACCURACY_STANDARD, 2},
                                            {ACCURACY_STANDARD, 4}, {ACCURACY_STANDARD, 8}, {ACCURACY_STANDARD, 16},
                                            {ACCURACY_FINE, 20},    {ACCURACY_FINE, 40},    {ACCURACY_FINE, 0},
                                            {ACCURACY_COARSE, -1}};
static const Setting TOLERANCES[] = {{0, 1e-2}, {0, 1e-3}, {0, 3e-4}, {0, 1e-4}, {0, 3e-5},
                                     {0, 1e-5}, {0, 1e-6}, {0, 1e-7}, {0, 1e-8}, {0, -1}};
static const Setting STEPS[] = {{0, 1e-2}, {0, 5e-3}, {0, 2e-3}, {0, 1e-3}, {0, 5e-4}, {0, 2e-4},
                                {0, 1e-4}, {0, 5e-5}, {0, 2e-5}, {0, 1e-5}, {0, -1}};

static const Setting *settings_of(int engine)
{
    switch (bench_engine(engine)->tolerance) {
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

static void name_tolerance(const Setting *setting, char text[16])
{
    static const char *const WORDS[] = {"coarse", "standard", "fine"};
    if (setting->tolerance > 0)
        snprintf(text, 16, "%g", setting->tolerance);
    else
        snprintf(text, 16, "%s", WORDS[setting->accuracy]);
}

static Status sweep_engine(Sweep *s, const BenchCase *bench_case, int engine, const TimedRun *reference, double limit_s,
                           Err *err)
{
    int slow = 0;
    for (const Setting *setting = settings_of(engine); setting->tolerance >= 0; setting++) {
        SweepRow *row = next_row(s);
        if (!row)
            return fail(err, STATUS_NO_MEMORY, "bench: no memory for another row");
        row->kind = bench_case->kind;
        row->engine = engine;
        name_tolerance(setting, row->tolerance);
        row->accuracy = setting->accuracy;
        row->tolerance_value = setting->tolerance;
        TRY(timed_run(bench_case, engine, setting->accuracy, setting->tolerance, &row->seen, err));
        row->error = run_errors(bench_case, &row->seen, reference);
        s->n++;
        slow += row->seen.seconds > limit_s;
        if (slow > 0 && (row->seen.result.outcome == RUN_OK || slow > 1))
            break;
    }
    return STATUS_OK;
}

/* Two methods that share nothing with CVODE's, and each other only the flow of a free mode; the nearer one counts. */
static const struct {
    int engine;
    double tolerance;
} SECOND[] = {{ENGINE_FAST, 320}, {ENGINE_ETDRK4, 1e-5}};

static Status find_reference(Sweep *s, int kind, const BenchCase *bench_case, TimedRun *reference, FILE *progress,
                             Err *err)
{
    TRY(timed_run(bench_case, ENGINE_CVODE, ACCURACY_FINE, REFERENCE_RTOL, reference, err));
    if (reference->result.outcome != RUN_OK)
        return fail(err, STATUS_INTERNAL, "bench: %s: the reference failed: %s", bench_case->kind->name,
                    reference->result.reason);
    fprintf(progress, "%-11s %.3g s from %.4g s, %ld impacts; cvode at %g agrees with", bench_case->kind->name,
            bench_case->duration, bench_case->start, reference->result.impacts, REFERENCE_RTOL);
    s->agreement[kind] = HUGE_VAL;
    for (size_t k = 0; k < sizeof SECOND / sizeof SECOND[0]; k++) {
        TimedRun other;
        TRY(timed_run(bench_case, SECOND[k].engine, ACCURACY_FINE, SECOND[k].tolerance, &other, err));
        const RunErrors e = run_errors(bench_case, &other, reference);
        if (other.result.outcome == RUN_OK)
            s->agreement[kind] = fmin(s->agreement[kind], fmax(e.objectives, 1e-16));
        fprintf(progress, " %s at %g to %.1e (state %.1e)", bench_engine(SECOND[k].engine)->name, SECOND[k].tolerance,
                e.objectives, e.state);
    }
    fputc('\n', progress);
    return STATUS_OK;
}

Status sweep_run(Sweep *s, int kind, const BenchCase *bench_case, const SweepPlan *plan, FILE *progress, Err *err)
{
    TimedRun *reference = malloc(sizeof *reference);
    if (!reference)
        return fail(err, STATUS_NO_MEMORY, "bench: out of memory");
    Status status = find_reference(s, kind, bench_case, reference, progress, err);
    for (int k = 0; k < BENCH_ENGINES && status == STATUS_OK; k++) {
        if (!(plan->engines >> k & 1))
            continue;
        const double start = processor_seconds();
        status = sweep_engine(s, bench_case, k, reference, plan->limit_s, err);
        fprintf(progress, "  %-20s %.1f s\n", bench_engine(k)->name, processor_seconds() - start);
    }
    free(reference);
    return status;
}

void sweep_free(Sweep *s)
{
    free(s->rows);
    memset(s, 0, sizeof *s);
}

double sweep_floor(const Sweep *s, int kind)
{
    return 10 * s->agreement[kind];
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

int sweep_row_failed(const SweepRow *row)
{
    return row->seen.result.outcome != RUN_OK || !isfinite(row->error.objectives);
}

static void put(FILE *out, double value)
{
    fputc(',', out);
    if (isfinite(value))
        fprintf(out, "%.6g", value);
}

static void write_row(const Sweep *s, const SweepRow *row, FILE *out)
{
    const SimResult *r = &row->seen.result;
    const int ok = !sweep_row_failed(row);
    fprintf(out, "%s,%s,%s", row->kind->name, bench_engine(row->engine)->name, row->tolerance);
    put(out, row->seen.seconds);
    put(out, ok ? row->error.objectives : NAN);
    for (int k = 0; k < BENCH_OBJECTIVES; k++)
        put(out, ok ? row->error.each[k] : NAN);
    put(out, ok ? row->error.state : NAN);
    put(out, ok ? row->error.first_s : NAN);
    put(out, ok ? row->error.first_speed : NAN);
    put(out, ok ? r->energy_balance_error : NAN);
    put(out, sweep_floor(s, (int)(row->kind - bench_kind(0))));
    fprintf(out, ",%ld,%ld,%ld,%s,\"%s\"\n", r->impacts, r->steps, r->force_evaluations,
            outcome_word((Outcome)r->outcome), r->reason);
}

void sweep_write(const Sweep *s, FILE *out)
{
    fprintf(out, "case,engine,tolerance,seconds,error_objectives");
    for (int k = 0; k < BENCH_OBJECTIVES; k++)
        fprintf(out, ",error_%s", BENCH_OBJECTIVE_NAMES[k]);
    fprintf(out, ",error_state,error_first_s,error_first_speed,residual,floor,impacts,steps,force_evaluations,"
                 "outcome,reason\n");
    for (size_t i = 0; i < s->n; i++)
        write_row(s, &s->rows[i], out);
}
