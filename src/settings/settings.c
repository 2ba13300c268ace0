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

typedef enum { REAL, WHOLE, CHOICE, TEXT } Kind;

typedef struct {
    const char *key, *unit;
    Kind kind;
    size_t offset;
    const char *standard; /* default, as one would type it */
    double min, max;      /* REAL and WHOLE */
    const char *words;    /* CHOICE: "a|b|c", in the order of its enum */
    const char *help;
} Option;

#define AT(field) offsetof(Settings, field)

/* "fast|cvode|...": the first name brings no bar with it. */
#define X(upper, lower) "|" #lower
static const char ENGINE_BARS[] = ENGINE_LIST(X);
#undef X
#define ENGINE_WORDS (ENGINE_BARS + 1)

static const Option OPTIONS[] = {
    /* key, unit, kind, field, default, min, max, words, help */
    {"building.model", "-", TEXT, AT(building.model), "guyan", 0, 0, NULL,
     "guyan | appendix | a folder with K.csv [N/m] and M.csv [kg]"},
    {"building.damping", "-", REAL, AT(building.damping), "0.03", 0, 10, NULL, "damping ratio of every building mode"},
    {"building.first_storey_m", "m", REAL, AT(building.first_storey_m), "5.4864", 0.1, 100, NULL,
     "height of the first storey: where the core's first node is"},
    {"building.storey_m", "m", REAL, AT(building.storey_m), "3.9624", 0.1, 100, NULL, "height of every further storey"},

    {"core.section", "-", CHOICE, AT(core.section), "box", 0, 0, "box|plate|effective",
     "box: square tube of side side_m; plate: solid, width_m wide, thickness deep; effective: area and inertia given"},
    {"core.side_m", "m", REAL, AT(core.side_m), "11.3", 0.1, 200, NULL, "outer side of the box"},
    {"core.width_m", "m", REAL, AT(core.width_m), "11.3", 0.1, 200, NULL, "width of the plate"},
    {"core.damping", "-", REAL, AT(core.damping), "0.03", 0, 10, NULL, "damping ratio of every core mode"},
    {"core.youngs_modulus_pa", "Pa", REAL, AT(core.youngs_modulus_pa), "2.1e11", 1, 1e14, NULL, "of the core's steel"},
    {"core.density_kg_m3", "kg/m3", REAL, AT(core.density_kg_m3), "7850", 1, 1e5, NULL, "of the core's steel"},
    {"core.area_base_m2", "m2", REAL, AT(core.area_base_m2), "1.567", 1e-9, 1e4, NULL, "effective: first storey"},
    {"core.area_top_m2", "m2", REAL, AT(core.area_top_m2), "0.811", 1e-9, 1e4, NULL, "effective: last storey"},
    {"core.inertia_base_m4", "m4", REAL, AT(core.inertia_base_m4), "25.6201", 1e-9, 1e6, NULL,
     "effective: first storey"},
    {"core.inertia_top_m4", "m4", REAL, AT(core.inertia_top_m4), "24.0503", 1e-9, 1e6, NULL, "effective: last storey"},

    {"contact.law", "-", CHOICE, AT(contact.law), "paper", 0, 0, "paper|exact|lankarani-nikravesh|flores|jankowski",
     "paper: a = 1.5 (1 - r); exact: a chosen so that an isolated impact rebounds with r; the others by their authors"},
    {"contact.restitution", "-", REAL, AT(contact.restitution), "0.7", 0, 1, NULL, "r of the contact law"},
    {"contact.v0_floor_m_s", "m/s", REAL, AT(contact.v0_floor_m_s), "1e-3", 1e-12, 10, NULL,
     "least approach speed that the contact law is given"},
    {"contact.radius_m", "m", REAL, AT(contact.radius_m), "0.1", 1e-6, 1e3, NULL, "radius of the contacting body"},
    {"contact.youngs_modulus_pa", "Pa", REAL, AT(contact.youngs_modulus_pa), "2.1e11", 1, 1e14, NULL, "of both bodies"},
    {"contact.poisson", "-", REAL, AT(contact.poisson), "0.3", 0, 0.5, NULL, "Poisson's ratio of both bodies"},

    {"motion.record", "-", TEXT, AT(motion.record), "builtin:kobe-like", 0, 0, NULL,
     "a ground motion file, or builtin:kobe-like | builtin:elcentro-like | builtin:sylmar-like"},
    {"motion.records", "-", TEXT, AT(motion.records), "none", 0, 0, NULL,
     "more records for the same study, a comma list: a design then answers to all of them (sim.robust)"},
    {"motion.pga_g", "g", REAL, AT(motion.pga_g), "0.3", 0, 1e6, NULL, "scaled to this peak; 0: as recorded"},
    {"motion.stretch", "-", REAL, AT(motion.stretch), "3.1", 1e-3, 1e3, NULL, "time is multiplied by this"},
    {"motion.unit", "-", CHOICE, AT(motion.unit), "from_file", 0, 0, "from_file|m_s2|cm_s2|g",
     "of the acceleration, where the file does not say"},
    {"motion.channel", "-", TEXT, AT(motion.channel), "auto", 0, 0, NULL,
     "name or number (from 1) of the component, where the file has several; auto: there is only one"},
    {"motion.dt_s", "s", REAL, AT(motion.dt_s), "0", 0, 100, NULL,
     "step of a file that has neither step nor times; 0: the file says it"},
    {"motion.resample_dt_s", "s", REAL, AT(motion.resample_dt_s), "0", 0, 100, NULL,
     "unequal times are resampled to this step by straight lines; 0: they are refused"},

    {"sim.engine", "-", CHOICE, AT(sim.engine), "fast", 0, 0, ENGINE_WORDS,
     "fast: the one to use; the others are slower and exist to be compared with"},
    {"sim.accuracy", "-", CHOICE, AT(sim.accuracy), "standard", 0, 0, "coarse|standard|fine",
     "what a run costs and how far it can be trusted (docs/chart.md)"},
    {"sim.steps_per_contact", "-", REAL, AT(sim.steps_per_contact), "0", 0, 1000, NULL,
     "engine fast: finer than sim.accuracy, with tolerances to match; 0: as sim.accuracy says"},
    {"sim.duration_s", "s", REAL, AT(sim.duration_s), "0", 0, 1e6, NULL, "stop here; 0: at the end of the motion"},
    {"sim.residual_max", "-", REAL, AT(sim.residual_max), "0.001", 1e-12, 1, NULL,
     "a run whose energy books are open by more than this share of the input is refined, then failed"},
    {"sim.ensemble", "-", WHOLE, AT(sim.ensemble), "1", 1, 1000, NULL,
     "simulations of each design in a study, gaps changed a little: the objectives are their means"},
    {"sim.gap_tolerance_m", "m", REAL, AT(sim.gap_tolerance_m), "0", 0, 1, NULL,
     "standard deviation of a gap as built; wants sim.ensemble of 2 at least"},
    {"sim.robust", "-", CHOICE, AT(sim.robust), "worst", 0, 0, "worst|mean",
     "of several records: the worst of each objective, or the mean"},

    {"design.gap_min_m", "m", REAL, AT(design.gap_min_m), "0.001", 0, 10, NULL, "search box: least gap"},
    {"design.gap_max_m", "m", REAL, AT(design.gap_max_m), "0.5", 1e-6, 10, NULL, "search box: widest gap"},
    {"design.thickness_min_m", "m", REAL, AT(design.thickness_min_m), "0.004", 1e-6, 10, NULL,
     "search box: thinnest core wall"},
    {"design.thickness_max_m", "m", REAL, AT(design.thickness_max_m), "0.04", 1e-6, 10, NULL,
     "search box: thickest core wall"},

    {"problem.kind", "-", CHOICE, AT(problem.kind), "tower", 0, 0,
     "tower|external|dtlz2|wfg4|dtlz1_inverted|dtlz5|dtlz7|wfg5",
     "tower: gaps and walls of the scene; external: a simulator of your own; the others: problems from textbooks"},
    {"problem.command", "-", TEXT, AT(problem.command), "none", 0, 0, NULL,
     "external: the worker, started without a shell once per thread; docs/external.md has the protocol"},
    {"problem.timeout_s", "s", REAL, AT(problem.timeout_s), "600", 1e-3, 1e7, NULL,
     "external: a worker that is silent for so long has failed and is replaced"},
    {"problem.variables", "-", WHOLE, AT(problem.variables), "22", 1, 10000, NULL, "their number; not of a tower"},
    {"problem.objectives", "-", WHOLE, AT(problem.objectives), "7", 1, 100, NULL, "their number; not of a tower"},
    {"problem.lower", "-", TEXT, AT(problem.lower), "0", 0, 0, NULL, "external: one number for all, or a comma list"},
    {"problem.upper", "-", TEXT, AT(problem.upper), "1", 0, 0, NULL, "external: one number for all, or a comma list"},
    {"problem.senses", "-", TEXT, AT(problem.senses), "min", 0, 0, NULL,
     "external: min or max, one for all objectives, or a comma list"},
    {"problem.variable_names", "-", TEXT, AT(problem.variable_names), "auto", 0, 0, NULL,
     "comma list; auto: x1, x2, ..."},
    {"problem.objective_names", "-", TEXT, AT(problem.objective_names), "auto", 0, 0, NULL,
     "comma list; auto: f1, f2, ..."},
    {"problem.noisy", "-", CHOICE, AT(problem.noisy), "auto", 0, 0, "auto|no|yes",
     "whether the same design answers differently each time; auto: only with problem.noise"},
    {"problem.noise", "-", REAL, AT(problem.noise), "0", 0, 1, NULL,
     "problems from textbooks: standard deviation of the answers, share of their value"},

    {"search.seed", "-", WHOLE, AT(search.seed), "1", 0, 4294967295.0, NULL, "same seed and settings: same bytes"},
    {"search.threads", "-", WHOLE, AT(search.threads), "0", 0, 1024, NULL, "0: one per processor"},
    {"search.population", "-", WHOLE, AT(search.population), "92", 4, 100000, NULL, "designs per generation"},
    {"search.initial", "-", WHOLE, AT(search.initial), "0", 0, 1000000, NULL,
     "designs of the Latin hypercube start, no more than max_evals; 0: by the number of variables"},
    {"search.start", "-", TEXT, AT(search.start), "none", 0, 0, NULL,
     "designs to begin with: a CSV with a column per variable, or the folder of a run, whose front is taken"},
    {"search.generations", "-", WHOLE, AT(search.generations), "1000", 1, 1e9, NULL, "stop after so many"},
    {"search.max_evals", "-", WHOLE, AT(search.max_evals), "2000", 4, 1e6, NULL, "stop after so many simulations"},
    {"search.max_hours", "h", REAL, AT(search.max_hours), "0", 0, 1e4, NULL, "stop after so long; 0: no limit"},
    {"search.nondominated_share", "-", REAL, AT(search.nondominated_share), "1", 0, 1, NULL,
     "stop when this share of all simulated designs is nondominated; 1: never"},
    {"search.trust_error", "-", REAL, AT(search.trust_error), "0.05", 0, 10, NULL,
     "a prediction stands where its leave-one-out based error is below this share of every objective's range"},
    {"search.crossover_probability", "-", REAL, AT(search.crossover_probability), "1", 0, 1, NULL, "of a pair (SBX)"},
    {"search.crossover_eta", "-", REAL, AT(search.crossover_eta), "20", 0, 1000, NULL, "distribution index of SBX"},
    {"search.mutation_eta", "-", REAL, AT(search.mutation_eta), "20", 0, 1000, NULL,
     "distribution index of polynomial mutation"},
    {"search.mutation_rate", "-", REAL, AT(search.mutation_rate), "1", 0, 100, NULL,
     "variables mutated per design, on average"},
    {"search.surrogate_max", "-", WHOLE, AT(search.surrogate_max), "600", 10, 5000, NULL,
     "most designs that the response surface is built on"},
    {"search.surrogate", "-", CHOICE, AT(search.surrogate), "on", 0, 0, "on|off|auto",
     "off: a plain evolutionary search; auto: off where it proves to cost more than four simulations for each, by the "
     "clock"},
    {"search.asynchronous", "-", CHOICE, AT(search.asynchronous), "off", 0, 0, "off|on",
     "on: no thread waits for the slowest design of a batch; the run then depends on the order in which results come"},
    {"search.survival", "-", CHOICE, AT(search.survival), "nsga3", 0, 0, "nsga3|rvea|moead",
     "who lives on from one generation to the next: NSGA-III, RVEA or MOEA/D with PBI"},
    {"search.repeats", "-", REAL, AT(search.repeats), "0.1", 0, 0.9, NULL,
     "noisy answers: share of the simulations that try designs of the front again (docs/search.md)"},
    {"search.members_min", "-", WHOLE, AT(search.members_min), "1", 1, 1000, NULL,
     "noisy answers: simulations that a design in front.csv has at least"},
    {"search.members_max", "-", WHOLE, AT(search.members_max), "4", 1, 1000, NULL,
     "noisy answers: simulations of one design at most; 1: none is repeated"},
    {"search.polish", "-", WHOLE, AT(search.polish), "3", 0, 32, NULL,
     "tower: designs that are polished at the end, with a tenth more simulations; none where that is too few"},
    {"search.limits", "-", TEXT, AT(search.limits), "none", 0, 0, NULL,
     "what objectives must keep, as j3_g<=5,edcs_pct>=3; none"},

    {"run.out", "-", TEXT, AT(run.out), "results/study", 0, 0, NULL, "the run's folder"},
};

enum { N_OPTIONS = sizeof OPTIONS / sizeof OPTIONS[0] };

const char *settings_key(int i)
{
    return i < N_OPTIONS ? OPTIONS[i].key : NULL;
}

const char *settings_words(int i)
{
    return OPTIONS[i].words;
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

static void format_word(char text[SETTINGS_TEXT_MAX], const char *words, long index)
{
    while (index-- > 0)
        words = strchr(words, '|') + 1;
    snprintf(text, SETTINGS_TEXT_MAX, "%.*s", (int)strcspn(words, "|"), words);
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
    if (o->kind == WHOLE && *number != (double)(long)*number)
        return fail(err, STATUS_BAD_DATA, "%s: %s is not a whole number", o->key, value);
    return STATUS_OK;
}

static Status assign(Settings *s, const Option *o, const char *value, Err *err)
{
    double number;
    switch (o->kind) {
    case REAL:
        TRY(parse_number(o, value, &number, err));
        *(double *)field_of(s, o) = number;
        return STATUS_OK;
    case WHOLE:
        TRY(parse_number(o, value, &number, err));
        *(long *)field_of(s, o) = (long)number;
        return STATUS_OK;
    case CHOICE: {
        const int i = word_index(o->words, value);
        if (i < 0)
            return unknown_word(o, value, err);
        *(long *)field_of(s, o) = i;
        return STATUS_OK;
    }
    case TEXT:
        if (!value[0])
            return fail(err, STATUS_BAD_DATA, "%s: is empty", o->key);
        if (strlen(value) >= SETTINGS_TEXT_MAX)
            return fail(err, STATUS_BAD_DATA, "%s: is longer than %d characters", o->key, SETTINGS_TEXT_MAX - 1);
        if (strpbrk(value, "\r\n") || strstr(value, " ;") || isspace((unsigned char)value[0]) ||
            isspace((unsigned char)value[strlen(value) - 1]))
            return fail(err, STATUS_BAD_DATA,
                        "%s: '%.60s' cannot be kept in a settings file (line ends, ' ;', blanks around it)", o->key,
                        value);
        snprintf(field_of(s, o), SETTINGS_TEXT_MAX, "%s", value);
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

/* A path that was written in a settings file is meant from that file's folder. */
static void anchor_path(char path[SETTINGS_TEXT_MAX], void *user)
{
    const Reading *r = user;
    const char *slash = strrchr(r->path, '/');
    if (!slash || path[0] == '/' || !setting_is_path(path))
        return;
    char anchored[2 * SETTINGS_TEXT_MAX];
    snprintf(anchored, sizeof anchored, "%.*s/%s", (int)(slash - r->path), r->path, path);
    if (strlen(anchored) < SETTINGS_TEXT_MAX && access(anchored, F_OK) == 0)
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
    const int is_model_name =
        o->offset == AT(building.model) && (!strcmp(value, "guyan") || !strcmp(value, "appendix"));
    const int is_path = o->offset == AT(motion.record) || o->offset == AT(search.start) ||
                        (o->offset == AT(building.model) && !is_model_name);
    if (is_path)
        anchor_path(field_of(r->s, o), r);
    if (o->offset == AT(motion.records))
        list_change(field_of(r->s, o), anchor_path, r);
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
static void format_real(double value, char text[SETTINGS_TEXT_MAX])
{
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, SETTINGS_TEXT_MAX, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
}

static void format_value(const Settings *s, const Option *o, char text[SETTINGS_TEXT_MAX])
{
    const void *field = field_of_const(s, o);
    switch (o->kind) {
    case REAL:
        format_real(*(const double *)field, text);
        break;
    case WHOLE:
        snprintf(text, SETTINGS_TEXT_MAX, "%ld", *(const long *)field);
        break;
    case CHOICE:
        format_word(text, o->words, *(const long *)field);
        break;
    case TEXT:
        snprintf(text, SETTINGS_TEXT_MAX, "%s", (const char *)field);
        break;
    }
}

void settings_each(const Settings *s, SettingFn take, void *user)
{
    char value[SETTINGS_TEXT_MAX];
    for (int i = 0; i < N_OPTIONS; i++) {
        format_value(s, &OPTIONS[i], value);
        take(OPTIONS[i].key, value, user);
    }
}

void settings_compare(const Settings *was, const Settings *is, SettingsDiffFn differs, void *user)
{
    char before[SETTINGS_TEXT_MAX], after[SETTINGS_TEXT_MAX];
    for (int i = 0; i < N_OPTIONS; i++) {
        format_value(was, &OPTIONS[i], before);
        format_value(is, &OPTIONS[i], after);
        if (strcmp(before, after) != 0)
            differs(OPTIONS[i].key, before, after, user);
    }
}

static void describe(const Option *o, FILE *out)
{
    fprintf(out, "; %s", o->help);
    if (o->kind == REAL || o->kind == WHOLE)
        fprintf(out, " [%s, %.10g..%.10g]", o->unit, o->min, o->max);
    if (o->kind == CHOICE)
        fprintf(out, " (%s)", o->words);
    fputc('\n', out);
}

void settings_write(const Settings *s, FILE *out, int described)
{
    const char *section = "";
    char value[SETTINGS_TEXT_MAX];
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
