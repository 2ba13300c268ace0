#include "motion/text_form.h"

#include <string.h>

#include "base/option.h"

/* One "key=value", or "time:1" and "value:3" behind columns=. */
static Status parse_word(char *word, TextForm *form, Err *err)
{
    enum { PLACE_MAX = 1000000 };
    static const char *const KEYS[] = {"skip=", "time:", "value:", "per_line=", "factor="};
    char *end;
    size_t k = 0;
    if (strncmp(word, "columns=", 8) == 0)
        word += 8;
    if (strncmp(word, "pairs=", 6) == 0) {
        form->pairs = strcmp(word + 6, "yes") == 0;
        if (form->pairs || strcmp(word + 6, "no") == 0)
            return STATUS_OK;
    }
    while (k < N_OF(KEYS) && strncmp(word, KEYS[k], strlen(KEYS[k])) != 0)
        k++;
    const char *from = k < N_OF(KEYS) ? word + strlen(KEYS[k]) : word;
    const double x = strtod(from, &end);
    const int is_whole = x == floor(x) && x >= (k > 0) && x <= PLACE_MAX;
    if (k == N_OF(KEYS) || end == from || *end || !(k == 4 ? isfinite(x) && x > 0 : is_whole))
        return bad_data(err,
                        "motion.text: '%.60s' is not understood; it is a list of skip=LINES, columns=time:NUMBER, "
                        "value:NUMBER, per_line=NUMBER, pairs=yes, factor=NUMBER",
                        word);
    if (k == 0)
        form->skip = (int)x;
    else if (k == 4)
        form->factor = x;
    else
        *(k == 1 ? &form->time : k == 2 ? &form->value : &form->per_line) = (size_t)x;
    return STATUS_OK;
}

Status text_form_parse(const char *text, TextForm *form, Err *err)
{
    char words[OPTION_TEXT_MAX], *rest = words;
    *form = (TextForm){0};
    if (!*text || strcmp(text, "auto") == 0)
        return STATUS_OK;
    snprintf(words, sizeof words, "%s", text);
    for (char *word; (word = strsep(&rest, ", "));)
        if (*word)
            TRY(parse_word(word, form, err));
    if ((form->pairs || form->per_line) && (form->time || form->value))
        return bad_data(err, "motion.text: columns do not go with pairs or per_line; leave one out");
    if (form->time && form->time == form->value)
        return bad_data(err, "motion.text: times and values are both column %zu", form->time);
    form->is_given = 1;
    return STATUS_OK;
}
