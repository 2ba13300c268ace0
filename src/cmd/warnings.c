#include "cmd/warnings.h"

#include <stdio.h>
#include <string.h>

#include "motion/motion_scale.h"
#include "settings/settings.h"

void warn_on_stderr(const char *key, const char *text, void *user)
{
    (void)user;
    fprintf(stderr, "warning: %s: %s\n", key, text);
}

/* Every record counts as often as it is listed. */
void warn_of_settings(const Settings *s, WarnFn warn, void *user)
{
    const MotionOptions *m = &s->motion;
    char name[OPTION_TEXT_MAX], other[OPTION_TEXT_MAX], text[OPTION_TEXT_MAX + 80];
    for (size_t i = 1; s->problem.kind == PROBLEM_TOWER && i < motion_n_records(m); i++)
        for (size_t j = 0; j < i; j++)
            if (motion_record(m, i, name, NULL) == STATUS_OK && motion_record(m, j, other, NULL) == STATUS_OK &&
                strcmp(name, other) == 0) {
                snprintf(text, sizeof text, "%s is there twice (motion.record is one of them) and counts twice", name);
                warn("motion.records", text, user);
                return;
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
