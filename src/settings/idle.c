#include "settings/idle.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/list.h"
#include "motion/builtin.h"
#include "scene/compiled_in.h"
#include "scene/frame.h"

/* -- what settings wait for ---------------------------------------------------------------------------------------- */

static int is_tower(const Settings *s)
{
    return s->problem.kind == PROBLEM_TOWER;
}

static int is_external(const Settings *s)
{
    return s->problem.kind == PROBLEM_EXTERNAL;
}

static int is_textbook(const Settings *s)
{
    return s->problem.kind >= PROBLEM_TEXTBOOK;
}

static int is_no_tower(const Settings *s)
{
    return !is_tower(s);
}

static int is_frame(const Settings *s)
{
    return !is_compiled_in(s->building.model) ? frame_is(s->building.model) : s->building.modes > 0;
}

static int is_matrices(const Settings *s)
{
    char storeys[OPTION_TEXT_MAX + 16];
    snprintf(storeys, sizeof storeys, "%s/storeys.csv", s->building.model);
    return is_compiled_in(s->building.model) || (!frame_is(s->building.model) && access(storeys, F_OK) != 0);
}

static int is_folder_of_matrices(const Settings *s)
{
    return is_matrices(s) && !is_compiled_in(s->building.model);
}

static int has_no_heights(const Settings *s)
{
    return is_matrices(s) && !list_is_given(s->building.heights_m);
}

static int is_damped_by_ratio(const Settings *s)
{
    return s->building.damping_model != DAMPING_TABLE;
}

static int is_rayleigh(const Settings *s)
{
    return s->building.damping_model == DAMPING_RAYLEIGH;
}

static int is_damped_by_table(const Settings *s)
{
    return s->building.damping_model == DAMPING_TABLE;
}

static int designs(const Settings *s, const char *variable)
{
    char word[64];
    for (size_t i = 0; i < list_count(s->design.variables); i++)
        if (list_item(s->design.variables, i, word, sizeof word) && strcmp(word, variable) == 0)
            return 1;
    return 0;
}

static int designs_bumpers(const Settings *s)
{
    return designs(s, "bumper");
}

static int designs_side(const Settings *s)
{
    return designs(s, "side");
}

static int is_box(const Settings *s)
{
    return s->core.section == CORE_BOX;
}

static int is_plate(const Settings *s)
{
    return s->core.section == CORE_PLATE;
}

static int is_effective(const Settings *s)
{
    return s->core.section == CORE_EFFECTIVE;
}

static int has_thickness(const Settings *s)
{
    return !is_effective(s);
}

static int is_effective_of_two(const Settings *s)
{
    return is_effective(s) && !list_is_given(s->core.areas_m2);
}

static int has_bumpers(const Settings *s)
{
    return s->contact.bumper_stiffness_n_m > 0 || designs_bumpers(s);
}

/* Of a list of records one may be a file. */
static int has_files(const Settings *s)
{
    return !builtin_name(s->motion.record) || (list_is_given(s->motion.records) && !builtin_name(s->motion.records));
}

static int has_spectral_value(const Settings *s)
{
    return s->motion.sa_g > 0;
}

/* What is replicated for its noise is not screened. */
static int is_screened(const Settings *s)
{
    const int repeats =
        s->problem.noisy == NOISY_YES && s->search.replicates_max > 1 && s->search.replicate_share > 0.0;
    const int by_replicates = is_tower(s) && s->sim.replicates > 1 && s->search.fidelity != FIDELITY_LEVELS,
              by_levels =
                  is_external(s) && list_is_given(s->problem.costs) && s->search.fidelity != FIDELITY_REPLICATES;
    return (by_replicates || by_levels) && !repeats;
}

static int is_fast(const Settings *s)
{
    return s->sim.engine == ENGINE_FAST;
}

static int has_parts(const Settings *s)
{
    return s->sim.replicates > 1 || list_is_given(s->motion.records);
}

static int is_quantile(const Settings *s)
{
    return s->sim.robust == ROBUST_QUANTILE && has_parts(s);
}

static int has_surrogate(const Settings *s)
{
    return s->search.surrogate != SURROGATE_OFF;
}

static int is_polished(const Settings *s)
{
    return s->search.polish > 0;
}

static const struct {
    const char *keys; /* patterns */
    int (*is_read)(const Settings *s);
    const char *where;
} WAITING[] = {
    {"building core contact motion sim uncertain design", is_tower, "problem.kind = tower"},
    {"search.objectives", is_tower, "problem.kind = tower"},
    {"problem.command problem.timeout_s problem.lower problem.upper problem.senses problem.costs", is_external,
     "problem.kind = external"},
    {"problem.variables problem.objectives problem.*_names", is_no_tower, "problem.kind is no tower"},
    {"problem.noise", is_textbook, "problem.kind is a test problem"},
    {"building.units", is_folder_of_matrices, "building.model is a folder with K.csv and M.csv"},
    {"building.first_storey_m building.storey_m", has_no_heights,
     "neither the files of building.model nor building.heights_m have heights"},
    {"building.rigid_floors", is_frame, "building.model is a plane frame"},
    {"building.damping", is_damped_by_ratio, "building.damping_model is not table"},
    {"building.rayleigh_modes", is_rayleigh, "building.damping_model = rayleigh"},
    {"building.damping_table", is_damped_by_table, "building.damping_model = table"},
    {"core.side_m", is_box, "core.section = box"},
    {"core.width_m", is_plate, "core.section = plate"},
    {"design.thickness_*", has_thickness, "core.section = box or plate"},
    {"core.area_* core.inertia_*", is_effective_of_two, "core.section = effective, without core.areas_m2"},
    {"core.shear_area_* core.areas_m2 core.inertias_m4 core.masses_kg", is_effective, "core.section = effective"},
    {"contact.bumper_damping contact.bumper_thickness_m contact.bumper_strain_max", has_bumpers,
     "there is a bumper (contact.bumper_stiffness_n_m, or bumper in design.variables)"},
    {"design.bumper_*", designs_bumpers, "design.variables has bumper"},
    {"design.side_*", designs_side, "design.variables has side"},
    {"motion.unit motion.channel motion.dt_s", has_files, "a record is a file"},
    {"motion.sa_period_s", has_spectral_value, "motion.sa_g is above 0"},
    {"sim.steps_per_contact sim.tolerance", is_fast, "sim.engine = fast"},
    {"search.fidelity", is_screened,
     "problem.kind = tower and sim.replicates is 2 or more (replicates), or problem.costs is given (levels), and "
     "problem.noisy is not yes"},
    {"sim.robust", has_parts, "there are replicates or further records (sim.replicates, motion.records)"},
    {"sim.quantile", is_quantile, "sim.robust = quantile, with replicates or further records"},
    {"search.trust_error search.surrogate_max", has_surrogate, "search.surrogate is not off"},
    {"search.polish_gain_min", is_polished, "search.polish is above 0"},
};

/* -- patterns ------------------------------------------------------------------------------------------------------ */

static int matches(const char *pattern, size_t n, const char *key)
{
    const char *star = memchr(pattern, '*', n);
    if (!star)
        return strncmp(pattern, key, n) == 0 && (key[n] == 0 || (key[n] == '.' && !memchr(pattern, '.', n)));
    const size_t before = (size_t)(star - pattern), behind = n - before - 1, length = strlen(key);
    return length >= before + behind && strncmp(pattern, key, before) == 0 &&
           strncmp(star + 1, key + length - behind, behind) == 0;
}

int settings_match(const char *patterns, const char *key)
{
    for (const char *p = patterns + strspn(patterns, " "); *p; p += strspn(p, " ")) {
        const size_t n = strcspn(p, " ");
        if (matches(p, n, key))
            return 1;
        p += n;
    }
    return 0;
}

const char *settings_idle(const Settings *s, const char *key)
{
    for (size_t i = 0; i < sizeof WAITING / sizeof WAITING[0]; i++)
        if (settings_match(WAITING[i].keys, key) && !WAITING[i].is_read(s))
            return WAITING[i].where;
    return NULL;
}

typedef struct {
    const Settings *s;
    IdleSettingFn idle;
    void *user;
} Looking;

static void look_at(const char *key, unsigned flags, const char *was, const char *is, void *user)
{
    const Looking *l = user;
    const char *where = settings_idle(l->s, key);
    (void)flags;
    (void)was;
    (void)is;
    if (where)
        l->idle(key, where, l->user);
}

void settings_idle_each(const Settings *s, IdleSettingFn idle, void *user)
{
    Settings defaults;
    settings_defaults(&defaults);
    settings_compare(&defaults, s, look_at, &(Looking){s, idle, user});
}
