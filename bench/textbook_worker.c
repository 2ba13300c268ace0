/* The textbook problems as an external simulator: the program build/release/textbook (bench/textbook.h). */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/textbook.h"
#include "evaluate/kinds.h"

static int complain(const char *why)
{
    fprintf(stderr, "textbook: %s\n", why);
    return 64;
}

/* Answers one request; a word stands for the number of its choice. */
static void answer(const Problem *p, const char *kinds, const json_t *request)
{
    const json_t *list = json_object_get(request, "x");
    double x[TEXTBOOK_VAR_MAX] = {0}, f[TEXTBOOK_OBJ_MAX];
    const Task task = {.id = (long)json_integer_value(json_object_get(request, "id")), .x = x, .result = f};
    for (size_t j = 0; j < p->n_var; j++) {
        const json_t *value = json_array_get(list, j);
        if (!json_is_string(value) || !kinds_number(kinds, j, json_string_value(value), &x[j]))
            x[j] = json_number_value(value);
    }
    p->simulator->simulate(p->self, 0, &task, NULL);
    printf("{\"id\":%ld,\"f\":[", task.id);
    for (size_t k = 0; k < p->n_obj; k++)
        printf("%s%.17g", k > 0 ? "," : "", f[k]);
    puts("]}");
    fflush(stdout);
}

int main(int argc, char *argv[])
{
    if (argc < 4)
        return complain("usage: textbook NAME VARIABLES OBJECTIVES [NOISE [SEED [KINDS]]]");
    const TextbookOptions o = {.name = argv[1],
                               .n_var = strtol(argv[2], NULL, 10),
                               .n_obj = strtol(argv[3], NULL, 10),
                               .noise = argc > 4 ? strtod(argv[4], NULL) : 0,
                               .seed = argc > 5 ? (uint32_t)strtoul(argv[5], NULL, 10) : 1,
                               .kinds = argc > 6 ? argv[6] : "real"};
    char line[65536];
    Problem p;
    Err err = {0};
    if (textbook_open(&p, &o, &err) != STATUS_OK)
        return complain(err.text);
    while (fgets(line, sizeof line, stdin)) {
        json_t *request = json_loads(line, 0, NULL);
        answer(&p, o.kinds, request);
        json_decref(request);
    }
    problem_close(&p);
    return 0;
}
