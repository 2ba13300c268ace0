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

/* A text that cannot be read. */
static void check_text(const Rules *r, Status read, const Err *err)
{
    if (read != STATUS_OK)
        break_rule(r, "%s", err->text);
}

/* Rules of the motion, the core and the variables of a design. */
static void check_structure(const Settings *s, const Rules *r)
{
    const MotionOptions *m = &s->motion;
    const CoreOptions *o = &s->core;
    const DesignOptions *d = &s->design;
    const int is_fixed = strcmp(o->foundation, "fixed") == 0, is_box = core_section(o) == CORE_BOX;
    const double wall = d->thickness_m.at[1];
    char scalings[SCALINGS_TEXT_MAX];
    DesignSpace space;
    Foundation f = {0};
    Err err;
    if (motion_scalings(m, scalings) > 1)
        break_rule(r, "motion: a record is scaled in one way, not in several: %s", scalings);
    check_text(r, target_parse(m->target, &(CodeSpectrum){0}, &err), &err);
    check_text(r, motion_unit_parse(m->unit, &(MotionUnit){0}, &(double){0}, &err), &err);
    check_text(r, text_form_parse(m->text, &(TextForm){0}, &err), &err);
    if (m->highpass_hz > 0 && m->lowpass_hz > 0 && m->highpass_hz >= m->lowpass_hz)
        break_rule(r, "motion.highpass_hz: %g must be below motion.lowpass_hz = %g", m->highpass_hz, m->lowpass_hz);

    check_text(r, foundation_parse(o->foundation, 1, &f, &err), &err);
    if (o->foundation_factor != 1 && is_fixed)
        break_rule(r, "core.foundation_factor: is of core.foundation, which is fixed; leave it at 1");
    if (neighbour_is_given(o) && !is_fixed)
        break_rule(r, "core.foundation: is that of a cantilever; a building of core.model stands fixed");

    if (design_space_make(&space, d, core_section(o), 0, &err) != STATUS_OK) {
        break_rule(r, "%s", err.text);
        return;
    }
    if (!is_box && (o->wall != WALL_FULL || o->wall_factor > 0 || o->stiffeners > 0))
        break_rule(r, "core.%s: is of the walls of core.section = box", o->stiffeners > 0 ? "stiffeners" : "wall");
    if (space.has_anchors && !(f.anchors > 1))
        break_rule(r, "design.variables: anchors goes from 1 to the most of core.foundation: set its anchors= above 1");
    if (space.has_side && !is_box)
        break_rule(r, "design.variables: side is that of core.section = box");
    if (space.has_side && 2 * wall > d->width_m.at[0])
        break_rule(r, "design.width_m: twice a thickness of %g m (design.thickness_m) does not fit into %g m", wall,
                   d->width_m.at[0]);
    if (is_box && 2 * wall > o->width_m)
        break_rule(r, "design.thickness_m: twice %g m does not fit into core.width_m = %g", wall, o->width_m);
}

void rules_check(const Settings *s, BrokenRuleFn broken, void *user)
{
    const Rules rules = {broken, user}, *r = &rules;
    const UncertainOptions *u = &s->sim.uncertain;
    const Fidelity fidelity = s->search.fidelity;
    check_structure(s, r);
    if (s->sim.gap_tolerance_m > 0 && s->sim.replicates < 2)
        break_rule(r, "sim.gap_tolerance_m: needs replicates that differ: set sim.replicates to 2 or more");
    if (is_uncertain(u) && s->sim.replicates < 2)
        break_rule(r, "sim.uncertain: needs replicates that differ: set sim.replicates to 2 or more");
    if (u->ground_stiffness > 0 && strcmp(s->core.foundation, "fixed") == 0)
        break_rule(r, "sim.uncertain: ground_stiffness is that of core.foundation, which is fixed");
    if (fidelity == FIDELITY_REPLICATES && s->sim.replicates < 2)
        break_rule(r, "search.fidelity: replicates needs several of them: set sim.replicates to 2 or more");
    if (fidelity == FIDELITY_RECORDS && !list_is_given(s->motion.records))
        break_rule(r, "search.fidelity: records needs several of them: set motion.records");
    if (fidelity != FIDELITY_OFF && s->search.stop_after > 0)
        break_rule(r, "search.fidelity: finishes most designs at the end, so that what was gained lately is not known "
                      "before: set search.stop_after = 0");
    if (s->problem.kind == PROBLEM_EXTERNAL && strcmp(s->problem.command, "none") == 0)
        break_rule(r, "problem.command: is none; problem.kind = external needs the command of the simulator");
}
