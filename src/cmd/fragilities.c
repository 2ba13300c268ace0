#include "cmd/fragilities.h"

#include "base/figure.h"
#include "cmd/show.h"

static const double CONFIDENCE = 1.96; /* standard errors of a normal 95 % */
static const double YEARS = 50;
static const double CUT_OFF_NOTICEABLE = 0.01; /* of the probability where a hazard curve begins */
static const double OUTSIDE_NOTICEABLE = 0.05; /* share of an annual loss that lies outside of what was simulated */

/* ---- what is asked for ------------------------------------------------------------------------------------------- */

static Status take_hazard(Fragilities *f, const Table *t, const char *intensity, Err *err)
{
    const int column[2] = {table_column(t, intensity), table_column(t, "rate_per_year")};
    if (column[0] < 0 || column[1] < 0 || t->n_rows < 2)
        return bad_data(err, "%s: needs columns %s and rate_per_year with at least two rows", t->path, intensity);
    TRY_ROOM(f->hazard, 2 * t->n_rows, "points of a hazard curve", err);
    f->n_hazard = t->n_rows;
    for (size_t i = 0; i < t->n_rows; i++) {
        double *at = f->hazard + 2 * i;
        at[0] = t->values[i * t->n_cols + (size_t)column[0]];
        at[1] = t->values[i * t->n_cols + (size_t)column[1]];
        if (!(at[0] > (i ? at[-2] : 0) && at[1] > 0 && (i == 0 || at[1] < at[-1])))
            return bad_data(err, "%s:%d: intensities must rise, and their rates fall, all above 0", t->path,
                            t->line[i]);
    }
    return STATUS_OK;
}

/* path NULL: none. */
static Status read_hazard(Fragilities *f, const char *path, const char *intensity, Err *err)
{
    Table t = {0};
    Status status = path ? table_read(&t, path, TABLE_HEADED, err) : STATUS_OK;
    if (status == STATUS_OK && path)
        status = take_hazard(f, &t, intensity, err);
    table_free(&t);
    return status;
}

Status fragilities_read(Fragilities *f, const Schema *schema, const char *list, const char *hazard,
                        const char *intensity, Settings *s, Err *err)
{
    Err why = {0};
    char item[128], *out = s->search.limits;
    size_t used = 0, result;
    f->schema = schema;
    for (size_t i = 0; strcmp(list, "limits") != 0 && i < list_count(list); i++) {
        char *is = list_item(list, i, item, sizeof item) ? strchr(item, '=') : NULL;
        if (!is || is == item)
            return misused(err, "--fragility %.80s: is not a list of NAME=NUMBER, or `limits`", list);
        const char *relation = "="; /* "j3_g=5" becomes "j3_g<=5", what is better when it is more ">=" */
        *is = 0;
        if (is[-1] != '<' && is[-1] != '>') {
            TRY(schema_pick(schema, schema->n_obj + schema->n_extra, "--fragility", item, &result, err));
            relation = schema_objective(schema, result)->sense > 0 ? "<=" : ">=";
        }
        used +=
            (size_t)snprintf(out + used, OPTION_TEXT_MAX - used, "%s%s%s%s", used ? "," : "", item, relation, is + 1);
        if (used >= OPTION_TEXT_MAX)
            return misused(err, "--fragility: the list is too long");
    }
    for (size_t i = 0; i < list_count(s->search.limits); i++) { /* one by one: a measure may have several */
        Limits one;
        list_item(s->search.limits, i, item, sizeof item);
        if (limits_read(&one, schema, item, &why) != STATUS_OK)
            return misused(err, "--fragility: %s", why.text);
        if (one.n == 0 || f->limits.n == LIMITS_MAX)
            return misused(err, "--fragility %s: no limit, or more than %d", list, LIMITS_MAX);
        f->limits.limit[f->limits.n++] = one.limit[0];
    }
    for (size_t i = 0; i < f->limits.n; i++) {
        const int k = schema->order.of[f->limits.limit[i].result];
        if (k >= MEASURES_LISTED || k == MEASURE_ANNUAL_LOSS)
            return misused(err, "--fragility: neither a probability nor annual_loss is a limit of one simulation");
    }
    return read_hazard(f, hazard, intensity, err);
}

/* Each row an intensity; the column that is named otherwise is that. */
static Status counts_of_table(Fragilities *f, const Table *t, Err *err)
{
    const int exceeded = table_column(t, "exceeded"), of = table_column(t, "of"), at = 3 - exceeded - of;
    if (exceeded < 0 || of < 0 || t->n_cols != 3 || t->n_rows < 2 || t->n_rows > IDA_LEVELS_MAX)
        return bad_data(err,
                        "%s: wanted are three columns, an intensity (sa_g, say), exceeded and of, and 2 to %d rows",
                        t->path, IDA_LEVELS_MAX);
    TRY_ROOM(f->level, t->n_rows, "intensities", err);
    text_copy(f->intensity, t->names[at]);
    for (size_t i = 0; i < t->n_rows; i++) {
        const double *row = t->values + 3 * i, before = i > 0 ? f->level[i - 1] : 0;
        const double x = row[at], n = row[of], z = row[exceeded];
        if (!(x > before && n >= 1 && n <= 1e9 && z >= 0 && z <= n && n == floor(n) && z == floor(z)))
            return bad_data(err,
                            "%s:%d: intensities must rise above 0, `of` is a whole number, `exceeded` one up to it",
                            t->path, t->line[i]);
        f->level[i] = x;
        f->n_at[i] = (size_t)n;
        f->exceeded[i] = (size_t)z;
    }
    f->n_levels = t->n_rows;
    return STATUS_OK;
}

Status counts_read(Fragilities *f, const char *path, const char *hazard, Err *err)
{
    Table t;
    TRY(table_read(&t, path, TABLE_HEADED, err));
    Status status = counts_of_table(f, &t, err);
    table_free(&t);
    THEN(status, read_hazard(f, hazard, f->intensity, err));
    f->counted = path;
    return status;
}

void fragilities_free(Fragilities *f)
{
    free(f->hazard);
    free(f->level);
}

/* ---- curves ------------------------------------------------------------------------------------------------------ */

/* One limit under one case, or counts. */
typedef struct {
    const char *name, *relation; /* NULL: of counts, whose bound and scene are not known */
    double bound;
    const SceneCase *scene;
    size_t n_at[IDA_LEVELS_MAX], exceeded[IDA_LEVELS_MAX], n, hits;
    Fragility fit;
    double low, high; /* median, 95 % */
    double rate;      /* per year; NAN: not known */
} Curve;

/* limit NULL: of counts. */
static Curve curve_of(const Fragilities *f, const Evaluations *e, const Limit *limit, SceneKind which)
{
    Curve c = {.name = f->counted, .bound = NAN};
    if (limit) {
        c = (Curve){.name = schema_objective(f->schema, limit->result)->name,
                    .relation = limit->sign > 0 ? ">" : "<",
                    .bound = limit->bound,
                    .scene = &SCENES[which]};
        c.fit = ida_fragility(e, which, f->schema->order.of[limit->result], limit, c.n_at, c.exceeded);
    } else {
        memcpy(c.n_at, f->n_at, sizeof c.n_at);
        memcpy(c.exceeded, f->exceeded, sizeof c.exceeded);
        c.fit = fragility_fit(e->n_levels, e->level, c.n_at, c.exceeded);
    }
    for (size_t l = 0; l < e->n_levels; l++) {
        c.n += c.n_at[l];
        c.hits += c.exceeded[l];
    }
    const double range = exp(CONFIDENCE * c.fit.sd_ln_median);
    c.low = c.fit.median / range;
    c.high = c.fit.median * range;
    c.rate = f->hazard ? fragility_rate(&c.fit, f->n_hazard, f->hazard) : NAN;
    return c;
}

static json_t *counts(size_t n, const size_t of[])
{
    json_t *list = json_array();
    for (size_t i = 0; i < n; i++)
        json_array_append_new(list, json_integer((json_int_t)of[i]));
    return list;
}

/* Of one limit under one case; limit NULL: of counts. Where the median is not known it is said why, and what helps. */
static void add_curve(const Fragilities *f, const Evaluations *e, const Limit *limit, SceneKind which, json_t *table,
                      json_t *list)
{
    const Curve c = curve_of(f, e, limit, which);
    const Fragility *fit = &c.fit;
    const double from = fit->between[0], to = fit->between[1], range[] = {c.low, c.high};
    char text[4 * FIGURE_MAX], column[64];

    /* 1. For programs. */
    json_t *o = json_of("of=%s relation=%s bound=%g scene=%s median=%g median_95=%p beta=%g sd_ln_median=%g sd_beta=%g "
                        "median_between=%p simulations=%p exceeded=%p",
                        c.name, c.relation, c.bound, c.scene ? c.scene->key : NULL, fit->median, json_numbers(2, range),
                        fit->beta, fit->sd_ln_median, fit->sd_beta, json_numbers(2, fit->between),
                        counts(e->n_levels, c.n_at), counts(e->n_levels, c.exceeded));
    if (f->hazard)
        json_put(o, "rate_per_year=%g probability_50_years=%g probability_where_hazard_begins=%g", c.rate,
                 -expm1(-YEARS * c.rate), fragility_at(fit, f->hazard[0]));
    json_array_append_new(list, limit ? put_device(o, which, &e->run[0].device[which]) : o);

    /* 2. For people. */
    snprintf(text, sizeof text, c.scene ? "%s%s%g" : "%s", c.name, c.relation, c.bound);
    json_t *row = json_put(figures_row(table), "limit=%s scene=%s", text, c.scene ? c.scene->words : NULL);
    snprintf(column, sizeof column, "median %s (95 %%)", e->intensity);
    figures_put_as(row, column, fit->median, c.low, c.high, "(");
    if (c.n == 0 || c.hits == 0 || c.hits == c.n)
        text_copy(text, c.n == 0 ? "-" : c.hits == 0 ? "never" : "always");
    else if (isnan(from))
        snprintf(text, sizeof text, "not rising with intensity");
    else if (from > 0 && isfinite(to))
        snprintf(text, sizeof text, "between %g and %g: finer steps", from, to);
    else if (isfinite(to))
        snprintf(text, sizeof text, "below %g: begin lower", to);
    else
        snprintf(text, sizeof text, "above %g: end higher", from);
    if (isnan(fit->median))
        json_object_set_new(row, column, json_string(text));
    figures_put(row, "beta", fit->beta, NAN, fit->sd_beta);
    snprintf(text, sizeof text, "%zu of %zu", c.hits, c.n);
    json_put(row, "exceeded=%s", text);
    if (!f->hazard)
        return;
    figures_number(row, "per_year", c.rate);
    figures_number(row, "in_50_years_pct", -100 * expm1(-YEARS * c.rate));
    if (fragility_at(fit, f->hazard[0]) > CUT_OFF_NOTICEABLE)
        json_put(row, " =%s", "more often: the hazard curve begins too high");
}

void document_fragilities(Document *d, const Fragilities *f, const Evaluations *e)
{
    json_t *list = json_array(), *table = document_table(d), *losses = json_array();
    double own = NAN, alone = NAN;
    if (f->counted)
        add_curve(f, e, NULL, SCENE_IMPACT, table, list);
    for (size_t i = 0; i < f->limits.n; i++)
        for (SceneKind k = 0; k < N_SCENES; k++)
            if (evaluated_has(e, e->run, k))
                add_curve(f, e, &f->limits.limit[i], k, table, list);
    json_put(d->data, "fragility=%p", list);

    /* The annual loss of every scene: how much of it is not of the levels, and what helps. */
    for (SceneKind k = 0; k < N_SCENES && f->hazard && !f->counted; k++) {
        if (!evaluated_has(e, e->run, k))
            continue;
        const AnnualLoss y = ida_annual_loss(e, k, f->n_hazard, f->hazard);
        const double below = y.below / y.per_year, above = y.above / y.per_year;
        const int is_low = below > OUTSIDE_NOTICEABLE, is_high = above > OUTSIDE_NOTICEABLE;
        const int is_cut = f->hazard[0] >= e->level[0] && y.at_begin > OUTSIDE_NOTICEABLE * y.per_year;
        char note[NOTE_MAX];
        snprintf(note, sizeof note, "%s%s%s",
                 is_low   ? "begin lower"
                 : is_cut ? "more: the hazard curve begins too high"
                          : "",
                 (is_low || is_cut) && is_high ? ", " : "", is_high ? "end higher" : "");
        json_array_append_new(losses, json_of("scene=%s annual_loss=%g standard_error=%g share_below_first=%g "
                                              "share_above_last=%g failed=%zu note=%s",
                                              SCENES[k].key, y.per_year, y.error, below, above, y.n_failed, note));
        own = k == SCENE_IMPACT ? y.per_year : own;
        alone = k == SCENE_NO_CORE ? y.per_year : alone;
    }
    if (json_array_size(losses) > 0) {
        json_array_extend(document_table(d), losses);
        json_put(d->data, "annual_loss=%p", json_incref(losses));
        document_say(d, "A year costs %.3g of a new building, %.3g times as much as with no core.", own, own / alone);
    }
    json_decref(losses);
}
