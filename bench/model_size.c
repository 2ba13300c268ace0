#include "bench/model_size.h"

#include <math.h>
#include <string.h>

#include "sim/fast/fast.h"

enum { DESIGNS = 20, ROUNDS = 3 };

static const double NINE_TENTHS = 0.9;

typedef enum { CORE_SPRINGS, CORE_CUT, BUILDING_CUT, N_SERIES } Series;

static const struct {
    const char *name;
    int from, step; /* modes, from all of them downwards */
    int least;
} SERIES[N_SERIES] = {
    {"core modes + springs", 20, -2, 2}, {"core modes cut", 20, -2, 2}, {"building modes cut", 20, -2, 8}};

/* Modes nb..nb+nc-1 become those of the core that were at nb_before. */
static void keep_modes(SimModel *model, int nb, int nc)
{
    const size_t count = (size_t)nc, row = (size_t)model->n_pad;
    const int from = model->nb;
    memmove(model->omega + nb, model->omega + from, count * sizeof(double));
    memmove(model->zeta + nb, model->zeta + from, count * sizeof(double));
    memmove(model->gamma + nb, model->gamma + from, count * sizeof(double));
    memmove(model->R + (size_t)nb * row, model->R + (size_t)from * row, count * row * sizeof(double));
    model->nb = nb;
    model->nc = nc;
    model->m = nb + nc;
}

static Status set_design(BenchCase *bench_case, const SceneOptions *s, int design, Err *err)
{
    bench_irregular_gaps((uint32_t)design, bench_case->building.n, bench_case->gaps);
    return model_set(&bench_case->model, s, &bench_case->building, bench_case->core, bench_case->gaps, err);
}

/* Least processor time [s] of several runs. */
static double run(const BenchCase *bench_case, FastWork *work, const FastTolerances *t, SimResult *r)
{
    const EngineOptions options = {.duration = bench_case->duration};
    double least = HUGE_VAL;
    for (int i = 0; i < ROUNDS; i++) {
        const double start = processor_seconds();
        fast_run(work, &bench_case->model, &bench_case->motion, &options, t, r);
        least = fmin(least, processor_seconds() - start);
    }
    return least;
}

static Status run_size(BenchCase *bench_case, const SceneOptions *s, FastWork *work, Series series,
                       const SimResult wanted[], ModelSizeRow *row, Err *err)
{
    double error[BENCH_OBJECTIVES][DESIGNS], worst[DESIGNS];
    for (int k = 0; k < DESIGNS; k++) {
        FastTolerances t = fast_tolerances(ACCURACY_STANDARD);
        SimResult r;
        double each[BENCH_OBJECTIVES];
        TRY(set_design(bench_case, s, k, err));
        SimModel *model = &bench_case->model;
        if (series == CORE_SPRINGS)
            t.core_modes = row->modes;
        else
            keep_modes(model, series == BUILDING_CUT ? row->modes : model->nb,
                       series == CORE_CUT ? row->modes : model->nc);
        if (series == CORE_CUT)
            t.core_modes = row->modes;
        row->seconds += run(bench_case, work, &t, &r) / DESIGNS;
        result_errors(&r, &wanted[k], each);
        worst[k] = 0;
        for (int i = 0; i < BENCH_OBJECTIVES; i++) {
            error[i][k] = r.outcome == RUN_OK ? each[i] : HUGE_VAL;
            worst[k] = fmax(worst[k], error[i][k]);
        }
    }
    row->error = bench_quantile(DESIGNS, worst, NINE_TENTHS);
    for (int i = 0; i < BENCH_OBJECTIVES; i++)
        row->each[i] = bench_quantile(DESIGNS, error[i], NINE_TENTHS);
    return STATUS_OK;
}

static Status run_all(ModelSize *m, BenchCase *bench_case, const SceneOptions *s, FastWork *work, Err *err)
{
    const FastTolerances fine = fast_tolerances(ACCURACY_FINE);
    SimResult wanted[DESIGNS];
    for (int k = 0; k < DESIGNS; k++) {
        const EngineOptions options = {.duration = bench_case->duration};
        TRY(set_design(bench_case, s, k, err));
        fast_run(work, &bench_case->model, &bench_case->motion, &options, &fine, &wanted[k]);
    }
    for (int i = 0; i < N_SERIES; i++)
        for (int modes = SERIES[i].from; modes >= SERIES[i].least; modes += SERIES[i].step) {
            ModelSizeRow *row = &m->row[m->n++];
            *row = (ModelSizeRow){.series = SERIES[i].name, .modes = modes};
            TRY(run_size(bench_case, s, work, (Series)i, wanted, row, err));
        }
    return STATUS_OK;
}

Status model_size_run(ModelSize *m, BenchCase *bench_case, const SceneOptions *s, Err *err)
{
    FastWork *work;
    *m = (ModelSize){.designs = DESIGNS, .duration = bench_case->duration};
    TRY(fast_create(&work, bench_case->building.n, bench_case->building.model.n, err));
    const Status status = run_all(m, bench_case, s, work, err);
    fast_free(work);
    return status;
}

void model_size_write_markdown(const ModelSize *m, FILE *out)
{
    if (m->n == 0)
        return;
    fprintf(
        out,
        "\n## Size of the model\n\n`fast` at `standard`, %d designs of irregular gaps, %.3g s, errors against `fine` "
        "with all modes: not exceeded\nby nine designs of ten. Springs: modes that are not followed act as springs in "
        "every contact; cut: they are\nleft out. Modes of the core come in vectors of eight, so that time has "
        "steps.\n\n"
        "| series | modes | ms | largest error | J1 | J2 | J3 | mode 1 | modes 5 to 10 | core |\n"
        "|---|---|---|---|---|---|---|---|---|---|\n",
        m->designs, m->duration);
    for (int i = 0; i < m->n; i++) {
        const ModelSizeRow *row = &m->row[i];
        fprintf(out, "| %s | %d | %.2f | %.1e |", row->series, row->modes, 1e3 * row->seconds, row->error);
        for (int k = 0; k < BENCH_OBJECTIVES; k++)
            fprintf(out, " %.0e |", row->each[k]);
        fputc('\n', out);
    }
}

void model_size_write_csv(const ModelSize *m, FILE *out)
{
    for (int i = 0; i < m->n; i++) {
        const ModelSizeRow *row = &m->row[i];
        fprintf(out, "model-size,%s,%d,%.6g,%.6g", row->series, row->modes, row->seconds, row->error);
        for (int k = 0; k < BENCH_OBJECTIVES; k++)
            fprintf(out, ",%.6g", row->each[k]);
        fprintf(out, ",,,,,,,,,,ok,\"\"\n");
    }
}
