#include "cmd/time_files.h"

#include "base/units.h"
#include "cmd/designs.h"
#include "sim/samples.h"
#include "motion/spectrum.h"
#include "sim/floor_record.h"
#include "store/output.h"

/* Writes what a worker has of design i. */
typedef Status (*WriteFn)(const TimeJob *job, SimWorker *worker, size_t i, FILE *out, Err *err);

static Status write_all(const TimeJob *job, const char *path, void (*write_header)(FILE *out, int n_floors),
                        WriteFn write, Err *err)
{
    Output o;
    SimWorker *worker;
    TRY(output_open(&o, path, err));
    Status status = sim_worker_create(&worker, job->scene, err);
    if (status == STATUS_OK) {
        write_header(o.stream, scene_n_floors(job->scene));
        for (size_t i = 0; i < job->n && status == STATUS_OK; i++)
            status = write(job, worker, i, o.stream, err);
        sim_worker_free(worker);
    }
    return output_end(&o, status, err);
}

static Status run_again(const TimeJob *job, SimWorker *worker, size_t i, Err *err)
{
    SimResult result;
    return sim_run(worker, job->tasks[i].kind, job->tasks[i].x, &result, err);
}

/* -- contacts one by one ------------------------------------------------------------------------------------------- */

/* Of designs by number; a run may be repeated with shorter steps: only the last attempt counts. */
typedef struct {
    FILE *out;
    long design;
    int attempt, wanted;
} ContactRows;

static void add_contact(const SimContact *c, void *user)
{
    ContactRows *r = user;
    r->attempt += !c; /* a run begins */
    if (!c || r->attempt != r->wanted)
        return;
    fprintf(r->out, "%ld,%d,%d,%d", r->design, c->floor + 1, c->side, c->open);
    print_cells(
        r->out, 8,
        (const double[]){c->t, c->duration, c->approach, c->rebound, c->force, c->indentation, c->impulse, c->lost});
    fputc('\n', r->out);
}

static void write_contacts_header(FILE *out, int n_floors)
{
    (void)n_floors;
    fprintf(out,
            "design,floor,side,open,t_s,duration_s,approach_m_s,rebound_m_s,force_n,indentation_m,impulse_ns,lost_j\n");
}

static Status write_contacts_of(const TimeJob *job, SimWorker *worker, size_t i, FILE *out, Err *err)
{
    ContactRows rows = {.out = out, .design = design_number(job->designs, i), .wanted = job->results[i].repeated + 1};
    sim_worker_contacts(worker, add_contact, &rows);
    return run_again(job, worker, i, err);
}

Status write_contacts(const TimeJob *job, const char *path, Err *err)
{
    return write_all(job, path, write_contacts_header, write_contacts_of, err);
}

/* -- histories ----------------------------------------------------------------------------------------------------- */

typedef struct {
    const SimWorker *worker;
    FILE *out;
    long design;
    int n_floors, attempt, wanted;
} HistoryRows;

static void write_history_header(FILE *out, int n_floors)
{
    static const char *const OF_FLOOR[] = {"floor_%02d_m", "floor_%02d_m_s", "drift_%02d_m",  "accel_%02d_g",
                                           "core_%02d_m",  "core_%02d_m_s",  "contact_%02d_n"};
    fputs("design,t_s,ground_g", out);
    for (size_t k = 0; k < N_OF(OF_FLOOR); k++)
        for (int j = 1; j <= n_floors; j++) {
            char name[32];
            snprintf(name, sizeof name, OF_FLOOR[k], j);
            fprintf(out, ",%s", name);
        }
    fputs(",kinetic_j,strain_j,damped_building_j,core_j,damped_core_j,contacts_j,input_j\n", out);
}

static void write_history_row(const SimSample *s, void *user)
{
    HistoryRows *rows = user;
    double row[SAMPLE_FIXED + SAMPLE_PARTS * FLOORS_MAX];
    rows->attempt += s->t == 0;
    if (rows->attempt != rows->wanted)
        return;
    sample_row(rows->worker, s, (size_t)rows->n_floors, row);
    fprintf(rows->out, "%ld", rows->design);
    print_cells(rows->out, SAMPLE_FIXED + SAMPLE_PARTS * (size_t)rows->n_floors, row);
    fputc('\n', rows->out);
}

static Status write_history_of(const TimeJob *job, SimWorker *worker, size_t i, FILE *out, Err *err)
{
    HistoryRows rows = {.worker = worker,
                        .out = out,
                        .design = design_number(job->designs, i),
                        .n_floors = scene_n_floors(job->scene),
                        .wanted = job->results[i].repeated + 1};
    sim_worker_sample(worker, job->every_s, write_history_row, &rows);
    return run_again(job, worker, i, err);
}

Status write_histories(const TimeJob *job, const char *path, Err *err)
{
    return write_all(job, path, write_history_header, write_history_of, err);
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

static void write_spectra_header(FILE *out, int n_floors)
{
    fputs("design,period_s,ground_psa_g", out);
    for (int j = 1; j <= n_floors; j++)
        fprintf(out, ",floor_%02d_psa_g", j);
    fputc('\n', out);
}

/* psa (n_floors + 1, N_PERIODS) of the ground and of the floors, from rows of accelerations. */
static Status find_spectra(const TimeJob *job, FloorRecord *record, const double T[], double psa[], Err *err)
{
    const double *rows;
    size_t n, width;
    TRY(floor_record_accelerations(record, &rows, &n, &width, err));
    Motion floor = {.n = n, .dt_s = floor_record_step(record), .accel = malloc((n + 1) * sizeof *floor.accel)};
    if (!floor.accel)
        return fail(err, STATUS_NO_MEMORY, "--floor-spectra: no memory for %zu samples", n);
    spectrum_psa(job->motion, DAMPING, N_PERIODS, T, psa);
    for (size_t j = 0; j < (size_t)scene_n_floors(job->scene); j++) {
        for (size_t i = 0; i < n; i++)
            floor.accel[i] = rows[i * width + j];
        spectrum_psa(&floor, DAMPING, N_PERIODS, T, psa + (j + 1) * N_PERIODS);
    }
    free(floor.accel);
    return STATUS_OK;
}

static void print_spectra(FILE *out, long design, int n_floors, const double T[], const double psa[])
{
    for (size_t i = 0; i < N_PERIODS; i++) {
        fprintf(out, "%ld", design);
        print_cells(out, 1, &T[i]);
        for (size_t j = 0; j <= (size_t)n_floors; j++)
            print_cells(out, 1, &(double){psa[j * N_PERIODS + i] / GRAVITY});
        fputc('\n', out);
    }
}

static Status spectra_of(const TimeJob *job, FloorSamples *floors, SimWorker *worker, size_t i, FILE *out, Err *err)
{
    double T[N_PERIODS], psa[(FLOORS_MAX + 1) * N_PERIODS];
    for (int k = 0; k < N_PERIODS; k++)
        T[k] = SHORTEST_S * pow(LONGEST_S / SHORTEST_S, (double)k / (N_PERIODS - 1));
    sim_worker_sample(worker, SAMPLES_S, take_floors, floors);
    TRY(run_again(job, worker, i, err));
    TRY(find_spectra(job, floors->record, T, psa, err));
    print_spectra(out, design_number(job->designs, i), scene_n_floors(job->scene), T, psa);
    return STATUS_OK;
}

static Status write_spectra_of(const TimeJob *job, SimWorker *worker, size_t i, FILE *out, Err *err)
{
    FloorSamples floors = {.worker = worker};
    TRY(floor_record_create(&floors.record, scene_n_floors(job->scene), err));
    const Status status = spectra_of(job, &floors, worker, i, out, err);
    floor_record_free(floors.record);
    return status;
}

Status write_floor_spectra(const TimeJob *job, const char *path, Err *err)
{
    return write_all(job, path, write_spectra_header, write_spectra_of, err);
}
