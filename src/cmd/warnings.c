#include "cmd/warnings.h"

#include <stdio.h>
#include <string.h>

#include "base/list.h"
#include "moga/constants.h"
#include "settings/settings.h"

void warn_on_stderr(const char *key, const char *text, void *user)
{
    (void)user;
    fprintf(stderr, "warning: %s: %s\n", key, text);
}

/* Every record counts as often as it is listed. */
void warn_of_settings(const Settings *s, WarnFn warn, void *user)
{
    const int is_tower = s->problem.kind == PROBLEM_TOWER;
    const size_t n = is_tower && list_is_given(s->motion.records) ? list_count(s->motion.records) : 0;
    char name[OPTION_TEXT_MAX], other[OPTION_TEXT_MAX], text[OPTION_TEXT_MAX + 80];
    for (size_t i = 0; i < n; i++) {
        int is_twin = list_item(s->motion.records, i, name, sizeof name) && strcmp(name, s->motion.record) == 0;
        for (size_t j = 0; j < i && !is_twin; j++)
            is_twin = list_item(s->motion.records, j, other, sizeof other) && strcmp(name, other) == 0;
        if (is_twin) {
            snprintf(text, sizeof text, "%s is there twice (motion.record is one of them) and counts twice", name);
            warn("motion.records", text, user);
            return;
        }
    }
}

void warn_of_designs(const Designs *d, const char *word, WarnFn warn, void *user)
{
    const DesignSpace *s = &d->space;
    char name[TABLE_NAME_MAX], text[900], line[16] = "";
    for (size_t i = 0; i < d->n; i++)
        for (int j = 0; j < s->n_gaps; j++) {
            const double gap = d->x[i * (size_t)s->n_var + (size_t)j];
            if (!(gap > GAP_MAX_M))
                continue;
            if (d->line && !d->id)
                snprintf(line, sizeof line, ":%d", d->line[i]);
            design_variable_name(s, j, name);
            snprintf(text, sizeof text, "%.600s%s: %s is %g m and does not close; gaps are in metres", word, line, name,
                     gap);
            warn("--design", text, user);
            return;
        }
}
