#include "cmd/show.h"

#include <math.h>

#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "moga/hypervolume.h"
#include "store/output.h"

static const char *scene_word(SceneKind kind)
{
    switch (kind) {
    case SCENE_IMPACT:
        return "impact";
    case SCENE_NO_CORE:
        return "no_core";
    case SCENE_RIGID:
        return "rigid";
    case SCENE_TMD:
        return "tmd";
    case SCENE_LINKS:
        return "links";
    case N_SCENES:
        break;
    }
    return "unknown";
}

/* [u > v, u < v][floor] */
static json_t *json_sides(int n, const double of[SIDES][FLOORS_MAX])
{
    return json_pack("[o, o]", json_numbers((size_t)n, of[0]), json_numbers((size_t)n, of[1]));
}

static void add_contact_forces(json_t *o, int n, const SimForces *f)
{
    double count[SIDES][FLOORS_MAX] = {{0}};
    for (int side = 0; side < SIDES; side++)
        for (int j = 0; j < n; j++)
            count[side][j] = (double)f->contacts[side][j];
    json_object_set_new(o, "contact_force_n", json_sides(n, f->contact_force_n));
    json_object_set_new(o, "contact_impulse_ns", json_sides(n, f->contact_impulse_ns));
    json_object_set_new(o, "contacts", json_sides(n, count));
    json_object_set_new(o, "indentation_m", json_sides(n, f->indentation_m));
}

static void add_core_forces(json_t *o, size_t n, const SimForces *f)
{
    json_object_set_new(o, "core_top_m", json_number(f->core_top_m));
    json_object_set_new(o, "core_shear_n", json_numbers(n, f->core_shear_n));
    json_object_set_new(o, "core_moment_nm", json_numbers(n, f->core_moment_nm));
    if (f->stress_known) {
        json_object_set_new(o, "core_stress_storey", json_integer(f->core_stress_storey + 1));
        json_object_set_new(o, "core_storey_stress_pa", json_numbers(n, f->core_storey_stress_pa));
        json_object_set_new(o, "core_shear_stress_pa", json_number(f->core_shear_stress_pa));
    }
    if (f->buckling_known) {
        json_object_set_new(o, "core_slenderness", json_numbers(n, f->core_slenderness));
        json_object_set_new(o, "core_buckling_pa", json_numbers(n, f->core_buckling_pa));
    }
}

static void add_building_forces(json_t *o, size_t n, const SimForces *f)
{
    json_object_set_new(o, "building_overturning_nm", json_number(f->building_overturning_nm));
    json_object_set_new(o, "building_shear_n", json_numbers(n, f->building_shear_n));
    json_object_set_new(o, "base_shear_ratio", json_number(f->base_shear_ratio));
    json_object_set_new(o, "overturning_nm", json_number(f->overturning_nm));
    json_object_set_new(o, "peak_velocity_m_s", json_numbers(n, f->peak_velocity_m_s));
}

static void add_forces(json_t *o, SceneKind kind, int n, const SimForces *f)
{
    add_building_forces(o, (size_t)n, f);
    if (kind != SCENE_NO_CORE && kind != SCENE_TMD)
        add_core_forces(o, (size_t)n, f);
    if (kind == SCENE_IMPACT)
        add_contact_forces(o, n, f);
}

static void add_peaks(json_t *o, const SimResult *r)
{
    const size_t n_floors = (size_t)r->n_floors, n_modes = (size_t)r->n_modes;
    json_object_set_new(o, "peak_displacement_m", json_numbers(n_floors, r->peak_displacement_m));
    json_object_set_new(o, "peak_drift_m", json_numbers(n_floors, r->peak_drift_m));
    json_object_set_new(o, "peak_acceleration_g", json_numbers(n_floors, r->peak_acceleration_g));
    json_object_set_new(o, "peak_filtered_g",
                        r->filtered_known ? json_numbers(n_floors, r->peak_filtered_g) : json_null());
    json_object_set_new(o, "drift_ratio_storey", json_integer(r->drift_ratio_storey + 1));
    json_object_set_new(o, "peak_drift_ratio", json_numbers(n_floors, r->drift_ratio));
    json_object_set_new(o, "mode_share_pct", json_numbers(n_modes, r->mode_share_pct));
}

json_t *json_result(SceneKind kind, const SimResult *r)
{
    json_t *o = json_object();
    json_object_set_new(o, "scene", json_string(scene_word(kind)));
    json_object_set_new(o, "outcome", json_string(outcome_word(measure_outcome(r->outcome))));
    json_object_set_new(o, "reason", json_string(r->reason));
    for (int k = 0; k < N_MEASURES; k++)
        json_object_set_new(o, measure(k)->name, json_number(measure_value(r, k)));
    json_object_set_new(o, "impacts", json_integer(r->impacts));
    json_object_set_new(o, "beyond_contact_law", json_boolean(beyond_contact_law(r)));
    if (kind == SCENE_TMD || kind == SCENE_LINKS) {
        json_object_set_new(o, "stroke_m", json_number(r->stroke_m));
        json_object_set_new(o, "dashpot_n", json_number(r->dashpot_n));
    }
    json_object_set_new(o, "v0_limited", json_integer(r->v0_limited));
    json_object_set_new(o, "settled_s", json_number(r->settled_s));
    json_object_set_new(o, "repeated", json_integer(r->repeated));
    add_peaks(o, r);
    if (r->forces_known)
        add_forces(o, kind, r->n_floors, &r->forces);

    json_object_set_new(o, "damped_building_j", json_number(r->damped_building_j));
    json_object_set_new(o, "damped_core_j", json_number(r->damped_core_j));
    json_object_set_new(o, "kinetic_strain_j", json_number(r->kinetic_strain_j));
    json_object_set_new(o, "contact_loss_j", json_number(r->contact_loss_j));
    json_object_set_new(o, "contact_stored_j", json_number(r->contact_stored_j));
    json_object_set_new(o, "clamp_j", json_number(r->clamp_j));
    json_object_set_new(o, "indentation_max_m", json_number(r->indentation_max_m));
    json_object_set_new(o, "contact_yields", json_boolean(r->contact_yields));
    if (r->bumper_strain > 0) {
        json_object_set_new(o, "bumper_compression_m", json_number(r->bumper_compression_m));
        json_object_set_new(o, "bumper_strain", json_number(r->bumper_strain));
        json_object_set_new(o, "bumper_bottoms_out", json_boolean(r->bumper_bottoms_out));
    }
    json_object_set_new(o, "steps", json_integer(r->steps));
    json_object_set_new(o, "force_evaluations", json_integer(r->force_evaluations));
    json_object_set_new(o, "seconds", json_number(r->seconds));
    return o;
}

json_t *json_errors(const double error[])
{
    json_t *o = json_object();
    for (int k = 0; k < N_MEASURES; k++)
        if (isfinite(error[k]))
            json_object_set_new(o, measure(k)->name, json_number(error[k]));
    return o;
}

json_t *json_replicates(const ReplicateSummary *r)
{
    json_t *o = json_object(), *mean = json_object(), *sd = json_object();
    for (int k = 0; k < N_MEASURES; k++) {
        json_object_set_new(mean, measure(k)->name, json_number(r->n_failed ? NAN : r->mean[k]));
        json_object_set_new(sd, measure(k)->name, json_number(r->n_failed ? NAN : r->sd[k]));
    }
    json_object_set_new(o, "n", json_integer((json_int_t)r->n_replicates));
    json_object_set_new(o, "records", json_integer((json_int_t)r->n_records));
    json_object_set_new(o, "failed", json_integer((json_int_t)r->n_failed));
    json_object_set_new(o, "spread", json_string(r->spread));
    json_object_set_new(o, "rule", json_string(r->rule));
    json_object_set_new(o, "mean", mean);
    json_object_set_new(o, "sd", sd);
    return o;
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
