#include "cmd/show.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "moga/hypervolume.h"
#include "store/output.h"

/* What a figure is, and what it takes to have it. */
typedef enum { OF_NUMBER, OF_LONG, OF_INT, OF_STOREY, OF_FLAG, OF_FLOORS, OF_MODES, OF_SIDES, OF_COUNTS } FieldKind;
enum {
    IF_FORCES = 1,
    IF_CORE = 2,
    IF_CONTACTS = 4,
    IF_STRESS = 8,
    IF_BUCKLING = 16,
    IF_DEVICE = 32,
    IF_BUMPER = 64,
    IN_CORE = IF_FORCES | IF_CORE
};

#define FIELD(kind, needs, field)                                                                                      \
    {                                                                                                                  \
#field, kind, needs, offsetof(SimResult, field)                                                                \
    }
#define FORCE(kind, needs, field)                                                                                      \
    {                                                                                                                  \
#field, kind, needs, offsetof(SimResult, forces.field)                                                         \
    }
#define NAMED(name, kind, needs, field)                                                                                \
    {                                                                                                                  \
        name, kind, needs, offsetof(SimResult, field)                                                                  \
    }
static const struct {
    const char *name;
    FieldKind kind;
    unsigned needs;
    size_t at;
} FIELDS[] = {
    FIELD(OF_LONG, 0, impacts),
    FIELD(OF_NUMBER, IF_DEVICE, stroke_m),
    FIELD(OF_NUMBER, IF_DEVICE, dashpot_n),
    FIELD(OF_LONG, 0, v0_limited),
    FIELD(OF_NUMBER, 0, settled_s),
    FIELD(OF_INT, 0, repeated),
    FIELD(OF_FLOORS, 0, peak_displacement_m),
    FIELD(OF_FLOORS, 0, peak_drift_m),
    FIELD(OF_FLOORS, 0, peak_acceleration_g),
    FIELD(OF_STOREY, 0, drift_ratio_storey),
    NAMED("peak_drift_ratio", OF_FLOORS, 0, drift_ratio),
    FIELD(OF_MODES, 0, mode_share_pct),
    FORCE(OF_NUMBER, IF_FORCES, building_overturning_nm),
    FORCE(OF_FLOORS, IF_FORCES, building_shear_n),
    FORCE(OF_NUMBER, IF_FORCES, base_shear_ratio),
    FORCE(OF_NUMBER, IF_FORCES, overturning_nm),
    FORCE(OF_FLOORS, IF_FORCES, peak_velocity_m_s),
    FORCE(OF_NUMBER, IN_CORE, core_top_m),
    FORCE(OF_FLOORS, IN_CORE, core_shear_n),
    FORCE(OF_FLOORS, IN_CORE, core_moment_nm),
    FORCE(OF_STOREY, IN_CORE | IF_STRESS, core_stress_storey),
    FORCE(OF_FLOORS, IN_CORE | IF_STRESS, core_storey_stress_pa),
    FORCE(OF_NUMBER, IN_CORE | IF_STRESS, core_shear_stress_pa),
    FORCE(OF_FLOORS, IN_CORE | IF_BUCKLING, core_slenderness),
    FORCE(OF_FLOORS, IN_CORE | IF_BUCKLING, core_buckling_pa),
    FORCE(OF_SIDES, IF_FORCES | IF_CONTACTS, contact_force_n),
    FORCE(OF_SIDES, IF_FORCES | IF_CONTACTS, contact_impulse_ns),
    FORCE(OF_COUNTS, IF_FORCES | IF_CONTACTS, contacts),
    FORCE(OF_SIDES, IF_FORCES | IF_CONTACTS, indentation_m),
    FIELD(OF_NUMBER, 0, damped_building_j),
    FIELD(OF_NUMBER, 0, damped_core_j),
    FIELD(OF_NUMBER, 0, kinetic_strain_j),
    FIELD(OF_NUMBER, 0, contact_loss_j),
    FIELD(OF_NUMBER, 0, contact_stored_j),
    FIELD(OF_NUMBER, 0, clamp_j),
    FIELD(OF_NUMBER, 0, indentation_max_m),
    FIELD(OF_FLAG, 0, contact_yields),
    FIELD(OF_NUMBER, IF_BUMPER, bumper_compression_m),
    FIELD(OF_NUMBER, IF_BUMPER, bumper_strain),
    FIELD(OF_FLAG, IF_BUMPER, bumper_bottoms_out),
    FIELD(OF_LONG, 0, steps),
    FIELD(OF_LONG, 0, force_evaluations),
    FIELD(OF_NUMBER, 0, seconds),
};

static json_t *json_counts(size_t n, const long counts[])
{
    json_t *list = json_array();
    for (size_t i = 0; i < n; i++)
        list = json_append(list, json_real((double)counts[i]));
    return list;
}

static json_t *json_field(FieldKind kind, const SimResult *r, const void *at)
{
    const double *of = at;
    const long *counts = at;
    const int *whole = at;
    const size_t n = (size_t)r->n_floors;
    switch (kind) {
    case OF_NUMBER:
        return json_number(*of);
    case OF_LONG:
        return json_integer(*counts);
    case OF_INT:
        return json_integer(*whole);
    case OF_STOREY:
        return json_integer(*whole + 1);
    case OF_FLAG:
        return json_boolean(*whole);
    case OF_FLOORS:
        return json_numbers(n, of);
    case OF_MODES:
        return json_numbers((size_t)r->n_modes, of);
    case OF_SIDES: /* [u > v, u < v][floor] */
        return json_pack("[o, o]", json_numbers(n, of), json_numbers(n, of + FLOORS_MAX));
    case OF_COUNTS:
        return json_pack("[o, o]", json_counts(n, counts), json_counts(n, counts + FLOORS_MAX));
    }
    return NULL;
}

json_t *json_result(SceneKind kind, const SimResult *r)
{
    static const char *const SCENES[N_SCENES] = {[SCENE_IMPACT] = "impact",
                                                 [SCENE_NO_CORE] = "no_core",
                                                 [SCENE_RIGID] = "rigid",
                                                 [SCENE_TMD] = "tmd",
                                                 [SCENE_LINKS] = "links"};
    const int has_device = kind == SCENE_TMD || kind == SCENE_LINKS;
    const unsigned has = (r->forces_known ? IF_FORCES : 0u) |
                         (kind != SCENE_NO_CORE && kind != SCENE_TMD ? IF_CORE : 0u) |
                         (kind == SCENE_IMPACT ? IF_CONTACTS : 0u) | (r->forces.stress_known ? IF_STRESS : 0u) |
                         (r->forces.buckling_known ? IF_BUCKLING : 0u) | (has_device ? IF_DEVICE : 0u) |
                         (r->bumper_strain > 0 ? IF_BUMPER : 0u);
    json_t *o = json_pack("{s:s, s:s, s:s}", "scene", SCENES[kind], "outcome",
                          outcome_word(measure_outcome(r->outcome)), "reason", r->reason);
    for (int k = 0; k < N_MEASURES; k++)
        json_object_set_new(o, measure(k)->name, json_number(measure_value(r, k)));
    json_object_set_new(o, "beyond_contact_law", json_boolean(beyond_contact_law(r)));
    json_object_set_new(o, "peak_filtered_g",
                        r->filtered_known ? json_numbers((size_t)r->n_floors, r->peak_filtered_g) : json_null());
    for (size_t i = 0; i < sizeof FIELDS / sizeof FIELDS[0]; i++)
        if (!(FIELDS[i].needs & ~has))
            json_object_set_new(o, FIELDS[i].name, json_field(FIELDS[i].kind, r, (const char *)r + FIELDS[i].at));
    return o;
}

static json_t *json_measures(const double values[], int omits)
{
    json_t *o = json_object();
    for (int k = 0; k < N_MEASURES; k++)
        if (!omits || isfinite(values[k]))
            json_object_set_new(o, measure(k)->name, json_number(values[k]));
    return o;
}

json_t *json_errors(const double error[])
{
    return json_measures(error, 1);
}

json_t *json_replicates(const ReplicateSummary *r)
{
    double unknown[N_MEASURES];
    for (int k = 0; k < N_MEASURES; k++)
        unknown[k] = NAN;
    return json_pack("{s:I, s:I, s:I, s:s, s:s, s:o, s:o}", "n", (json_int_t)r->n_replicates, "records",
                     (json_int_t)r->n_records, "failed", (json_int_t)r->n_failed, "spread", r->spread, "rule", r->rule,
                     "mean", json_measures(r->n_failed ? unknown : r->mean, 0), "sd",
                     json_measures(r->n_failed ? unknown : r->sd, 0));
}

Status show_json(json_t *all, Err *err)
{
    const int failed = !all || json_dumpf(all, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) != 0;
    json_decref(all);
    putchar('\n');
    return failed ? fail(err, STATUS_IO, "standard output: cannot be written") : STATUS_OK;
}

void show_motion(FILE *out, const Motion *m, double duration_s)
{
    const double length = (double)(m->n - 1) * m->dt_s;
    char peak[MOTION_PEAK_TEXT_MAX];
    motion_peak_text(m, peak);
    fprintf(out, "%s: ", m->name);
    if (duration_s > 0 && duration_s < length)
        fprintf(out, "the first %.4g of ", duration_s);
    fprintf(out, "%.4g s, %s\n", length, peak);
    if (m->processed[0])
        fprintf(out, "  %s\n", m->processed);
    if (m->warning[0])
        fprintf(out, "  warning: %s\n", m->warning);
}

/* Digits of a value that an error leaves standing: one to four. */
static int digits_known(double value, double error)
{
    const double digits = 1 + floor(log10(fabs(value / error)));
    return digits >= 1 && digits < 4 ? (int)digits : digits < 1 ? 1 : 4;
}

/* In a column of width 10 or of the name's, if that is wider. */
static void show_digits(double value, int digits, const char *name)
{
    const int width = strlen(name) > 10 ? (int)strlen(name) : 10;
    if (isfinite(value))
        printf(" %*.*g", width, digits, value);
    else
        printf(" %*s", width, "-");
}

static void show_number(double value, const char *name)
{
    show_digits(value, 4, name);
}

void show_result_names(const char *label, const MeasureOrder *order)
{
    printf("%-28s", label);
    for (int i = 0; i < order->n_obj; i++)
        printf(" %10s", measure(order->of[i])->name);
    printf(" %8s %9s %11s\n", "impacts", "balance", "indentation");
}

void show_result_errors(const MeasureOrder *order, const double error[])
{
    printf("%-28s", "  estimated error");
    for (int i = 0; i < order->n_obj; i++)
        show_digits(error[order->of[i]], 1, measure(order->of[i])->name);
    putchar('\n');
}

void show_result(const char *label, const MeasureOrder *order, const SimResult *r, const double error[])
{
    printf("%-28.28s", label);
    for (int i = 0; i < order->n_obj; i++)
        show_digits(measure_value(r, order->of[i]),
                    error ? digits_known(measure_value(r, order->of[i]), error[order->of[i]]) : 4,
                    measure(order->of[i])->name);
    printf(" %8ld %9.1e %11.3g", r->impacts, r->energy_balance_error, r->indentation_ratio);
    if (r->outcome != RUN_OK)
        printf("  %s", outcome_word(measure_outcome(r->outcome)));
    if (beyond_contact_law(r))
        printf("  deeper than %g of the contact's radius: beyond the contact law", INDENTATION_RATIO_MAX);
    if (r->bumper_bottoms_out)
        printf("  a bumper is compressed by %.3g of its thickness: it bottoms out", r->bumper_strain);
    putchar('\n');
}

/* Of the first column: "best NAME" of every objective fits, and the words of the baselines. */
static int label_width(const Schema *schema)
{
    size_t width = 18;
    for (size_t k = 0; k < schema->n_obj; k++) {
        const size_t length = strlen("best ") + strlen(schema_objective(schema, k)->name);
        width = length > width ? length : width;
    }
    return (int)width;
}

static void show_label(const char *label, const char *id, const Schema *schema)
{
    printf("%-*s %7s", label_width(schema), label, id);
}

static void show_design(const char *label, long id, const Schema *schema)
{
    char text[24] = "-";
    if (id > 0)
        snprintf(text, sizeof text, "%ld", id);
    show_label(label, text, schema);
}

void show_limited_names(const Schema *schema)
{
    show_label("limited", "design", schema);
    for (size_t k = 0; k < schema->n_limited; k++)
        printf(" %10s", schema_extra(schema, schema->limited[k])->name);
    putchar('\n');
}

void show_limited(const char *label, long id, const Schema *schema, const double extra[])
{
    show_design(label, id, schema);
    for (size_t k = 0; k < schema->n_limited; k++)
        show_number(extra[schema->limited[k]], schema_extra(schema, schema->limited[k])->name);
    putchar('\n');
}

void show_objective_names(const Schema *schema)
{
    show_label("", "design", schema);
    for (size_t k = 0; k < schema->n_obj; k++)
        printf(" %10s", schema_objective(schema, k)->name);
    putchar('\n');
}

void show_objectives(const char *label, long id, const Schema *schema, const double natural[], const double error[])
{
    show_design(label, id, schema);
    for (size_t k = 0; k < schema->n_obj; k++)
        show_digits(natural[k], error ? digits_known(natural[k], error[k]) : 4, schema_objective(schema, k)->name);
    putchar('\n');
}

void show_objective_errors(const Schema *schema, const double error[])
{
    printf("%-26s", "  estimated error");
    for (size_t k = 0; k < schema->n_obj; k++)
        show_digits(error[k], 1, schema_objective(schema, k)->name);
    putchar('\n');
}

static void show_moments(int indent, const char *word, const ReplicateSummary *r, const MeasureOrder *order,
                         const double values[])
{
    char label[64];
    if (r->n_records > 1)
        snprintf(label, sizeof label, "  %s, %zu records x %zu", word, r->n_records, r->n_replicates);
    else
        snprintf(label, sizeof label, "  %s of %zu", word, r->n_replicates);
    printf("%*s%-28s", indent, "", label);
    for (int i = 0; i < order->n_obj; i++)
        show_number(values[order->of[i]], measure(order->of[i])->name);
    printf(" %8.3g %9.1e\n", values[MEASURE_IMPACTS], values[MEASURE_BALANCE]);
}

void show_replicates(int indent, const MeasureOrder *order, const ReplicateSummary *r)
{
    if (r->n_failed) {
        printf("%*s  %zu of the simulations of this design failed: no mean\n", indent, "", r->n_failed);
        return;
    }
    char label[48];
    show_moments(indent, r->rule, r, order, r->mean);
    snprintf(label, sizeof label, "sd %s", r->spread);
    if (r->n_records * r->n_replicates > 1 && isfinite(r->sd[order->of[0]]))
        show_moments(indent, label, r, order, r->sd);
}

void write_replicates_names(FILE *out)
{
    fputs(",records,replicates,rule,spread", out);
    for (int k = 0; k < N_MEASURES; k++)
        fprintf(out, ",%s_mean,%s_sd", measure(k)->name, measure(k)->name);
}

void write_replicates(FILE *out, const ReplicateSummary *r)
{
    if (r)
        fprintf(out, ",%zu,%zu,%s,%s", r->n_records, r->n_replicates, r->rule, r->spread);
    else
        fputs(",,,,", out);
    for (int k = 0; k < N_MEASURES; k++) {
        const int known = r && !r->n_failed;
        print_cells(out, 2, (const double[]){known ? r->mean[k] : NAN, known ? r->sd[k] : NAN});
    }
}

/* Names of the objectives that are better (sign 1) or worse (-1) than the baseline's, by more than a thousandth. */
static void print_better(const char *verb, const Schema *schema, double sign, const double natural[], const Baseline *b)
{
    static const double SHARE = 1e-3;
    int n = 0;
    for (size_t k = 0; k < schema->n_obj; k++) {
        const Column *c = schema_objective(schema, k);
        const double other = b->value[schema->order.of[k]];
        if (sign * c->sense * (other - natural[k]) > SHARE * fabs(other))
            printf("%s%s", n++ ? ", " : verb, c->name);
    }
    if (n == 0)
        printf("%snothing", verb);
}

void show_verdict(BaselineKind kind, const Schema *schema, const double natural[], const Baseline *b)
{
    char device[DEVICE_TEXT_MAX];
    baseline_device_text(kind, &b->device, device);
    printf("against %s%s%s%s: impacts ", baseline_words(kind), *device ? " (" : "", device, *device ? ")" : "");
    print_better("win in ", schema, 1, natural, b);
    print_better("; lose in ", schema, -1, natural, b);
    putchar('\n');
}

void show_baselines(const Schema *schema, const double natural[], const Baseline baseline[N_BASELINES])
{
    double values[OBJECTIVES_MAX];
    for (int k = 0; k < N_BASELINES; k++) {
        for (size_t i = 0; i < schema->n_obj; i++)
            values[i] = baseline[k].value[schema->order.of[i]];
        show_objectives(baseline_words((BaselineKind)k), 0, schema, values, NULL);
    }
    putchar('\n');
    for (int k = 0; k < N_BASELINES; k++)
        show_verdict((BaselineKind)k, schema, natural, &baseline[k]);
}

void show_expected_gain(double gain)
{
    if (isfinite(gain) && gain < hypervolume_error(0.5))
        puts("as many simulations again: no more hypervolume expected than its noise");
    else if (isfinite(gain))
        printf(
            "as many simulations again: some %.2g more hypervolume expected, as a share of the box about the front\n",
            fmax(gain, 0.0));
}
