#include "targets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <fcntl.h>
#include <unistd.h>

#include "scene/design.h"
#include "settings/settings.h"
#include "base/csv.h"
#include "motion/motion_scale.h"
#include "motion/motion_read.h"

/* What must hold whatever the bytes are; a fuzzer and a test both notice an abort. */
static void demand(int holds, const char *what)
{
    if (holds)
        return;
    fprintf(stderr, "does not hold: %s\n", what);
    abort();
}

static void demand_reason(Status status, const Err *err)
{
    demand(status == STATUS_OK || err->text[0], "a refusal has a reason");
}

/* The bytes as a file of memory: its descriptor, and the path under which it can be opened. The descriptor is high: a
 * record called 4 in these settings would mean descriptor 4, another file when they are read again. */
static int file_of(const uint8_t *data, size_t size, char path[64])
{
    const int low = memfd_create("input", MFD_CLOEXEC), fd = fcntl(low, F_DUPFD_CLOEXEC, 900);
    close(low);
    demand(fd >= 0 && write(fd, data, size) == (ssize_t)size, "a file of memory can be had");
    snprintf(path, 64, "/proc/self/fd/%d", fd);
    return fd;
}

static char *written(const Settings *s)
{
    char *text = NULL;
    size_t length;
    FILE *f = open_memstream(&text, &length);
    demand(f != NULL, "a stream of memory can be had");
    settings_write(s, f, 0, NULL);
    fclose(f);
    return text;
}

/* Settings that were accepted are written and read again as the same. */
static void read_back(const Settings *s)
{
    char path[64];
    Err err = {0};
    Settings again;
    char *text = written(s);
    const int fd = file_of((const uint8_t *)text, strlen(text), path);
    settings_defaults(&again);
    demand(settings_read(&again, path, NULL, NULL, &err) == STATUS_OK, "saved settings are accepted");
    char *second = written(&again);
    demand(strcmp(text, second) == 0, "saved settings stay what they are");
    free(text);
    free(second);
    close(fd);
}

void fuzz_settings(const uint8_t *data, size_t size)
{
    char path[64];
    Err err = {0};
    Settings s;
    int n_faults = 0;
    const int fd = file_of(data, size, path);
    settings_defaults(&s);
    const Status status = settings_read(&s, path, NULL, &n_faults, &err);
    demand_reason(status, &err);
    demand((status == STATUS_OK) == (n_faults == 0), "faults are counted");
    if (status == STATUS_OK)
        read_back(&s);
    close(fd);
}

static void demand_motion(const Motion *m)
{
    demand(m->n >= 2 && m->dt_s > 0 && isfinite(m->dt_s), "a motion has samples and a step");
    for (size_t i = 0; i < m->n; i++)
        demand(fabs(m->accel[i]) <= 200, "samples are finite and below 20 g");
}

/* Base line, filters and a scaling give finite samples or a reason. */
static void process(Motion *m)
{
    Settings s;
    Err err = {0};
    settings_defaults(&s);
    s.motion.baseline = BASELINE_QUADRATIC;
    s.motion.highpass_hz = 0.5;
    s.motion.lowpass_hz = 5;
    strcpy(s.motion.target, "asce7 sds=1 sd1=0.6");
    Status status = motion_process(m, &s.motion, &err);
    if (status == STATUS_OK)
        status = motion_scale(m, &s.motion, &err);
    demand_reason(status, &err);
    for (size_t i = 0; status == STATUS_OK && i < m->n; i++)
        demand(isfinite(m->accel[i]), "processed samples are finite");
}

static void read_motion(const uint8_t *data, size_t size, const MotionHow *how, int processed)
{
    Err err = {0};
    Motion m;
    const Status status = motion_parse(&m, "input", (const char *)data, size, how, &err);
    demand_reason(status, &err);
    if (status == STATUS_OK)
        demand_motion(&m);
    if (status == STATUS_OK && processed && m.n < 4096 && m.dt_s > 1e-3)
        process(&m);
    motion_free(&m);
}

void fuzz_motion(const uint8_t *data, size_t size)
{
    read_motion(data, size, &(MotionHow){0}, 0);
    read_motion(data, size, &(MotionHow){.unit = UNIT_G, .channel = "1", .dt_s = 0.01}, 0);
    read_motion(data, size, &(MotionHow){.channel = "2", .dt_s = 0.5}, 0);
    read_motion(data, size, &(MotionHow){.text = {.is_given = 1, .skip = 1, .pairs = 1}, .unit = UNIT_G}, 0);
    read_motion(data, size, &(MotionHow){.text = {.is_given = 1, .time = 1, .value = 3, .factor = 2}}, 0);
}

void fuzz_instrument(const uint8_t *data, size_t size)
{
    read_motion(data, size, &(MotionHow){.channel = "1", .unit = UNIT_COUNTS, .counts_per_m_s2 = 1e5}, 1);
    read_motion(data, size, &(MotionHow){.channel = "3", .unit = UNIT_CM_S2}, 0);
}

void fuzz_archive(const uint8_t *data, size_t size)
{
    read_motion(data, size, &(MotionHow){.channel = "2", .unit = UNIT_COUNTS, .counts_per_m_s2 = 1e5}, 0);
}

static void demand_table(const Table *t)
{
    demand((t->n_rows > 0 || t->names) && t->n_cols > 0, "a table has columns, and rows or names");
    for (size_t i = 0; i < t->n_rows * t->n_cols; i++)
        demand(isfinite(t->values[i]) || (t->names && isnan(t->values[i])),
               "its numbers are finite, or cells are empty");
}

void fuzz_table(const uint8_t *data, size_t size)
{
    char path[64];
    Designs d;
    for (int has_header = 0; has_header < 2; has_header++) {
        Err err = {0};
        Table t;
        const Status status = table_parse(&t, "input", (const char *)data, size, has_header, &err);
        demand_reason(status, &err);
        if (status == STATUS_OK)
            demand_table(&t);
        table_free(&t);
    }
    const int fd = file_of(data, size, path);
    Err err = {0};
    DesignSpace space;
    demand(design_space_make(&space, &(DesignOptions){0}, CORE_BOX, 2, &err) == STATUS_OK, "the paper's variables");
    const Status status = design_read(&d, path, &space, &err);
    demand_reason(status, &err);
    for (size_t i = 0; status == STATUS_OK && i < d.n * 4; i++)
        demand(d.x[i] >= 0, "gaps and walls are not negative");
    design_free(&d);
    close(fd);
}
