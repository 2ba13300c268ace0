#include "cmd/time_files.h"

#include "base/units.h"
#include "cmd/designs.h"
#include "sim/samples.h"
#include "motion/spectrum.h"
#include "sim/floor_record.h"
#include "store/output.h"

/* Writes what a worker has of design i, before the first one the header. */
typedef Status (*WriteFn)(const TimeJob *job, SimWorker *worker, size_t i, FILE *out, Err *err);

static Status run_again(const TimeJob *job, SimWorker *worker, size_t i, Err *err)
{
    SimResult result;
    return sim_run(worker, job->tasks[i].kind, job->tasks[i].x, &result, err);
}

/* The name of each floor's column, by a format. */
static void print_floors(FILE *out, const char *format, int n_floors)
{
    for (int j = 1; j <= n_floors; j++) {
        char name[32];
        snprintf(name, sizeof name, format, j);
        fputs(name, out);
    }
}

/* Of designs by number. A run may be repeated with shorter steps, or walls that bend: only the last attempt counts. */
typedef struct {
    const SimWorker *worker;
    FILE *out;
    long design;
    int n_floors, attempt, wanted;
} Rows;

static Rows rows_of(const TimeJob *job, const SimWorker *worker, size_t i, FILE *out)
{
    const long design = design_number(job->designs, i);
    return (Rows){.worker = worker, .out = out, .design = design, .n_floors = scene_n_floors(job->scene)};
}

/* The first time attempts are counted: the second one writes the last of them. */
static Status write_last(const TimeJob *job, SimWorker *worker, size_t i, Rows *r, Err *err)
{
    TRY(run_again(job, worker, i, err));
    r->wanted = r->attempt;
    r->attempt = 0;
    return run_again(job, worker, i, err);
}

/* -- contacts one by one ------------------------------------------------------------------------------------------- */

static void add_contact(const SimContact *c, void *user)
{
    Rows *r = user;
    r->attempt += !c; /* a run begins */
    if (!c || r->attempt != r->wanted)
        return;
    fprintf(r->out, "%ld,%d,%d,%d", r->design, c->floor + 1, c->side, c->open);
    print_cells(
        r->out, 8,
        (const double[]){c->t, c->duration, c->approach, c->rebound, c->force, c->indentation, c->impulse, c->lost});
    fputc('\n', r->out);
}

static Status write_contacts(const TimeJob *job, SimWorker *worker, size_t i, FILE *out, Err *err)
{
    Rows rows = rows_of(job, worker, i, out);
    if (i == 0)
        fputs("design,floor,side,open,t_s,duration_s,approach_m_s,rebound_m_s,force_n,indentation_m,impulse_ns,"
              "lost_j\n",
              out);
    sim_worker_contacts(worker, add_contact, &rows);
    return write_last(job, worker, i, &rows, err);
}

/* -- histories ----------------------------------------------------------------------------------------------------- */

static void add_sample(const SimSample *s, void *user)
{
    Rows *r = user;
    double row[SAMPLE_FIXED + SAMPLE_PARTS * FLOORS_MAX];
    r->attempt += s->t == 0;
    if (r->attempt != r->wanted)
        return;
    sample_row(r->worker, s, (size_t)r->n_floors, row);
    fprintf(r->out, "%ld", r->design);
    print_cells(r->out, SAMPLE_FIXED + SAMPLE_PARTS * (size_t)r->n_floors, row);
    fputc('\n', r->out);
}

static Status write_history(const TimeJob *job, SimWorker *worker, size_t i, FILE *out, Err *err)
{
    static const char *const OF_FLOOR[] = {",floor_%02d_m", ",floor_%02d_m_s", ",drift_%02d_m",  ",accel_%02d_g",
                                           ",core_%02d_m",  ",core_%02d_m_s",  ",contact_%02d_n"};
    Rows rows = rows_of(job, worker, i, out);
    if (i == 0) {
        fputs("design,t_s,ground_g", out);
        for (size_t k = 0; k < N_OF(OF_FLOOR); k++)
            print_floors(out, OF_FLOOR[k], rows.n_floors);
        fputs(",kinetic_j,strain_j,damped_building_j,core_j,damped_core_j,contacts_j,input_j\n", out);
    }
    sim_worker_sample(worker, job->every_s, add_sample, &rows);
    return write_last(job, worker, i, &rows, err);
}

/* -- floor spectra ------------------------------------------------------------------------------------------------- */

enum { N_PERIODS = 91 };
static const double DAMPING = 0.05, SHORTEST_S = 0.02, LONGEST_S = 10, SAMPLES_S = 1e-3;

typedef struct {
    const SimWorker *worker;
    FloorRecord *record;
} FloorSamples;

static void take_floors(const SimSample *s, void *user)
{
    const FloorSamples *floors = user;
    if (s->t == 0)
        floor_record_start(floors->record, s->spacing);
    double *u = floor_record_add(floors->record, s->ground);
    if (u)
        sim_worker_floors(floors->worker, s, u);
}

/* Of the ground, then of every floor, from the accelerations that were taken. */
static Status print_spectra(const TimeJob *job, FloorRecord *record, long design, FILE *out, Err *err)
{
    const double *rows;
    size_t n, width, n_floors = (size_t)scene_n_floors(job->scene);
    double T[N_PERIODS], psa[FLOORS_MAX + 1][N_PERIODS];
    TRY(floor_record_accelerations(record, &rows, &n, &width, err));
    Motion floor = {.n = n, .dt_s = floor_record_step(record), .accel = malloc((n + 1) * sizeof *floor.accel)};
    if (!floor.accel)
        return fail(err, STATUS_NO_MEMORY, "--floor-spectra: no memory for %zu samples", n);
    for (int k = 0; k < N_PERIODS; k++)
        T[k] = SHORTEST_S * pow(LONGEST_S / SHORTEST_S, (double)k / (N_PERIODS - 1));
    spectrum_psa(job->motion, DAMPING, N_PERIODS, T, psa[0]);
    for (size_t j = 0; j < n_floors; j++) {
        for (size_t i = 0; i < n; i++)
            floor.accel[i] = rows[i * width + j];
        spectrum_psa(&floor, DAMPING, N_PERIODS, T, psa[j + 1]);
    }
    free(floor.accel);
    for (size_t i = 0; i < N_PERIODS; i++) {
        fprintf(out, "%ld", design);
        print_cells(out, 1, &T[i]);
        for (size_t j = 0; j <= n_floors; j++)
            print_cells(out, 1, &(double){psa[j][i] / GRAVITY});
        fputc('\n', out);
    }
    return STATUS_OK;
}

static Status write_spectra(const TimeJob *job, SimWorker *worker, size_t i, FILE *out, Err *err)
{
    FloorSamples floors = {.worker = worker};
    if (i == 0) {
        fputs("design,period_s,ground_psa_g", out);
        print_floors(out, ",floor_%02d_psa_g", scene_n_floors(job->scene));
        fputc('\n', out);
    }
    TRY(floor_record_create(&floors.record, scene_n_floors(job->scene), err));
    sim_worker_sample(worker, SAMPLES_S, take_floors, &floors);
    Status status = run_again(job, worker, i, err);
    THEN(status, print_spectra(job, floors.record, design_number(job->designs, i), out, err));
    floor_record_free(floors.record);
    return status;
}

/* ------------------------------------------------------------------------------------------------------------------ */

Status time_file_write(const TimeJob *job, TimeFile which, const char *path, Err *err)
{
    static const WriteFn WRITE[] = {write_contacts, write_history, write_spectra};
    Output o;
    SimWorker *worker;
    TRY(output_open(&o, path, err));
    Status status = sim_worker_create(&worker, job->scene, err);
    if (status == STATUS_OK) {
        for (size_t i = 0; i < job->n && status == STATUS_OK; i++)
            status = WRITE[which](job, worker, i, o.stream, err);
        sim_worker_free(worker);
    }
    return output_end(&o, status, err);
}
