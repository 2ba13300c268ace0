/* The protocol of external workers without the processes: the bytes come as a pipe would bring them, in pieces. */
#include "targets.h"

#include "simulator/external.c"

enum { N_VAR = 2, N_OBJ = 2, N_DESIGNS = 4 };

static void demand_answers(const Batch *b)
{
    for (size_t i = 0; i < b->done && i < N_DESIGNS; i++)
        if (b->answers[i].outcome == ANSWER_OK)
            for (size_t k = 0; k < N_OBJ; k++)
                if (!isfinite(b->F[i * N_OBJ + k]))
                    abort();
}

static void hear(External *e, const uint8_t *data, size_t size)
{
    double F[N_DESIGNS * N_OBJ] = {0};
    Answer answers[N_DESIGNS] = {{0}};
    Batch b = {.n = N_DESIGNS, .F = F, .answers = answers};
    Worker w = {.line = malloc(LINE_MAX_BYTES), .design = SIZE_MAX};
    while (w.line && b.next < N_DESIGNS && size > 0) {
        if (w.design == SIZE_MAX) {
            w.design = b.next++;
            w.id = (long)b.next;
        }
        const size_t piece = size < 7 + w.n_line ? size : 7 + w.n_line, room = LINE_MAX_BYTES - w.n_line;
        const size_t n = piece < room ? piece : room;
        memcpy(w.line + w.n_line, data, n);
        w.n_line += n;
        data += n;
        size -= n;
        look_for_answer(e, &w, &b);
    }
    demand_answers(&b);
    free(w.line);
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
