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
static void warn_of_twins(const Settings *s, WarnFn warn, void *user)
{
    const size_t n = list_is_given(s->motion.records) ? list_count(s->motion.records) : 0;
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

void warn_of_settings(const Settings *s, WarnFn warn, void *user)
{
    if (s->search.fidelity != FIDELITY_OFF && !settings_screens(s))
        warn("search.fidelity", "has no effect: it screens sim.replicates of a tower, unless problem.noisy", user);
    if (s->problem.kind != PROBLEM_TOWER)
        return;
    if (s->sim.gap_tolerance_m > s->design.gap_m.at[1]) {
        char text[100];
        snprintf(text, sizeof text, "%g m is more than the largest gap of %g m", s->sim.gap_tolerance_m,
                 s->design.gap_m.at[1]);
        warn("sim.gap_tolerance_m", text, user);
    }
    warn_of_twins(s, warn, user);
}

/* "FILE:LINE: " of a design file, else "WORD: "; then what is said of it. */
static void warn_of_one(const Designs *d, const char *word, size_t i, WarnFn warn, void *user, const char *what)
{
    char text[900], line[16] = "";
    if (d->line && !d->id)
        snprintf(line, sizeof line, ":%d", d->line[i]);
    snprintf(text, sizeof text, "%.600s%s: %s", word, line, what);
    warn("--design", text, user);
}

void warn_of_designs(const Designs *d, const char *word, WarnFn warn, void *user)
{
    const DesignSpace *s = &d->space;
    char name[TABLE_NAME_MAX], text[200];
    int has_wide = 0, has_top_heavy = 0;
    for (size_t i = 0; i < d->n; i++) {
        const double *gap = &d->x[i * (size_t)s->n_var], *wall = gap + s->n_gaps;
        for (int j = 0; j < s->n_gaps && !has_wide; j++)
            if (gap[j] > GAP_MAX_M) {
                design_variable_name(s, j, name);
                snprintf(text, sizeof text, "%s is %g m and does not close; gaps are in metres", name, gap[j]);
                warn_of_one(d, word, i, warn, user, text);
                has_wide = 1;
            }
        if (s->n_walls > 0 && wall[1] > wall[0] && !has_top_heavy) {
            snprintf(text, sizeof text, "t_top_m %g is thicker than t_base_m %g; the search would not propose this",
                     wall[1], wall[0]);
            warn_of_one(d, word, i, warn, user, text);
            has_top_heavy = 1;
        }
    }
}
