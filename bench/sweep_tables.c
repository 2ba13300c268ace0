#include <math.h>
#include <string.h>

#include "bench/sweep.h"
#include "evaluate/measures.h"
#include "store/output.h"

/* An energy-balance error above BALANCE_OPEN is a failure that the engine itself shows; an error above WRONG with a
 * better balance is a wrong answer in silence. */
static const double BALANCE_OPEN = 1e-3, WRONG = 0.1;

int sweep_row_failed(const SweepRow *row)
{
    return row->seen.result.outcome != RUN_OK || !isfinite(row->error.objectives);
}

int sweep_silently_wrong(const SweepRow *row)
{
    return !sweep_row_failed(row) && row->error.objectives > WRONG &&
           row->seen.result.energy_balance_error < BALANCE_OPEN;
}

static int kind_index(const BenchKind *kind)
{
    return (int)(kind - bench_kind(0));
}

static void put(FILE *out, double value)
{
    fputc(',', out);
    if (isfinite(value))
        fprintf(out, "%.6g", value);
}

void sweep_write_csv(const Sweep *s, FILE *out)
{
    fprintf(out, "case,engine,tolerance,seconds,error_objectives");
    for (int k = 0; k < BENCH_OBJECTIVES; k++)
        fprintf(out, ",error_%s", BENCH_OBJECTIVE_NAMES[k]);
    fprintf(out,
            ",error_state,error_first_s,error_first_speed,residual,floor,noise,impacts,steps,force_evaluations,outcome,"
            "reason\n");
    for (size_t i = 0; i < s->n; i++) {
        const SweepRow *row = &s->rows[i];
        const SimResult *r = &row->seen.result;
        const int failed = sweep_row_failed(row);
        fprintf(out, "%s,%s,%s", row->kind->name, bench_engine(row->engine)->name, row->tolerance);
        put(out, row->seen.seconds);
        put(out, failed ? NAN : row->error.objectives);
        for (int k = 0; k < BENCH_OBJECTIVES; k++)
            put(out, failed ? NAN : row->error.each[k]);
        put(out, failed ? NAN : row->error.state);
        put(out, failed ? NAN : row->error.first_s);
        put(out, failed ? NAN : row->error.first_speed);
        put(out, failed ? NAN : r->energy_balance_error);
        put(out, sweep_floor(s, kind_index(row->kind)));
        put(out, s->noise > 0 ? s->noise : NAN);
        fprintf(out, ",%ld,%ld,%ld,%s,\"%s\"\n", r->impacts, r->steps, r->force_evaluations,
                outcome_word(measure_outcome(r->outcome)), r->reason);
    }
}

/* The fastest row of an engine on a case whose error is at most `error`; NULL: there is none. */
static const SweepRow *fastest(const Sweep *s, int kind, int engine, double error)
{
    const SweepRow *best = NULL;
    for (size_t i = 0; i < s->n; i++) {
        const SweepRow *row = &s->rows[i];
        if (row->kind == bench_kind(kind) && row->engine == engine && !sweep_row_failed(row) &&
            row->error.objectives <= error && (!best || row->seen.seconds < best->seen.seconds))
            best = row;
    }
    return best;
}

static int was_run(const Sweep *s, int kind, int engine)
{
    for (size_t i = 0; i < s->n; i++)
        if (s->rows[i].kind == bench_kind(kind) && s->rows[i].engine == engine)
            return 1;
    return 0;
}

static void write_cell(const SweepRow *row, const SweepRow *fast, FILE *out)
{
    if (!row) {
        fprintf(out, " not reached | | |");
        return;
    }
    fprintf(out, " %s | %.3g |", row->tolerance, 1e3 * row->seen.seconds);
    if (fast)
        fprintf(out, " %.3g |", row->seen.seconds / fast->seen.seconds);
    else
        fprintf(out, " |");
}

static void write_case(const Sweep *s, int kind, FILE *out)
{
    static const double LEVELS[] = {1e-2, 1e-3};
    fprintf(out, "\n## %s: %s\n\n", bench_kind(kind)->name, bench_kind(kind)->what);
    fprintf(out, "%.3g s, %ld impacts. The two references agree to %.1e; smaller errors than %.1e are not shown.\n\n",
            s->duration[kind], s->impacts[kind], s->agreement[kind], sweep_floor(s, kind));
    fprintf(out, "| engine | tolerance at error 1e-2 | ms | x fast | tolerance at error 1e-3 | ms | x fast |\n"
                 "|---|---|---|---|---|---|---|\n");
    for (int k = 0; k < BENCH_ENGINES; k++) {
        if (!was_run(s, kind, k))
            continue;
        fprintf(out, "| %s |", bench_engine(k)->name);
        for (int l = 0; l < 2; l++)
            write_cell(fastest(s, kind, k, LEVELS[l]), fastest(s, kind, ENGINE_FAST, LEVELS[l]), out);
        fputc('\n', out);
    }
}

static void write_failures(const Sweep *s, FILE *out)
{
    int n = 0;
    fprintf(out,
            "\n## What failed\n\nA run that does not finish, whose energy-balance error is above %g of the input,"
            "\nor that is off by more than %g although its energy balance closes (silently wrong).\n\n"
            "| case | engine | tolerance | how |\n|---|---|---|---|\n",
            BALANCE_OPEN, WRONG);
    for (size_t i = 0; i < s->n; i++) {
        const SweepRow *row = &s->rows[i];
        const SimResult *r = &row->seen.result;
        const int open = !sweep_row_failed(row) && r->energy_balance_error >= BALANCE_OPEN;
        if (!sweep_row_failed(row) && !sweep_silently_wrong(row) && !open)
            continue;
        fprintf(out, "| %s | %s | %s | ", row->kind->name, bench_engine(row->engine)->name, row->tolerance);
        if (sweep_row_failed(row))
            fprintf(out, "%s: %s |\n", outcome_word(measure_outcome(r->outcome)), r->reason);
        else if (open)
            fprintf(out, "energy-balance error %.2g, error %.2g |\n", r->energy_balance_error, row->error.objectives);
        else
            fprintf(out, "silently wrong: error %.2g, energy-balance error %.1e |\n", row->error.objectives,
                    r->energy_balance_error);
        n++;
    }
    if (n == 0)
        fprintf(out, "| none | | | |\n");
}

void sweep_write_markdown(const Sweep *s, const Motion *motion, FILE *out)
{
    const char *folder = strrchr(motion->name, '/');
    fprintf(
        out,
        "# Speed against accuracy\n\nWritten by `make chart`; do not edit. Motion: %s. One thread, processor time.\n"
        "Error: the largest relative error of J1, J2, J3 and of the shares of mode 1, modes 5 to 10 and the core\n"
        "(a share below 0.1 %% counts as 0.1 %%). x fast: time over that of `fast` at the same error.\n",
        folder ? folder + 1 : motion->name);
    if (s->noise > 0)
        fprintf(out,
                "Dashed: %.2g, the largest spread of any objective of nine designs over the whole motion, gaps changed "
                "by 1e-8.\n",
                s->noise);
    fprintf(out, "\n![speed against accuracy](chart.svg)\n\n| engine | what it is | tolerance |\n|---|---|---|\n");
    static const char *const KINDS[] = {"step [s]", "relative tolerance", "steps per contact"};
    for (int k = 0; k < BENCH_ENGINES; k++)
        fprintf(out, "| %s | %s | %s |\n", bench_engine(k)->name, bench_engine(k)->words,
                KINDS[bench_engine(k)->tolerance]);
    for (int k = 0; k < N_BENCH_KINDS; k++)
        if (s->agreement[k] > 0)
            write_case(s, k, out);
    write_failures(s, out);
}
