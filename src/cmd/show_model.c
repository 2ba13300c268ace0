#include "cmd/show_model.h"

#include <errno.h>
#include <limits.h>
#include <string.h>

#include "base/text.h"

static double number(const json_t *o, const char *key)
{
    return json_number_value(json_object_get(o, key));
}

static long whole(const json_t *o, const char *key)
{
    return (long)json_integer_value(json_object_get(o, key));
}

void document_model(Document *d, const json_t *model)
{
    const json_t *settings = json_object_get(model, "settings");
    size_t i;
    json_t *e;
    document_say(d, "model: %ld simulations of %ld designs under %ld record%s; %.2g times as fast as with all effects",
                 whole(model, "simulations"), whole(model, "designs"), whole(model, "records"),
                 whole(model, "records") == 1 ? "" : "s", number(model, "speed_factor"));
    json_t *table = document_table(d);
    json_array_foreach(json_object_get(model, "effects"), i, e)
    {
        const char *value = json_text(settings, json_text(e, "setting"));
        const int is_set = strcmp(json_text(e, "is_set"), "yes") == 0, is_on = strcmp(json_text(e, "kept"), "yes") == 0;
        json_t *row = json_put(figures_row(table), "=%s", is_set ? "set" : is_on ? "on" : "off");
        json_put(row, " without=%s", json_text(e, "without"));
        figures_number(row, "J1 %", is_set ? NAN : number(e, "j1_m_pct"));
        figures_number(row, "drift %", is_set ? NAN : number(e, "drift_ratio_pct"));
        figures_number(row, "J3 %", is_set ? NAN : number(e, "j3_g_pct"));
        json_put(row, "matters in=%s", !is_set && number(e, "in_tolerances") > 1 ? json_text(e, "most_in") : "");
        json_put(row, " value=%s", value);
    }
}

void document_model_confirmed(Document *d, const json_t *model, const char *folder)
{
    const json_t *confirmed = json_object_get(model, "confirmed"), *within = json_object_get(model, "tolerance");
    json_t *more = json_object_get(confirmed, "more"), *designs = json_object_get(confirmed, "designs"), *value, *one;
    char text[4 * PATH_MAX + 3], *sets = NULL;
    const char *key;
    size_t length, i;
    if (!confirmed)
        return;
    if (json_array_size(designs) == 0) {
        document_say(d, "model: not confirmed: with all effects the simulations of the knee and the best designs fail");
        return;
    }
    if (json_object_size(more) == 0) {
        document_say(d,
                     "model: enough for the knee and the best of each objective: with all effects J1, drift and J3 are "
                     "within %.2g, %.2g, %.2g %%",
                     number(within, "j1_m_pct"), number(within, "drift_ratio_pct"), number(within, "j3_g_pct"));
        return;
    }

    /* What to search with, and the designs that need more, by both models. */
    FILE *f = text_open(&sets, &length);
    json_object_foreach(more, key, value)
    {
        if (f)
            text_set(f, "%s=%s", key, json_string_value(value));
    }
    if (f)
        text_close(f);
    document_say(d, "model: the knee, a best design or one of their baselines needs more effects. Search again:");
    document_say(d, "  %s optimize %s --new%s", program_invocation_name, text_shell(folder, text), sets);
    free(sets);
    json_t *table = document_table(d);
    json_array_foreach(designs, i, one)
    {
        const json_t *set = json_object_get(one, "by_the_set"), *with = json_object_get(one, "with_more");
        if (json_is_false(json_object_get(one, "is_enough")))
            json_put(
                figures_row(table),
                "design=%ld record=%ld j1_m=%g more_j1_m=%g drift_ratio=%g more_drift_ratio=%g j3_g=%g more_j3_g=%g",
                whole(one, "design"), whole(one, "record"), number(set, "j1_m"), number(with, "j1_m"),
                number(set, "drift_ratio"), number(with, "drift_ratio"), number(set, "j3_g"), number(with, "j3_g"));
    }
}
