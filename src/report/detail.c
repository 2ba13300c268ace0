#include "report/detail.h"

#include "analysis/estimate.h"
#include "base/units.h"
#include "evaluate/tower.h"
#include "report/verdict.h"
#include "settings/options.h"

static Status take_here(const Problem *p, const double x[], const DetailOptions *options, Detail *d, Err *err)
{
    const Scenario *w = tower_record(tower_of(p), 0);
    const int n = d->n_floors;
    const double given = w->options.sim.duration_s, as_set = w->options.contact.bumper_stiffness_n_m;
    Design design;
    SceneModes modes;
    SimTask tasks[TOWER_RECORDS_MAX];

    /* 1. The design and its ground motion. */
    design_of(scene_design(w->scene), x, &design);
    design_protection(scene_design(w->scene), &design, d->protection);
    d->gap_sides = scene_design(w->scene)->gap_sides;
    for (int j = 0; j < n; j++) {
        for (int s = 0; s < SIDES; s++)
            if ((d->gap_side_m[s][j] = design.gap[s][j]) >= DESIGN_OPEN_M)
                d->gap_side_m[s][j] = design.gap[s][j] = INFINITY;
        d->storey_m[j] = scene_building(w->scene)->storey_m[j];
        d->gap_m[j] = design_gap(&design, j);
        d->thickness_m[j] = design_thickness(scene_design(w->scene), &design, j);
        d->bumper_n_m[j] = design.bumper[j] >= 0 ? design.bumper[j] : as_set;
    }
    text_copy(d->record, w->motion.name);
    d->pga_g = motion_peak(&w->motion) / GRAVITY;
    d->scale = w->motion.scale;
    d->stretch = w->motion.stretch;
    d->duration_s = given > 0 ? given : motion_duration(&w->motion);
    TRY(scene_frequencies(w->scene, x, &modes, err));
    memcpy(d->building_hz, modes.building_hz, sizeof d->building_hz);
    memcpy(d->core_hz, modes.core_hz, sizeof d->core_hz);

    /* 2. Under every record as designed: replicates are not among them. */
    d->n_records = tower_n_records(tower_of(p));
    for (int k = 0; k < N_MEASURES; k++)
        d->standard_error[k] = NAN;
    if (d->n_records > 1) {
        for (size_t i = 0; i < d->n_records; i++)
            tasks[i] = (SimTask){.kind = SCENE_IMPACT, .x = x, .scene = i};
        TRY_ROOM(d->by_record, d->n_records, "results", err);
        TRY(tower_simulate(p, d->n_records, tasks, d->by_record, err));
        tower_standard_errors(tower_of(p), d->by_record, d->standard_error);
    }

    /* 3. Under the first record; the baselines under all of them too. */
    const SimTask task = {.kind = SCENE_IMPACT, .x = x};
    double sd[N_MEASURES];
    TRY(tower_simulate(p, 1, &task, &d->result[SCENE_IMPACT], err));
    for (int k = 0; k < N_MEASURES; k++)
        d->error[k] = sd[k] = NAN;
    if (w->options.sim.engine == ENGINE_FAST)
        TRY(estimate_designs(p, 1, &task, &d->result[SCENE_IMPACT], d->error, sd, err));
    for (int k = 0; k < N_MEASURES; k++)
        d->error[k] = fmax(ESTIMATE_FACTOR * d->error[k], sd[k]); /* what is known of both */
    TRY(baselines_find(p, x, !options->without_devices, d->baseline, err));
    for (int k = SCENE_IMPACT + 1; k < N_SCENES; k++)
        d->result[k] = d->baseline[k].first;
    return histories_run(w, x, d->floor, d->history, err);
}

static Status take_elsewhere(const Settings *other, const char *record, const double x[], Elsewhere *e, Err *err)
{
    Settings s = *other;
    Problem p;
    SimResult results[2];
    const SimTask tasks[2] = {{.kind = SCENE_IMPACT, .x = x}, {.kind = SCENE_NO_CORE, .x = x}};
    TRY(option_put_path(s.motion.record, record, err));
    TRY(tower_open(&p, &s, TOWER_SINGLE, 2, err));
    const Motion *m = &tower_record(tower_of(&p), 0)->motion;
    const Status status = tower_simulate(&p, 2, tasks, results, err);
    text_copy(e->record, m->name);
    e->pga_g = motion_peak(m) / GRAVITY;
    e->scale = m->scale;
    e->stretch = m->stretch;
    e->with_core = results[0];
    e->no_core = results[1];
    problem_close(&p);
    return status;
}

/* A design that fails by the model with all effects has none, and the page says why; and the verdict with it. */
static Status take_ladder(const Settings *s, const double x[], const DetailOptions *options, Detail *d, Err *err)
{
    if (s->sim.engine != ENGINE_FAST)
        return STATUS_OK;
    TRY_ROOM(d->ladder, 1, "a ladder", err);
    if (ladder_find(s, x, LADDER_BRIEF, d->ladder, &d->no_ladder)) {
        free(d->ladder);
        d->ladder = NULL;
    }
    verdict_of_run(options->run, options->row, s, d->ladder, &d->verdict, &(Err){0});
    return STATUS_OK;
}

Status detail_make(const Settings *s, int n_var, const double x[], const DetailOptions *options, Detail *out, Err *err)
{
    Problem p;
    Settings once = *s;
    once.sim.replicates = 1;
    once.sim.forces = FORCES_YES; /* what the design has to bear */
    *out = (Detail){.run = options->run, .row = options->row};
    TRY(tower_open(&p, &once, TOWER_AS_SET, N_SCENES, err));
    Status status = STATUS_OK;
    out->n_floors = scene_n_floors(tower_record(tower_of(&p), 0)->scene);
    out->floor = (out->n_floors - 1) / 2;
    if ((int)p.n_var != n_var)
        status = bad_data(err, "the front has designs of %d variables, the building has %zu", n_var, p.n_var);
    if (status == STATUS_OK && options->n_records > 0) {
        out->elsewhere = calloc(options->n_records, sizeof *out->elsewhere);
        if (!out->elsewhere)
            status = fail_memory(err, options->n_records, "earthquakes");
    }
    for (; status == STATUS_OK && out->n_elsewhere < options->n_records; out->n_elsewhere++)
        status = take_elsewhere(options->other, options->records[out->n_elsewhere], x,
                                &out->elsewhere[out->n_elsewhere], err);
    if (status == STATUS_OK) /* last, as it takes longest */
        status = take_here(&p, x, options, out, err);
    if (status == STATUS_OK && options->with_ladder)
        status = take_ladder(s, x, options, out, err);
    problem_close(&p);
    if (status != STATUS_OK)
        detail_free(out);
    return status;
}

void detail_free(Detail *d)
{
    for (int i = 0; i < 2; i++)
        track_free(&d->history[i]);
    free(d->elsewhere);
    free(d->by_record);
    free(d->ladder);
    free(d->verdict);
    memset(d, 0, sizeof *d);
}
