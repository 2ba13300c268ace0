/* Settings that do nothing because of another one's value. */
#include <stdio.h>
#include <string.h>

#include "settings/settings.h"
#include "settings/table.h"

/* keys, parted by blanks: one that ends in . or _ stands for all that begin so. They are read where `other` has the
 * value, with ! in front of it where it has any other. */
static const struct {
    const char *keys, *other, *value;
} WAITING[] = {
    {"building. core. contact. motion. sim. design. search.objectives", "problem.kind", "tower"},
    {"problem.command problem.timeout_s problem.lower problem.upper problem.senses", "problem.kind", "external"},
    {"problem.variables problem.objectives problem.variable_names problem.objective_names", "problem.kind", "!tower"},
    {"building.rayleigh_modes", "building.damping_model", "rayleigh"},
    {"core.width_m", "core.section", "!effective"},
    {"core.areas_m2 core.inertias_m4 core.shear_areas_m2 core.masses_kg", "core.section", "effective"},
    {"design.thickness_m", "core.section", "!effective"},
    {"motion.sa_period_s", "motion.sa_g", "!0"},
};

static int names_key(const char *keys, const char *key)
{
    for (const char *p = keys; *p; p += strspn(p, " ")) {
        const size_t n = strcspn(p, " ");
        if (strncmp(p, key, n) == 0 && (!key[n] || strchr("._", p[n - 1])))
            return 1;
        p += n;
    }
    return 0;
}

typedef struct {
    const Settings *s;
    SettingFn idle;
    void *user;
} Looking;

static void look_at(const char *key, unsigned flags, const char *was, const char *is, void *user)
{
    const Looking *l = user;
    char value[OPTION_TEXT_MAX], text[160];
    (void)flags;
    (void)was;
    (void)is;
    for (size_t i = 0; i < sizeof WAITING / sizeof WAITING[0]; i++) {
        const char *wanted = WAITING[i].value;
        const int is_other = *wanted == '!';
        table_text(l->s, WAITING[i].other, value);
        if (!names_key(WAITING[i].keys, key) || (strcmp(value, wanted + is_other) == 0) != is_other)
            continue;
        snprintf(text, sizeof text, "has no effect: it is read where %s %s %s", WAITING[i].other,
                 is_other ? "is not" : "=", wanted + is_other);
        l->idle(key, text, l->user);
        return;
    }
}

void settings_idle(const Settings *was, const Settings *is, SettingFn idle, void *user)
{
    settings_compare(was, is, look_at, &(Looking){is, idle, user});
}

int settings_screens(const Settings *s)
{
    const SearchOptions *search = &s->search;
    const int repeats = s->problem.noisy == NOISY_YES && search->replicates_max > 1 && search->replicate_share > 0;
    return search->fidelity != FIDELITY_OFF && !repeats && s->problem.kind == PROBLEM_TOWER && s->sim.replicates > 1;
}
