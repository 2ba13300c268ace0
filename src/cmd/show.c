#include "cmd/show.h"

#include "analysis/estimate.h"
#include "base/visible.h"
#include "base/figure.h"
#include "base/hypervolume.h"
#include "base/text.h"
#include "motion/suite.h"
#include "report/words.h"
#include "store/output.h"
#include "study/progress.h"

/* ---- tables ------------------------------------------------------------------------------------------------------ */

json_t *figures_row(json_t *table)
{
    json_t *row = json_object();
    json_array_append_new(table, row);
    return row;
}

static void put_as(json_t *row, const char *column, double value, double error, double sd, const char *word)
{
    static const double NOTHING = 0.05; /* [%] of a share, which is not negative but by rounding or a deviation */
    char text[FIGURE_MAX] = "0.0";
    if (!(strstr(column, "_pct") && value < 0 && value > -NOTHING && isnan(error) && isnan(sd)))
        figure_text(value, error, sd, word, text);
    json_object_set_new(row, column, json_string(text));
}

void figures_put(json_t *row, const char *column, double value, double error, double sd)
{
    put_as(row, column, value, error, sd, "sd");
}

/* Behind the point, of a number that is known: 0.03, not 0.03000. */
static void drop_zeros(char *text)
{
    size_t n = strchr(text, '.') && !strchr(text, '^') ? strlen(text) : 0;
    while (n > 0 && text[n - 1] == '0')
        n--;
    if (n > 0)
        text[n - (text[n - 1] == '.')] = 0;
}

enum { CELL_MAX = 600 };

/* As it is shown; NULL: empty. */
static void cell_words(const json_t *cell, char text[CELL_MAX])
{
    if (!cell || json_is_string(cell))
        snprintf(text, CELL_MAX, "%s", cell ? json_string_value(cell) : "");
    else if (json_is_integer(cell))
        snprintf(text, CELL_MAX, "%" JSON_INTEGER_FORMAT, json_integer_value(cell));
    else if (json_is_boolean(cell))
        snprintf(text, CELL_MAX, "%s", json_is_true(cell) ? "yes" : "no");
    else
        figure_text(json_is_real(cell) ? json_real_value(cell) : NAN, 0, NAN, "", text);
    if (json_is_real(cell))
        drop_zeros(text);
}

/* Characters, not bytes. */
static int width_of(const char *text)
{
    int n = 0;
    for (; *text; text++)
        n += (*text & 0xC0) != 0x80;
    return n;
}

/* Every column with its width; the table has one row at least. */
static json_t *columns_of(json_t *table)
{
    json_t *columns = json_object(), *row, *cell;
    const char *name;
    char text[CELL_MAX];
    size_t i;
    json_array_foreach(table, i, row) json_object_foreach(row, name, cell)
    {
        const json_int_t before = json_integer_value(json_object_get(columns, name));
        cell_words(cell, text);
        const int head = width_of(name), own = width_of(text), width = MAX_OF(head, own);
        if (!before || width > before)
            json_object_set_new(columns, name, json_integer(width));
    }
    return columns;
}

/* row NULL: the names. Words stand left, in the first column and in those whose name begins with a blank. */
static void print_row(json_t *columns, const json_t *row)
{
    const char *name, *gap = "";
    json_t *width;
    char text[CELL_MAX];
    json_object_foreach(columns, name, width)
    {
        if (row)
            cell_words(json_object_get(row, name), text);
        else
            snprintf(text, sizeof text, "%s", name);
        const int blanks = (int)json_integer_value(width) - width_of(text), is_word = !*gap || *name == ' ';
        if (is_word)
            printf("%s%s%*s", gap, text, *name == ' ' ? 0 : blanks, "");
        else
            printf("%s%*s%s", gap, blanks, "", text);
        gap = "  ";
    }
    putchar('\n');
}

void figures_print(json_t *table)
{
    json_t *columns = columns_of(table), *row;
    size_t i;
    if (json_array_size(table) > 0)
        print_row(columns, NULL);
    json_array_foreach(table, i, row) print_row(columns, row);
    json_decref(columns);
    json_decref(table);
}

enum { LISTED_MAX = 32 }; /* numbers in a line: more are not for the eye */

static void list_value(const json_t *value)
{
    char text[CELL_MAX];
    size_t i;
    json_t *item;
    json_array_foreach(value, i, item) list_value(item);
    cell_words(value, text);
    if (!json_is_array(value))
        printf(" %s", text);
}

/* Behind seconds of a study that are many: hours and minutes. */
static void list_duration(const char *key, const json_t *value)
{
    char text[32];
    duration_words(json_number_value(value), text);
    if (strncmp(key, "seconds", 7) == 0 && json_number_value(value) >= 100)
        printf(" (%s)", text);
}

/* Nothing to be seen: no value, no text, or rows, which a table shows. */
static int is_listed(const json_t *value)
{
    const size_t n = json_array_size(value);
    return !json_is_null(value) && !(json_is_string(value) && !json_string_length(value)) &&
           (!json_is_array(value) || (n > 0 && n <= LISTED_MAX && !json_is_object(json_array_get(value, 0))));
}

void figures_list(int indent, json_t *o)
{
    const char *key;
    json_t *value;
    json_object_foreach(o, key, value)
    {
        if (!is_listed(value) || (json_is_object(value) && json_object_size(value) == 0))
            continue;
        printf("%*s%s", indent, "", key);
        if (!json_is_object(value)) {
            printf("%*s", 24 - (int)strlen(key), "");
            list_value(value);
            list_duration(key, value);
        }
        putchar('\n');
        figures_list(indent + 2, value);
    }
}

/* row NULL: the names. */
static void write_row(FILE *out, json_t *columns, const json_t *row)
{
    const char *name, *comma = "";
    char text[CELL_MAX], safe[CELL_MAX];
    json_t *unused;
    json_object_foreach(columns, name, unused)
    {
        const json_t *cell = json_object_get(row, name);
        fputs(comma, out);
        comma = ",";
        if (json_is_real(cell)) {
            print_number(out, json_real_value(cell));
        } else if (cell && !json_is_null(cell)) {
            cell_words(cell, text);
            cell_text(safe, sizeof safe, text);
            fputs(safe, out);
        } else if (!row) {
            fputs(name, out);
        }
    }
    fputc('\n', out);
}

Status figures_csv(json_t *table, const char *path, Err *err)
{
    Output o;
    size_t i;
    json_t *row, *columns = columns_of(table);
    Status status = output_open(&o, path, err);
    if (status == STATUS_OK) {
        write_row(o.stream, columns, NULL);
        json_array_foreach(table, i, row) write_row(o.stream, columns, row);
        status = output_close(&o, err);
    }
    json_decref(columns);
    json_decref(table);
    return status;
}

/* row NULL: the names. */
static void html_row(FILE *out, json_t *columns, const json_t *row)
{
    const char *name, *tag = "th";
    char text[CELL_MAX];
    json_t *unused;
    fputs("<tr>", out);
    json_object_foreach(columns, name, unused)
    {
        cell_words(json_object_get(row, name), text);
        fprintf(out, "<%s%s>", tag, *name == ' ' ? " class=\"words\"" : "");
        text_html(out, row ? text : name);
        fprintf(out, "</%s>", tag);
        tag = row ? "td" : "th";
    }
    fputs("</tr>\n", out);
}

void figures_html(FILE *out, json_t *table)
{
    json_t *columns = columns_of(table), *row;
    size_t i;
    fputs("<table>\n", out);
    html_row(out, columns, NULL);
    json_array_foreach(table, i, row) html_row(out, columns, row);
    fputs("</table>\n", out);
    json_decref(columns);
    json_decref(table);
}

Status show_json(json_t *all, Err *err)
{
    const int failed = json_dumpf(all, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) != 0;
    json_decref(all);
    putchar('\n');
    return failed ? fail(err, STATUS_IO, "standard output: cannot be written") : STATUS_OK;
}

/* ---- results ----------------------------------------------------------------------------------------------------- */

/* One value, a list, or [u > v, u < v] of lists. */
static json_t *json_part(const ResultPart *part, size_t rows, size_t n, const double of[])
{
    switch (part->shape) {
    case PART_NUMBER:
        return json_number(*of);
    case PART_LONG:
    case PART_INT:
    case PART_STOREY:
        return json_integer((json_int_t)*of);
    case PART_FLAG:
        return json_boolean(*of != 0);
    default:
        return rows == SIDES ? json_pair(n, of, of + n) : json_numbers(n, of);
    }
}

static json_t *json_damage(const SimResult *r)
{
    json_t *o = json_object();
    for (DamagedPart p = 0; p < N_PARTS; p++) {
        json_t *list = json_array();
        for (int j = 0; j < r->n_floors; j++)
            json_array_append_new(
                list, json_string(damage_word(
                          damage_state(p, p == PART_ACCELERATION ? r->peak_acceleration_g[j] : r->drift_ratio[j]))));
        json_object_set_new(o, DAMAGE_PARTS[p].key, list);
    }
    return o;
}

json_t *json_result(const MeasureOrder *order, SceneKind kind, const SimResult *r)
{
    json_t *o =
        json_of("scene=%s outcome=%s reason=%s", SCENES[kind].key, outcome_word((Outcome)r->outcome), r->reason);
    put_measures(o, order, "", measured(r).value, NULL, NULL);
    json_put(o, "beyond_contact_law=%c peak_filtered_g=%p", beyond_contact_law(r),
             r->filtered_known ? json_numbers(r->n_floors, r->peak_filtered_g) : json_null());
    for (const ResultPart *part = RESULT_PARTS; part->name; part++) {
        double values[SIDES * FLOORS_MAX];
        size_t rows;
        const size_t n = result_part(r, SCENES[kind].has, part, values, &rows);
        if (n > 0)
            json_object_set_new(o, part->name, json_part(part, rows, n, values));
    }
    return json_put(o, "damage=%p", r->outcome == RUN_OK ? json_damage(r) : NULL);
}

json_t *put_device(json_t *o, SceneKind kind, const LinearDevice *device)
{
    const char *name;
    double value;
    for (int i = 0; (name = case_device_number(kind, device, i, &value)); i++)
        json_object_set_new(o, name, json_number(value));
    return o;
}

void put_measures(json_t *o, const MeasureOrder *order, const char *end, const double values[], const char *other,
                  const double others[])
{
    char name[64];
    for (int k = 0; k < (order ? N_MEASURES : MEASURES_LISTED) && *measures_name(order, k); k++) {
        snprintf(name, sizeof name, "%s%s", measures_name(order, k), end);
        json_object_set_new(o, name, json_number(values ? values[k] : NAN));
        snprintf(name, sizeof name, "%s%s", measures_name(order, k), other ? other : "");
        if (other)
            json_object_set_new(o, name, json_number(others ? others[k] : NAN));
    }
}

/* The values that are known, by the names of their measures. */
static json_t *json_known(const double value[], double times)
{
    json_t *o = json_object();
    for (int k = 0; k < MEASURES_LISTED; k++)
        if (isfinite(value[k]))
            json_object_set_new(o, measure(k)->name, json_real(times * value[k]));
    return o;
}

void put_errors(json_t *o, const double likely[], const double sd[])
{
    json_t *bound = json_known(likely, ESTIMATE_FACTOR);
    json_object_set(o, "estimated_error", bound);
    json_put(o, "error=%p",
             json_of("likely=%p bound=%p sd_gaps_1_um=%p", json_known(likely, 1), bound, json_known(sd, 1)));
}

static json_t *json_measures(const MeasureOrder *order, const double values[])
{
    json_t *o = json_object();
    put_measures(o, order, "", values, NULL, NULL);
    return o;
}

json_t *json_replicates(const MeasureOrder *order, const ReplicateSummary *r)
{
    const int known = !r->n_failed;
    return json_of("n=%ld records=%ld failed=%ld spread=%s rule=%s mean=%p sd=%p standard_error=%p", r->n_replicates,
                   r->n_records, r->n_failed, r->spread, r->rule, json_measures(order, known ? r->mean : NULL),
                   json_measures(order, known ? r->sd : NULL), json_measures(order, known ? r->error : NULL));
}

void put_replicates(json_t *row, const MeasureOrder *order, const ReplicateSummary *r)
{
    const int known = r && !r->n_failed;
    json_put(row, "records=%p replicates=%p rule=%p spread=%p",
             r ? json_integer((json_int_t)r->n_records) : json_null(),
             r ? json_integer((json_int_t)r->n_replicates) : json_null(), r ? json_string(r->rule) : json_null(),
             r ? json_string(r->spread) : json_null());
    put_measures(row, order, "_mean", known ? r->mean : NULL, "_sd", known ? r->sd : NULL);
}

void put_fractiles(json_t *row, const char *column, const Evaluations *e, size_t level, SceneKind c, int k,
                   double factor)
{
    char value[IDA_FRACTILES][FIGURE_MAX];
    for (int f = 0; f < IDA_FRACTILES; f++)
        figure_text(factor * ida_fractile(e, level, c, k, IDA_FRACTILE[f]), NAN, NAN, "", value[f]);
    json_object_set_new(row, column,
                        e->n_read == 1 ? json_string(value[1])
                                       : json_sprintf("%s (%s to %s)", value[1], value[0], value[2]));
}

void show_motion(FILE *out, const Motion *m, double duration_s)
{
    char peak[MOTION_PEAK_TEXT_MAX];
    motion_peak_text(m, peak);
    fprintf(out, "%s: ", m->name);
    if (duration_s > 0 && duration_s < motion_duration(m))
        fprintf(out, "the first %.4g of ", duration_s);
    fprintf(out, "%.4g s, %s\n", motion_duration(m), peak);
    if (m->processed[0])
        fprintf(out, "  %s\n", m->processed);
    if (m->warning[0])
        fprintf(out, "  warning: %s\n", m->warning);
}

const char *uplift_words(const SimResult *r, char text[NOTE_MAX])
{
    if (r->mat_rotation_rad > 0)
        snprintf(text, NOTE_MAX, "the mat lifts: it turns by %.3g rad", r->mat_rotation_rad);
    else
        snprintf(text, NOTE_MAX,
                 "the core's moment is %.3g times that at which its foundation begins to lift%s: anchors must hold it",
                 r->forces.uplift_ratio, r->forces.uplift_ratio > LIFTED ? ", more than weight can hold" : "");
    return text;
}

/* What there is of errors and deviations; NULL: nothing. error: likely ones, behind the sign stands their bound,
 * which 95 % keep, as the errors of named designs do. word: what the deviation is, in the place of "sd". */
static void put_objectives(json_t *row, const MeasureOrder *order, const double value[], const double error[],
                           const double sd[], const char *word)
{
    for (int i = 0; i < order->n_obj; i++) {
        const int k = order->of[i];
        put_as(row, measures_name(order, k), value[k], error ? ESTIMATE_FACTOR * error[k] : NAN, sd ? sd[k] : NAN,
               word);
    }
}

json_t *figures_result(json_t *table, const char *label, const MeasureOrder *order, const SimResult *r,
                       const double error[], const double sd[])
{
    char note[NOTE_MAX] = "";
    json_t *row = json_put(figures_row(table), "=%s", label);
    put_objectives(row, order, measured(r).value, error, sd, "sd 1 um");
    json_put(row, "impacts=%ld", r->impacts);
    figures_put(row, "indentation", r->indentation_ratio, NAN, NAN);
    if (r->outcome != RUN_OK)
        snprintf(note, sizeof note, "%s", outcome_word((Outcome)r->outcome));
    else if (beyond_contact_law(r))
        snprintf(note, sizeof note, "deeper than %g of the contact's radius: beyond the contact law",
                 INDENTATION_RATIO_MAX);
    else if (r->bumper_bottoms_out)
        snprintf(note, sizeof note, "a bumper is compressed by %.3g of its thickness: it bottoms out",
                 r->bumper_strain);
    else if (foundation_lifts(r))
        uplift_words(r, note);
    else if (r->filtered_known && r->j3_filtered_g > r->j3_g)
        snprintf(note, sizeof note, "j3_filtered_g above j3_g: the filter overshoots (docs/theory.md)");
    if (note[0])
        json_put(row, " =%s", note);
    return row;
}

void figures_replicates(json_t *table, const MeasureOrder *order, const ReplicateSummary *r, const double error[])
{
    char label[96];
    const int by_replicates = r->n_replicates > 1 && isfinite(r->sd[order->of[0]]);
    const double *sd = by_replicates ? r->sd : r->n_records > 1 ? r->error : NULL;
    json_t *row = figures_row(table);
    if (r->n_failed)
        snprintf(label, sizeof label, "  %zu of its simulations failed: no mean", r->n_failed);
    else if (r->n_records > 1)
        snprintf(label, sizeof label, "  %s, %zu records x %zu", r->rule, r->n_records, r->n_replicates);
    else
        snprintf(label, sizeof label, "  %s of %zu", r->rule, r->n_replicates);
    if (sd && !r->n_failed)
        snprintf(label + strlen(label), sizeof label - strlen(label), by_replicates ? ", sd %s" : ", standard error",
                 r->spread);
    json_put(row, "=%s", label);
    if (r->n_failed)
        return;
    put_objectives(row, order, r->mean, error, sd, by_replicates ? "sd" : "se");
    figures_put(row, "impacts", r->mean[MEASURE_IMPACTS], NAN, by_replicates ? sd[MEASURE_IMPACTS] : NAN);
}

json_t *figures_design(json_t *table, const char *label, long id, const Schema *schema, const double natural[],
                       const double error[], const double sd[], const double extra[])
{
    json_t *row = json_put(figures_row(table), "=%s design=%p", label, id > 0 ? json_integer(id) : json_string("-"));
    for (size_t k = 0; k < schema->n_obj; k++)
        figures_put(row, schema_objective(schema, k)->name, natural[k], error ? error[k] : NAN, sd ? sd[k] : NAN);
    for (size_t k = 0; k < schema->n_limited; k++)
        figures_put(row, schema_extra(schema, schema->limited[k])->name, extra ? extra[schema->limited[k]] : NAN, NAN,
                    NAN);
    return row;
}

json_t *json_review(const FrontReview *r)
{
    json_t *smallest = json_array(), *largest = json_array(), *never = json_array();
    for (size_t j = 0; j < r->n_gaps; j++) {
        json_array_append_new(smallest, json_integer(r->at_smallest[j]));
        json_array_append_new(largest, json_integer(r->at_largest[j]));
    }
    for (size_t j = 0; j < r->n_floors; j++)
        if (r->closes[j] == 0 && r->has_stop[j])
            json_array_append_new(never, json_integer(j + 1));
    json_t *o =
        json_of("beyond_contact_law=%ld gaps_on_smallest=%p gaps_on_largest=%p", r->n_beyond, smallest, largest);
    if (r->n_simulated > 0)
        return json_put(o, "designs_simulated=%zu never_closing=%p", r->n_simulated, never);
    json_decref(never);
    return o;
}

/* Names of the objectives that are better (sign 1) or worse (-1) than the baseline's, by more than a thousandth and
 * what is not known of them; none of what the baseline does not have: a core, whose mass is then 0, or what would
 * dissipate a share. */
static void print_better(FILE *out, const char *verb, const Schema *schema, double sign, const double natural[],
                         const double error[], const Baseline *b)
{
    static const double SHARE = 1e-3;
    int n = 0;
    for (size_t k = 0; k < schema->n_obj; k++) {
        const Column *c = schema_objective(schema, k);
        const int id = schema->order.of[k];
        const double other = b->value[id];
        if ((other != 0 || (c->sense > 0 && id != MEASURE_MCORE)) &&
            sign * c->sense * (other - natural[k]) > fmax(SHARE * fabs(other), error[k]))
            fprintf(out, "%s%s", n++ ? ", " : verb, words_of_objective(schema, k).title);
    }
    if (n == 0)
        fprintf(out, "%snothing", verb);
}

void show_verdicts(FILE *out, const Run *run, size_t row, const Baseline baseline[N_SCENES])
{
    double error[OBJECTIVES_MAX];
    char words[CASE_TEXT_MAX], has[PROTECTION_MAX];
    Design design;
    const Schema *schema = &run->schema;
    const double *natural = run_f(run, row);
    run_likely(run, row, error);
    design_of(&schema->design, run_x(run, row), &design);
    for (int k = SCENE_IMPACT + 1; k < N_SCENES; k++) {
        fprintf(out, "against %s: with %s ", case_text(k, &baseline[k].device, words),
                design_protection(&schema->design, &design, has));
        print_better(out, "better in ", schema, 1, natural, error, &baseline[k]);
        print_better(out, "; worse in ", schema, -1, natural, error, &baseline[k]);
        fputc('\n', out);
    }
}

void show_expected_gain(double gain)
{
    if (isfinite(gain) && gain < hypervolume_error(0.5))
        puts("Doubling the simulations would raise the hypervolume by no more than its noise.");
    else if (isfinite(gain))
        printf("Doubling the simulations would raise the hypervolume by about %.2g (of the box about the front).\n",
               fmax(gain, 0.0));
}

/* ---- warnings ---------------------------------------------------------------------------------------------------- */

void warn_on_stderr(const char *key, const char *text, void *user)
{
    (void)user;
    fprintf(stderr, "warning: %s: %s\n", key, text);
}

typedef struct {
    const MotionOptions *motion;
    const char *source;
    size_t n; /* times that it is there */
    int is_told;
    WarnFn warn;
    void *user;
} Twice;

static Status count_same(const char *source, void *user, Err *err)
{
    Twice *t = user;
    (void)err;
    t->n += strcmp(source, t->source) == 0;
    return STATUS_OK;
}

static Status tell_twice(const char *source, void *user, Err *err)
{
    Twice *t = user;
    char text[OPTION_TEXT_MAX + 80];
    t->source = source;
    t->n = 0;
    TRY(t->is_told ? STATUS_OK : suite_of_study(t->motion, count_same, t, err));
    if (t->n < 2)
        return STATUS_OK;
    t->is_told = 1;
    snprintf(text, sizeof text, "%s is there twice (motion.record is one of them) and counts twice", source);
    t->warn("motion.records", text, t->user);
    return STATUS_OK;
}

/* Every record counts as often as it is listed. */
void warn_of_settings(const Settings *s, WarnFn warn, void *user)
{
    if (s->problem.kind == PROBLEM_TOWER)
        suite_of_study(&s->motion, tell_twice, &(Twice){.motion = &s->motion, .warn = warn, .user = user}, NULL);
}

void warn_of_designs(const Designs *d, const char *word, WarnFn warn, void *user)
{
    const DesignSpace *s = &d->space;
    char name[TABLE_NAME_MAX], text[900], line[16] = "";
    for (size_t i = 0; i < d->n; i++)
        for (int j = 0; j < s->n_gaps; j++) {
            const double gap = d->x[i * s->n_var + j];
            if (!(gap > GAP_MAX_M) || gap == DESIGN_OPEN_M)
                continue;
            if (d->line && !d->id)
                snprintf(line, sizeof line, ":%d", d->line[i]);
            design_variable_name(s, j, name);
            snprintf(text, sizeof text, "%.600s%s: %s is %g m and does not close; gaps are in metres", word, line, name,
                     gap);
            warn("--design", text, user);
            return;
        }
}
