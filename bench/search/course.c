#include "bench/search/course.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

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
