#include "evaluate/kinds.h"

#include <jansson.h>

#include "base/list.h"
#include "base/text.h"

static const char CHOICE[] = "choice:", SOLD[] = "list:";

/* The item of variable j. */
static int item_of(const char *list, size_t j, char item[LIST_MAX])
{
    return list_item(list, list_count(list) == 1 ? 0 : j, item, LIST_MAX);
}

int kinds_are_real(const char *list)
{
    char item[LIST_MAX];
    for (size_t j = 0; list[0] && j < list_count(list); j++)
        if (!list_item(list, j, item, sizeof item) || strcmp(item, "real") != 0)
            return 0;
    return 1;
}

/* Word i of "choice:a|b|c" or "list:1|2|3", whichever `kind` is; 0: there is none, or it is too long. */
static int word_at(const char *item, const char *kind, size_t i, char word[KIND_WORD_MAX])
{
    const char *at = strncmp(item, kind, strlen(kind)) == 0 ? item + strlen(kind) : NULL;
    for (; at && i > 0; i--)
        at = strchr(at, '|') ? strchr(at, '|') + 1 : NULL;
    const size_t n = at ? strcspn(at, "|") : 0;
    if (n == 0 || n >= KIND_WORD_MAX)
        return 0;
    memcpy(word, at, n);
    word[n] = 0;
    return 1;
}

int kinds_word(const char *list, size_t j, double number, char word[KIND_WORD_MAX])
{
    char item[LIST_MAX];
    return number >= 0.0 && number < LIST_MAX && item_of(list, j, item) && word_at(item, CHOICE, (size_t)number, word);
}

int kinds_number(const char *list, size_t j, const char *word, double *number)
{
    char item[LIST_MAX], other[KIND_WORD_MAX];
    for (size_t i = 0; item_of(list, j, item) && word_at(item, CHOICE, i, other); i++)
        if (strcmp(word, other) == 0) {
            *number = (double)i;
            return 1;
        }
    return 0;
}

int kinds_have(const char *list, size_t j, double x)
{
    char item[LIST_MAX] = "", word[KIND_WORD_MAX];
    item_of(list, j, item);
    for (size_t i = 0; word_at(item, SOLD, i, word); i++)
        if (strtod(word, NULL) == x)
            return 1;
    return strncmp(item, SOLD, strlen(SOLD)) != 0 && (strcmp(item, "int") != 0 || x == floor(x));
}

/* UTF-8 that fits JSON, a cell of a CSV file and people: no quote, control character, blank at an end, or formula. */
static int is_plain(const char *word)
{
    const size_t n = strlen(word);
    for (size_t i = 0; i < n; i++)
        if ((unsigned char)word[i] < ' ' || word[i] == '"' || word[i] == '\\' || word[i] == 127)
            return 0;
    json_auto_t *text = json_stringn(word, n);
    return text && n > 0 && word[0] != ' ' && word[n - 1] != ' ' && !strchr("=+-@", word[0]);
}

/* Words of a choice, whose upper bound is the number of the last one. */
static Status read_choice(const char *item, double *upper, Err *err)
{
    char word[KIND_WORD_MAX];
    double first;
    size_t n = 0, bars = 0;
    for (const char *c = item; *c; c++)
        bars += *c == '|';
    for (; word_at(item, CHOICE, n, word) && is_plain(word); n++)
        if (kinds_number(item, 0, word, &first) && first < n)
            return bad_data(err, "problem.kinds: %s names %s twice", item, word);
    if (n != bars + 1)
        return bad_data(err,
                        "problem.kinds: %s: word %zu is empty, longer than %d letters, begins or ends with a blank, "
                        "begins with one of = + - @, or holds a quote or what is no text",
                        item, n + 1, KIND_WORD_MAX - 1);
    *upper = (double)(n - 1);
    return STATUS_OK;
}

/* Numbers of a list, into at. */
static Status read_sold(const char *item, Steps *s, double at[], Err *err)
{
    char word[KIND_WORD_MAX], *end = word;
    *s = (Steps){.at = at};
    for (const char *c = item; c; c = strchr(c + 1, '|'), s->n++) {
        at[s->n] = word_at(item, SOLD, s->n, word) ? strtod(word, &end) : NAN;
        if (!isfinite(at[s->n]) || *end)
            return bad_data(err, "problem.kinds: %s: item %zu is no number", item, s->n + 1);
        if (s->n > 0 && at[s->n] <= at[s->n - 1])
            return bad_data(err, "problem.kinds: %s: %g stands behind %g; give them in ascending order", item, at[s->n],
                            at[s->n - 1]);
    }
    return STATUS_OK;
}

Status kinds_read(const char *list, size_t n_var, VariableKind kind[], double bounds[], Steps **steps, Err *err)
{
    static const char *const WORDS[] = {[VARIABLE_REAL] = "real", [VARIABLE_LOG] = "log", [VARIABLE_WHOLE] = "int"};
    const size_t n = list_count(list);
    double *lower = bounds, *upper = bounds + n_var, *sold;
    char item[LIST_MAX];
    *steps = NULL;
    if (n != 1 && n != n_var)
        return bad_data(err, "problem.kinds: %zu kinds for %zu variables", n, n_var);
    for (size_t j = 0; j < n_var; j++) {
        if (!item_of(list, j, item))
            return bad_data(err, "problem.kinds: kind %zu is missing", j + 1);
        if (strncmp(item, CHOICE, sizeof CHOICE - 1) == 0) {
            kind[j] = VARIABLE_CHOICE;
            lower[j] = 0.0;
            TRY(read_choice(item, &upper[j], err));
            continue;
        }
        if (strncmp(item, SOLD, strlen(SOLD)) == 0) {
            if (!*steps)
                TRY_ROOM(*steps, n_var * (1 + LIST_MAX / 2 * sizeof *sold / sizeof **steps), "lists of numbers", err);
            sold = (double *)(void *)(*steps + n_var) + j * (LIST_MAX / 2);
            kind[j] = VARIABLE_STEPPED;
            TRY(read_sold(item, *steps + j, sold, err));
            lower[j] = sold[0];
            upper[j] = sold[(*steps)[j].n - 1];
            continue;
        }
        kind[j] = (VariableKind)index_of_word(item, WORDS, N_OF(WORDS));
        if (kind[j] == N_OF(WORDS))
            return bad_data(err, "problem.kinds: '%s' is none of real, log, int, list:NUMBER|NUMBER, choice:WORD|WORD",
                            item);
        if (kind[j] == VARIABLE_LOG && !(lower[j] > 0.0))
            return bad_data(err, "problem.lower: is %g for variable %zu, which is log: set it above 0", lower[j],
                            j + 1);
        if (kind[j] == VARIABLE_WHOLE && (lower[j] != floor(lower[j]) || upper[j] != floor(upper[j])))
            return bad_data(
                err, "problem.lower, problem.upper: %g and %g of variable %zu, which is int, are no whole numbers",
                lower[j], upper[j], j + 1);
    }
    return STATUS_OK;
}
