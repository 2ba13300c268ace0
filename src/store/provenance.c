#include "base/json.h"
#include "store/provenance.h"

#include <cblas.h>
#include <inttypes.h>
#include <nlopt.h>
#include <sqlite3.h>
#include <sundials/sundials_version.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/linalg.h"
#include "scene/building.h"
#include "sim/fast/fast.h"
#include "settings/options.h"
#include "store/folder.h"

#ifndef IMTET_VERSION
#define IMTET_VERSION "unknown"
#endif
#ifndef IMTET_REVISION
#define IMTET_REVISION "unknown"
#endif
#ifndef IMTET_CFLAGS
#define IMTET_CFLAGS "unknown"
#endif

#ifdef __clang__
#define COMPILER __VERSION__ /* says its name itself */
#else
#define COMPILER "gcc " __VERSION__
#endif

const char *program_version(void)
{
    return IMTET_VERSION;
}

const char *program_revision(void)
{
    return IMTET_REVISION;
}

/* Random123 does not say its version; the Debian release does. */
json_t *program_description(void)
{
    char sundials[32] = "unknown", nlopt[32];
    int major, minor, fix;
    SUNDIALSGetVersion(sundials, sizeof sundials);
    nlopt_version(&major, &minor, &fix);
    snprintf(nlopt, sizeof nlopt, "%d.%d.%d", major, minor, fix);
    json_t *libraries =
        json_of("sqlite=%s sundials=%s nlopt=%s openblas=%s jansson=%s random123=%s", sqlite3_libversion(), sundials,
                nlopt, openblas_get_config(), jansson_version_str(), "as packaged by the system");
    return json_of("program=%s version=%s revision=%s compiler=%s flags=%s libraries=%p", "imtet", IMTET_VERSION,
                   IMTET_REVISION, COMPILER, IMTET_CFLAGS, libraries);
}

void program_identity(size_t n, char text[])
{
    json_t *all = program_description();
    char *words = json_dumps(all, JSON_COMPACT);
    const uint64_t hash = hash_fnv1a(words, strlen(words), HASH_SEED);
    const char *bytes_of = strcmp(fast_kernel_name(), "base") == 0 ? "base" : "avx2"; /* with AVX-512 the same bytes */
    snprintf(text, n, "%s (%s, %s, build %016" PRIx64 ")", IMTET_VERSION, IMTET_REVISION, bytes_of, hash);
    free(words);
    json_decref(all);
}

/* Host, operating system and the kernels that this processor gets. */
static json_t *machine(int threads)
{
    char host[256] = "unknown", system[128] = "unknown", started[24], line[256];
    gethostname(host, sizeof host - 1);
    utc_now(started);
    FILE *f = fopen("/etc/os-release", "r"); /* with its name the versions of all packages are known */
    while (f && fgets(line, sizeof line, f))
        sscanf(line, "PRETTY_NAME=\"%127[^\"\n]", system);
    if (f)
        fclose(f);
    return json_of("host=%s system=%s kernel=%s blas=%s threads=%d started=%s", host, system, fast_kernel_name(),
                   linalg_kernel_name(), threads, started);
}

uint64_t provenance_add_hash(uint64_t so_far, uint64_t file_hash)
{
    return (so_far ^ file_hash) * HASH_PRIME;
}

/* Its word in that part; empty: none. */
static void word_of(const char *provenance, const char *part, const char *key, char word[32])
{
    json_t *all = provenance ? json_loads(provenance, 0, NULL) : NULL;
    const char *text = json_string_value(json_object_get(json_object_get(all, part), key));
    snprintf(word, 32, "%s", text ? text : "");
    json_decref(all);
}

uint64_t provenance_hash(const char *provenance, const char *input)
{
    char word[32];
    word_of(provenance, "inputs", input, word);
    return strtoull(word, NULL, 16);
}

void provenance_blas(const char *provenance, char name[32])
{
    word_of(provenance, "machine", "blas", name);
}

Status provenance_inputs(Inputs *out, const Adapter *adapter, Err *err)
{
    Building b;
    *out = (Inputs){0};
    const Tower *t = adapter_tower(adapter);
    if (!t)
        return STATUS_OK;
    TRY(building_load(&b, &tower_record(t, 0)->options.building, err));
    const Motion *m = &tower_record(t, 0)->motion;
    *out = (Inputs){.record = m->file_hash, .forces = m->forces_hash, .matrices = b.hash};
    building_free(&b);
    for (size_t i = 0; i < tower_n_records(t); i++)
        out->records = provenance_add_hash(out->records, tower_record(t, i)->motion.file_hash);
    return STATUS_OK;
}

static char *hex(uint64_t hash, char text[24])
{
    snprintf(text, 24, "%016" PRIx64, hash);
    return text;
}

/* The records and the building of a tower; of another problem its command. */
static json_t *inputs(const Settings *s, const Tower *t, const Inputs *hashes)
{
    char record[24], records[24], forces[24], matrices[24];
    if (!t) {
        json_t *all = json_of("command=%s", s->problem.kind == PROBLEM_EXTERNAL ? s->problem.command : "built in");
        return s->problem.constraints > 0 ? json_put(all, "constraints=%ld", s->problem.constraints) : all;
    }
    const Scenario *w = tower_record(t, 0);
    return json_of(
        "record=%s record_format=%s record_channel=%s record_processed=%s record_fnv1a=%s records=%s "
        "records_fnv1a=%s forces=%s forces_fnv1a=%s samples=%ld step_s=%g building=%s floors=%d matrices_fnv1a=%s",
        w->record.record, w->motion.format, w->motion.channel, w->motion.processed, hex(hashes->record, record),
        w->record.records, hex(hashes->records, records), w->record.forces, hex(hashes->forces, forces), w->motion.n,
        w->motion.dt_s, w->options.building.model, scene_n_floors(w->scene), hex(hashes->matrices, matrices));
}

Status provenance_text(char **out, const Settings *s, const Adapter *adapter, json_t *model, Err *err)
{
    Inputs hashes;
    *out = NULL;
    TRY(provenance_inputs(&hashes, adapter, err));
    json_t *all = json_put(program_description(), "seed=%ld model=%p machine=%p inputs=%p", s->search.seed, model,
                           machine(adapter_threads(adapter)), inputs(s, adapter_tower(adapter), &hashes));
    *out = json_dumps(all, JSON_INDENT(2) | JSON_REAL_PRECISION(17));
    json_decref(all);
    return STATUS_OK;
}
