#include "report/what_if.h"

#include <limits.h>
#include <zlib.h>

#include "base/json.h"
#include "base/units.h"
#include "evaluate/portable.h"
#include "evaluate/tower.h"
#include "motion/motion_scale.h"
#include "motion/suite.h"

/* Shares of the run's own between which motion and restitution may be changed. */
static const double PGA_SHARE = 4, STRETCH_SHARE = 2, RESTITUTION[2] = {0.05, 1};

/* Of `imtet simulate`, for the one simulation of the design as designed. */
static const char ONCE[] = " --set sim.replicates=1 --set sim.gap_tolerance_m=0 --set motion.records=none "
                           "--set search.fidelity=off";
static const char CERTAIN[] = " --set sim.uncertain=none";

static Status name_record(const char *source, void *user, Err *err)
{
    (void)err;
    const char *slash = strrchr(source, '/');
    json_array_append_new(user, json_words(slash && slash[1] ? slash + 1 : source));
    return STATUS_OK;
}

void *gzip_bytes(const void *bytes, size_t n, size_t *n_packed)
{
    z_stream z = {.next_in = (unsigned char *)(uintptr_t)bytes, .avail_in = (unsigned)n};
    if (n > INT_MAX ||
        deflateInit2(&z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + 16, MAX_MEM_LEVEL, Z_DEFAULT_STRATEGY) != Z_OK)
        return NULL;
    z.avail_out = (unsigned)deflateBound(&z, n);
    void *packed = z.next_out = calloc(1, z.avail_out + 3);
    if (packed) {
        deflate(&z, Z_FINISH);
        *n_packed = z.total_out;
    }
    deflateEnd(&z);
    return packed;
}

/* gzip, then base64 (RFC 4648), to be freed; NULL: no memory. */
static char *packed_text(const unsigned char *bytes, size_t n)
{
    static const char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t size = 0;
    unsigned char *packed = gzip_bytes(bytes, n, &size);
    char *text = packed ? calloc(1, (size + 2) / 3 * 4 + 1) : NULL, *at = text;
    for (size_t i = 0; text && i < size; i += 3) {
        const unsigned long three = packed[i] << 16 | packed[i + 1] << 8 | packed[i + 2];
        for (size_t k = 0; k < 4; k++)
            *at++ = i + k > size ? '=' : DIGITS[three >> (18 - 6 * k) & 63];
    }
    free(packed);
    return text;
}

Status what_if_json(const Run *run, const RecordPaths *moved, json_t **out, Err *err)
{
    Settings s = *run->settings;
    unsigned char *bytes = NULL;
    char *scene = NULL, options[sizeof ONCE + sizeof CERTAIN];
    Problem p;
    size_t n;
    if (s.problem.kind != PROBLEM_TOWER)
        return fail(err, STATUS_MISSING, "%s: is no run of the tower: nothing to change", run->folder);

    /* 1. The bytes of all records and buildings; the tower says what its variables may be, and how it is shaken. */
    s.search.threads = 1;
    TRY(record_paths_find(&s, run->provenance, moved, err));
    TRY(tower_open(&p, &s, TOWER_SINGLE, 1, err));
    Status status = STATUS_OK;
    if (p.n_var != run->schema.n_var)
        status = bad_data(err, "%s: its building has other variables now", run->folder);
    THEN(status, portable_make(&s, &bytes, &n, err));
    if (status == STATUS_OK && !(scene = packed_text(bytes, n)))
        status = fail_memory(err, n, "bytes of a scene");
    json_t *records = json_array();
    THEN(status, suite_of_study(&s.motion, name_record, records, err));

    /* 2. Between which numbers they may be changed, and what `imtet simulate` is told to do the same. */
    if (status == STATUS_OK) {
        const double pga = motion_peak(&tower_record(tower_of(&p), 0)->motion) / GRAVITY;
        const size_t n_simulations = (size_t)s.sim.replicates * suite_count(&s.motion);
        json_t *values = json_array();

        /* The numbers that whole and stepped variables take; null of others: the page has the words of a choice. */
        for (size_t d = 0; d < p.n_var; d++) {
            const Steps *steps = problem_kind(&p, d) == VARIABLE_STEPPED ? &p.steps[d] : NULL;
            json_t *list = steps || problem_kind(&p, d) == VARIABLE_WHOLE ? json_array() : json_null();
            const size_t n_values = steps ? steps->n : (size_t)(p.upper[d] - p.lower[d]) + 1;
            for (size_t i = 0; json_is_array(list) && i < n_values; i++)
                json_array_append_new(list, json_number(steps ? steps_at(steps, i) : p.lower[d] + (double)i));
            json_array_append_new(values, list);
        }
        snprintf(options, sizeof options, "%s%s", n_simulations == 1 ? "" : ONCE,
                 is_uncertain(&s.sim.uncertain) ? CERTAIN : "");
        *out = json_of(
            "lower=%p upper=%p values=%p pga_g=%p stretch=%p restitution=%p records=%p simulations=%ld options=%s "
            "scene=%s",
            json_numbers(p.n_var, p.lower), json_numbers(p.n_var, p.upper), values,
            json_numbers(3, (double[]){pga / PGA_SHARE, pga, pga * PGA_SHARE}),
            json_numbers(
                3, (double[]){s.motion.stretch / STRETCH_SHARE, s.motion.stretch, s.motion.stretch * STRETCH_SHARE}),
            json_numbers(3, (double[]){RESTITUTION[0], s.contact.restitution, RESTITUTION[1]}), json_incref(records),
            (long)n_simulations, options, scene);
    }
    json_decref(records);
    free(bytes);
    free(scene);
    problem_close(&p);
    return status;
}
