#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "cmd/commands.h"
#include "cmd/show.h"
#include "run/crew.h"
#include "run/front.h"
#include "run/world.h"

enum { WITH_CORE, WITHOUT_CORE, N_SCENES };
static const SceneKind SCENES[N_SCENES] = {SCENE_IMPACT, SCENE_NO_CORE};

typedef struct {
    Front front;
    size_t row;
} Chosen;

static Status choose_design(const Args *args, Chosen *c, Err *err)
{
    const char *word = args_value(args, "--design");
    char *end;
    if (!word)
        return fail(err, STATUS_USAGE, "--design ID is missing; %s/front.csv lists them, knee is one too",
                    args->operand);
    TRY(front_read(&c->front, args->operand, err));
    if (strcmp(word, "knee") == 0) {
        c->row = front_knee(&c->front);
        return STATUS_OK;
    }
    c->row = front_find(&c->front, strtol(word, &end, 10));
    if (end == word || *end || c->row == c->front.n)
        return fail(err, STATUS_BAD_DATA,
                    "--design %.40s: no such id on the front; the column id of %s/front.csv has them", word,
                    args->operand);
    return STATUS_OK;
}

static Status read_run(const Args *args, Settings *s, Err *err)
{
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s/settings.ini", args->operand);
    settings_defaults(s);
    TRY(settings_read(s, path, NULL, NULL, err));
    TRY(args_apply(args, s, NULL, NULL, err));
    return settings_check(s, err);
}

static Status simulate(const World *w, const Chosen *c, SimResult results[N_SCENES], Err *err)
{
    Crew *crew;
    SimTask tasks[N_SCENES];
    if (w->settings.problem.kind != PROBLEM_TOWER)
        return fail(err, STATUS_BAD_DATA, "this run searched another problem than the tower: no ground motion applies");
    if (scene_n_floors(w->scene) + 2 != c->front.n_var)
        return fail(err, STATUS_BAD_DATA, "the front has designs of %d floors, the building has %d", c->front.n_var - 2,
                    scene_n_floors(w->scene));
    for (int i = 0; i < N_SCENES; i++)
        tasks[i] = (SimTask){SCENES[i], front_x(&c->front, c->row)};
    TRY(crew_create(&crew, w->scene, N_SCENES, err));
    const Status status = crew_run(crew, N_SCENES, tasks, results, err);
    crew_free(crew);
    return status;
}

static json_t *describe(const World *w, const SimResult results[N_SCENES])
{
    json_t *o = json_object();
    json_object_set_new(o, "record", json_string(w->motion.name));
    json_object_set_new(o, "pga_g", json_number(motion_peak(&w->motion) / 9.81));
    json_object_set_new(o, "stretch", json_number(w->settings.motion.stretch));
    for (int i = 0; i < N_SCENES; i++)
        json_object_set_new(o, i == WITH_CORE ? "with_core" : "no_core", json_result(SCENES[i], &results[i]));
    return o;
}

static void print_pair(const World *w, const SimResult results[N_SCENES])
{
    show_motion(&w->motion, w->settings.sim.duration_s);
    show_result_names("");
    for (int i = 0; i < N_SCENES; i++)
        show_result(i == WITH_CORE ? "with core" : "no core", &results[i]);
    putchar('\n');
}

/* One record: simulated, then appended to `list` or printed. */
static Status evaluate_on(const Settings *s, const Chosen *c, json_t *list, Err *err)
{
    World w;
    SimResult results[N_SCENES];
    TRY(world_open(&w, s, err));
    const Status status = simulate(&w, c, results, err);
    if (status == STATUS_OK && list)
        json_array_append_new(list, describe(&w, results));
    else if (status == STATUS_OK)
        print_pair(&w, results);
    world_close(&w);
    return status;
}

static Status evaluate_all(const Args *args, Settings *s, const Chosen *c, json_t *list, Err *err)
{
    for (int i = 0; i < args->n_given; i++) {
        if (strcmp(args->given[i].option->name, "--record") != 0)
            continue;
        char assignment[SETTINGS_TEXT_MAX + 32];
        snprintf(assignment, sizeof assignment, "motion.record=%s", args->given[i].value);
        TRY(settings_set(s, assignment, err));
        TRY(evaluate_on(s, c, list, err));
    }
    return STATUS_OK;
}

static Status show_all(const Args *args, Settings *s, const Chosen *c, Err *err)
{
    const long id = front_id(&c->front, c->row);
    if (!args_has(args, "--json")) {
        printf("design %ld of %s\n\n", id, args->operand);
        return evaluate_all(args, s, c, NULL, err);
    }
    json_t *list = json_array();
    const Status status = evaluate_all(args, s, c, list, err);
    if (status != STATUS_OK) {
        json_decref(list);
        return status;
    }
    json_t *all = json_object();
    json_object_set_new(all, "run", json_string(args->operand));
    json_object_set_new(all, "design", json_integer(id));
    json_object_set_new(all, "variables_m", json_numbers((size_t)c->front.n_var, front_x(&c->front, c->row)));
    json_object_set_new(all, "records", list);
    return show_json(all, err);
}

static Status run(const Args *args, Err *err)
{
    Settings s;
    Chosen c = {0};
    if (!args_has(args, "--record"))
        return fail(err, STATUS_USAGE, "--record FILE is missing; it may be repeated");
    TRY(read_run(args, &s, err));
    Status status = choose_design(args, &c, err);
    if (status == STATUS_OK)
        status = show_all(args, &s, &c, err);
    front_free(&c.front);
    return status;
}

static const ArgOption OPTIONS[] = {
    {"--design", "ID", NULL, 0, "column id of RUN/front.csv, or knee"},
    {"--record", "FILE", NULL, 1, "ground motion; may be repeated"},
    OPTION_PGA,
    OPTION_STRETCH,
    OPTION_UNIT,
    OPTION_DURATION,
    OPTION_ENGINE,
    OPTION_JSON,
    OPTION_END,
};

const Command CMD_EVALUATE = {
    .name = "evaluate",
    .operand = "RUN",
    .summary = "one design of a front on other earthquakes",
    .example = "imtet evaluate results/quick --design knee --record builtin:elcentro-like",
    .details =
        "Simulates one design of the front of the folder RUN under each record, with the building without a core\n"
        "beside it. Peak, stretch and all else are the run's unless an option says otherwise.",
    .options = OPTIONS,
    .run = run,
};
