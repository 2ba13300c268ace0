#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/units.h"
#include "cmd/commands.h"
#include "cmd/designs.h"
#include "cmd/show.h"
#include "simulator/tower.h"
#include "store/run_read.h"
#include "scene/motion_scale.h"
#include "scene/motion_source.h"
#include "settings/settings.h"

enum { WITH_CORE, WITHOUT_CORE, N_CASES };
static const SceneKind SCENES[N_CASES] = {SCENE_IMPACT, SCENE_NO_CORE};

/* A design of the run, or one from elsewhere under the run's settings. */
typedef struct {
    const Run *run;
    long id; /* in the run; 0: none */
    const double *x;
    const char *word; /* as it was asked for */
} Chosen;

static Status simulate(const Problem *p, const Chosen *c, SimResult results[N_CASES], Err *err)
{
    SimTask tasks[N_CASES];
    const int n_floors = tower_n_floors(tower_of(p));
    if (n_floors + 2 != (int)c->run->schema.n_var)
        return fail(err, STATUS_BAD_DATA, "the front has designs of %d floors, the building has %d",
                    (int)c->run->schema.n_var - 2, n_floors);
    for (int i = 0; i < N_CASES; i++)
        tasks[i] = (SimTask){SCENES[i], c->x};
    return tower_simulate(p, N_CASES, tasks, results, err);
}

static json_t *describe(const Scenario *w, const SimResult results[N_CASES])
{
    json_t *o = json_object();
    json_object_set_new(o, "record", json_string(w->motion.name));
    json_object_set_new(o, "pga_g", json_number(motion_peak(&w->motion) / GRAVITY));
    json_object_set_new(o, "scale", json_number(w->motion.scale));
    json_object_set_new(o, "stretch", json_number(w->motion.stretch));
    for (int i = 0; i < N_CASES; i++)
        json_object_set_new(o, i == WITH_CORE ? "with_core" : "no_core", json_result(SCENES[i], &results[i]));
    return o;
}

static void print_pair(const Scenario *w, const MeasureOrder *order, const SimResult results[N_CASES])
{
    show_motion(stdout, &w->motion, w->options.sim.duration_s);
    show_result_names("", order);
    for (int i = 0; i < N_CASES; i++)
        show_result(i == WITH_CORE ? "with core" : "no core", order, &results[i]);
    putchar('\n');
}

/* One record: simulated, then appended to `list` or printed. */
static Status evaluate_on(const Settings *s, const Chosen *c, json_t *list, Err *err)
{
    Problem p;
    SimResult results[N_CASES];
    TRY(tower_open(&p, s, TOWER_SINGLE, N_CASES, err));
    const Scenario *w = tower_record(tower_of(&p), 0);
    const Status status = simulate(&p, c, results, err);
    if (status == STATUS_OK && list)
        json_array_append_new(list, describe(w, results));
    else if (status == STATUS_OK)
        print_pair(w, &c->run->schema.order, results);
    problem_close(&p);
    return status;
}

/* ---- every file of a folder ------------------------------------------------------------------------------------ */

typedef struct {
    json_t *records, *unreadable; /* NULL: to be printed */
    int n_read;
    char *refused; /* their lines, for the end of the printed table */
    size_t refused_length;
    FILE *refusals; /* writes to `refused` */
} Folder;

static Status pick_record(Settings *s, const char *path, Err *err)
{
    char assignment[OPTION_TEXT_MAX + 32];
    const int n = snprintf(assignment, sizeof assignment, "motion.record=%s", path);
    if (n < 0 || (size_t)n >= sizeof assignment)
        return fail(err, STATUS_BAD_DATA, "%.60s...: the path is too long", path);
    return settings_set(s, assignment, err);
}

/* What a reader has to say against the file, before anything is built on it. */
static Status try_record(Settings *s, const char *path, Err *err)
{
    Motion m = {0};
    TRY(pick_record(s, path, err));
    Status status = motion_open(&m, &s->motion, err);
    if (status == STATUS_OK)
        status = motion_scale(&m, &s->motion, err);
    motion_free(&m);
    return status;
}

static void print_rows(const char *path, const MeasureOrder *order, const SimResult results[N_CASES])
{
    static const char *const words[N_CASES] = {"with core", "no core"};
    const char *slash = strrchr(path, '/');
    for (int i = 0; i < N_CASES; i++) {
        char label[64];
        snprintf(label, sizeof label, "%-17.17s %s", slash ? slash + 1 : path, words[i]);
        show_result(label, order, &results[i]);
    }
}

static Status evaluate_file(Settings *s, const Chosen *c, const char *path, Folder *f, Err *err)
{
    Err why = {0};
    Problem p;
    SimResult results[N_CASES];
    const Status readable = try_record(s, path, &why);
    if (readable == STATUS_NO_MEMORY)
        return fail(err, readable, "%s", why.text);
    if (readable != STATUS_OK && f->unreadable)
        json_array_append_new(f->unreadable, json_pack("{s:s, s:s}", "record", path, "reason", why.text));
    if (readable != STATUS_OK) {
        fprintf(f->refusals, "not read: %s\n", why.text);
        return STATUS_OK;
    }
    f->n_read++;
    TRY(tower_open(&p, s, TOWER_SINGLE, N_CASES, err));
    const Scenario *w = tower_record(tower_of(&p), 0);
    const Status status = simulate(&p, c, results, err);
    if (status == STATUS_OK && f->records)
        json_array_append_new(f->records, describe(w, results));
    else if (status == STATUS_OK)
        print_rows(path, &c->run->schema.order, results);
    problem_close(&p);
    return status;
}

static int is_visible(const struct dirent *e)
{
    return e->d_name[0] != '.';
}

static Status evaluate_files(Settings *s, const Chosen *c, const char *folder, int n, struct dirent **names, Folder *f,
                             Err *err)
{
    if (!f->records)
        show_result_names("record", &c->run->schema.order);
    for (int i = 0; i < n; i++) {
        char path[PATH_MAX];
        struct stat there;
        const int length = snprintf(path, sizeof path, "%s/%s", folder, names[i]->d_name);
        if (length < PATH_MAX && stat(path, &there) == 0 && S_ISDIR(there.st_mode))
            continue;
        TRY(evaluate_file(s, c, path, f, err));
    }
    fflush(f->refusals);
    if (!f->records)
        printf("%s%s", f->refused_length ? "\n" : "", f->refused_length ? f->refused : "");
    if (f->n_read == 0)
        return fail(err, STATUS_BAD_DATA, "%s: holds no ground motion that can be read", folder);
    return STATUS_OK;
}

static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name); /* the same order in every language */
}

static void names_free(struct dirent **names, int n)
{
    for (int i = 0; i < n; i++)
        free(names[i]);
    free(names);
}

/* What is in the folder; for names_free. */
static Status scan_folder(const char *folder, struct dirent ***names, int *n, Err *err)
{
    *n = scandir(folder, names, is_visible, by_name);
    if (*n < 0)
        return fail(err, status_of_errno(errno, STATUS_MISSING), "--records %s: %s", folder, strerror(errno));
    if (*n > 0)
        return STATUS_OK;
    names_free(*names, *n);
    return fail(err, STATUS_BAD_DATA, "--records %s: is empty", folder);
}

static Status evaluate_folder(const Args *args, Settings *s, const Chosen *c, json_t *records, json_t *unreadable,
                              Err *err)
{
    const char *folder = args_value(args, "--records");
    struct dirent **names = NULL;
    Folder f = {.records = records, .unreadable = unreadable};
    int n;
    TRY(scan_folder(folder, &names, &n, err));
    f.refusals = open_memstream(&f.refused, &f.refused_length);
    const Status status = f.refusals ? evaluate_files(s, c, folder, n, names, &f, err)
                                     : fail(err, STATUS_NO_MEMORY, "no memory for the files of %s", folder);
    if (f.refusals)
        fclose(f.refusals);
    free(f.refused);
    names_free(names, n);
    return status;
}

/* ---- all ------------------------------------------------------------------------------------------------------- */

/* Before anything is simulated or printed. */
static Status try_records(const Args *args, const Settings *s, Err *err)
{
    Settings each = *s;
    const char *path;
    for (int i = 0; (path = args_next(args, "--record", &i));)
        TRY(try_record(&each, path, err));
    if (args_has(args, "--records")) {
        struct dirent **names;
        int n;
        TRY(scan_folder(args_value(args, "--records"), &names, &n, err));
        names_free(names, n);
    }
    return STATUS_OK;
}

/* The run's own, where they are now. */
static Status evaluate_own(Settings *s, const Chosen *c, json_t *list, Err *err)
{
    char records[OPTION_TEXT_MAX], path[OPTION_TEXT_MAX];
    snprintf(records, sizeof records, "%s", strcmp(s->motion.records, "none") == 0 ? "" : s->motion.records);
    TRY(evaluate_on(s, c, list, err));
    for (size_t i = 0; records[0] && i < list_count(records); i++) {
        if (!list_item(records, i, path, sizeof path))
            return fail(err, STATUS_BAD_DATA, "motion.records: item %zu is empty or too long", i + 1);
        TRY(pick_record(s, path, err));
        TRY(evaluate_on(s, c, list, err));
    }
    return STATUS_OK;
}

static Status evaluate_all(const Args *args, Settings *s, const Chosen *c, json_t *list, json_t *unreadable, Err *err)
{
    const char *path;
    if (!args_has(args, "--record") && !args_has(args, "--records"))
        return evaluate_own(s, c, list, err);
    for (int i = 0; (path = args_next(args, "--record", &i));) {
        TRY(pick_record(s, path, err));
        TRY(evaluate_on(s, c, list, err));
    }
    return args_has(args, "--records") ? evaluate_folder(args, s, c, list, unreadable, err) : STATUS_OK;
}

static Status show_all(const Args *args, Settings *s, const Chosen *c, Err *err)
{
    TRY(try_records(args, s, err));
    if (!args_has(args, "--json")) {
        if (c->id > 0)
            printf("design %ld of %s\n\n", c->id, args->operand);
        else
            printf("design %s by the settings of %s\n\n", c->word, args->operand);
        return evaluate_all(args, s, c, NULL, NULL, err);
    }
    json_t *list = json_array(), *unreadable = json_array();
    const Status status = evaluate_all(args, s, c, list, unreadable, err);
    if (status != STATUS_OK) {
        json_decref(list);
        json_decref(unreadable);
        return status;
    }
    json_t *all = json_object();
    json_object_set_new(all, "run", json_string(args->operand));
    json_object_set_new(all, "design", c->id > 0 ? json_integer(c->id) : json_string(c->word));
    json_object_set_new(all, "variables_m", json_numbers(c->run->schema.n_var, c->x));
    json_object_set_new(all, "records", list);
    json_object_set_new(all, "unreadable", unreadable);
    return show_json(all, err);
}

static Status evaluate_design(const Args *args, const Run *run, const Chosen *c, Err *err)
{
    Settings s = *run->settings;
    TRY(args_apply(args, &s, NULL, NULL, err));
    TRY(settings_check(&s, err));
    if (s.problem.kind != PROBLEM_TOWER)
        return fail(err, STATUS_BAD_DATA, "this run searched another problem than the tower: no ground motion applies");
    if (!args_has(args, "--record") && !args_has(args, "--records"))
        TRY(record_paths_find(&s, NULL, &(RecordPaths){NULL, NULL}, err));
    return show_all(args, &s, c, err);
}

static Status evaluate(const Args *args, const Run *run, Err *err)
{
    const char *word = args_value(args, "--design");
    size_t row;
    Designs other;
    if (!word)
        return fail(err, STATUS_USAGE, "--design ID is missing: an id of %s, knee or best_NAME", args->operand);
    TRY(design_of_run(run, word, &row, &other, err));
    const int is_own = row < run->table.n;
    const Chosen c = {run, is_own ? run->table.row[row].id : 0, is_own ? run_x(run, row) : other.x, word};
    const Status status = evaluate_design(args, run, &c, err);
    design_free(&other);
    return status;
}

static Status run(const Args *args, Err *err)
{
    Run r;
    TRY(run_read(&r, args->operand, err));
    const Status status = evaluate(args, &r, err);
    run_free(&r);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--design", "ID", NULL, 0, DESIGN_OF_RUN},
    {"--record", "FILE", NULL, 1, "ground motion; may be repeated"},
    {"--records", "FOLDER", NULL, 0, "every ground motion in it, sorted, in one table"},
    OPTION_CHANNEL,
    OPTION_PGA,
    OPTION_STRETCH,
    OPTION_UNIT,
    OPTION_DURATION,
    OPTION_ENGINE,
    OPTION_SET,
    OPTION_JSON,
    OPTION_END,
};

const Command CMD_EVALUATE = {
    .name = "evaluate",
    .operand = "RUN",
    .summary = "one design of a front on other earthquakes",
    .example = "imtet evaluate results/quick --design knee --record builtin:elcentro-like",
    .details =
        "Simulates one design under each record, by default the run's own, with the building without a core\n"
        "beside it. Files of a folder that cannot be read are listed with the reason. Peak, stretch and all else are "
        "the\n"
        "run's unless an option says otherwise.",
    .options = OPTIONS,
    .run = run,
};
