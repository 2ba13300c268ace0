#include "report/words.h"

#include "motion/suite.h"
#include "settings/options.h"

/* A measure without a line here is shown by its name in its own unit. */
static const Words WORDS[N_MEASURES] = {
    [MEASURE_J1] = {"J1 displacement", "m", 1},
    [MEASURE_J2] = {"J2 interstorey drift", "m", 1},
    [MEASURE_J3] = {"J3 acceleration", "g", 1},
    [MEASURE_ED1] = {"mode 1 share", "%", 1},
    [MEASURE_ED5_10] = {"modes 5–10 share", "%", 1},
    [MEASURE_EDCS] = {"core share", "%", 1},
    [MEASURE_MCORE] = {"core mass", "t", 1e-3},
    [MEASURE_INPUT] = {"input energy", "MJ", 1e-6},
    [MEASURE_BALANCE] = {"energy balance error", "", 1},
    [MEASURE_IMPACTS] = {"impacts", "", 1},
    [MEASURE_DRIFT_RATIO] = {"drift ratio", "%", 100},
    [MEASURE_INDENTATION] = {"indentation / radius", "", 1},
    [MEASURE_BEYOND_LAW] = {"beyond contact law", "", 1},
    [MEASURE_PRESSURE] = {"contact pressure", "GPa", 1e-9},
    [MEASURE_BUMPER_STRAIN] = {"bumper strain", "%", 100},
    [MEASURE_CONTACT_FORCE] = {"contact force", "MN", 1e-6},
    [MEASURE_CORE_SHEAR] = {"core base shear", "MN", 1e-6},
    [MEASURE_CORE_OVERTURNING] = {"core overturning", "MN m", 1e-6},
    [MEASURE_CORE_STRESS] = {"core stress", "MPa", 1e-6},
    [MEASURE_CORE_BUCKLING] = {"stress / buckling", "", 1},
    [MEASURE_BUILDING_SHEAR] = {"building base shear", "MN", 1e-6},
    [MEASURE_BASE_SHEAR] = {"base shear", "MN", 1e-6},
    [MEASURE_J3_FILTERED] = {"J3 filtered", "g", 1},
    [MEASURE_BASE_ROTATION] = {"base rotation", "mrad", 1e3},
    [MEASURE_UPLIFT] = {"moment / uplift", "", 1},
    [MEASURE_DUCTILITY] = {"ductility", "", 1},
    [MEASURE_PLASTIC_DRIFT] = {"plastic drift", "%", 100},
    [MEASURE_RESIDUAL_DRIFT] = {"residual drift", "%", 100},
    [MEASURE_HYSTERESIS] = {"hysteresis share", "%", 1},
    [MEASURE_DEVICE_FORCE] = {"force of a link or tuned mass", "MN", 1e-6},
    [MEASURE_DEVICE_STROKE] = {"stroke of a link or tuned mass", "m", 1},
    [MEASURE_DEVICE_SHARE] = {"share of links and tuned mass", "%", 1},
    [MEASURE_LOSS] = {"repair cost", "%", 100},
    [MEASURE_ANNUAL_LOSS] = {"repair cost of a year", "%", 100},
};

Words words_of_measure(int k)
{
    const Measure *m = measure(k);
    const int has_unit = strcmp(m->unit, "-") != 0;
    return WORDS[k].title ? WORDS[k] : (Words){m->name, has_unit ? m->unit : "", 1};
}

/* Without the apostrophe that keeps a name from being a formula in a spreadsheet (base/visible.h). */
Words words_of_objective(const Schema *schema, size_t k)
{
    const char *name = schema_objective(schema, k)->name;
    if (schema->order.n_obj > 0 && schema->order.of[k] < MEASURES_LISTED)
        return words_of_measure(schema->order.of[k]);
    return (Words){name + (name[0] == '\'' && name[1] && strchr("=+-@", name[1])), "", 1};
}

void words_of_rule(const Settings *s, char text[RULE_WORDS_MAX])
{
    static const char *const RULES[] = {ROBUST_LIST(CHOICE_WORD)};
    const size_t n = suite_count(&s->motion);
    const long each = s->sim.replicates;
    char rule[40], spread[40] = "";
    if (s->sim.quantile > 0)
        snprintf(rule, sizeof rule, "quantile %g", s->sim.quantile);
    else
        snprintf(rule, sizeof rule, "%s", n == 1 && s->sim.robust == ROBUST_WORST ? "mean" : RULES[s->sim.robust]);
    if (each > 1)
        snprintf(spread, sizeof spread, "%s%ld replicates", n > 1 ? " x " : "", each);
    text[0] = 0;
    if (n > 1)
        snprintf(text, RULE_WORDS_MAX, "%s of %zu records%s", rule, n, spread);
    else if (each > 1)
        snprintf(text, RULE_WORDS_MAX, "%s of %s", rule, spread);
}
