#include "evaluate/measures.h"

#include "base/list.h"
#include "scene/foundation.h"
#include "scene/neighbour.h"

static const Measure MEASURES[N_MEASURES] = {
#define X(id, name, unit, sense, needs, value, title, shown, factor, what)                                             \
    {name, unit, sense, needs, {title, shown, factor}, what},
    MEASURE_LIST(X)
#undef X
        [MEASURES_LISTED... N_MEASURES - 1] = {
            "p", "-", 1, NEEDS_NOTHING, {"p", "", 1}, "share of the simulations that exceed a limit"}};

const Measure *measure(int k)
{
    return &MEASURES[k];
}

int measures_borne(int id[MEASURES_LISTED])
{
    int n = 0;
    for (int k = 0; k < MEASURES_LISTED; k++)
        if (MEASURES[k].needs & IS_BORNE)
            id[n++] = k;
    return n;
}

int measure_is_share(int k)
{
    return k == MEASURE_DRIFT_RATIO || k >= MEASURES_LISTED;
}

double measure_value(const SimResult *r, int k)
{
    const unsigned needs = MEASURES[k].needs;
    if (k >= MEASURES_LISTED)
        return r->chance[k - MEASURES_LISTED];
    if (((needs & (NEEDS_FORCES | NEEDS_FEW_FORCES)) && !r->forces_known) ||
        ((needs & NEEDS_FILTER) && !r->filtered_known) || ((needs & NEEDS_YIELDING) && !r->yields) ||
        ((needs & NEEDS_NEIGHBOUR) && r->neighbour.n == 0))
        return NAN;
    switch ((MeasureId)k) {
#define X(id, name, unit, sense, needs, value, ...)                                                                    \
    case MEASURE_##id:                                                                                                 \
        return value;
        MEASURE_LIST(X)
#undef X
    case MEASURES_LISTED:
        break;
    }
    return NAN;
}

Measured measured(const SimResult *r)
{
    Measured m = {.seconds = r->seconds, .outcome = r->outcome};
    for (int k = 0; k < N_MEASURES; k++)
        m.value[k] = measure_value(r, k);
    text_copy(m.reason, r->reason);
    return m;
}

static unsigned measures_need(MeasureSet set)
{
    unsigned needs = NEEDS_NOTHING;
    for (int k = 0; k < N_MEASURES; k++)
        needs |= set >> k & 1 ? MEASURES[k].needs : NEEDS_NOTHING;
    return needs;
}

void measures_ask(MeasureSet set, SimOptions *o)
{
    const unsigned needs = measures_need(o->forces == FORCES_YES ? ~(MeasureSet)0 : set);
    o->filtered = (needs & NEEDS_FILTER) != 0;
    if (needs & (NEEDS_FORCES | NEEDS_FEW_FORCES))
        o->forces = FORCES_YES;
    if (needs & NEEDS_FORCES)
        o->measures_only = 0;
}

Status measures_check(MeasureSet set, const CoreOptions *core, const Building *b, Err *err)
{
    static const struct {
        unsigned needs;
        const char *words;
    } LACKS[] = {
        {NEEDS_YIELDING, "no storey yields: set building.yield_drift, or a column yield_drift of storeys.csv"},
        {NEEDS_TURNING, "the core's base does not turn: set core.foundation to soil=, g= or rotation="},
        {NEEDS_RADIUS, "no radius is known: set core.foundation with radius= [m]"},
        {NEEDS_SHAPE, "the core has no section: set core.section = box or plate, and core.model = none"},
        {NEEDS_WALLS, "the core has no walls: set core.section = box, and core.model = none"},
        {NEEDS_NEIGHBOUR, "there is no neighbour: set core.model"},
    };
    Foundation f = {0};
    const CoreSection section = core_section(core);
    foundation_parse(core->foundation, 1, &f, NULL); /* of settings that were checked */
    const unsigned has = (b->yields ? NEEDS_YIELDING : 0u) | (neighbour_is_given(core) ? NEEDS_NEIGHBOUR : 0u) |
                         (f.rotation > 0 ? NEEDS_TURNING : 0u) | (f.radius_m > 0 ? NEEDS_RADIUS : 0u) |
                         (section != CORE_EFFECTIVE ? NEEDS_SHAPE : 0u) | (section == CORE_BOX ? NEEDS_WALLS : 0u);
    for (int k = 0; k < N_MEASURES; k++)
        for (size_t i = 0; set >> k & 1 && i < N_OF(LACKS); i++)
            if (MEASURES[k].needs & LACKS[i].needs & ~has)
                return bad_data(err, "search.objectives: %s (there or in search.limits): %s", MEASURES[k].name,
                                LACKS[i].words);
    return STATUS_OK;
}

/* Whether a building of n_floors can have anything but 0 there. */
static int measure_exists(int k, int n_floors)
{
    return k != MEASURE_ED5_10 || n_floors == 0 || n_floors >= 5;
}

const char *measures_missing(const MeasureOrder *order, const char *objectives, int n_floors)
{
    if (measure_exists(MEASURE_ED5_10, n_floors))
        return NULL;
    if (order->objectives >> MEASURE_ED5_10 & 1)
        return "ed5_10_pct is 0 for every design: the building has no modes 5 to 10 (search.objectives)";
    return strcmp(objectives, "auto") == 0
               ? "ed5_10_pct is no objective: the building has no modes 5 to 10 (search.objectives)"
               : NULL;
}

void measures_settle(SimResult *r, MeasureSet set)
{
    for (int k = 0; k < N_MEASURES && r->outcome == RUN_OK; k++) {
        if (!(set >> k & 1) || isfinite(measure_value(r, k)))
            continue;
        r->outcome = RUN_NOT_FINITE;
        if (r->input_energy_j > 0)
            snprintf(r->reason, sizeof r->reason, "%s is not finite", MEASURES[k].name);
        else
            snprintf(r->reason, sizeof r->reason,
                     "the motion puts in no net energy, so shares of it are undefined: use more of the motion "
                     "(sim.duration_s) or other objectives (search.objectives)");
    }
}

/* -- objectives ---------------------------------------------------------------------------------------------------- */

/* A listed measure of that name of n characters; MEASURES_LISTED: none. */
static int find(const char *name, size_t n)
{
    int k = 0;
    while (k < MEASURES_LISTED && (strncmp(MEASURES[k].name, name, n) != 0 || MEASURES[k].name[n] != 0))
        k++;
    return k;
}

const char *measures_name(const MeasureOrder *order, int k)
{
    return k < MEASURES_LISTED ? MEASURES[k].name : order->chance[k - MEASURES_LISTED].name;
}

void measures_chances(const MeasureOrder *order, SimResult *r)
{
    for (int i = 0; i < CHANCES_MAX && order->chance[i].name[0]; i++) {
        const Chance *c = &order->chance[i];
        r->chance[i] = c->sign * (measure_value(r, c->of) - c->bound) > 0;
    }
}

static Status no_result(const char *key, const char *name, Err *err)
{
    const char *names[MEASURES_LISTED];
    for (int i = 0; i < MEASURES_LISTED; i++)
        names[i] = MEASURES[i].name;
    return fail_no_word(err, STATUS_BAD_DATA, key, name, "result", names, MEASURES_LISTED);
}

/* Read "p(NAME>NUMBER)", a share of simulations that is minimised, into *k, a measure of the order; another text says
 * so. Refused is what is the same for all designs, a per cent where the number is a share, and a preference of what is
 * worse. */
static Status take_chance(MeasureOrder *o, const char *key, const char *text, int *k, Err *err)
{
    Chance c = {0};
    size_t length = 0;
    char *end = NULL, name[sizeof c.name];
    for (const char *t = text; *t && length + 1 < sizeof c.name; t++)
        if (*t != ' ' && *t != '\t')
            c.name[length++] = *t;
    const int n = (int)strcspn(c.name + 2, "<>");
    const char *relation = c.name + 2 + n;
    c.bound = *relation ? strtod(relation + 1, &end) : NAN;
    if (!*relation || end == relation + 1 || strcmp(end, ")") != 0 || !isfinite(c.bound))
        return bad_data(err, "%s: '%.60s' is no p(NAME>NUMBER) with a column as NAME", key, text);
    snprintf(name, sizeof name, "%.*s", n, c.name + 2);
    c.of = find(name, n);
    c.sign = *relation == '>' ? 1 : -1;
    if (c.of == MEASURES_LISTED)
        return no_result(key, name, err);
    const int is_less = MEASURES[c.of].sense > 0;
    if (c.of == MEASURE_ANNUAL_LOSS)
        return bad_data(err, "%s: %s: annual_loss is a sum over records, no result of one simulation", key, c.name);
    if (c.bound < 0 || (c.bound == 0 && c.sign < 0))
        return bad_data(err, "%s: %s is the same for all designs: no result is below 0", key, c.name);
    if (c.bound >= 1 && measure_is_share(c.of))
        return bad_data(err, "%s: %s: this is a share of 1, no per cent; write %g for %g %%", key, c.name,
                        0.01 * c.bound, c.bound);
    if (is_less != (c.sign > 0))
        return bad_data(err, "%s: %s prefers what is worse: of %s %s is better; write p(%s%c%g)", key, c.name, name,
                        is_less ? "less" : "more", name, is_less ? '>' : '<', c.bound);
    for (*k = 0; *k < CHANCES_MAX && o->chance[*k].name[0] && strcmp(o->chance[*k].name, c.name) != 0;)
        ++*k;
    if (*k == CHANCES_MAX)
        return bad_data(err, "%s: with those of search.objectives more than %d probabilities", key, CHANCES_MAX);
    o->chance[*k] = c;
    o->judged |= (MeasureSet)1 << c.of;
    *k += MEASURES_LISTED;
    return STATUS_OK;
}

static int is_chance(const char *text)
{
    return strncmp(text, "p(", 2) == 0;
}

static void add_objective(MeasureOrder *o, int k)
{
    o->of[o->n_obj++] = k;
    o->objectives |= (MeasureSet)1 << k;
}

Status measures_order(MeasureOrder *out, const char *objectives, const char *limits, int n_floors, Err *err)
{
    static const char KEY[] = "search.objectives";
    const int is_auto = strcmp(objectives, "auto") == 0, is_paper = strcmp(objectives, "paper") == 0;
    const size_t n_names = is_auto || is_paper ? 0 : list_count(objectives);
    char name[64], text[128];
    int k;
    *out = (MeasureOrder){0};

    /* 1. Objectives: those of the paper, or a list of names. */
    for (k = 0; k < PAPER_OBJECTIVES && (is_auto || is_paper); k++)
        if (is_paper || measure_exists(k, n_floors))
            add_objective(out, k);
    for (size_t i = 0; i < n_names; i++) {
        if (!list_item(objectives, i, name, sizeof name))
            return bad_data(err, "%s: name %zu is empty or too long", KEY, i + 1);
        k = find(name, strlen(name));
        if (is_chance(name))
            TRY(take_chance(out, KEY, name, &k, err));
        else if (k == MEASURES_LISTED)
            return no_result(KEY, name, err);
        if (out->objectives >> k & 1)
            return bad_data(err, "%s: %s stands there twice", KEY, name);
        add_objective(out, k);
    }

    /* 2. Limits: what stands before the relation of every one; limits.c reads the rest. */
    for (size_t i = 0; i < list_count(limits); i++) {
        if (!list_item(limits, i, text, sizeof text))
            continue;
        const size_t inside = is_chance(text) ? strcspn(text, ")") : 0, n = inside + strcspn(text + inside, "<> \t");
        k = find(text, n);
        text[n] = 0;
        if (is_chance(text))
            TRY(take_chance(out, "search.limits", text, &k, err));
        if (k != MEASURES_LISTED || is_chance(text))
            out->limited |= (MeasureSet)1 << k;
    }

    /* 3. What is judged: both; one record alone need not have a rate, so that loss stands for annual_loss. */
    out->judged |= out->objectives | out->limited;
    if (out->judged >> MEASURE_ANNUAL_LOSS & 1)
        out->judged = (out->judged & ~((MeasureSet)1 << MEASURE_ANNUAL_LOSS)) | (MeasureSet)1 << MEASURE_LOSS;

    /* 4. All others behind the objectives. */
    out->n = out->n_obj;
    for (k = 0; k < N_MEASURES; k++)
        if (!(out->objectives >> k & 1) && (k < MEASURES_LISTED || (out->limited >> k & 1)))
            out->of[out->n++] = k;
    return STATUS_OK;
}

_Static_assert((int)OUTCOME_OK == RUN_OK && (int)OUTCOME_ENGINE_FAILED == RUN_ENGINE_FAILED,
               "the outcomes of an evaluation begin with those of a run");
