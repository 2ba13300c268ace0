#include "settings/rules.h"

#include <stdarg.h>

#include "base/list.h"
#include "scene/design.h"
#include "scene/foundation.h"
#include "motion/motion_read.h"
#include "motion/motion_scale.h"
#include "scene/neighbour.h"
#include "sim/as_built.h"

typedef struct {
    BrokenRuleFn broken;
    void *user;
} Rules;

__attribute__((format(printf, 2, 3))) static void break_rule(const Rules *r, const char *format, ...)
{
    char text[sizeof((Err *)0)->text];
    va_list values;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    r->broken(text, r->user);
}

static void check_motion(const MotionOptions *m, const Rules *r)
{
    char scalings[SCALINGS_TEXT_MAX];
    Err err;
    if (motion_scalings(m, scalings) > 1)
        break_rule(r, "motion: a record is scaled in one way, not in several: %s", scalings);
    if (target_parse(m->target, &(CodeSpectrum){0}, &err) != STATUS_OK)
        break_rule(r, "%s", err.text);
    if (motion_unit_parse(m->unit, &(MotionUnit){0}, &(double){0}, &err) != STATUS_OK)
        break_rule(r, "%s", err.text);
    if (m->highpass_hz > 0 && m->lowpass_hz > 0 && m->highpass_hz >= m->lowpass_hz)
        break_rule(r, "motion.highpass_hz: %g must be below motion.lowpass_hz = %g", m->highpass_hz, m->lowpass_hz);
}

static void check_core(const CoreOptions *o, const Rules *r)
{
    Err err;
    if (foundation_parse(o->foundation, 1, &(Foundation){0}, &err) != STATUS_OK)
        break_rule(r, "%s", err.text);
    if (o->foundation_factor != 1 && strcmp(o->foundation, "fixed") == 0)
        break_rule(r, "core.foundation_factor: is of core.foundation, which is fixed; leave it at 1");
    if (neighbour_is_given(o) && strcmp(o->foundation, "fixed") != 0)
        break_rule(r, "core.foundation: is that of a cantilever; a building of core.model stands fixed");
}

static void check_variables(const Settings *s, const Rules *r)
{
    const DesignOptions *d = &s->design;
    DesignSpace space;
    Err err;
    if (design_space_make(&space, d, core_section(&s->core), 0, &err) != STATUS_OK) {
        break_rule(r, "%s", err.text);
        return;
    }
    if (space.has_side && core_section(&s->core) != CORE_BOX)
        break_rule(r, "design.variables: side is that of core.section = box");
    if (space.has_side && 2 * d->thickness_m.at[1] > d->width_m.at[0])
        break_rule(r, "design.width_m: twice a thickness of %g m (design.thickness_m) does not fit into %g m",
                   d->thickness_m.at[1], d->width_m.at[0]);
    if (core_section(&s->core) == CORE_BOX && 2 * d->thickness_m.at[1] > s->core.width_m)
        break_rule(r, "design.thickness_m: twice %g m does not fit into core.width_m = %g", d->thickness_m.at[1],
                   s->core.width_m);
}

static void check_replicates(const Settings *s, const Rules *r)
{
    const UncertainOptions *u = &s->sim.uncertain;
    if (s->sim.gap_tolerance_m > 0 && s->sim.replicates < 2)
        break_rule(r, "sim.gap_tolerance_m: needs replicates that differ: set sim.replicates to 2 or more");
    if (is_uncertain(u) && s->sim.replicates < 2)
        break_rule(r, "sim.uncertain: needs replicates that differ: set sim.replicates to 2 or more");
    if (u->ground_stiffness > 0 && strcmp(s->core.foundation, "fixed") == 0)
        break_rule(r, "sim.uncertain: ground_stiffness is that of core.foundation, which is fixed");
}

static void check_fidelity(const SearchOptions *s, long replicates, const char *records, const Rules *r)
{
    if (s->fidelity == FIDELITY_OFF)
        return;
    if (s->fidelity == FIDELITY_REPLICATES && replicates < 2)
        break_rule(r, "search.fidelity: replicates needs several of them: set sim.replicates to 2 or more");
    if (s->fidelity == FIDELITY_RECORDS && !list_is_given(records))
        break_rule(r, "search.fidelity: records needs several of them: set motion.records");
    if (s->stop_after > 0)
        break_rule(r, "search.fidelity: finishes most designs at the end, so that what was gained lately is not known "
                      "before: set search.stop_after = 0");
}

void rules_check(const Settings *s, BrokenRuleFn broken, void *user)
{
    const Rules rules = {broken, user}, *r = &rules;
    check_motion(&s->motion, r);
    check_core(&s->core, r);
    check_variables(s, r);
    check_replicates(s, r);
    check_fidelity(&s->search, s->sim.replicates, s->motion.records, r);
    if (s->problem.kind == PROBLEM_EXTERNAL && strcmp(s->problem.command, "none") == 0)
        break_rule(r, "problem.command: is none; problem.kind = external needs the command of the simulator");
}
