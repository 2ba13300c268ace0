#include "bench/search/course.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "store/output.h"

static double processor_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

Status course_create(Course *c, size_t n_max, size_t n_obj, Err *err)
{
    *c = (Course){.n_max = n_max, .n_obj = n_obj, .start_s = processor_s()};
    c->F = calloc(n_max * n_obj, sizeof *c->F);
    c->cpu_s = calloc(n_max, sizeof *c->cpu_s);
    c->counts = calloc(n_max, 1);
    if (c->F && c->cpu_s && c->counts)
        return STATUS_OK;
    course_free(c);
    return fail(err, STATUS_NO_MEMORY, "no memory for %zu designs", n_max);
}

void course_free(Course *c)
{
    free(c->F);
    free(c->cpu_s);
    free(c->counts);
    *c = (Course){0};
}

void course_add(Course *c, const double f[], int counts)
{
    if (c->n == c->n_max)
        return;
    memcpy(c->F + c->n * c->n_obj, f, c->n_obj * sizeof *f);
    c->cpu_s[c->n] = processor_s() - c->start_s;
    c->counts[c->n++] = counts != 0;
}

/* -- file ---------------------------------------------------------------------------------------------------------- */

Status course_save(const Course *c, const char *path, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    const size_t head[] = {c->n, c->n_obj};
    fwrite(head, sizeof head, 1, o.stream);
    fwrite(c->F, sizeof *c->F, c->n * c->n_obj, o.stream);
    fwrite(c->cpu_s, sizeof *c->cpu_s, c->n, o.stream);
    fwrite(c->counts, 1, c->n, o.stream);
    return output_close(&o, err);
}

Status course_load(Course *c, const char *path, size_t n, size_t n_obj, int *found, Err *err)
{
    size_t head[2] = {0};
    *found = 0;
    FILE *in = fopen(path, "rb");
    if (!in)
        return STATUS_OK;
    Status status = course_create(c, n, n_obj, err);
    if (status == STATUS_OK)
        *found = fread(head, sizeof head, 1, in) == 1 && head[0] == n && head[1] == n_obj &&
                 fread(c->F, sizeof *c->F, n * n_obj, in) == n * n_obj &&
                 fread(c->cpu_s, sizeof *c->cpu_s, n, in) == n && fread(c->counts, 1, n, in) == n;
    c->n = *found ? n : 0;
    fclose(in);
    if (!*found)
        course_free(c);
    return status;
}
