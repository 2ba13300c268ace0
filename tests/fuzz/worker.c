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

static void hear(External *e, const uint8_t *data, size_t size)
{
    ExternalAnswer *answer = calloc(1, sizeof *answer + N_OBJ * sizeof *answer->f);
    Worker w = {.line = malloc(LINE_MAX_BYTES)};
    while (answer && w.line && w.id < N_DESIGNS && size > 0) {
        if (!w.answer) {
            w.answer = answer;
            w.id++;
        }
        const size_t piece = size < 7 + w.n_line ? size : 7 + w.n_line, room = LINE_MAX_BYTES - w.n_line;
        const size_t n = piece < room ? piece : room;
        memcpy(w.line + w.n_line, data, n);
        w.n_line += n;
        data += n;
        size -= n;
        look_for_answer(e, &w);
        if (!w.answer)
            demand_numbers(answer);
    }
    free(w.line);
    free(answer);
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
