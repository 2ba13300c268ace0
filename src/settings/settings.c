#include "settings/settings.h"

#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <ini.h>
#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/list.h"

typedef enum { KIND_REAL, KIND_WHOLE, KIND_CHOICE, KIND_TEXT, KIND_PATH, KIND_PATH_LIST } Kind;

typedef struct {
    const char *key;
    Kind kind;
    size_t offset;
    const char *standard; /* default, as one would type it */
    const char *unit;     /* REAL and WHOLE */
    double min, max;
    const char *words; /* CHOICE: "a|b|c", in the order of its enum; PATH: names that are no path, or NULL */
    const char *help;
    unsigned flags; /* SettingFlags */
} Option;

/* The place of a field; compiles only where the field is of that type. */
#define AT(field)             offsetof(Settings, field)
#define AT_TYPED(field, type) (AT(field) + 0 * sizeof(&((Settings *)0)->field == (type *)0))
typedef char OptionText[OPTION_TEXT_MAX];

/* A line of the table by its kind. The key is the path of the field; what follows the named columns is the help, and
 * .flags = ... where there are some. */
#define REAL(field, unit_, standard_, min_, max_, ...)                                                                 \
    {                                                                                                                  \
        .key = #field, .kind = KIND_REAL, .offset = AT_TYPED(field, double), .unit = unit_, .standard = standard_,     \
        .min = min_, .max = max_, .help = __VA_ARGS__                                                                  \
    }
#define WHOLE(field, standard_, min_, max_, ...)                                                                       \
    {                                                                                                                  \
        .key = #field, .kind = KIND_WHOLE, .offset = AT_TYPED(field, long), .unit = "-", .standard = standard_,        \
        .min = min_, .max = max_, .help = __VA_ARGS__                                                                  \
    }
#define CHOICE(field, type, words_, standard_, ...)                                                                    \
    {                                                                                                                  \
        .key = #field, .kind = KIND_CHOICE, .offset = AT_TYPED(field, type), .words = words_, .standard = standard_,   \
        .help = __VA_ARGS__                                                                                            \
    }
#define STRING(field, kind_, words_, standard_, ...)                                                                   \
    {                                                                                                                  \
        .key = #field, .kind = kind_, .offset = AT_TYPED(field, OptionText), .words = words_, .standard = standard_,   \
        .help = __VA_ARGS__                                                                                            \
    }
#define TEXT(field, standard_, ...)        STRING(field, KIND_TEXT, NULL, standard_, __VA_ARGS__)
#define PATH(field, standard_, names, ...) STRING(field, KIND_PATH, names, standard_, __VA_ARGS__)
#define PATH_LIST(field, standard_, ...)   STRING(field, KIND_PATH_LIST, NULL, standard_, __VA_ARGS__)

/* "fast|cvode|...": the first name brings no bar with it. */
#define X(upper, lower) "|" #lower
static const char ENGINE_BARS[] = ENGINE_LIST(X);
#undef X
#define ENGINE_WORDS (ENGINE_BARS + 1)

static const Option OPTIONS[] = {
    PATH(building.model, "guyan", "guyan|appendix", "guyan | appendix | a folder with K.csv [N/m] and M.csv [kg]",
         .flags = SETTING_FREE),
    REAL(building.damping, "-", "0.03", 0, 10, "damping ratio of every building mode"),
    REAL(building.first_storey_m, "m", "5.4864", 0.1, 100,
         "height of the first storey: where the core's first node is"),
    REAL(building.storey_m, "m", "3.9624", 0.1, 100, "height of every further storey"),

    CHOICE(core.section, CoreSection, CHOICE_WORDS(CORE_SECTION_LIST), "box",
           "box: square tube of side side_m; plate: solid, width_m wide, thickness deep; effective: area and inertia "
           "given"),
    CHOICE(core.theory, CoreTheory, CHOICE_WORDS(CORE_THEORY_LIST), "timoshenko",
           "timoshenko: with shear deformation and rotary inertia; euler_bernoulli: bending alone, as in the paper"),
    REAL(core.side_m, "m", "11.3", 0.1, 200, "outer side of the box"),
    REAL(core.width_m, "m", "11.3", 0.1, 200, "width of the plate"),
    REAL(core.damping, "-", "0.03", 0, 10, "damping ratio of every core mode"),
    REAL(core.youngs_modulus_pa, "Pa", "2.1e11", 1, 1e14, "of the core's steel"),
    REAL(core.poisson, "-", "0.3", 0, 0.5, "Poisson's ratio of the core's steel: its shear stiffness"),
    REAL(core.density_kg_m3, "kg/m3", "7850", 1, 1e5, "of the core's steel"),
    REAL(core.area_base_m2, "m2", "1.567", 1e-9, 1e4, "effective: first storey"),
    REAL(core.area_top_m2, "m2", "0.811", 1e-9, 1e4, "effective: last storey"),
    REAL(core.inertia_base_m4, "m4", "25.6201", 1e-9, 1e6, "effective: first storey"),
    REAL(core.inertia_top_m4, "m4", "24.0503", 1e-9, 1e6, "effective: last storey"),
    REAL(core.shear_area_base_m2, "m2", "0", 0, 1e4, "effective: first storey; 0: no shear deformation"),
    REAL(core.shear_area_top_m2, "m2", "0", 0, 1e4, "effective: last storey"),

    CHOICE(contact.law, ContactLaw, CHOICE_WORDS(CONTACT_LAW_LIST), "paper",
           "paper: a = 1.5 (1 - r); exact: a chosen so that an isolated impact rebounds with r; the others by their "
           "authors"),
    REAL(contact.restitution, "-", "0.7", 0, 1, "r of the contact law"),
    REAL(contact.v0_floor_m_s, "m/s", "1e-3", 1e-12, 10, "least approach speed that the contact law is given"),
    REAL(contact.radius_m, "m", "0.1", 1e-6, 1e3, "radius of the contacting body"),
    REAL(contact.youngs_modulus_pa, "Pa", "2.1e11", 1, 1e14, "of both bodies"),
    REAL(contact.poisson, "-", "0.3", 0, 0.5, "Poisson's ratio of both bodies"),

    PATH(motion.record, "builtin:kobe-like", NULL,
         "a ground motion file, or builtin:kobe-like | builtin:elcentro-like | builtin:sylmar-like",
         .flags = SETTING_FREE),
    PATH_LIST(motion.records, "none",
              "more records for the same study, a comma list: a design then answers to all of them (sim.robust)",
              .flags = SETTING_FREE),
    REAL(motion.pga_g, "g", "0.3", 0, 1e6, "scaled to this peak; 0: as recorded"),
    REAL(motion.stretch, "-", "3.1", 1e-3, 1e3, "time is multiplied by this"),
    CHOICE(motion.unit, MotionUnit, CHOICE_WORDS(MOTION_UNIT_LIST), "from_file",
           "of the acceleration, where the file does not say"),
    TEXT(motion.channel, "auto",
         "name or number (from 1) of the component, where the file has several; auto: there is only one"),
    REAL(motion.dt_s, "s", "0", 0, 100, "step of a file that has neither step nor times; 0: the file says it"),
    REAL(motion.resample_dt_s, "s", "0", 0, 100,
         "unequal times are resampled to this step by straight lines; 0: they are refused"),

    CHOICE(sim.engine, Engine, ENGINE_WORDS, "fast",
           "fast, or cvode (SUNDIALS, another method, slower) for a cross-check"),
    CHOICE(sim.accuracy, Accuracy, CHOICE_WORDS(ACCURACY_LIST), "standard",
           "what a run costs and how far it can be trusted (docs/chart.md)"),
    REAL(sim.steps_per_contact, "-", "0", 0, 1000,
         "engine fast: finer than sim.accuracy, with tolerances to match; 0: as sim.accuracy says"),
    REAL(sim.duration_s, "s", "0", 0, 1e6, "stop here; 0: at the end of the motion"),
    REAL(sim.residual_max, "-", "0.001", 1e-12, 1,
         "a run whose energy books are open by more than this share of the input is refined, then failed"),
    WHOLE(sim.ensemble, "1", 1, 1000,
          "simulations of each design in a study, gaps changed a little: the objectives are their means"),
    REAL(sim.gap_tolerance_m, "m", "0", 0, 1, "standard deviation of a gap as built; wants sim.ensemble of 2 at least"),
    CHOICE(sim.robust, Robust, CHOICE_WORDS(ROBUST_LIST), "worst",
           "of several records: the worst of each objective, or the mean"),

    REAL(design.gap_min_m, "m", "0.001", 0, 10, "search box: least gap"),
    REAL(design.gap_max_m, "m", "0.5", 1e-6, 10, "search box: widest gap"),
    REAL(design.thickness_min_m, "m", "0.004", 1e-6, 10, "search box: thinnest core wall"),
    REAL(design.thickness_max_m, "m", "0.04", 1e-6, 10, "search box: thickest core wall"),

    CHOICE(
        problem.kind, ProblemKind, CHOICE_WORDS(PROBLEM_KIND_LIST), "tower",
        "tower: gaps and walls of the scene; external: a simulator of your own; the others: problems from textbooks"),
    TEXT(problem.command, "none",
         "external: the worker, started without a shell once per thread; docs/external.md has the protocol"),
    REAL(problem.timeout_s, "s", "600", 1e-3, 1e7,
         "external: a worker that is silent for so long has failed and is replaced", .flags = SETTING_LIMIT),
    WHOLE(problem.variables, "22", 1, 10000, "their number; not of a tower"),
    WHOLE(problem.objectives, "7", 1, 100, "their number; not of a tower"),
    TEXT(problem.lower, "0", "external: one number for all, or a comma list"),
    TEXT(problem.upper, "1", "external: one number for all, or a comma list"),
    TEXT(problem.senses, "min", "external: min or max, one for all objectives, or a comma list"),
    TEXT(problem.variable_names, "auto", "comma list; auto: x1, x2, ..."),
    TEXT(problem.objective_names, "auto", "comma list; auto: f1, f2, ..."),
    CHOICE(problem.noisy, Noisy, CHOICE_WORDS(NOISY_LIST), "auto",
           "whether the same design answers differently each time; auto: only with problem.noise"),
    REAL(problem.noise, "-", "0", 0, 1,
         "problems from textbooks: standard deviation of the answers, share of their value"),

    WHOLE(search.seed, "1", 0, 4294967295.0, "same seed and settings: same bytes"),
    WHOLE(search.threads, "0", 0, 1024, "0: one per processor", .flags = SETTING_FREE),
    WHOLE(search.population, "92", 4, 100000, "designs per generation"),
    WHOLE(search.initial, "0", 0, 1000000,
          "designs of the Latin hypercube start, no more than max_evals; 0: by the number of variables"),
    PATH(search.start, "none", NULL,
         "designs to begin with: a CSV with a column per variable, or the folder of a run, whose front is taken",
         .flags = SETTING_FREE),
    WHOLE(search.generations, "1000", 1, 1e9, "stop after so many", .flags = SETTING_LIMIT),
    WHOLE(search.max_evals, "2000", 4, 1e6, "stop after so many simulations", .flags = SETTING_LIMIT),
    REAL(search.max_hours, "h", "0", 0, 1e4, "stop after so long; 0: no limit", .flags = SETTING_LIMIT),
    REAL(search.nondominated_share, "-", "1", 0, 1,
         "stop when this share of all simulated designs is nondominated; 1: never", .flags = SETTING_LIMIT),
    REAL(search.trust_error, "-", "0.05", 0, 10,
         "a prediction stands where its leave-one-out based error is below this share of every objective's range"),
    REAL(search.crossover_probability, "-", "1", 0, 1, "of a pair (SBX)"),
    REAL(search.crossover_eta, "-", "20", 0, 1000, "distribution index of SBX"),
    REAL(search.mutation_eta, "-", "20", 0, 1000, "distribution index of polynomial mutation"),
    REAL(search.mutation_rate, "-", "1", 0, 100, "variables mutated per design, on average"),
    WHOLE(search.surrogate_max, "600", 10, 5000, "most designs that the response surface is built on"),
    CHOICE(search.surrogate, SurrogateUse, CHOICE_WORDS(SURROGATE_USE_LIST), "on",
           "off: a plain evolutionary search; auto: off where it proves to cost more than four simulations for each, "
           "by the "
           "clock"),
    CHOICE(search.asynchronous, Switch, CHOICE_WORDS(SWITCH_LIST), "off",
           "on: no thread waits for the slowest design of a batch; the run then depends on the order in which results "
           "come"),
    CHOICE(search.survival, SurvivalKind, CHOICE_WORDS(SURVIVAL_KIND_LIST), "nsga3",
           "who lives on from one generation to the next: NSGA-III, RVEA or MOEA/D with PBI"),
    REAL(search.repeats, "-", "0.1", 0, 0.9,
         "noisy answers: share of the simulations that try designs of the front again (docs/search.md)"),
    WHOLE(search.members_min, "1", 1, 1000, "noisy answers: simulations that a design in front.csv has at least"),
    WHOLE(search.members_max, "4", 1, 1000, "noisy answers: simulations of one design at most; 1: none is repeated"),
    WHOLE(search.polish, "3", 0, 32,
          "tower: designs that are polished at the end, with a tenth more simulations; none where that is too few"),
    TEXT(search.limits, "none", "what objectives must keep, as j3_g<=5,edcs_pct>=3; none"),

    TEXT(run.out, "results/study", "the run's folder", .flags = SETTING_FREE),
};

enum { N_OPTIONS = sizeof OPTIONS / sizeof OPTIONS[0] };

_Static_assert(sizeof(CoreSection) == sizeof(int), "a choice is stored as an int");
_Static_assert((int)OPTION_TEXT_MAX == (int)LIST_MAX, "a list of the settings can be changed");

const char *settings_key(int i)
{
    return i < N_OPTIONS ? OPTIONS[i].key : NULL;
}

const char *settings_words(int i)
{
    return OPTIONS[i].kind == KIND_CHOICE ? OPTIONS[i].words : NULL;
}

unsigned settings_flags(int i)
{
    return OPTIONS[i].flags;
}

static void *field_of(Settings *s, const Option *o)
{
    return (char *)s + o->offset;
}

static const void *field_of_const(const Settings *s, const Option *o)
{
    return (const char *)s + o->offset;
}

/* Index of value in "a|b|c", or -1. */
static int word_index(const char *words, const char *value)
{
    const size_t length = strlen(value);
    for (int i = 0; words; i++) {
        const char *end = strchr(words, '|');
        const size_t n = end ? (size_t)(end - words) : strlen(words);
        if (n == length && strncmp(words, value, n) == 0)
            return i;
        words = end ? end + 1 : NULL;
    }
    return -1;
}

static void format_word(char text[OPTION_TEXT_MAX], const char *words, int index)
{
    while (index-- > 0)
        words = strchr(words, '|') + 1;
    snprintf(text, OPTION_TEXT_MAX, "%.*s", (int)strcspn(words, "|"), words);
}

static Status unknown_word(const Option *o, const char *value, Err *err)
{
    enum { WORDS_MAX = 24 };
    char copy[512], *rest = copy;
    const char *list[WORDS_MAX];
    int n = 0;
    snprintf(copy, sizeof copy, "%s", o->words);
    for (char *word; n < WORDS_MAX && (word = strsep(&rest, "|"));)
        list[n++] = word;
    const char *near = nearest_word(value, list, n);
    return near ? fail(err, STATUS_BAD_DATA, "%s: '%.60s' is not one of %s; did you mean %s?", o->key, value, o->words,
                       near)
                : fail(err, STATUS_BAD_DATA, "%s: '%.60s' is not one of %s", o->key, value, o->words);
}

static Status parse_number(const Option *o, const char *value, double *number, Err *err)
{
    const char *unit = strcmp(o->unit, "-") == 0 ? "" : o->unit;
    char *end;
    errno = 0;
    *number = strtod(value, &end);
    if (end == value || *end)
        return fail(err, STATUS_BAD_DATA, "%s: '%s' is not a number%s%s%s", o->key, value, *unit ? " [" : "", unit,
                    *unit ? "]" : "");
    if (!(*number >= o->min && *number <= o->max)) /* also rejects NaN */
        return fail(err, STATUS_BAD_DATA, "%s: %s is outside %.10g..%.10g%s%s", o->key, value, o->min, o->max,
                    *unit ? " " : "", unit);
    if (o->kind == KIND_WHOLE && *number != (double)(long)*number)
        return fail(err, STATUS_BAD_DATA, "%s: %s is not a whole number", o->key, value);
    return STATUS_OK;
}

static Status assign(Settings *s, const Option *o, const char *value, Err *err)
{
    double number;
    switch (o->kind) {
    case KIND_REAL:
        TRY(parse_number(o, value, &number, err));
        *(double *)field_of(s, o) = number;
        return STATUS_OK;
    case KIND_WHOLE:
        TRY(parse_number(o, value, &number, err));
        *(long *)field_of(s, o) = (long)number;
        return STATUS_OK;
    case KIND_CHOICE: {
        const int i = word_index(o->words, value);
        if (i < 0)
            return unknown_word(o, value, err);
        memcpy(field_of(s, o), &i, sizeof i); /* an enumeration */
        return STATUS_OK;
    }
    case KIND_TEXT:
    case KIND_PATH:
    case KIND_PATH_LIST:
        if (!value[0])
            return fail(err, STATUS_BAD_DATA, "%s: is empty", o->key);
        if (strlen(value) >= OPTION_TEXT_MAX)
            return fail(err, STATUS_BAD_DATA, "%s: is longer than %d characters", o->key, OPTION_TEXT_MAX - 1);
        if (strpbrk(value, "\r\n") || strstr(value, " ;") || isspace((unsigned char)value[0]) ||
            isspace((unsigned char)value[strlen(value) - 1]))
            return fail(err, STATUS_BAD_DATA,
                        "%s: '%.60s' cannot be kept in a settings file (line ends, ' ;', blanks around it)", o->key,
                        value);
        snprintf(field_of(s, o), OPTION_TEXT_MAX, "%s", value);
        return STATUS_OK;
    }
    return STATUS_INTERNAL;
}

void settings_defaults(Settings *s)
{
    memset(s, 0, sizeof *s);
    for (int i = 0; i < N_OPTIONS; i++)
        assign(s, &OPTIONS[i], OPTIONS[i].standard, NULL);
}

static Status find_option(const char *key, const Option **found, Err *err)
{
    const char *keys[N_OPTIONS];
    for (int i = 0; i < N_OPTIONS; i++) {
        keys[i] = OPTIONS[i].key;
        if (strcmp(key, keys[i]) == 0) {
            *found = &OPTIONS[i];
            return STATUS_OK;
        }
    }
    const char *near = nearest_word(key, keys, N_OPTIONS);
    return near ? fail(err, STATUS_BAD_DATA, "%s: no such setting; did you mean %s?", key, near)
                : fail(err, STATUS_BAD_DATA, "%s: no such setting; `imtet settings` lists them all", key);
}

static Status set_key(Settings *s, const char *key, const char *value, Err *err)
{
    const Option *o = NULL;
    TRY(find_option(key, &o, err));
    return assign(s, o, value, err);
}

typedef struct {
    Settings *s;
    const char *path;
    FILE *faults;
    FILE *file;
    char *text; /* the line at hand, whole */
    size_t capacity;
    const char *long_value; /* in text: what did not fit into the library's line */
    int n_faults, line;
    int seen[N_OPTIONS]; /* the line that set it, 0: none */
    Err *first;
} Reading;

static void report_fault(Reading *r, int line, const char *text)
{
    if (r->n_faults++ == 0)
        fail(r->first, STATUS_BAD_DATA, "%s:%d: %s", r->path, line, text);
    if (r->faults)
        fprintf(r->faults, "%s:%d: %s\n", r->path, line, text);
}

int setting_is_path(const char *value)
{
    return strncmp(value, "builtin:", 8) != 0 && strcmp(value, "none") != 0;
}

/* The paths of one option, handed to `change`; a list's one by one. */
static void change_paths(Settings *s, const Option *o, ListItemFn change, void *user)
{
    char *value = field_of(s, o);
    if (o->kind == KIND_PATH_LIST)
        list_change(value, change, user);
    else if (o->kind == KIND_PATH && !(o->words && word_index(o->words, value) >= 0))
        change(value, user);
}

static void make_absolute(char path[OPTION_TEXT_MAX], void *user)
{
    (void)user;
    if (!setting_is_path(path))
        return;
    char *absolute = realpath(path, NULL);
    if (absolute && strlen(absolute) < OPTION_TEXT_MAX)
        snprintf(path, OPTION_TEXT_MAX, "%s", absolute);
    free(absolute);
}

void settings_make_absolute(Settings *s)
{
    for (int i = 0; i < N_OPTIONS; i++)
        change_paths(s, &OPTIONS[i], make_absolute, NULL);
}

/* A path that was written in a settings file is meant from that file's folder. */
static void anchor_path(char path[OPTION_TEXT_MAX], void *user)
{
    const Reading *r = user;
    const char *slash = strrchr(r->path, '/');
    if (!slash || path[0] == '/' || !setting_is_path(path))
        return;
    char anchored[2 * OPTION_TEXT_MAX];
    snprintf(anchored, sizeof anchored, "%.*s/%s", (int)(slash - r->path), r->path, path);
    if (strlen(anchored) < OPTION_TEXT_MAX && access(anchored, F_OK) == 0)
        memcpy(path, anchored, strlen(anchored) + 1);
}

/* Stands for a value that waits in long_value; no settings file holds this byte. */
static const char ELSEWHERE[] = "\x01";

/* The library takes lines of `size` - 1 bytes, too few for a long path: such a value waits in long_value. */
static void hand_over(Reading *r, char *text, char *line, int size)
{
    r->long_value = NULL;
    if (strlen(text) < (size_t)size) {
        memcpy(line, text, strlen(text) + 1);
        return;
    }
    char *equals = strchr(text, '=');
    char *note = strstr(text, " ;");
    if (text[0] == ';' || text[0] == '#') {
        line[0] = 0;
    } else if (!equals || equals - text + 4 > size) {
        report_fault(r, r->line, "the line is too long");
        line[0] = 0;
    } else {
        if (note)
            *note = 0;
        r->long_value = equals + 1 + strspn(equals + 1, " \t");
        snprintf(line, (size_t)size, "%.*s%s", (int)(equals + 1 - text), text, ELSEWHERE);
    }
}

/* Counts lines for the messages and refuses what the library would skip or join without a word: it reports its first
 * bad line only, and takes an indented line for a continuation of the one above. */
static char *next_line(char *line, int size, void *user)
{
    Reading *r = user;
    const ssize_t n = getline(&r->text, &r->capacity, r->file);
    if (n < 0)
        return NULL;
    r->line++;
    line[0] = 0;
    char *text = r->text;
    const int has_nul = strlen(text) != (size_t)n;
    if (r->line == 1 && strncmp(text, "\xEF\xBB\xBF", 3) == 0)
        text += 3;
    text += strspn(text, " \t");
    for (char *end = text + strlen(text); end > text && isspace((unsigned char)end[-1]);)
        *--end = 0;
    if (has_nul)
        report_fault(r, r->line, "holds a NUL byte; this is not a settings file");
    else if (strchr(";#", text[0]) || (text[0] == '[' && strchr(text, ']')) || strchr(text, '='))
        hand_over(r, text, line, size);
    else
        report_fault(r, r->line, "neither [section] nor key = value");
    return line;
}

static int take_pair(void *user, const char *section, const char *name, const char *value)
{
    Reading *r = user;
    char key[128];
    Err err = {0};
    const Option *o = NULL;
    if (strcmp(value, ELSEWHERE) == 0 && r->long_value)
        value = r->long_value;
    snprintf(key, sizeof key, "%s%s%s", section, section[0] ? "." : "", name);
    if (find_option(key, &o, &err) != STATUS_OK || assign(r->s, o, value, &err) != STATUS_OK) {
        report_fault(r, r->line, err.text);
        return 1;
    }
    int *seen = &r->seen[o - OPTIONS];
    if (*seen) {
        fail(&err, STATUS_BAD_DATA, "%s: was set in line %d already; remove one of the two", key, *seen);
        report_fault(r, r->line, err.text);
    }
    *seen = r->line;
    change_paths(r->s, o, anchor_path, r);
    return 1;
}

/* The rules that tie settings together: each broken one is handed to `broken` with the fields it ties. */
typedef void (*BrokenFn)(const size_t fields[3], const char *text, void *user);

static void check_rules(const Settings *s, BrokenFn broken, void *user)
{
    Err e;
    if (s->design.gap_min_m >= s->design.gap_max_m) {
        fail(&e, STATUS_BAD_DATA, "design.gap_min_m: %g must be below design.gap_max_m = %g", s->design.gap_min_m,
             s->design.gap_max_m);
        broken((size_t[]){AT(design.gap_min_m), AT(design.gap_max_m), AT(design.gap_max_m)}, e.text, user);
    }
    if (s->design.thickness_min_m >= s->design.thickness_max_m) {
        fail(&e, STATUS_BAD_DATA, "design.thickness_min_m: %g must be below design.thickness_max_m = %g",
             s->design.thickness_min_m, s->design.thickness_max_m);
        broken((size_t[]){AT(design.thickness_min_m), AT(design.thickness_max_m), AT(design.thickness_max_m)}, e.text,
               user);
    }
    if (s->sim.gap_tolerance_m > 0.0 && s->sim.ensemble < 2) {
        fail(&e, STATUS_BAD_DATA, "sim.gap_tolerance_m: wants members to try it on: set sim.ensemble to 2 at least");
        broken((size_t[]){AT(sim.gap_tolerance_m), AT(sim.ensemble), AT(sim.ensemble)}, e.text, user);
    }
    if (s->problem.kind == PROBLEM_EXTERNAL && strcmp(s->problem.command, "none") == 0) {
        fail(&e, STATUS_BAD_DATA, "problem.command: is none; problem.kind = external wants the worker's command");
        broken((size_t[]){AT(problem.command), AT(problem.kind), AT(problem.kind)}, e.text, user);
    }
    if (s->search.members_min > s->search.members_max) {
        fail(&e, STATUS_BAD_DATA, "search.members_min: %ld is above search.members_max = %ld", s->search.members_min,
             s->search.members_max);
        broken((size_t[]){AT(search.members_min), AT(search.members_max), AT(search.members_max)}, e.text, user);
    }
    if (s->search.members_min > 1 && !(s->search.repeats > 0.0)) {
        fail(&e, STATUS_BAD_DATA, "search.members_min: %ld simulations of a design want search.repeats above 0",
             s->search.members_min);
        broken((size_t[]){AT(search.members_min), AT(search.repeats), AT(search.repeats)}, e.text, user);
    }
    if (s->core.section == CORE_BOX && 2 * s->design.thickness_max_m > s->core.side_m) {
        fail(&e, STATUS_BAD_DATA, "design.thickness_max_m: two walls of %g m do not fit into core.side_m = %g",
             s->design.thickness_max_m, s->core.side_m);
        broken((size_t[]){AT(design.thickness_max_m), AT(core.side_m), AT(core.section)}, e.text, user);
    }
}

static void report_broken(const size_t fields[3], const char *text, void *user)
{
    Reading *r = user;
    int line = 0;
    for (int k = 0; k < 3 && !line; k++)
        for (int i = 0; i < N_OPTIONS && !line; i++)
            line = OPTIONS[i].offset == fields[k] ? r->seen[i] : 0;
    report_fault(r, line, text);
}

/* Closes the file. */
static Status read_stream(Reading *r, int *n_faults, Err *err)
{
    const int bad_line = ini_parse_stream(next_line, r, take_pair, r);
    const int read_error = ferror(r->file), whole = feof(r->file);
    fclose(r->file);
    free(r->text);
    if (read_error)
        return fail(err, STATUS_MISSING, "%s: cannot be read (is it a folder?)", r->path);
    if (!whole)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory to read it", r->path);
    if (bad_line > 0 && r->n_faults == 0)
        report_fault(r, bad_line, "neither [section] nor key = value");
    check_rules(r->s, report_broken, r);
    if (n_faults)
        *n_faults = r->n_faults;
    return r->n_faults ? STATUS_BAD_DATA : STATUS_OK;
}

Status settings_read(Settings *s, const char *path, FILE *faults, int *n_faults, Err *err)
{
    Reading r = {.s = s, .path = path, .faults = faults, .first = err};
    r.file = fopen(path, "rb");
    if (!r.file)
        return fail(err, status_of_errno(errno, STATUS_MISSING), "%s: %s", path, strerror(errno));
    return read_stream(&r, n_faults, err);
}

Status settings_parse(Settings *s, const char *path, const char *text, Err *err)
{
    Reading r = {.s = s, .path = path, .first = err};
    r.file = text[0] ? fmemopen((void *)(uintptr_t)text, strlen(text), "rb") : fopen("/dev/null", "rb");
    if (!r.file)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for its settings", path);
    return read_stream(&r, NULL, err);
}

Status settings_set(Settings *s, const char *assignment, Err *err)
{
    char key[128];
    const char *equals = strchr(assignment, '=');
    if (!equals || equals == assignment || (size_t)(equals - assignment) >= sizeof key)
        return fail(err, STATUS_USAGE, "--set %s: write --set section.key=value", assignment);
    snprintf(key, sizeof key, "%.*s", (int)(equals - assignment), assignment);
    return set_key(s, key, equals + 1, err);
}

static void keep_first(const size_t fields[3], const char *text, void *user)
{
    (void)fields;
    Err *first = user;
    if (first->code == STATUS_OK)
        fail(first, STATUS_BAD_DATA, "%s", text);
}

Status settings_check(const Settings *s, Err *err)
{
    Err first = {0};
    check_rules(s, keep_first, &first);
    return first.code == STATUS_OK ? STATUS_OK : fail(err, first.code, "%s", first.text);
}

/* The fewest digits that read back as the same number. */
static void format_real(double value, char text[OPTION_TEXT_MAX])
{
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, OPTION_TEXT_MAX, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
}

static void format_value(const Settings *s, const Option *o, char text[OPTION_TEXT_MAX])
{
    const void *field = field_of_const(s, o);
    int word;
    switch (o->kind) {
    case KIND_REAL:
        format_real(*(const double *)field, text);
        break;
    case KIND_WHOLE:
        snprintf(text, OPTION_TEXT_MAX, "%ld", *(const long *)field);
        break;
    case KIND_CHOICE:
        memcpy(&word, field, sizeof word);
        format_word(text, o->words, word);
        break;
    case KIND_TEXT:
    case KIND_PATH:
    case KIND_PATH_LIST:
        snprintf(text, OPTION_TEXT_MAX, "%s", (const char *)field);
        break;
    }
}

void settings_each(const Settings *s, SettingFn take, void *user)
{
    char value[OPTION_TEXT_MAX];
    for (int i = 0; i < N_OPTIONS; i++) {
        format_value(s, &OPTIONS[i], value);
        take(OPTIONS[i].key, value, user);
    }
}

void settings_compare(const Settings *was, const Settings *is, SettingsDiffFn differs, void *user)
{
    char before[OPTION_TEXT_MAX], after[OPTION_TEXT_MAX];
    for (int i = 0; i < N_OPTIONS; i++) {
        format_value(was, &OPTIONS[i], before);
        format_value(is, &OPTIONS[i], after);
        if (strcmp(before, after) != 0)
            differs(OPTIONS[i].key, OPTIONS[i].flags, before, after, user);
    }
}

static void describe(const Option *o, FILE *out)
{
    fprintf(out, "; %s", o->help);
    if (o->kind == KIND_REAL || o->kind == KIND_WHOLE)
        fprintf(out, " [%s, %.10g..%.10g]", o->unit, o->min, o->max);
    if (o->kind == KIND_CHOICE)
        fprintf(out, " (%s)", o->words);
    fputc('\n', out);
}

void settings_write(const Settings *s, FILE *out, int described)
{
    const char *section = "";
    char value[OPTION_TEXT_MAX];
    for (int i = 0; i < N_OPTIONS; i++) {
        const Option *o = &OPTIONS[i];
        const int n = (int)strcspn(o->key, ".");
        if (strncmp(section, o->key, (size_t)n + 1) != 0)
            fprintf(out, "%s[%.*s]\n", i ? "\n" : "", n, o->key);
        section = o->key;
        if (described)
            describe(o, out);
        format_value(s, o, value);
        fprintf(out, "%s = %s\n", o->key + n + 1, value);
    }
}
