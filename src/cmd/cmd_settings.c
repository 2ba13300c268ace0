#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.h"
#include "cmd/commands.h"
#include "cmd/show.h"
#include "scene/building.h"
#include "settings/settings.h"
#include "store/output.h"

static void put_setting(const char *key, const char *value, void *list)
{
    json_object_set_new(list, key, json_string(value));
}

static Status run(const Args *args, Err *err)
{
    json_t *list = json_object();
    Settings s;
    settings_defaults(&s);
    settings_each(&s, args->operand, put_setting, list);
    if (json_object_size(list) > 0 && args_has(args, "--json"))
        return show_json(list, err);
    const size_t n = json_object_size(list);
    json_decref(list);
    if (n == 0)
        return settings_put(&s, args->operand, "", err);
    if (!args->operand)
        printf("; Every setting of imtet with its default. A setting that is left out of a file keeps this value.\n\n");
    settings_write(&s, stdout, SETTINGS_DESCRIBED, args->operand);
    return STATUS_OK;
}

const Command CMD_SETTINGS = {
    .name = "settings",
    .group = GROUP_PREPARE,
    .operand = "[KEY|WORD]",
    .summary = "every setting with default, range, unit and meaning",
    .example = "imtet settings motion.pga_g",
    .details = "Prints every setting with its default below its meaning, unit and range. The output is a valid\n"
               "configuration (imtet settings > mine.ini). With KEY or WORD it prints only the settings whose name\n"
               "or meaning has it.",
    .options =
        {
            SWITCH("--json", "keys and defaults as an object"),
        },
    .run = run,
    .only_reads = 1,
};

/* ---- new --------------------------------------------------------------------------------------------------------- */

/* Studies to begin with: their settings, KEY=VALUE, beside those by the building (fit_building). What is not there
 * keeps its default. The paper's is configs/kobe.ini. */
static const struct {
    const char *name, *settings[10];
} PRESETS[] = {
    {"stops",
     {"design.variables=gaps, thickness, anchors", "search.objectives=j1_m, drift_ratio, j3_filtered_g, cost",
      "search.max_evals=300"}},
    {"devices",
     {"design.variables=gaps, thickness, anchors, links", "design.devices=gap, link, none",
      "search.objectives=j1_m, drift_ratio, j3_filtered_g, cost", "search.max_evals=300"}},
    {"engineer",
     {"design.variables=gaps, thickness, anchors, links", "design.devices=gap, link, none", "sim.forces=yes",
      "search.objectives=j1_m, drift_ratio, j3_filtered_g, cost", "search.max_evals=600",
      "search.limits=drift_ratio<=0.02, core_stress_pa<=3.45e8, core_buckling_ratio<=1, contact_force_max_n<=6.5e6"}},
    {"risk",
     {"design.variables=gaps, thickness, anchors", "motion.records=builtin:suite", "sim.robust=mean",
      "search.fidelity=records", "search.objectives=loss, j1_m, drift_ratio, cost",
      "search.limits=p(drift_ratio>0.02)<=0.1", "search.max_evals=300"}},
    {"paper",
     {"sim.model=given", "core.theory=euler_bernoulli", "motion.pga_g=0.3", "motion.stretch=3.1",
      "search.max_evals=1500", "search.stop_after=1000"}},
};

static Status take_preset(const char *name, Settings *s, Err *err)
{
    const char *known[N_OF(PRESETS)];
    for (size_t i = 0; i < N_OF(PRESETS); i++) {
        known[i] = PRESETS[i].name;
        for (const char *const *set = PRESETS[i].settings; strcmp(name, known[i]) == 0; set++)
            if (*set)
                TRY(settings_set(s, *set, err));
            else
                return STATUS_OK;
    }
    return fail_no_word(err, STATUS_USAGE, "--preset", name, "preset", known, N_OF(PRESETS));
}

/* Unless an option says it. */
__attribute__((format(printf, 4, 5))) static Status put_unless_given(const Args *args, Settings *s, const char *key,
                                                                     const char *format, ...)
{
    char value[OPTION_TEXT_MAX];
    Err err;
    va_list list;
    va_start(list, format);
    vsnprintf(value, sizeof value, format, list);
    va_end(list);
    return args_gives(args, key) ? STATUS_OK : settings_put(s, key, value, &err);
}

/* The search box by the building: gaps of up to 0.6 % of its height, which is what a building of steel sways by; a core
 * as slender as that of the paper's tower, with stiffeners, for bare walls would buckle, on a mat twice as wide on
 * ground of class C, with anchors, for its weight alone would let it lift; links of 3 to 300 % of the dashpot per floor
 * that would damp the first mode critically, were the building rigid; and five zones of floors at most. */
static Status fit_building(const Args *args, Settings *s, Err *err)
{
    static const double SWAY = 0.006, SLENDERNESS = 7, LEAST = 0.03, MOST = 3;
    enum { ZONES = 5, ANCHORS_MAX = 100 };
    Building b;
    double height = 0;
    TRY(building_load(&b, &s->building, err));
    for (int j = 0; j < b.n; j++)
        height += b.storey_m[j];
    const int n = b.n, zones = MIN_OF(b.n, (int)ZONES);
    const double per_floor = 2 * building_mass(&b) * b.omega[0] / n;
    building_free(&b);
    TRY(put_unless_given(args, s, "design.gap_m", "0.001, %.2g", SWAY * height));
    TRY(put_unless_given(args, s, "core.width_m", "%.2g", height / SLENDERNESS));
    TRY(put_unless_given(args, s, "core.stiffeners", "0.25"));
    TRY(put_unless_given(args, s, "core.foundation", "soil=C radius=%g anchors=%d", s->core.width_m, ANCHORS_MAX));
    if (!strstr(s->design.variables, "links"))
        return STATUS_OK;
    TRY(put_unless_given(args, s, "design.link_n_s_m", "%.2g, %.2g", LEAST * per_floor, MOST * per_floor));
    if (zones == n)
        return STATUS_OK;
    TRY(put_unless_given(args, s, "design.gap_zones", "%d", zones));
    TRY(put_unless_given(args, s, "design.link_zones", "%d", zones));
    return put_unless_given(args, s, "design.device_zones", "%d", zones);
}

typedef struct {
    Status status;
    Err *err;
} Looked;

/* Is the file there that a setting names? The first that is not ends in words that say which setting it is. */
static void look_for(const char *key, const char *path, void *user)
{
    Looked *l = user;
    Err why;
    if (l->status != STATUS_OK || access(path, F_OK) == 0)
        return;
    fail_missing(&why, path);
    l->status = fail(l->err, why.code, "%s: %s", key, why.text);
}

static Status begin(const Args *args, Err *err)
{
    static const char NAME[] = "study.ini";
    const char *preset = args_value(args, "--preset");
    Looked looked = {.err = err};
    char path[PATH_MAX], quoted[4 * PATH_MAX + 3];
    Settings s;
    Output o;

    /* 1. The settings: by the preset, by options over it, and by the building. */
    settings_defaults(&s);
    TRY(settings_put(&s, "sim.model", "auto", err));
    TRY(preset ? take_preset(preset, &s, err) : STATUS_OK);
    TRY(args_apply(args, &s, NULL, NULL, err));
    settings_each_path(&s, look_for, &looked);
    TRY(looked.status);
    TRY(preset && s.sim.model == MODEL_AUTO ? fit_building(args, &s, err) : STATUS_OK);
    TRY(settings_check(&s, err));

    /* 2. Their file, in a folder that has none. */
    if (snprintf(path, sizeof path, "%s/%s", args->operand, NAME) >= (int)sizeof path)
        return misused(err, "%.60s...: the path is too long", args->operand);
    if (mkdir(args->operand, 0777) != 0 && errno != EEXIST)
        return fail(err, STATUS_IO, "%s: %s", args->operand, strerror(errno));
    if (faccessat(AT_FDCWD, path, F_OK, AT_SYMLINK_NOFOLLOW) == 0)
        return misused(err, "%s: exists already; name another folder", path);
    char *folder = realpath(args->operand, NULL), out[PATH_MAX];
    if (!folder)
        return fail(err, STATUS_IO, "%s: %s", args->operand, strerror(errno));
    settings_make_relative(&s, folder);
    snprintf(out, sizeof out, "results%s", strrchr(folder, '/'));
    free(folder);
    TRY(args_gives(args, "run.out") ? STATUS_OK : settings_put(&s, "run.out", out, err));
    TRY(output_open(&o, path, err));
    fputs("; Settings that are not written here keep their defaults: `imtet settings` lists all.\n\n", o.stream);
    settings_write(&s, o.stream, SETTINGS_BASIC, NULL);
    TRY(output_close(&o, err));
    text_shell(path, quoted);
    printf("%s: edit it, then `imtet check %s` and `imtet optimize %s`\n", path, quoted, quoted);
    return STATUS_OK;
}

const Command CMD_NEW = {
    .name = "new",
    .group = GROUP_PREPARE,
    .operand = "FOLDER",
    .summary = "begin a study: a folder with the settings that a first study needs",
    .example = "imtet new tower --preset devices --record builtin:kobe-like",
    .details = "Writes FOLDER/study.ini with the settings that a first study needs, each below its meaning, unit\n"
               "and range. Files must exist; the study names them by their path from FOLDER. Its run goes to\n"
               "results/FOLDER. A preset has few objectives and a search box that fits the building: gaps of up to\n"
               "0.6 % of its height, a core of a seventh of it. Options and --set override the preset.",
    .options =
        {
            VALUE("--preset", "NAME",
                  "a short study: stops, devices (stops, links or nothing), engineer (with limits), risk or paper"),
            OPTION_RECORD,
            OPTION_PGA,
            OPTION_SET,
        },
    .run = begin,
    .only_reads = 1,
};
