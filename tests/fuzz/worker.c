/* The protocol of external workers without the processes: the bytes come as a pipe would bring them, in pieces. */
#include "targets.h"

#include "evaluate/external.c"

enum { N_VAR = 2, N_OBJ = 2, N_DESIGNS = 4 };

static void demand_numbers(const ExternalAnswer *a)
{
    for (size_t k = 0; a->outcome == OUTCOME_OK && k < N_OBJ; k++)
        if (!isfinite(a->f[k]))
            abort();
}

/* Two designs alone, then two together. */
static void hear(External *e, const uint8_t *data, size_t size)
{
    const size_t one = sizeof(ExternalAnswer) + N_OBJ * sizeof(double);
    char *answers = calloc(N_DESIGNS, one);
    Pool pool = {.protocol = {.request_bytes = 1, .tell = tell}};
    Worker w = {.pool = &pool, .line = malloc(LINE_MAX_BYTES), .batch = 1};
    Task task[N_DESIGNS];
    for (size_t i = 0; i < N_DESIGNS; i++)
        task[i] = (Task){.id = (long)i + 1, .result = answers + i * one};
    for (size_t at = 0; answers && w.line && at < N_DESIGNS && size > 0;) {
        if (w.n_done >= w.n)
            w.task = task + at, w.n = at < 2 ? 1 : N_DESIGNS - at, w.n_done = 0;
        const size_t piece = size < 7 + w.n_line ? size : 7 + w.n_line, room = LINE_MAX_BYTES - w.n_line;
        const size_t n = piece < room ? piece : room;
        memcpy(w.line + w.n_line, data, n);
        w.n_line += n;
        data += n;
        size -= n;
        look_for_answer(e, &w);
        if (w.n_done < w.n)
            continue;
        for (size_t i = 0; i < w.n_done; i++)
            demand_numbers(w.task[i].result);
        at += w.n_done > 0 ? w.n_done : 1;
    }
    free(w.request);
    free(w.line);
    free(answers);
}

void fuzz_worker(const uint8_t *data, size_t size)
{
    External e = {.n_var = N_VAR, .n_obj = N_OBJ};
    Err err = {0};
    const uint8_t *end = memchr(data, '\n', size);
    const size_t length = end ? (size_t)(end - data) : size;
    char *command = strndup((const char *)data, length);
    if (command)
        split_command(&e, command, &err);
    hear(&e, data + length, size - length);
    free(e.text);
    free(command);
}
