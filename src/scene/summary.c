#include "scene/summary.h"

#include <limits.h>
#include <stdarg.h>

#include "base/units.h"
#include "motion/spectrum.h"
#include "scene/frame.h"
#include "scene/neighbour.h"

/* ---- figures -------------------------------------------------------------------------------------------------- */

/* Root of the sum of squares of the modal base shears over the weight. */
static double base_shear(const BuildingModel *m, const Motion *motion, double mass)
{
    double squares = 0;
    for (int i = 0; i < m->n; i++) {
        const double period = m->omega[i] > 0 ? 2 * M_PI / m->omega[i] : 0;
        double psa;
        spectrum_psa(motion, fmin(m->zeta[i], 0.99), 1, &period, &psa);
        squares += pow(m->gamma[i] * m->gamma[i] * psa, 2);
    }
    return sqrt(squares) / (mass * GRAVITY);
}

/* The building's figures. */
static void summarise_building(SceneSummary *s, const Building *b)
{
    const int n = b->n;
    *s = (SceneSummary){.n_floors = n,
                        .note = b->note,
                        .mass_kg = building_mass(b),
                        .floor_mass_min_kg = HUGE_VAL,
                        .floor_mass_max_kg = -HUGE_VAL,
                        .lowest_m = HUGE_VAL,
                        .heights_assumed = b->heights_assumed,
                        .hardening_raised = b->hardening_raised ? b->hardening : 0};
    for (int j = 0; j < n; j++) {
        const double row = building_floor_mass(b, j);
        if (row < s->floor_mass_min_kg) {
            s->floor_mass_min_kg = row;
            s->lightest = j + 1;
        }
        if (row > s->floor_mass_max_kg) {
            s->floor_mass_max_kg = row;
            s->heaviest = j + 1;
        }
        s->height_m += b->storey_m[j];
        s->lowest_m = fmin(s->lowest_m, b->storey_m[j]);
        s->highest_m = fmax(s->highest_m, b->storey_m[j]);
    }

    /* From the top down the first mode falls from row to row. Of storeys it rises in any order: there each is stiffer
     * than the one below, and the last floor heavier than the first. */
    int falls = n > 1, stiffens = s->lightest < s->heaviest;
    for (int j = 1; j < n; j++) {
        const double *row = b->K + (j - 1) * n, below = j > 1 ? -row[j - 2] : row[0] + row[1];
        falls &= fabs(b->phi[j * n]) < fabs(b->phi[(j - 1) * n]);
        stiffens &= -row[j] > below;
    }
    s->top_first = falls || stiffens;
    for (int i = 0; i < 3 && i < n; i++) {
        s->period_s[i] = 2 * M_PI / b->omega[i];
        s->damping[i] = b->zeta[i];
    }
    s->first_mode_mass = b->gamma[0] * b->gamma[0] / s->mass_kg;
}

Status scene_summarise(SceneSummary *s, const Building *b, const CoreOptions *core, const BuildingOptions *of,
                       const Motion *motion, double t_base_m, double t_top_m, Err *err)
{
    CoreOptions clamped = *core;
    CoreBeam *beam;
    const double *h = b->storey_m;
    summarise_building(s, b);
    s->content_hz = 0.5 / motion->dt_s;
    s->base_shear = base_shear(&b->model, motion, s->mass_kg);
    TRY_ROOM(beam, 1, "a core", err);
    const Status status = core_make(beam, core, of, b, t_base_m, t_top_m, err);
    if (status == STATUS_OK) {
        s->core_mass_kg = beam->mass_kg;
        s->core_hz = s->timoshenko_hz = s->euler_bernoulli_hz = s->clamped_hz = beam->omega[0] / (2 * M_PI);
        while (s->core_modes_within < beam->top && beam->omega[s->core_modes_within] <= 2 * M_PI * s->content_hz)
            s->core_modes_within++;
    }
    free(beam);
    if (status != STATUS_OK || neighbour_is_given(core))
        return status;

    /* The first mode of a cantilever also by both theories, and clamped. */
    TRY(core_beam_first_hz(core, CORE_TIMOSHENKO, b->n, h, t_base_m, t_top_m, &s->timoshenko_hz, err));
    TRY(core_beam_first_hz(core, CORE_EULER_BERNOULLI, b->n, h, t_base_m, t_top_m, &s->euler_bernoulli_hz, err));
    snprintf(clamped.foundation, sizeof clamped.foundation, "fixed");
    return core_beam_first_hz(&clamped, core->theory, b->n, h, t_base_m, t_top_m, &s->clamped_hz, err);
}

/* ---- warnings ------------------------------------------------------------------------------------------------- */

typedef struct {
    WarnFn warn;
    void *user;
} Warner;

/* Warns of what the setting `key` leads to. */
__attribute__((format(printf, 3, 4))) static void say(const Warner *w, const char *key, const char *format, ...)
{
    char text[300];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    w->warn(key, text, w->user);
}

/* Warns of figures of the building outside the ranges of summary.h. */
static void warn_of_building(const SceneSummary *s, const Warner *w)
{
    const double per_storey = s->period_s[0] / s->n_floors;
    if (s->note[0])
        say(w, "building.model", "skipped:%s", s->note);
    if (!(per_storey >= PERIOD_PER_STOREY_MIN_S && per_storey <= PERIOD_PER_STOREY_MAX_S))
        say(w, "building.model", "the first period of %.4g s is %.3g s per storey; buildings have %g to %g",
            s->period_s[0], per_storey, PERIOD_PER_STOREY_MIN_S, PERIOD_PER_STOREY_MAX_S);
    for (int i = 0; i < 2; i++) {
        const double mass = i ? s->floor_mass_max_kg : s->floor_mass_min_kg;
        if (i ? mass > FLOOR_MASS_MAX_KG : mass < FLOOR_MASS_MIN_KG)
            say(w, "building.model", "floor %d has a mass of %.4g t; a floor usually has %g to %g t",
                i ? s->heaviest : s->lightest, mass / 1e3, FLOOR_MASS_MIN_KG / 1e3, FLOOR_MASS_MAX_KG / 1e3);
    }
    if (s->heights_assumed)
        say(w, "building.heights_m",
            "the files have no heights: those of the built-in tower are assumed, %.4g m in all; give "
            "building.heights_m = FIRST, OTHERS in m, from the bottom",
            s->height_m);
    if (s->lowest_m < STOREY_MIN_M || s->highest_m > STOREY_MAX_M)
        say(w, "building.model", "storeys of %.4g to %.4g m; they usually have %g to %g m", s->lowest_m, s->highest_m,
            STOREY_MIN_M, STOREY_MAX_M);
    if (s->hardening_raised > 0)
        say(w, "building.hardening", "raised to %.3g: with less the building would not stand where all storeys yield",
            s->hardening_raised);
    if (s->top_first)
        say(w, "building.model",
            "looks like floors from the top down (the first mode falls from row to row, or the storeys become stiffer "
            "and the floors heavier); they are wanted bottom floor first");
    for (int i = 0; i < 3; i++)
        if (s->damping[i] > DAMPING_MAX) {
            say(w, "building.damping", "mode %d has %g %% of critical; steel frames have 1 to 5 %%", i + 1,
                100 * s->damping[i]);
            break;
        }
}

void building_warnings(const Building *b, WarnFn warn, void *user)
{
    SceneSummary s;
    summarise_building(&s, b);
    warn_of_building(&s, &(Warner){warn, user});
}

/* [s] Of the lowest mode that resembles mode i of the floors; 0: there is none. */
static double period_like(const BuildingModel *m, int i)
{
    int k = 0;
    while (k < m->n && m->like[k] != i)
        k++;
    return k < m->n ? 2 * M_PI / m->omega[k] : 0;
}

Status condensation_warnings(const Building *b, const BuildingOptions *o, WarnFn warn, void *user, Err *err)
{
    Building full;
    BuildingOptions all = *o;
    all.modes = LONG_MAX;
    if (o->rigid_floors || o->modes > 0 || !frame_is(o->model))
        return STATUS_OK;
    TRY(building_load(&full, &all, err));
    for (int i = 0; i < 3 && i < b->n; i++) {
        const double is = period_like(&b->model, i), should = period_like(&full.model, i);
        if (is > 0 && should > 0 && fabs(is / should - 1) > PERIOD_ERROR_MAX)
            say(&(Warner){warn, user}, "building.rigid_floors",
                "off: period %d is %.4g s with one node for each floor, %.4g s in the full model; set building.modes, "
                "or leave floors rigid",
                i + 1, is, should);
    }
    building_free(&full);
    return STATUS_OK;
}

void scene_warnings(const SceneSummary *s, const CoreOptions *core, const DesignOptions *design, const Motion *motion,
                    WarnFn warn, void *user)
{
    const Warner w = {warn, user};
    const double peak_g = motion_peak(motion) / GRAVITY;
    warn_of_building(s, &w);

    /* A core that is damped, slow or modelled unlike others. */
    if (core->damping > DAMPING_MAX)
        say(&w, "core.damping", "%g is %g %% of critical; steel has 1 to 5 %%", core->damping, 100 * core->damping);
    if (s->core_modes_within == 0)
        say(&w, "motion.record",
            "holds nothing above %.4g Hz; the core's first mode is at %.4g Hz: the ground moves it as if it were "
            "rigid, impacts alone make it vibrate. Right where the ground shakes no faster; else take a record of "
            "smaller steps",
            s->content_hz, s->core_hz);
    if (core->theory == CORE_EULER_BERNOULLI && s->euler_bernoulli_hz > 1.1 * s->timoshenko_hz)
        say(&w, "core.theory", "shear lowers the core's first mode from %.4g to %.4g Hz; take timoshenko",
            s->euler_bernoulli_hz, s->timoshenko_hz);

    /* What moves it, and what stands around it. */
    if (peak_g > PEAK_MAX_G)
        say(&w, "motion.pga_g", "a peak of %.4g g; hardly a record exceeds %g g", peak_g, PEAK_MAX_G);
    if (design->gap_m.at[1] > GAP_MAX_M)
        say(&w, "design.gap_m", "gaps up to %g m; floors move less than %g m, such a gap does not close",
            design->gap_m.at[1], GAP_MAX_M);
}
