#include "base/keyed.h"

#include "base/option.h"
#include "base/text.h"

static char last_letter(const KeyedNumber *k)
{
    return k->letters ? (char)('A' + (int)k->most - 1) : 0;
}

Status keyed_numbers(const char *setting, const char *text, unsigned kind, size_t n, const KeyedNumber keys[],
                     double x[], Err *err)
{
    char copy[OPTION_TEXT_MAX], all[160] = "", *rest = copy, *end;
    unsigned seen = 0;
    text_copy(copy, text);
    for (char *word; (word = strsep(&rest, " ,"));) {
        /* The key of "key=value". */
        const size_t length = strcspn(word, "=");
        size_t i = 0;
        if (!*word)
            continue;
        while (i < n &&
               !((keys[i].kinds & kind) && strlen(keys[i].key) == length && strncmp(word, keys[i].key, length) == 0))
            i++;
        for (size_t k = 0; i == n && k < n; k++)
            if (keys[k].kinds & kind)
                text_join(all, sizeof all, " ", "%s=%.*s", keys[k].key, keys[k].letters ? 4 : 0,
                          (const char[]){'A', '.', '.', last_letter(&keys[k])});
        if (i == n)
            return bad_data(err, "%s: '%.60s' is none of %s", setting, word, all);

        /* Its value; none twice, for the other one would be lost. */
        const KeyedNumber *k = &keys[i];
        const char *value = word + length + (word[length] == '=');
        if (seen >> i & 1)
            return bad_data(err, "%s: %s stands twice; the second is '%.60s'", setting, k->key, word);
        seen |= 1U << i;
        x[i] = strtod(value, &end);
        if (k->letters && *value >= 'A' && *value <= last_letter(k)) {
            x[i] = *value - 'A' + 1;
            end++;
        }
        if (end == value || *end || !(x[i] >= k->least && x[i] <= k->most))
            return bad_data(err, "%s: '%.60s' is no number from %g to %g%s%.*s", setting, word, k->least, k->most,
                            k->letters ? " and no capital letter from A to " : "", k->letters,
                            (char[]){last_letter(k)});
    }
    return STATUS_OK;
}
