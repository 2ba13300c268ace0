#include "cmd/show_model.h"

#include <errno.h>
#include <limits.h>
#include <string.h>

#include "base/text.h"

static const char *word(const json_t *o, const char *key)
{
    const char *text = json_string_value(json_object_get(o, key));
    return text ? text : "";
}

static double number(const json_t *o, const char *key)
{
    return json_number_value(json_object_get(o, key));
}

static long whole(const json_t *o, const char *key)
{
    return (long)json_integer_value(json_object_get(o, key));
}

/* A row for an effect: what it changes in the design where it changes most, and in which scene that is most of all. */
static void show_effect(FILE *out, const json_t *e, const json_t *settings)
{
    const char *value = word(settings, word(e, "setting"));
    const int is_set = strcmp(word(e, "is_set"), "yes") == 0, is_on = strcmp(value, word(e, "with")) == 0;
    fprintf(out, "  %-4s %-24s", is_set ? "set" : is_on ? "on" : "off", word(e, "without"));
    if (is_set)
        fprintf(out, "%39s", "");
    else
        fprintf(out, "%8.2g %8.2g %8.2g  %11s ", number(e, "j1_m_pct"), number(e, "drift_ratio_pct"),
                number(e, "j3_g_pct"), number(e, "in_tolerances") > 1 ? word(e, "most_in") : "");
    fprintf(out, "%s\n", value);
}

void show_model(FILE *out, const json_t *model)
{
    size_t i;
    json_t *e;
    fprintf(out, "model: %ld simulations of %ld designs under %ld record%s; %.2g times as fast as with all effects\n",
            whole(model, "simulations"), whole(model, "designs"), whole(model, "records"),
            whole(model, "records") == 1 ? "" : "s", number(model, "speed_factor"));
    fprintf(out, "  %-4s %-24s%8s %8s %8s  %11s %s\n", "", "without", "J1 %", "drift %", "J3 %", "matters in", "value");
    json_array_foreach(json_object_get(model, "effects"), i, e) show_effect(out, e, json_object_get(model, "settings"));
}

/* The designs that need more, by both models. */
static void show_needy(FILE *out, const json_t *designs)
{
    size_t i;
    json_t *d;
    fprintf(out, "  %-7s %-7s%10s %10s   %8s %8s   %8s %8s\n", "design", "record", "J1 [m]", "more", "drift", "more",
            "J3 [g]", "more");
    json_array_foreach(designs, i, d)
    {
        const json_t *set = json_object_get(d, "by_the_set"), *more = json_object_get(d, "with_more");
        if (json_is_false(json_object_get(d, "is_enough")))
            fprintf(out, "  %-7ld %-7ld%10.4g %10.4g   %8.4g %8.4g   %8.4g %8.4g\n", whole(d, "design"),
                    whole(d, "record"), number(set, "j1_m"), number(more, "j1_m"), number(set, "drift_ratio"),
                    number(more, "drift_ratio"), number(set, "j3_g"), number(more, "j3_g"));
    }
}

static void show_more(FILE *out, const json_t *confirmed, const char *folder)
{
    char text[4 * PATH_MAX + 3], setting[PATH_MAX];
    const char *key;
    json_t *value;
    fprintf(out,
            "model: some of the knee and the best of each objective, or their baselines, need more. Search again:\n"
            "  %s optimize %s --new",
            program_invocation_name, text_shell(folder, text));
    json_object_foreach(json_object_get(confirmed, "more"), key, value)
    {
        snprintf(setting, sizeof setting, "%s=%s", key, json_string_value(value));
        fprintf(out, " --set %s", text_shell(setting, text));
    }
    fputc('\n', out);
    show_needy(out, json_object_get(confirmed, "designs"));
}

void show_model_confirmed(FILE *out, const json_t *model, const char *folder)
{
    const json_t *confirmed = json_object_get(model, "confirmed"), *within = json_object_get(model, "tolerance");
    if (!confirmed)
        return;
    if (json_array_size(json_object_get(confirmed, "designs")) == 0)
        fputs("model: not confirmed, for with all effects the knee and the best of each objective fail\n", out);
    else if (json_object_size(json_object_get(confirmed, "more")) > 0)
        show_more(out, confirmed, folder);
    else
        fprintf(
            out,
            "model: enough for the knee and the best of each objective: with all effects J1, drift and J3 are within "
            "%.2g, %.2g, %.2g %%\n",
            number(within, "j1_m_pct"), number(within, "drift_ratio_pct"), number(within, "j3_g_pct"));
}
