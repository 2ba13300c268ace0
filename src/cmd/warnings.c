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
    if (s->sim.gap_tolerance_m > s->design.gap_max_m) {
        char text[100];
        snprintf(text, sizeof text, "%g m is more than the largest gap of %g m", s->sim.gap_tolerance_m,
                 s->design.gap_max_m);
        warn("sim.gap_tolerance_m", text, user);
    }
    warn_of_twins(s, warn, user);
}

/* "FILE:LINE" of a design file, else the word. */
static void name_design(const Designs *d, const char *word, size_t i, char *name, size_t size)
{
    if (d->line && !d->id)
        snprintf(name, size, "%s:%d", word, d->line[i]);
    else
        snprintf(name, size, "%s", word);
}

static void warn_of_gaps(const Designs *d, const char *word, WarnFn warn, void *user)
{
    char name[600], variable[TABLE_NAME_MAX], text[900];
    for (size_t i = 0; i < d->n; i++)
        for (int j = 0; j < d->space.n_gaps; j++) {
            const double gap = d->x[i * (size_t)d->space.n_var + (size_t)j];
            if (!(gap > GAP_MAX_M))
                continue;
            name_design(d, word, i, name, sizeof name);
            design_variable_name(&d->space, j, variable);
            snprintf(text, sizeof text, "%s: %s is %g m and does not close; gaps are in metres", name, variable, gap);
            warn("--design", text, user);
            return;
        }
}

static void warn_of_top_heavy(const Designs *d, const char *word, WarnFn warn, void *user)
{
    char name[600], text[900];
    for (size_t i = 0; i < d->n && d->space.n_walls > 0; i++) {
        const double *wall = &d->x[i * (size_t)d->space.n_var + (size_t)d->space.n_gaps];
        if (!(wall[1] > wall[0]))
            continue;
        name_design(d, word, i, name, sizeof name);
        snprintf(text, sizeof text, "%s: t_top_m %g is thicker than t_base_m %g; the search would not propose this",
                 name, wall[1], wall[0]);
        warn("--design", text, user);
        return;
    }
}

void warn_of_designs(const Designs *d, const char *word, WarnFn warn, void *user)
{
    warn_of_gaps(d, word, warn, user);
    warn_of_top_heavy(d, word, warn, user);
}
