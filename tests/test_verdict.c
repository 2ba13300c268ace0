/* The verdict on a design: the same words everywhere, and every number of it as independent simulations have it. */
#include "runs.h"

#include "evaluate/consequences.h"
#include "report/verdict.h"

#define N_RECORDS 2
static const char *const RECORDS[N_RECORDS] = {"builtin:kobe-like", "builtin:elcentro-like"};
static const char *const KEYS[] = {"j1_m", "drift_ratio", "j3_g"}, *const NAMES[] = {"J1 ", "drift ", "J3 "};

static char verdict[6000], sentence[5][1200]; /* as the program stored it, and its lines */

/* The design `word` (none: the building alone), under record r. */
static json_t *simulated(size_t r, const char *word, const char *more)
{
    return as_json("simulate @/run/settings.ini --record %s --set motion.records=none --json --design %s %s",
                   RECORDS[r], word, more);
}

static void make_run(void)
{
    free(output_of(
        "optimize configs/quick.ini " SIX_FLOORS "--out @/run --max-evals 10 --set search.initial=8 --set "
        "search.population=8 --set search.polish=0 --set sim.accuracy=coarse --record builtin:kobe-like --set "
        "motion.records=builtin:elcentro-like --set sim.duration_s=8 --set core.foundation=fixed"));
    FREED char *stored = read_in_place("run/verdicts.json");
    json_t *all = json_loads(stored, 0, NULL), *text = json_object_iter_value(json_object_iter(all));
    OWNED(run_free) Run run = run_in("run");
    const long id = run.table.row[run_knee(&run)].id;
    assert_true(text && atol(json_object_iter_key(json_object_iter(all))) == id);
    snprintf(verdict, sizeof verdict, "%s", json_string_value(text));
    char rest[800], *run_at = strstr(verdict, " RUN ");
    snprintf(rest, sizeof rest, "%s", run_at + 4);
    sprintf(run_at + 1, "%s/run%s", place.folder, rest);
    for (char *at = verdict, *end; (end = strchr(at, '\n')); at = end + 1) {
        static size_t n = 0;
        if (n < N_OF(sentence))
            snprintf(sentence[n++], sizeof *sentence, "%.*s", (int)(end - at), at);
    }
    json_decref(all);
    assert_true(sentence[4][0]);
}

/* The number behind a word of a text, behind `after`. */
static double number_behind(const char *text, const char *after, const char *word)
{
    const char *at = strstr(text, after);
    at = at ? strstr(at + strlen(after), word) : NULL;
    if (!at)
        fail_msg("%s: no '%s' behind '%s'", text, word, after);
    at += strlen(word);
    return atof(at + strcspn(at, "0123456789."));
}

TEST(the_verdict_is_the_same_at_the_end_of_every_command_in_the_report_and_in_the_dossier)
{
    FOR_EACH (const char *, command, "optimize @/run", "choose @/run", "evaluate @/run --design knee") {
        FREED char *said = output_of("%s", *command);
        for (size_t k = 0; k < N_OF(sentence); k++)
            assert_words(said, sentence[k]);
    }
    free(output_of("report @/run --out @/page.html"));
    FREED char *page = read_in_place("page.html");
    json_auto_t *run = json_loads(strchr(strstr(page, "id=\"run\">"), '>') + 1, JSON_DISABLE_EOF_CHECK, NULL);
    assert_string_equal(json_string_value(json_object_get(json_object_get(run, "detail"), "verdict")), verdict);
    free(output_of("report @/run --dossier @/d.html"));
    for (size_t k = 0; k < 4; k++) /* the fifth has signs that a page escapes */
        expect_file("d.html", brief("<p>%s</p>", sentence[k]));
}

/* As a command that says nothing but the design: without the file it is found anew, with the same words. */
TEST(a_verdict_that_is_not_stored_is_found_again_word_for_word)
{
    FREED char *said = output_of("evaluate @/run --design knee");
    assert_int_equal(unlink(there("run/verdicts.json")), 0);
    assert_text(output_of("evaluate @/run --design knee"), said);
}

TEST(factors_are_medians_over_the_records_of_simulations_one_by_one)
{
    static const char *const OTHERS[] = {"no core", "rigidly connected", "viscous links"};
#define BOTH "evaluate @/run --design knee --record builtin:kobe-like --record builtin:elcentro-like"
    json_auto_t *links = as_json(BOTH " --json");
    FREED char *said = output_of(BOTH); /* its links are those of each record, the stored verdict has one constant */
    for (size_t o = 0; o < N_OF(OTHERS); o++)
        for (size_t k = 0; k < N_OF(KEYS); k++) {
            double ratio[N_RECORDS];
            size_t better = 0;
            for (size_t r = 0; r < N_RECORDS; r++) {
                json_auto_t *own = simulated(r, "@/run:knee", ""), *other = NULL;
                if (o < 2)
                    other = o == 0 ? simulated(r, "none", "") : simulated(r, "@/run:knee", "--rigid");
                const json_t *record = json_array_get(json_object_get(links, "records"), r);
                const double its = number(o < 2 ? other : json_object_get(record, "links"), KEYS[k]);
                ratio[r] = number(own, KEYS[k]) / its;
                better += ratio[r] < 0.999;
            }
            const char *text = o < 2 ? sentence[0] : strstr(said, "Against no core");
            FREED char *head = formatted("gainst %s ", OTHERS[o]);
            assert_close(number_behind(text, head, NAMES[k]), 0.5 * (ratio[0] + ratio[1]), 5e-3);
            FREED char *wanted = formatted("(%s%zu of %d)", o + k ? "" : "better under ", better, N_RECORDS);
            const char *at = strstr(strstr(text, head), NAMES[k]);
            if (strncmp(strchr(at, '('), wanted, strlen(wanted)) != 0)
                fail_msg("%s: not '%s'", at, wanted);
        }
}

/* Of what the last sentence sets, the effects: without its remedies, and on a mat that weight alone holds down. */
TEST(the_model_is_that_of_the_settings_that_the_last_sentence_asks_for)
{
    char more[1200] = "", *anchors;
    json_auto_t *own = simulated(0, "@/run:knee", "");
    assert_close(number_behind(sentence[1], strstr(sentence[1], "instead of") ? "instead of" : "need:", "J1 "),
                 number(own, "j1_m"), 5e-3);
    if (!strstr(sentence[1], "instead of"))
        skip();
    for (const char *at = strstr(sentence[4], " --set "), *end; at; at = *end ? end : NULL) {
        const char *value = at + 7 + (at[7] == '\'');
        end = strstr(value, " --set ");
        end = end ? end : value + strlen(value);
        FOR_EACH (const char *, effect, "core.theory=", "core.foundation=", "core.wall=", "contact.", "building.")
            if (strncmp(value, *effect, strlen(*effect)) == 0)
                strncat(more, at, (size_t)(end - at));
    }
    if ((anchors = strstr(more, "anchors=")))
        memmove(anchors + 9, strchr(anchors, '\''), strlen(strchr(anchors, '\'')) + 1), anchors[8] = '1';
    json_auto_t *needed = simulated(0, "@/run:knee", more);
    for (size_t k = 0; k < N_OF(KEYS); k++)
        assert_close(number_behind(sentence[1], "it has", NAMES[k]), (k == 1 ? 100 : 1) * number(needed, KEYS[k]),
                     5e-3);
}

TEST(as_built_is_the_mean_and_deviation_of_its_structures)
{
    char *at;
    FREED char *more = formatted("--replicates %d --set sim.gap_tolerance_m=%g", VERDICT_REPLICATES, VERDICT_GAP_M);
    json_auto_t *o = simulated(0, "@/run:knee", more), *own = simulated(0, "@/run:knee", "");
    const json_t *all = json_object_get(o, "replicates");
    const double mean = number(json_object_get(all, "mean"), "j1_m"), sd = number(json_object_get(all, "sd"), "j1_m");
    at = strstr(sentence[2], "J1 ") + 3;
    assert_true(fabs(atof(at) - mean) <= sd); /* as many digits as the deviation leaves */
    assert_close(atof(strstr(brief("%.*s", (int)strcspn(at, "m"), at), "\u00b1") + 2), sd, 0.5);
    const double off = 100 * (mean / number(own, "j1_m") - 1); /* [%] */
    assert_true(fabs(atof(strstr(sentence[2], "on average ") + 11) - off) <= 0.5 + 1e-9);
}

TEST(demands_are_the_largest_of_all_records_over_their_limits_in_descending_order)
{
    double buckling = 0, drift = 0, stress = 0, moment = 0, mass = 0, before = INFINITY;
    for (size_t r = 0; r < N_RECORDS; r++) {
        json_auto_t *o = simulated(r, "@/run:knee", "");
        buckling = fmax(buckling, number(o, "core_buckling_ratio"));
        drift = fmax(drift, number(o, "drift_ratio"));
        stress = fmax(stress, number(o, "core_stress_pa"));
        moment = fmax(moment, number(o, "core_overturning_nm"));
        mass = number(o, "mcore_kg");
    }
    assert_close(number_behind(sentence[3], "", "bare wall "), buckling, 5e-3);
    assert_close(number_behind(sentence[3], "", "steel frame "), drift / DAMAGE_PARTS[PART_STRUCTURE].median[2], 5e-3);
    assert_close(number_behind(sentence[3], "", "(S235) "), stress / 235e6, 5e-3);
    assert_close(number_behind(sentence[3], "", "weight holds "), moment / (mass * 9.81 * 5 / 2), 5e-3);
    for (const char *at = strstr(sentence[3], "damage): "); at; at = strstr(at + 2, ", ")) {
        const char *end = strstr(at + 2, ", ");
        end = end ? end : sentence[3] + strlen(sentence[3]) - 1;
        while (end > at && end[-1] != ' ')
            end--;
        assert_true(atof(end) <= before);
        before = atof(end);
    }
}

TEST(better_is_by_more_than_a_thousandth_and_the_error)
{
    assert_int_equal(verdict_compare(1, 0.9, 0, 1), 1);
    assert_int_equal(verdict_compare(-1, 0.9, 0, 1), -1);
    assert_int_equal(verdict_compare(1, 0.9995, 0, 1), 0);
    assert_int_equal(verdict_compare(1, 1.2, 0.3, 1), 0);
    assert_int_equal(verdict_compare(1, 1.2, 0.1, 1), -1);
    assert_int_equal(verdict_compare(1, NAN, 0, 1), 0);
    assert_int_equal(verdict_compare(1, 1, NAN, 2), 1);
}

SUITE_FILLED(make_place, make_run, clear_place)
