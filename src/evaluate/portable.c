#include "evaluate/portable.h"

#include "motion/motion_scale.h"
#include "motion/suite.h"
#include "scene/neighbour.h"

static const uint64_t MARK = 0x00316574746d6900u; /* "imtet1", the form of the bytes */
enum { SETTINGS_MAX = 1 << 20, DEGREES_MAX = 1 << 12, SAMPLES_MAX = 1 << 24 };

/* While reading there is to be room for them; else it is a fault of the walk. */
static void walk_numbers(Pack *p, double **x, size_t n)
{
    if (p->reading && !p->faulty && n > 0)
        p->faulty |= !(*x = malloc(n * sizeof **x));
    pack(p, *x, n * sizeof **x);
}

/* Numbers that may be absent. */
static void walk_optional(Pack *p, double **x, size_t n)
{
    size_t has = *x != NULL;
    pack_size(p, &has, 1);
    walk_numbers(p, x, has ? n : 0);
}

static void walk_frame(Pack *p, FrameFull *f)
{
    size_t n = f->n;
    pack_size(p, &n, DEGREES_MAX);
    f->n = p->faulty ? 0 : (int)n;
    walk_numbers(p, &f->K, n * n);
    walk_numbers(p, &f->M, n * n);
    walk_optional(p, &f->influence, n);
}

static void walk_building(Pack *p, BuildingFiles *b)
{
    walk_frame(p, &b->floors);
    walk_frame(p, &b->full);
    walk_optional(p, &b->storey_m, b->floors.n);
    walk_optional(p, &b->yield_drift, b->floors.n);
}

static void walk_motion(Pack *p, char source[OPTION_TEXT_MAX], Motion *m)
{
    size_t n_force = m->n_force;
    pack(p, source, OPTION_TEXT_MAX);
    pack(p, m->name, sizeof m->name);
    pack_size(p, &m->n, SAMPLES_MAX);
    pack(p, &m->dt_s, sizeof m->dt_s);
    walk_numbers(p, &m->accel, m->n);
    pack_size(p, &n_force, FLOORS_MAX);
    pack_size(p, &m->n_force_rows, SAMPLES_MAX);
    m->n_force = p->faulty ? 0 : (int)n_force;
    walk_numbers(p, &m->force_rows, m->n_force_rows * (n_force > 0 ? n_force + 1 : 0));
    source[OPTION_TEXT_MAX - 1] = m->name[sizeof m->name - 1] = 0;
}

/* -- made ---------------------------------------------------------------------------------------------------------- */

typedef struct {
    Pack pack;
    const MotionOptions *options;
} Making;

static Status add_record(const char *source, void *user, Err *err)
{
    Making *making = user;
    MotionOptions o = *making->options;
    Motion m = {0};
    text_copy(o.record, source);
    TRY(motion_open(&m, &o, err));
    walk_motion(&making->pack, o.record, &m);
    motion_free(&m);
    return STATUS_OK;
}

Status portable_make(const Settings *s, unsigned char **bytes, size_t *n, Err *err)
{
    Making making = {.options = &s->motion};
    Pack *p = &making.pack;
    char *text = settings_text(s);
    size_t length = text ? strlen(text) : 0, n_records = 0, n_buildings = 1u + (neighbour_is_given(&s->core) != 0);
    double steps = s->sim.steps_per_contact;
    Status status = text ? suite_size(&s->motion, &n_records, err) : fail_memory(err, 1, "settings");
    if (status == STATUS_OK && n_records > PORTABLE_RECORDS_MAX)
        status = bad_data(err, "%zu records; a page takes %d", n_records, PORTABLE_RECORDS_MAX);

    /* 1. The settings, and how many records there are. */
    pack_expect(p, MARK);
    pack_size(p, &length, SETTINGS_MAX);
    pack(p, text, length);
    pack(p, &steps, sizeof steps);
    pack_size(p, &n_records, PORTABLE_RECORDS_MAX);
    free(text);

    /* 2. Their motions. */
    THEN(status, suite_of_study(&s->motion, add_record, &making, err));

    /* 3. The buildings, last: they are read from here again and again. */
    pack_size(p, &n_buildings, 2);
    for (size_t i = 0; i < n_buildings && status == STATUS_OK; i++) {
        BuildingOptions o = s->building;
        BuildingFiles b;
        if (i == 1) { /* condensed to its floors (scene/neighbour.h) */
            memcpy(o.model, s->core.model, sizeof o.model);
            o.modes = 0;
        }
        status = building_read(&b, &o, err);
        pack(p, o.model, sizeof o.model);
        if (status == STATUS_OK)
            walk_building(p, &b);
        building_files_free(&b);
    }
    if (status == STATUS_OK && p->faulty)
        status = fail_memory(err, p->n, "bytes of a scene");
    if (status != STATUS_OK)
        free(p->bytes);
    *bytes = status == STATUS_OK ? p->bytes : NULL;
    *n = p->n;
    return status;
}

/* -- read ---------------------------------------------------------------------------------------------------------- */

Status portable_read(Portable *p, const unsigned char *bytes, size_t n, Err *err)
{
    Pack in = {.bytes = (unsigned char *)(uintptr_t)bytes, .n = n, .reading = 1};
    size_t length = 0;
    double steps = 0;
    memset(p, 0, sizeof *p);
    settings_defaults(&p->settings);
    pack_expect(&in, MARK);
    pack_size(&in, &length, SETTINGS_MAX);
    char *text = in.faulty ? NULL : calloc(1, length + 1);
    if (!text)
        return bad_data(err, "these bytes are no scene of this program");
    pack(&in, text, length);
    pack(&in, &steps, sizeof steps);
    Status status = settings_parse(&p->settings, "scene", text, err);
    free(text);
    p->settings.sim.steps_per_contact = steps;
    pack_size(&in, &p->n_records, PORTABLE_RECORDS_MAX);
    for (size_t i = 0; i < p->n_records && !in.faulty; i++)
        walk_motion(&in, p->source[i], &p->record[i]);
    p->buildings = in.bytes + in.at;
    p->n_buildings_bytes = in.n - in.at;
    if (status == STATUS_OK && in.faulty)
        status = bad_data(err, "these bytes are no scene of this program");
    if (status != STATUS_OK)
        portable_free(p);
    return status;
}

Status portable_building(const Portable *p, const char *model, BuildingFiles *out, Err *err)
{
    Pack in = {.bytes = (unsigned char *)(uintptr_t)p->buildings, .n = p->n_buildings_bytes, .reading = 1};
    size_t n = 0;
    pack_size(&in, &n, 2);
    for (size_t i = 0; i < n && !in.faulty; i++) {
        char name[OPTION_TEXT_MAX];
        memset(out, 0, sizeof *out);
        pack(&in, name, sizeof name);
        walk_building(&in, out);
        if (!in.faulty && strncmp(name, model, sizeof name) == 0)
            return STATUS_OK;
        building_files_free(out);
    }
    return fail(err, STATUS_MISSING, "%s: this scene has no such building", model);
}

void portable_free(Portable *p)
{
    for (size_t i = 0; i < p->n_records; i++)
        motion_free(&p->record[i]);
    memset(p, 0, sizeof *p);
}
