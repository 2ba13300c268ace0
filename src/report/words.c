#include "report/words.h"

#include "motion/suite.h"
#include "settings/options.h"

/* Without the apostrophe that keeps a name from being a formula in a spreadsheet (base/visible.h). */
Words words_of_objective(const Schema *schema, size_t k)
{
    const char *name = schema_objective(schema, k)->name;
    if (schema->order.n_obj > 0 && schema->order.of[k] < MEASURES_LISTED)
        return measure(schema->order.of[k])->words;
    return (Words){name + (name[0] == '\'' && name[1] && strchr("=+-@", name[1])), "", 1};
}

void words_of_rule(const Settings *s, char text[RULE_WORDS_MAX])
{
    static const char *const RULES[] = {ROBUST_LIST(CHOICE_WORD)};
    const size_t n = suite_count(&s->motion);
    const long each = s->sim.replicates;
    char rule[40], spread[40] = "";
    if (s->sim.quantile > 0)
        snprintf(rule, sizeof rule, "quantile %g", s->sim.quantile);
    else
        text_copy(rule, n == 1 && s->sim.robust == ROBUST_WORST ? "mean" : RULES[s->sim.robust]);
    if (each > 1)
        snprintf(spread, sizeof spread, "%s%ld replicates", n > 1 ? " x " : "", each);
    text[0] = 0;
    if (n > 1)
        snprintf(text, RULE_WORDS_MAX, "%s of %zu records%s", rule, n, spread);
    else if (each > 1)
        snprintf(text, RULE_WORDS_MAX, "%s of %s", rule, spread);
}
