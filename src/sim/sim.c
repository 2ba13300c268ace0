#include "sim/sim.h"

#include "base/clock.h"
#include "base/hash.h"
#include "base/linalg.h"
#include "base/stat.h"
#include "base/units.h"
#include "motion/forces.h"
#include "scene/neighbour.h"
#include "scene/torsion.h"
#include "sim/as_built.h"
#include "sim/engine.h"
#include "sim/floor_filter.h"
#include "sim/joined.h"
#include "sim/model.h"
#include "sim/tail.h"

struct Scene {
    SceneOptions options;
    const Motion *motion; /* borrowed */
    Building building;
    DesignSpace design;
    CoreBeam *neighbour; /* NULL: the core is a beam of the design */
    const EngineEntry *engine;
    double strong_s;    /* end of the motion's strong part (motion_strong_part) */
    double *tail_input; /* (n of the motion), NULL without one */
    EngineOptions run;  /* of every run; each worker adds its own work space and sample function */
};

struct SimWorker {
    const Scene *scene;
    const SceneOptions *options; /* the scene's, or own_... */
    const Building *building;
    SceneOptions own_options;
    Building own_building;
    double *own_store; /* of own_building; NULL: never needed */
    SimModel model;
    CoreBeam core;
    LinearDevice device;
    int is_joined; /* the last run */
    EngineOptions run;
    FloorFilter *filter; /* NULL: not wanted */
    double filtered_to;  /* [s] */
};

/* A run whose energy balance does not close is repeated with so many times the steps before it counts as failed. */
static const double REFINEMENTS[] = {1, 4, 16};
enum { N_REFINEMENTS = sizeof REFINEMENTS / sizeof REFINEMENTS[0] };

/* At coarse three times what nine designs in ten of a front have (docs/promise.md). */
double sim_energy_balance_max(const SimOptions *o)
{
    return o->accuracy == ACCURACY_COARSE ? 0.03 : 1e-3;
}

double sim_steps_per_contact(const SimOptions *o)
{
    return o->steps_per_contact > 0 ? o->steps_per_contact
           : o->tolerance > 0       ? 2 * pow(0.01 / o->tolerance, 2.0 / 3)
                                    : 0;
}

/* Dashpots that a user gives are left out of the modes, and are no longer small beside the springs from here on: at
 * omega C / K 0.18 J1 errs by 0.2 %, at 1.8 by 31 % (against the coupled equations). */
static const double DASHPOT_SHARE_MAX = 0.3;

/* Of the stiffest core that the design may have. */
static Status check_dashpots(const Scene *scene, Err *err)
{
    const DesignOptions *d = &scene->options.design;
    CoreOptions o = scene->options.core;
    CoreBeam *core;
    if (!strstr(o.foundation, "_dashpot") || scene->neighbour)
        return STATUS_OK;
    o.width_m = scene->design.has_side ? d->width_m.at[1] : o.width_m;
    TRY_ROOM(core, 1, "a core", err);
    Status status = core_beam_make(core, &o, scene->building.n, scene->building.storey_m, d->thickness_m.at[1],
                                   d->thickness_m.at[1], err);
    const double share = status == STATUS_OK ? core_beam_dashpot_share(core) : 0;
    if (share > DASHPOT_SHARE_MAX)
        status =
            bad_data(err,
                     "core.foundation: omega C / K of its dashpots is %.2g at the first mode of the thickest core, "
                     "%.3g Hz; above %g they change the modes, which are found without them: give smaller ones",
                     share, core->omega[0] / (2 * M_PI), DASHPOT_SHARE_MAX);
    free(core);
    return status;
}

Status scene_create(Scene **out, const SceneOptions *o, const Motion *motion, Err *err)
{
    *out = NULL;
    if (motion && (motion->n < 2 || !(motion->dt_s > 0 && isfinite(motion->dt_s))))
        return bad_data(err, "%s: %zu samples, %g s apart, are no motion; two or more are needed", motion->name,
                        motion->n, motion->dt_s);
    Scene *scene;
    TRY_ROOM(scene, 1, "a scene", err);
    scene->options = *o;
    scene->motion = motion;
    scene->engine = engine_entry(o->sim.engine);
    scene->run.accuracy = o->sim.accuracy;
    scene->run.steps_per_contact = sim_steps_per_contact(&o->sim);
    scene->run.duration = o->sim.duration_s;
    if (scene->run.duration == 0 && motion)
        scene->run.duration = motion_duration(motion);
    Status status = building_load(&scene->building, &o->building, err);
    THEN(status, torsion_add(&scene->building, &o->contact.eccentricity, err));
    THEN(status, design_space_make(&scene->design, &o->design, core_section(&o->core), scene->building.n, err));
    if (status == STATUS_OK && neighbour_is_given(&o->core)) {
        scene->neighbour = calloc(1, sizeof *scene->neighbour);
        status = scene->neighbour ? core_make(scene->neighbour, &o->core, &o->building, &scene->building, 0, 0, err)
                                  : fail_memory(err, 1, "a neighbour");
    }
    if (status == STATUS_OK && scene->neighbour) {
        const size_t n = (size_t)scene->building.n;
        scene->building.hash ^= hash_fnv1a(scene->neighbour->K, n * n * sizeof *scene->neighbour->K, HASH_SEED);
    }
    THEN(status, check_dashpots(scene, err));
    if (status == STATUS_OK && motion && motion->n_force > scene->building.n)
        status = bad_data(err, "motion.forces: column floor_%02d_n; the building has %d floors", motion->n_force,
                          scene->building.n);
    if (status == STATUS_OK && motion) {
        scene->strong_s = motion_strong_part(motion, 2 * M_PI / scene->building.omega[0]);
        double *input = calloc(motion->n, sizeof *input);
        scene->run.tail_input = scene->tail_input = input;
        status = input ? tail_input(&scene->building.model, motion, input, err)
                       : fail_memory(err, motion->n, "samples of a motion");
    }
    if (status == STATUS_OK)
        *out = scene;
    else
        scene_free(scene);
    return status;
}

void scene_free(Scene *scene)
{
    if (scene) {
        building_free(&scene->building);
        free(scene->tail_input);
        free(scene->neighbour);
    }
    free(scene);
}

void scene_set_engine(Scene *scene, const EngineEntry *engine)
{
    scene->engine = engine;
}

int scene_n_floors(const Scene *scene)
{
    return scene->building.n;
}

const Building *scene_building(const Scene *scene)
{
    return &scene->building;
}

const DesignSpace *scene_design(const Scene *scene)
{
    return &scene->design;
}

Status scene_frequencies(const Scene *scene, const double x[], SceneModes *out, Err *err)
{
    CoreOptions options = scene->options.core;
    CoreBeam *core;
    Design d;
    TRY_ROOM(core, 1, "a core", err);
    design_of(&scene->design, x, &d);
    if (d.side > 0)
        options.width_m = d.side;
    Status status = core_make(core, &options, &scene->options.building, &scene->building, d.t_base, d.t_top, err);
    THEN(status, building_joined_hz(core, &scene->building, out->joined_hz, err));
    for (int i = 0; i < scene->building.n && status == STATUS_OK; i++) {
        out->building_hz[i] = scene->building.model.omega[i] / (2 * M_PI);
        out->core_hz[i] = i < core->top ? core->omega[i] / (2 * M_PI) : NAN;
    }
    out->core_mass_kg = core->mass_kg;
    free(core);
    return status;
}

Status sim_worker_create(SimWorker **out, const Scene *scene, Err *err)
{
    const DesignSpace *s = &scene->design;
    /* A link or friction link on every floor, the tuned mass, the mat that lifts. */
    const int devices_max = (s->n_links + s->n_slips > 0 ? s->n_floors : 0) + (s->n_mass > 0) + 1;
    SimWorker *w = *out = NULL;
    TRY_ROOM(w, 1, "a simulator", err);
    w->scene = scene;
    w->options = &scene->options;
    w->building = &scene->building;
    w->run = scene->run;
    Status status = model_create(&w->model, scene->building.n, scene->building.model.n, err);
    if (status == STATUS_OK && (scene->options.sim.forces == FORCES_YES || scene->options.core.wall == WALL_EFFECTIVE))
        status = force_monitor_create(&w->run.forces, scene->building.n, scene->building.model.n, err);
    if (status == STATUS_OK && scene->options.sim.filtered)
        status = floor_filter_create(&w->filter, model_points(&scene->options, &scene->building),
                                     scene->options.sim.filter_hz, err);
    sim_worker_sample(w, 0, NULL, NULL);
    if (status == STATUS_OK && scene->engine->work_create)
        status = scene->engine->work_create(&w->run.work, scene->building.n, scene->building.model.n,
                                            scene->building.yields, devices_max, err);
    if (status == STATUS_OK)
        *out = w;
    else
        sim_worker_free(w);
    return status;
}

void sim_worker_free(SimWorker *worker)
{
    if (!worker)
        return;
    model_free(&worker->model);
    force_monitor_free(worker->run.forces);
    floor_filter_free(worker->filter);
    if (worker->scene->engine->work_free)
        worker->scene->engine->work_free(worker->run.work);
    free(worker->own_store);
    free(worker);
}

/* For the filter: the floors of a sample. */
static void take_floors(const SimSample *sample, void *user)
{
    SimWorker *w = user;
    if (sample->t == 0)
        floor_filter_start(w->filter, sample->spacing);
    else if (sample->t > w->filtered_to + 1.5 * sample->spacing)
        floor_filter_interrupt(w->filter);
    w->filtered_to = sample->t;
    double *u = floor_filter_add(w->filter, sample->ground);
    if (u && sample->u)
        memcpy(u, sample->u, (size_t)w->model.points * sizeof *u);
    else if (u)
        points_from_modes(&w->model, sample->q, u);
}

static int is_below(const double acceleration[], void *user)
{
    return floor_filter_is_below(((SimWorker *)user)->filter, acceleration);
}

void sim_worker_sample(SimWorker *worker, double spacing, SimSampleFn sample, void *user)
{
    EngineOptions *run = &worker->run;
    const int filters = !sample && worker->filter;
    run->sample = filters ? take_floors : sample;
    run->sample_user = filters ? worker : user;
    run->sample_spacing = filters ? floor_filter_spacing(worker->scene->options.sim.filter_hz) : spacing;
    run->sample_peaks = filters;
    run->sample_memory = filters ? floor_filter_memory(worker->scene->options.sim.filter_hz) : 0;
    run->skip = filters ? is_below : NULL;
}

void sim_worker_contacts(SimWorker *worker, SimContactFn contact, void *user)
{
    if (worker->run.forces)
        force_monitor_on_contact(worker->run.forces, contact, user);
}

/* u (n_floors) of the floors' centres by modes x of a sample. */
static void centres(const SimModel *model, const double x[], double u[])
{
    double points[POINTS_MAX];
    rows_from_modes(model->U, model->p_pad, 0, model->nb, x, points);
    memcpy(u, points, (size_t)model->n * sizeof *u);
}

void sim_worker_floors(const SimWorker *worker, const SimSample *sample, double u[])
{
    centres(&worker->model, sample->q, u);
}

/* Nodes of the core, whose rows of R are -phi. */
static void core_nodes(const SimModel *model, const SimSample *s, const double x[], double out[])
{
    const int kept = s->n_modes - s->n_building, nc = kept < model->nc ? kept : model->nc;
    double w[FLOORS_MAX] = {0};
    floors_from_modes(model, model->nb, model->nb + nc, x + s->n_building - model->nb, w);
    for (int j = 0; j < model->n; j++)
        out[j] = 0 - w[j];
}

void sim_worker_motion(const SimWorker *worker, const SimSample *s, FloorMotion *out)
{
    const SimModel *model = &worker->model;
    double force[FLOORS_MAX] = {0}, *u_ddot = out->u_ddot;
    centres(model, s->q, out->u);
    centres(model, s->v, out->u_dot);

    /* Absolute accelerations: sum_i R_ij (-2 zeta w q' - w^2 q + sum_l R_il f_l) over the building's modes, f of
     * contacts and of the motion. */
    if (s->plastic)
        model_plastic_forces(model, s->plastic, force);
    for (int j = 0; j < model->n; j++)
        force[j] += (s->force ? s->force[j] : 0) + motion_force(worker->scene->motion, j, s->t);
    memset(u_ddot, 0, (size_t)model->n * sizeof *u_ddot);
    for (int i = 0; i < model->nb; i++) {
        const double w = s->omega[i], *row = centre_row(model, i);
        double pull = -w * (2 * model->zeta[i] * s->v[i] + w * s->q[i]);
        if (model->may_lift) /* 0 but of a core that is joined */
            pull -= s->mat_nm * model->B[(model->n_devices - 1) * model->m_pad + i];
        for (int j = 0; j < model->n; j++)
            pull += row[j] * force[j];
        for (int j = 0; j < model->n; j++)
            u_ddot[j] += row[j] * pull;
    }
    if (worker->is_joined) {
        floors_from_modes(model, 0, model->nb, s->q, out->core);
        floors_from_modes(model, 0, model->nb, s->v, out->core_dot);
        return;
    }
    core_nodes(model, s, s->q, out->core);
    core_nodes(model, s, s->v, out->core_dot);
}

/* One run, repeated with shorter steps while its energy balance stays open. A result that is not finite has failed. */
static Status run_engine(SimWorker *w, SimResult *r, Err *err)
{
    const Scene *scene = w->scene;
    const double open_max = sim_energy_balance_max(&w->options->sim);
    for (int k = 0; k < (scene->engine->refines ? N_REFINEMENTS : 1); k++) {
        w->run.refinement = REFINEMENTS[k];
        TRY(scene->engine->run(&w->model, scene->motion, &w->run, r, err));
        r->repeated = k;
        const double all[] = {r->j1_m,           r->j2_m,    r->j3_g,       r->energy_balance_error,
                              r->input_energy_j, r->ed1_pct, r->ed5_10_pct, r->edcs_pct};
        const size_t n = N_OF(all) - (r->input_energy_j > 0 ? 0 : 3); /* shares of nothing are undefined */
        if (r->outcome == RUN_OK && !all_finite(n, all))
            r->outcome = RUN_NOT_FINITE;
        if (r->outcome == RUN_OK && r->energy_balance_error > open_max) {
            r->outcome = RUN_ENERGY_BALANCE;
            snprintf(r->reason, sizeof r->reason, "energy-balance error %.3g of the input, allowed %.3g",
                     r->energy_balance_error, open_max);
        }
        if (r->outcome != RUN_OK && !r->reason[0])
            text_copy(r->reason, run_outcome_words(r->outcome));
        if (r->outcome != RUN_ENERGY_BALANCE)
            break;
    }
    return STATUS_OK;
}

Status sim_worker_as_built(SimWorker *w, const AsBuilt *built, Err *err)
{
    w->options = &w->scene->options;
    w->building = &w->scene->building;
    w->run.tail_input = built ? NULL : w->scene->run.tail_input; /* of the building as designed */
    if (!built)
        return STATUS_OK;
    as_built_options(built, &w->scene->options, &w->own_options);
    TRY(as_built_building(built, &w->scene->building, &w->own_building, &w->own_store, err));
    w->options = &w->own_options;
    w->building = &w->own_building;
    return STATUS_OK;
}

/* The core of a design; or the neighbour, as it was built: the modulus is that of all of it. */
static Status make_core(SimWorker *w, const Design *d, Err *err)
{
    const CoreBeam *neighbour = w->scene->neighbour;
    const int n = w->building->n;
    if (neighbour) {
        const CoreOptions *o = &w->options->core;
        const double stiffness = o->youngs_modulus_pa / w->scene->options.core.youngs_modulus_pa;
        w->core = *neighbour;
        for (int i = 0; i < n * n; i++)
            w->core.K[i] *= stiffness;
        for (int i = 0; i < n; i++) {
            w->core.omega[i] *= sqrt(stiffness);
            w->core.zeta[i] = o->damping;
        }
        return STATUS_OK;
    }
    if ((d->side > 0 || d->anchors > 0 || w->options->core.wall == WALL_EFFECTIVE) && w->options != &w->own_options) {
        w->own_options = *w->options;
        w->options = &w->own_options;
    }
    if (d->side > 0)
        w->own_options.core.width_m = d->side;
    if (d->anchors > 0)
        w->own_options.core.anchors = d->anchors;
    return core_beam_make(&w->core, &w->options->core, n, w->building->storey_m, d->t_base, d->t_top, err);
}

void sim_worker_device(SimWorker *worker, const LinearDevice *device)
{
    worker->device = *device;
}

void sim_worker_brief(SimWorker *worker, int is_brief)
{
    worker->run.duration = fmin(worker->scene->run.duration, is_brief ? worker->scene->strong_s : INFINITY);
}

/* The model of a design with its gaps, bumpers and devices. core NULL: none. exponent: of links. */
static Status set_model(SimWorker *w, const CoreBeam *core, const Design *d, double exponent, Err *err)
{
    SimModel *model = &w->model;
    TRY(model_set(model, w->options, w->building, core, NULL, err));
    if (core)
        TRY(model_set_gaps(model, d->gap[0], d->gap[1], err));
    for (int j = w->core.top; j < model->n; j++) { /* above a neighbour */
        model->gap[j] = 1e300;
        model->middle[j] = 0;
    }
    /* As built: the modulus is that of all parts of the contact. */
    const double built = w->options->contact.youngs_modulus_pa / w->scene->options.contact.youngs_modulus_pa;
    for (int j = 0; j < model->n; j++)
        if (d->bumper[j] >= 0)
            model->contact[j].bumper = built * d->bumper[j];

    /* The tuned mass, a mode more, comes before the devices, and its device behind them: spring m w^2, dashpot
     * c = 2 zeta m w. */
    if (d->mass_kg > 0)
        model_add_mass(model, d->mass_kg);
    for (int j = 0; j < w->core.top; j++)
        if (design_has_link(d, j))
            model_add_device(model,
                             &(Device){.floor = j,
                                       .damping = d->link[j] + d->friction[j],
                                       .exponent = d->friction[j] > 0 ? 0 : exponent},
                             0);
    const double omega = 2 * M_PI * d->mass_hz;
    if (d->mass_kg > 0)
        model_add_device(model,
                         &(Device){.floor = model->n - 1,
                                   .stiffness = d->mass_kg * omega * omega,
                                   .damping = 2 * d->mass_damping * d->mass_kg * omega,
                                   .exponent = 1},
                         1);
    if (core)
        model_add_uplift(model, core);
    return STATUS_OK;
}

/* Floors and core without gaps: the building's model is that of both while the engine runs. */
static Status run_joined(SimWorker *w, const Design *d, SimResult *result, Err *err)
{
    Joined joined;
    const Building *own = w->building;
    Status status = joined_make(&joined, own, &w->core, err);
    w->building = &joined.building;
    if (status == STATUS_OK && w->run.forces)
        force_monitor_set(w->run.forces, w->options, w->building, &w->core, 1, (double[]){d->t_base, d->t_top});
    THEN(status, model_set(&w->model, w->options, w->building, NULL, NULL, err));
    if (status == STATUS_OK)
        model_add_uplift(&w->model, &w->core);
    w->model.neighbour_floors = w->model.neighbour_at ? w->core.top : 0;
    THEN(status, run_engine(w, result, err));
    if (status == STATUS_OK)
        joined_book(&joined, result);
    w->building = own;
    joined_free(&joined);
    return status;
}

/* Any other scene than joined. A design has no work space for what is no variable of it. */
static Status run_design(SimWorker *w, SceneKind kind, Design d, SimResult *result, Err *err)
{
    const CoreBeam *core = SCENES[kind].has & HAS_CORE ? &w->core : NULL;
    void *const work = w->run.work;
    if (kind != SCENE_IMPACT)
        case_design(kind, &w->device, w->core.mass_kg, w->model.n, &d);
    if (case_has_device(kind))
        w->run.work = NULL;
    if (w->run.forces)
        force_monitor_set(w->run.forces, w->options, w->building, core, 0, (double[]){d.t_base, d.t_top});
    Status status = set_model(w, core, &d, kind == SCENE_IMPACT ? w->options->design.link_exponent : 1, err);
    THEN(status, run_engine(w, result, err));
    w->run.work = work;

    /* What the devices cost. */
    const PriceOptions *price = &w->options->design.prices;
    int stops = 0, bumpers = 0, links = 0;
    for (int j = 0; j < w->core.top; j++) {
        const int is_stop = design_gap(&d, j) < DESIGN_OPEN_M;
        stops += is_stop;
        bumpers += is_stop && d.bumper[j] > 0;
        links += design_has_link(&d, j);
    }
    result->n_devices = stops + links + (d.mass_kg > 0);
    result->cost =
        stops * price->gap + bumpers * price->bumper + links * price->link + 1e-3 * d.mass_kg * price->tuned_mass_t;
    return status;
}

Status sim_run(SimWorker *w, SceneKind kind, const double x[], SimResult *result, Err *err)
{
    Design d = {0};
    if (kind != SCENE_NO_CORE)
        design_of(&w->scene->design, x, &d);
    return sim_run_built(w, kind, &d, result, err);
}

/* Middle of the circle of contact, by Hertz: p0 = 2 E* / pi sqrt(p / R), E* = E / (2 (1 - nu^2)); below its surface
 * steel (nu 0.3) begins to yield at p0 = 1.6 of the yield stress, 345 MPa for structural steel (ASTM A572, grade 50).
 * K. L. Johnson, Contact Mechanics (1985), sections 4.2, 6.1 */
static const double YIELD_PRESSURE_PA = 1.6 * 3.45e8;

/* What a result has beside what the engine says: filtered peaks, drift over storey height, measures of contacts. */
static Status complete(SimWorker *w, SimResult *r, Err *err)
{
    const double *storey_m = w->building->storey_m;
    const ContactOptions *o = &w->options->contact;
    if (w->run.sample == take_floors && r->outcome == RUN_OK) {
        double peak[POINTS_MAX];
        TRY(floor_filter_peaks(w->filter, peak, err));
        model_report_peaks(&w->model, (const double *const[]){NULL, NULL, NULL, peak}, r);
        r->filtered_known = 1;
    }
    for (int s = 0; s < r->n_floors; s++) {
        r->plastic_drift_ratio = fmax(r->plastic_drift_ratio, fabs(r->plastic_drift_m[s]) / storey_m[s]);
        r->residual_drift_ratio = fmax(r->residual_drift_ratio, fabs(r->residual_drift_m[s]) / storey_m[s]);
        r->drift_ratio[s] = r->peak_drift_m[s] / storey_m[s];
        if (r->drift_ratio[s] > r->drift_ratio_max) {
            r->drift_ratio_max = r->drift_ratio[s];
            r->drift_ratio_storey = s;
        }
    }
    for (int s = 0; s < r->neighbour.n; s++) {
        r->neighbour.peak_drift_ratio[s] = r->neighbour.drift_m[s] / w->core.storey_m[s];
        r->neighbour.drift_ratio_max = fmax(r->neighbour.drift_ratio_max, r->neighbour.peak_drift_ratio[s]);
    }
    r->indentation_ratio = r->indentation_max_m / o->radius_m;
    r->contact_pressure_pa = o->youngs_modulus_pa / (M_PI * PLANE_STRAIN) * sqrt(fmax(r->indentation_ratio, 0));
    r->contact_yields = r->contact_pressure_pa > YIELD_PRESSURE_PA;
    r->bumper_strain = r->bumper_compression_m / o->bumper_thickness_m;
    r->bumper_bottoms_out = r->bumper_strain > o->bumper_strain_max;
    r->repair = w->options->sim.repair;
    if (r->settled_s == 0)
        r->settled_s = w->run.duration; /* of an engine that follows contacts to the end */
    return STATUS_OK;
}

/* One simulation of the core as it is, forces included. */
static Status run_once(SimWorker *w, SceneKind kind, const Design *d, SimResult *result, Err *err)
{
    memset(result, 0, sizeof *result);
    if (kind != SCENE_NO_CORE)
        TRY(make_core(w, d, err));
    TRY(w->is_joined ? run_joined(w, d, result, err) : run_design(w, kind, *d, result, err));
    if (w->run.forces) {
        force_monitor_report(w->run.forces, w->run.duration, &result->forces);
        if (result->mat_rotation_rad > 0)
            result->forces.base_rotation_rad = result->mat_rotation_rad;
        result->forces_known = 1;
        if (w->is_joined) /* what connects them is not resolved */
            result->forces.contact_force_max_n = NAN;
        if (kind == SCENE_LINKS) /* what acts on a floor from the core */
            result->forces.contact_force_max_n = result->dashpot_n;
    }
    return STATUS_OK;
}

/* Simulations until the walls that buckle bend as their largest stress lets them, within WALLS_OFF of each share: first
 * whole, then the secant's step in the logarithms of each storey: what is left, over what is assumed, falls with the
 * assumed share, at first to a power of WALLS_POWER; between -1 and 0, so that it settles where a stiffer core has
 * more. 46 simulations of bare walls took 4.6, 4.9, 5.3 and 5.2 passes with powers of -0.2, -0.4, -0.6 and -1. Where
 * contacts are followed for more than twice the strong part of the motion, walls settle on that in a first half of the
 * passes; the first and the last pass are whole. */
enum { WALLS_MAX = 16 };
static const double WALLS_OFF = 0.01, WALLS_POWER = -0.4;

static Status settle_walls(SimWorker *w, SceneKind kind, const Design *d, SimResult *result, Err *err)
{
    const double whole_s = w->run.duration;
    double strong_s = whole_s;
    double *share = w->own_options.core.wall_share, assumed[FLOORS_MAX], found[FLOORS_MAX]; /* logarithms */
    Status status = STATUS_OK;
    memset(share, 0, sizeof w->own_options.core.wall_share);
    for (int pass = 0, n_whole = 0; pass < WALLS_MAX; pass++) {
        n_whole += w->run.duration == whole_s;
        status = run_once(w, kind, d, result, err);
        const int is_settled = !(result->forces.core_wall_share_off > WALLS_OFF);
        if (status != STATUS_OK || result->outcome != RUN_OK || (is_settled && w->run.duration == whole_s))
            break;
        if (pass == 0 && w->scene->motion->n_force == 0 && result->settled_s > 2 * w->scene->strong_s)
            strong_s = w->scene->strong_s;
        w->run.duration = is_settled || n_whole > 1 || pass > WALLS_MAX / 2 ? whole_s : strong_s;
        for (int s = 0; s < result->n_floors && !is_settled && pass + 1 < WALLS_MAX; s++) {
            const double x = share[s] > 0 ? log(share[s]) : 0, left = log(result->forces.core_wall_share[s]);
            const double power = pass > 0 && x != assumed[s] ? (left - found[s]) / (x - assumed[s]) : WALLS_POWER;
            assumed[s] = x;
            found[s] = left;
            share[s] = exp(x + (left - x) / (1 - fmin(fmax(power, -1), 0)));
        }
    }
    w->run.duration = whole_s;
    return status;
}

Status sim_run_built(SimWorker *w, SceneKind kind, const Design *d, SimResult *result, Err *err)
{
    const PriceOptions *price = &w->scene->options.design.prices;
    const double start = clock_seconds();
    const int has_walls = w->options->core.wall == WALL_EFFECTIVE && SCENES[kind].has & HAS_CORE;
    w->is_joined = (SCENES[kind].has & IS_JOINED) != 0;
    TRY((has_walls ? settle_walls : run_once)(w, kind, d, result, err));
    TRY(complete(w, result, err));
    result->mcore_kg = kind == SCENE_NO_CORE ? 0 : w->core.mass_kg;
    if (kind != SCENE_TMD)
        result->cost += 1e-3 * result->mcore_kg * price->core_t;
    if (SCENES[kind].has & HAS_CORE)
        result->cost += 1e-6 * core_beam_anchor(&w->core) * price->anchor_mn;
    result->seconds = clock_seconds() - start;
    return STATUS_OK;
}
