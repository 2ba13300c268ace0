#include "motion/text_form.h"

Status text_form_parse(const char *text, TextForm *form, Err *err)
{
    enum { PLACE_MAX = 1000000, SKIP = 0, PAIRS, FACTOR, TIME, VALUE, PER_LINE, N_KEYS };
    static const char *const KEYS[] = {"skip=", "pairs=", "factor=", "time:", "value:", "per_line="};
    char words[OPTION_TEXT_MAX], *rest = words, *end;
    *form = (TextForm){0};
    if (!*text || strcmp(text, "auto") == 0)
        return STATUS_OK;
    text_copy(words, text);
    for (char *word; (word = strsep(&rest, ", "));) {
        size_t k = 0;
        if (!*word)
            continue;

        /* One "key=value", or "time:1" and "value:3" behind columns=. */
        word += strncmp(word, "columns=", 8) == 0 ? 8 : 0;
        while (k < N_KEYS && strncmp(word, KEYS[k], strlen(KEYS[k])) != 0)
            k++;
        const char *from = k < N_KEYS ? word + strlen(KEYS[k]) : word;
        const double x = strtod(from, &end);
        const int is_whole = x == floor(x) && x >= (k != SKIP) && x <= PLACE_MAX;
        form->pairs = k == PAIRS ? strcmp(from, "yes") == 0 : form->pairs;
        if (k == PAIRS ? !form->pairs && strcmp(from, "no") != 0
                       : k == N_KEYS || end == from || *end || !(k == FACTOR ? isfinite(x) && x > 0 : is_whole))
            return bad_data(err,
                            "motion.text: '%.60s' is not understood; it is a list of skip=LINES, columns=time:NUMBER, "
                            "value:NUMBER, per_line=NUMBER, pairs=yes, factor=NUMBER",
                            word);
        if (k == SKIP)
            form->skip = (int)x;
        else if (k == FACTOR)
            form->factor = x;
        else if (k != PAIRS)
            *(k == TIME ? &form->time : k == VALUE ? &form->value : &form->per_line) = (size_t)x;
    }
    if ((form->pairs || form->per_line) && (form->time || form->value))
        return bad_data(err, "motion.text: columns do not go with pairs or per_line; leave one out");
    if (form->time && form->time == form->value)
        return bad_data(err, "motion.text: times and values are both column %zu", form->time);
    form->is_given = 1;
    return STATUS_OK;
}
