#include "analysis/ladder.h"

#include "base/json.h"
#include "scene/frame.h"
#include "scene/neighbour.h"
#include "settings/settings.h"

/* Values of a setting with an effect, where it is not set, and without it. NULL: set_values has it. */
static const struct {
    const char *words, *key, *with, *without;
} EFFECTS[] = {
    {"between the floors", "building.modes", "100000", "0"},
    {"shear of the core", "core.theory", "timoshenko", "euler_bernoulli"},
    {"P-delta", "building.p_delta", "on", "off"},
    {"ground under the core", "core.foundation", NULL, "fixed"},
    {"core that lifts", "core.foundation", NULL, NULL},
    {"walls that buckle", "core.wall", "effective", "full"},
    {"storeys that yield", "building.yield_drift", "0.01", "0"},
    {"flexibility at contacts", "contact.bumper_stiffness_n_m", "5e8", "0"},
    {"contacts off the centre", "contact.eccentricity", "0.05", "0"},
    {"weak end of the record", "sim.duration_s", NULL, NULL},
    {"steps, modes of the core", "sim.accuracy", "fine", NULL},
};
enum { BETWEEN, SHEAR, P_DELTA, GROUND, LIFT, WALLS, YIELDING, FLEXIBILITY, OFF_CENTRE, END, STEPS, KINDS };

static void take_value(const char *key, const char *value, void *to)
{
    (void)key;
    snprintf(to, OPTION_TEXT_MAX, "%s", value);
}

/* -- effects ------------------------------------------------------------------------------------------------------- */

void ladder_anchors(const char *foundation, double anchors, char to[OPTION_TEXT_MAX])
{
    const char *word = strstr(foundation, " anchors=");
    const int n = word ? (int)(word - foundation) : (int)strlen(foundation);
    snprintf(to, OPTION_TEXT_MAX, "%.*s anchors=%g%s", n, foundation, anchors,
             word ? word + 1 + strcspn(word + 1, " ") : "");
}

/* The effects before it are in `all`: the ground that a mat lifts from. */
static void set_values(const Settings *all, int kind, double strong_s, LadderEffect *e)
{
    Foundation f;
    char now[OPTION_TEXT_MAX] = "";
    settings_each(all, EFFECTS[kind].key, take_value, now);
    const char *with = EFFECTS[kind].with ? EFFECTS[kind].with : now;
    const char *without = EFFECTS[kind].without ? EFFECTS[kind].without : now;
    *e = (LadderEffect){.words = EFFECTS[kind].words, .key = EFFECTS[kind].key};
    e->is_set = kind == STEPS ? strcmp(now, with) == 0 : strcmp(now, without) != 0 || kind == END;
    text_copy(e->with, e->is_set ? now : with);
    text_copy(e->without, kind == STEPS && e->is_set ? "standard" : without);
    if (kind == END)
        snprintf(e->without, sizeof e->without, "%.6g", strong_s);
    if (kind == GROUND && !e->is_set) /* a mat twice as wide as the core, held down */
        snprintf(e->with, sizeof e->with, "soil=C radius=%g anchors=inf", all->core.width_m);
    if (kind == LIFT) { /* what the settings have, else weight alone; and a mat that never lifts */
        e->is_set = foundation_parse(now, 1, &f, NULL) == STATUS_OK && f.anchors > 0;
        ladder_anchors(now, INFINITY, e->without);
        if (!e->is_set)
            ladder_anchors(now, 1, e->with);
    }
}

static int is_there(const Settings *all, int kind, double strong_s)
{
    const int has_beam = !neighbour_is_given(&all->core);
    Foundation f;
    Err err;
    switch (kind) {
    case BETWEEN:
        return frame_is(all->building.model);
    case SHEAR:
    case GROUND:
        return has_beam;
    case LIFT:
        return has_beam && foundation_parse(all->core.foundation, 1, &f, &err) == STATUS_OK && f.radius_m > 0 &&
               f.rotation > 0;
    case WALLS:
        return has_beam && core_section(&all->core) == CORE_BOX;
    case END:
        return all->sim.duration_s == 0 || strong_s < all->sim.duration_s;
    default:
        return 1;
    }
}

Status ladder_effects(const Settings *s, double strong_s, LadderForm form, Ladder *l, Settings *all, Err *err)
{
    *l = (Ladder){0};
    *all = *s;
    const int n_kinds = form == LADDER_WHOLE ? KINDS : form == LADDER_BRIEF ? END : STEPS;
    for (int kind = 0; kind < n_kinds; kind++) {
        LadderEffect *e = &l->effect[l->n];
        const int is_given = form == LADDER_OPEN && settings_gives(s, EFFECTS[kind].key);
        if (!is_there(all, kind, strong_s))
            continue;
        set_values(all, kind, strong_s, e);
        e->is_added = kind == STEPS || (kind == BETWEEN && form == LADDER_BRIEF);
        if (is_given)
            settings_each(s, e->key, take_value, e->with);
        else
            TRY(settings_put(all, e->key, e->is_added ? e->without : e->with, err));
        if (form == LADDER_OPEN)
            e->is_set = is_given;
        e->cost_s = NAN;
        l->n++;
    }
    for (int k = 0; k < LADDER_MEASURES; k++)
        l->tolerance[k] = LADDER_TOLERANCE;
    Building b;
    TRY(building_load(&b, &all->building, err));
    l->hardening = b.yields ? b.hardening : 0;
    building_free(&b);
    return STATUS_OK;
}

/* -- what each changes --------------------------------------------------------------------------------------------- */

/* Of two orders of the same sums. */
static const double ROUNDING = 1e-11;

double ladder_change(const Measured *to, const Measured *from, int k)
{
    const int is_known = to->outcome == RUN_OK && from->outcome == RUN_OK;
    const double by = is_known ? to->value[LADDER_MEASURE[k]] / from->value[LADDER_MEASURE[k]] - 1 : NAN;
    return fabs(by) < ROUNDING ? 0 : by;
}

double ladder_in_tolerances(const Ladder *l, const double change[LADDER_MEASURES], int scene)
{
    double most = 0;
    for (int k = 0; k < LADDER_MEASURES; k++) {
        const double of = fabs(change[k]) / (scene == 0 ? l->tolerance[k] : LADDER_TOLERANCE);
        most = isnan(of) ? INFINITY : fmax(most, of);
    }
    return most;
}

double ladder_largest(const Ladder *l, double changes[LADDER_SCENES][LADDER_MEASURES], int *scene)
{
    double most = -1;
    for (int i = 0; i < LADDER_SCENES; i++) {
        const double own = ladder_in_tolerances(l, changes[i], i);
        *scene = own > most ? i : *scene;
        most = fmax(most, own);
    }
    return most;
}

/* -- the set ------------------------------------------------------------------------------------------------------- */

Status ladder_put_set(const Ladder *l, Settings *s, Err *err)
{
    for (size_t i = 0; i < l->n; i++)
        if (ladder_says(l, i))
            TRY(settings_put(s, l->effect[i].key, l->effect[i].is_kept ? l->effect[i].with : l->effect[i].without,
                             err));
    return STATUS_OK;
}

LadderEffect *ladder_largest_left_out(Ladder *l)
{
    LadderEffect *found = NULL;
    for (size_t i = 0; i < l->n; i++)
        if (!l->effect[i].is_kept && (!found || l->effect[i].most > found->most))
            found = &l->effect[i];
    return found;
}

void ladder_keep(Ladder *l, LadderEffect *e)
{
    e->is_kept = 1;
    if (e > l->effect && strcmp(e->key, e[-1].key) == 0)
        e[-1].is_kept = 1;
}

/* -- in words ------------------------------------------------------------------------------------------------------ */

/* By the names of the measures and `end`, times `factor`. */
static json_t *json_by_measure(const double values[], const char *end, double factor)
{
    json_t *o = json_object();
    for (int k = 0; k < LADDER_MEASURES; k++) {
        char name[40];
        snprintf(name, sizeof name, "%s%s", measure(LADDER_MEASURE[k])->name, end);
        json_object_set_new(o, name, json_number(factor * values[k]));
    }
    return o;
}

json_t *ladder_json(const Ladder *l)
{
    json_t *effects = json_array(), *all = json_by_measure(l->value, "", 1), *settings = json_object(),
           *set = json_by_measure(l->off[0], "_pct", 100), *by_set = json_object();
    for (size_t i = 0; i < l->n; i++) {
        const LadderEffect *e = &l->effect[i];
        json_t *row = json_of("without=%s", e->words);
        json_object_update_new(row, json_by_measure(e->change[0], "_pct", 100));
        json_put(row,
                 "most_in=%s in_tolerances=%g costs_ms=%g verdict=%s is_set=%s kept=%s setting=%s "
                 "with=%s otherwise=%s",
                 SCENES[LADDER_SCENE[e->decided_in]].key, e->most, 1e3 * e->cost_s, e->is_needed ? "needed" : "not",
                 e->is_set ? "yes" : "no", e->is_kept ? "yes" : "no", e->key, e->with, e->without);
        json_array_append_new(effects, row);
        if (ladder_says(l, i))
            json_object_set_new(settings, e->key, json_string(e->is_kept ? e->with : e->without));
    }
    for (int i = 0; i < LADDER_SCENES; i++)
        json_object_set_new(by_set, SCENES[LADDER_SCENE[i]].key, json_by_measure(l->set[i], "", 1));
    json_put(all, "ms=%g hardening=%g", 1e3 * l->all_s, l->hardening);
    json_put(set, "ms=%g", 1e3 * l->set_s);
    return json_of("effects=%p with_all=%p tolerance=%p enough=%p by_the_set=%p settings=%p", effects, all,
                   json_by_measure(l->tolerance, "_pct", 100), set, by_set, settings);
}
