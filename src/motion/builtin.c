/* motion/builtin.c -- near-fault pulses on filtered noise.
 *
 *   a(t) = scale [ sum_k v_k'(t) + z(t) ],   rounded to 1e-6 m/s2, so that the last bits of libm do not show;
 *   scale makes max |a| the stated peak
 *
 *   v_k(t) = A/2 [1 + cos(2 pi f s / gamma)] cos(2 pi f s + phase),   s = t - centre,  |s| < gamma / (2 f)
 *
 * is the near-fault velocity pulse of Mavroeidis and Papageorgiou, Bull. Seism. Soc. Am. 93 (2003) 1099-1131; each
 * leaves the ground at rest. z is white noise under an envelope, filtered by a soil layer (Kanai, Tajimi) and by a high
 * pass that keeps velocity and displacement bounded (Clough and Penzien, Dynamics of Structures); the white noise is
 * Philox4x32-10 (Salmon et al., SC11) with the key of the table.
 *
 * The 89 numbers of a motion (16 pulses of 5, 9 of the noise) were fitted by Levenberg and Marquardt's method to 5 %
 * damped response spectra and to responses of the 20-storey building, starting from a matching pursuit. How near they
 * come to the N-S components of Kobe JMA 1995, El Centro 1940 and Sylmar Hospital 1994, all with a peak of 0.3 g and
 * stretched by 3.1, 3.0 and 3.0: J1, J2, J3 of the building alone (largest displacement, drift, acceleration) within
 * 0.5 %, for both matrix pairs; pseudo-acceleration from 0.3 to 6 s of the stretched motion within 3 % on average of
 * |ratio - 1| over 60 periods. tests/test_builtin.c measures this where the records are at hand. They are meant as
 * stand-ins in that sense and in no other: seismologically they are none of these earthquakes. */
#include "motion/builtin.h"

#include "base/csv.h"
#include "base/hash.h"
#include "base/random.h"
#include "base/text.h"
#include "motion/synthetic.h"

static const double DT_S = 0.02;

typedef struct {
    double amplitude_m_s, centre_s, frequency_hz, phase_rad, gamma;
} Pulse;

typedef struct {
    double level_m_s2;                      /* standard deviation of the white samples */
    double begin_s, rise_s, plateau_s;      /* envelope: zero, rising as a square, one */
    double decay_s;                         /* then falling as exp(-t / decay) */
    double ground_hz, ground_damping;       /* Kanai and Tajimi's layer */
    double high_pass_hz, high_pass_damping; /* Clough and Penzien's second filter */
} Noise;

/* As its numbers stand in the table, row by row. */
typedef struct {
    double duration_s, pga_m_s2, key; /* key: of the random stream */
    Noise noise;
    double unused[3];
    Pulse pulse[16];
} Model;

enum { BUILTIN_MOTION_LIST(CHOICE_NAME) N_MOTIONS };

/* builtin.csv, a part of the program (Makefile, rule for *.csv.o): a Model for each. */
extern const char _binary_src_motion_builtin_csv_start[], _binary_src_motion_builtin_csv_end[];
static const char *const TABLE[] = {_binary_src_motion_builtin_csv_start, _binary_src_motion_builtin_csv_end};

/* Sample i of a unit white noise: Philox4x32-10 at counter i, then Box and Muller. */
static double white(uint32_t key, size_t i)
{
    Random random = {.key = {key, 0x67726f75}, .counter = {(uint32_t)i}};
    const double radius = sqrt(-2 * log((random_bits(&random) + 0.5) * 0x1p-32));
    return radius * cos(2 * M_PI * (random_bits(&random) + 0.5) * 0x1p-32);
}

/* Its end is tapered, so that the filters come to rest before the motion ends. */
static double envelope(const Noise *z, double t, double duration)
{
    const double into = t - z->begin_s, over = into - z->rise_s - z->plateau_s;
    if (into <= 0 || t >= duration - 2)
        return 0;
    const double taper = t > duration - 6 ? 0.5 + 0.5 * cos(M_PI * (t - duration + 6) / 4) : 1;
    const double rise = into < z->rise_s ? into * into / (z->rise_s * z->rise_s) : 1;
    return taper * rise * (over > 0 ? exp(-over / z->decay_s) : 1);
}

/* x'' + 2 zeta w x' + w^2 x = -a by the average acceleration method; here it only has to be some fixed filter. */
typedef struct {
    double w, zeta, x, v, accel;
} Filter;

static void filter_step(Filter *f, double a)
{
    const double h = DT_S, damping = 2 * f->zeta * f->w, stiffness = f->w * f->w;
    const double x = f->x + h * f->v + h * h / 4 * f->accel, v = f->v + h / 2 * f->accel;
    f->accel = -(a + damping * v + stiffness * x) / (1 + h / 2 * damping + h * h / 4 * stiffness);
    f->x = x + h * h / 4 * f->accel;
    f->v = v + h / 2 * f->accel;
}

/* The samples of a model, to its peak and to whole millionths. */
static Status make_motion(Motion *m, const Model *model, Err *err)
{
    const Noise *z = &model->noise;
    const size_t n = m->n = lround(model->duration_s / DT_S) + 1;
    double *accel, peak = 0;
    m->dt_s = DT_S;
    TRY_ROOM(m->accel, n, "samples of a motion", err);
    accel = m->accel;

    /* Noise of the layer's absolute acceleration. */
    Filter layer = {.w = 2 * M_PI * z->ground_hz, .zeta = z->ground_damping};
    Filter high_pass = {.w = 2 * M_PI * z->high_pass_hz, .zeta = z->high_pass_damping};
    for (size_t i = 0; i < n; i++) {
        const double t = (double)i * DT_S;
        const double rock = z->level_m_s2 * envelope(z, t, model->duration_s) * white((uint32_t)model->key, i);
        filter_step(&layer, rock);
        filter_step(&high_pass, layer.accel + rock);
        accel[i] += high_pass.accel;
    }

    /* The derivative of every pulse of velocity. */
    for (const Pulse *p = model->pulse; p < model->pulse + N_OF(model->pulse); p++) {
        const double w = 2 * M_PI * p->frequency_hz, half = p->gamma / (2 * p->frequency_hz);
        for (size_t i = 0; i < n; i++) {
            const double t = (double)i * DT_S - p->centre_s, bell = w / p->gamma * t, carrier = w * t + p->phase_rad;
            if (fabs(t) < half)
                accel[i] -=
                    p->amplitude_m_s * w / 2 * (sin(bell) * cos(carrier) / p->gamma + (1 + cos(bell)) * sin(carrier));
        }
    }
    accel[0] = accel[n - 1] = 0;
    for (size_t i = 0; i < n; i++)
        peak = fmax(peak, fabs(accel[i]));
    for (size_t i = 0; i < n; i++)
        accel[i] = rint(accel[i] * (model->pga_m_s2 / peak) * 1e6) / 1e6;
    return STATUS_OK;
}

const char *builtin_name(const char *source)
{
    static const char PREFIX[] = "builtin:";
    return strncmp(source, PREFIX, sizeof PREFIX - 1) == 0 ? source + sizeof PREFIX - 1 : NULL;
}

Status builtin_motion(Motion *m, const char *source, Err *err)
{
    static const char *const NAMES[] = {BUILTIN_MOTION_LIST(CHOICE_WORD) SUITE_SOURCE};
    char name[sizeof SUITE_SOURCE + 8];
    size_t of_suite = SUITE_MOTIONS; /* from 1; 0: it is none of the suite */
    const int k = (int)index_of_word(source, NAMES, N_MOTIONS);
    do
        snprintf(name, sizeof name, SUITE_SOURCE "-%02zu", of_suite);
    while (strcmp(source, name) != 0 && --of_suite > 0);
    memset(m, 0, sizeof *m);
    if (strcmp(source, SUITE_SOURCE) == 0)
        return bad_data(err, "motion.record: %s is a suite of motion.records; its motions are %s-01 to -%02d", source,
                        source, SUITE_MOTIONS);
    if (k == N_MOTIONS && of_suite == 0)
        return fail_no_word(err, STATUS_BAD_DATA, "motion.record", source, "built-in motion", NAMES, k + 1);
    if (of_suite > 0) {
        TRY(synthetic_motion(m, of_suite - 1, err));
    } else {
        Table t;
        TRY(table_parse(&t, source, TABLE[0], TABLE[1] - TABLE[0], TABLE_PLAIN, err));
        const Status status = make_motion(m, (const Model *)t.values + k, err);
        table_free(&t);
        TRY(status);
    }
    m->is_corrected = of_suite > 0; /* its ground ends where it began */
    m->file_hash = hash_fnv1a(m->accel, m->n * sizeof *m->accel, HASH_SEED);
    text_copy(m->name, source);
    snprintf(m->format, sizeof m->format, "builtin");
    return STATUS_OK;
}
