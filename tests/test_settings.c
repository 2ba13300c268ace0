/* The settings table: defaults, ranges, files, messages. */
#include "bad_inputs.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "settings/settings.h"

enum { KEYS_MAX = 200 };

typedef struct {
    int n;
    char key[KEYS_MAX][64], value[KEYS_MAX][OPTION_TEXT_MAX];
} Pairs;

/* What settings_write says, line by line. The caller frees the text. */
static char *written(const Settings *s, int described)
{
    char *text = NULL;
    size_t length = 0;
    FILE *f = open_memstream(&text, &length);
    assert_non_null(f);
    settings_write(s, f, described);
    fclose(f);
    return text;
}

static void pairs_of(const Settings *s, Pairs *p)
{
    char section[48] = "", *text = written(s, 0), *rest = text;
    p->n = 0;
    for (char *line; (line = strsep(&rest, "\n"));) {
        char key[48];
        int at = 0;
        if (sscanf(line, "[%47[^]]]", section) == 1 || sscanf(line, "%47s = %n", key, &at) < 1 || at == 0)
            continue;
        snprintf(p->key[p->n], sizeof p->key[0], "%.31s.%.31s", section, key);
        snprintf(p->value[p->n++], sizeof p->value[0], "%s", line + at);
    }
    free(text);
}

static void write_text(const char *path, const char *text)
{
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    assert_true(fputs(text, f) >= 0);
    assert_int_equal(fclose(f), 0);
}

static Status read_text(Settings *s, const char *text, Err *err)
{
    char path[] = "/tmp/imtet-settings-XXXXXX";
    const int fd = mkstemp(path);
    assert_true(fd >= 0);
    close(fd);
    write_text(path, text);
    settings_defaults(s);
    const Status status = settings_read(s, path, NULL, NULL, err);
    remove(path);
    return status;
}

static void set(Settings *s, const char *key, const char *value)
{
    Err err = {0};
    char assignment[OPTION_TEXT_MAX + 80];
    snprintf(assignment, sizeof assignment, "%s=%s", key, value);
    CHECK_OK(settings_set(s, assignment, &err), &err);
}

static void test_every_default_is_in_its_range_and_the_rules_hold(void **state)
{
    (void)state;
    Err err = {0};
    Settings s, again;
    static Pairs p;
    settings_defaults(&s);
    settings_defaults(&again);
    CHECK_OK(settings_check(&s, &err), &err);
    pairs_of(&s, &p);
    assert_true(p.n > 40);
    for (int i = 0; i < p.n; i++)
        set(&again, p.key[i], p.value[i]);
    assert_memory_equal(&s, &again, sizeof s);
}

static void test_keys_are_unique(void **state)
{
    (void)state;
    Settings s;
    static Pairs p;
    settings_defaults(&s);
    pairs_of(&s, &p);
    for (int i = 0; i < p.n; i++)
        for (int j = 0; j < i; j++)
            assert_string_not_equal(p.key[i], p.key[j]);
}

static void change_everything(Settings *s)
{
    static const char *const VALUES[][2] = {
        {"building.model", "/somewhere/a tower"},
        {"building.damping", "0.30000000000000004"},
        {"core.section", "effective"},
        {"core.inertia_top_m4", "3.3333333333333335"},
        {"contact.law", "exact"},
        {"contact.v0_floor_m_s", "1.0000000000000002e-12"},
        {"motion.record", "/a/path/with = and # in it.csv"},
        {"motion.unit", "cm_s2"},
        {"sim.engine", "cvode"},
        {"sim.accuracy", "fine"},
        {"search.seed", "4294967295"},
        {"search.max_evals", "1000000"},
        {"run.out", "a/folder"},
    };
    settings_defaults(s);
    for (size_t i = 0; i < sizeof VALUES / sizeof VALUES[0]; i++)
        set(s, VALUES[i][0], VALUES[i][1]);
}

static void test_saved_settings_load_to_the_same_values(void **state)
{
    (void)state;
    Err err = {0};
    Settings s, back;
    change_everything(&s);
    for (int described = 0; described < 2; described++) {
        char *text = written(&s, described);
        CHECK_OK(read_text(&back, text, &err), &err);
        char *plain = written(&s, 0), *returned = written(&back, 0);
        assert_string_equal(plain, returned);
        assert_true(back.building.damping == s.building.damping && back.search.seed == 4294967295);
        free(text);
        free(plain);
        free(returned);
    }
}

/* A path may be longer than the lines that the INI library takes. */
static void test_a_long_path_survives_saving(void **state)
{
    (void)state;
    Err err = {0};
    Settings s, back;
    char path[OPTION_TEXT_MAX];
    memset(path, 'x', sizeof path);
    path[0] = '/';
    path[sizeof path - 1] = 0;
    settings_defaults(&s);
    set(&s, "motion.record", path);
    char *text = written(&s, 1);
    CHECK_OK(read_text(&back, text, &err), &err);
    assert_string_equal(back.motion.record, path);
    free(text);
}

static void test_what_is_not_written_keeps_its_default(void **state)
{
    (void)state;
    Err err = {0};
    Settings s, defaults;
    settings_defaults(&defaults);
    CHECK_OK(read_text(&s, "\xEF\xBB\xBF; a comment\r\n\r\n  [motion]\r\n\tpga_g = 0.25 ; of gravity\r\n", &err), &err);
    assert_true(s.motion.pga_g == 0.25);
    s.motion.pga_g = defaults.motion.pga_g;
    assert_memory_equal(&s, &defaults, sizeof s);
    CHECK_OK(read_text(&s, "", &err), &err);
    assert_memory_equal(&s, &defaults, sizeof s);
}

static void test_a_misspelt_key_is_answered_with_the_nearest(void **state)
{
    (void)state;
    static const char *const PAIRS[][2] = {{"motion.strech=2", "motion.stretch"},
                                           {"contact.restitutoin=0.5", "contact.restitution"},
                                           {"search.max_eval=10", "search.max_evals"},
                                           {"sim.duration=3", "sim.duration_s"}};
    Settings s;
    settings_defaults(&s);
    for (size_t i = 0; i < sizeof PAIRS / sizeof PAIRS[0]; i++) {
        Err err = {0};
        assert_int_equal(settings_set(&s, PAIRS[i][0], &err), STATUS_BAD_DATA);
        assert_non_null(strstr(err.text, "did you mean"));
        assert_non_null(strstr(err.text, PAIRS[i][1]));
    }
    Err err = {0};
    assert_int_equal(settings_set(&s, "nonsense", &err), STATUS_USAGE);
    assert_int_equal(settings_set(&s, "=3", &err), STATUS_USAGE);
    assert_int_equal(settings_set(&s, "qqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqq=3", &err), STATUS_BAD_DATA);
    assert_non_null(strstr(err.text, "imtet settings"));
}

/* Else the copy that is saved with a run would say something else than the run used. */
static void refused(const char *assignment, Status status, const char *says)
{
    Settings s;
    Err err = {0};
    settings_defaults(&s);
    assert_int_equal(settings_set(&s, assignment, &err), status);
    if (!strstr(err.text, says))
        fail_msg("%s: the message should contain '%s' and is '%s'", assignment, says, err.text);
}

static void test_a_misspelt_word_is_answered_with_the_nearest(void **state)
{
    (void)state;
    refused("sim.engine=cvod", STATUS_BAD_DATA, "did you mean cvode?");
    refused("contact.law=lankarani-nikravech", STATUS_BAD_DATA, "did you mean lankarani-nikravesh?");
    refused("motion.unit=m/s2", STATUS_BAD_DATA, "did you mean m_s2?");
    refused("core.section=xxxxxxxxxx", STATUS_BAD_DATA, "is not one of box|plate|effective");
}

static void test_a_number_that_is_none_is_refused_with_the_unit_that_is_wanted(void **state)
{
    (void)state;
    refused("core.side_m=wide", STATUS_BAD_DATA, "core.side_m: 'wide' is not a number [m]");
    refused("core.damping=much", STATUS_BAD_DATA, "core.damping: 'much' is not a number");
    refused("core.side_m=1000", STATUS_BAD_DATA, "core.side_m: 1000 is outside 0.1..200 m");
}

static void test_the_rules_between_settings_hold_without_a_file(void **state)
{
    (void)state;
    Settings s;
    Err err = {0};
    settings_defaults(&s);
    s.problem.kind = PROBLEM_EXTERNAL;
    s.design.gap_min_m = 1;
    assert_int_equal(settings_check(&s, &err), STATUS_BAD_DATA);
    assert_non_null(strstr(err.text, "design.gap_min_m: 1 must be below")); /* the first of two */
    s.design.gap_min_m = 0;
    assert_int_equal(settings_check(&s, &err), STATUS_BAD_DATA);
    assert_non_null(strstr(err.text, "problem.command: is none"));
    CHECK_OK(settings_set(&s, "problem.command=./worker", &err), &err);
    CHECK_OK(settings_check(&s, &err), &err);
}

static void test_a_building_that_is_built_in_is_a_name_and_no_path(void **state)
{
    (void)state;
    Settings s;
    Err err = {0};
    CHECK_OK(read_text(&s, "[building]\nmodel = appendix\n[motion]\nrecord = builtin:sylmar-like\n", &err), &err);
    assert_string_equal(s.building.model, "appendix");
    assert_string_equal(s.motion.record, "builtin:sylmar-like");
    assert_int_equal(read_text(&s, "[motion]\nrecord = \x01\n=1\n", &err), STATUS_BAD_DATA);
}

static void test_an_assignment_has_a_key_and_an_equals_sign(void **state)
{
    (void)state;
    char long_key[300];
    memset(long_key, 'k', sizeof long_key);
    strcpy(long_key + 200, "=1");
    refused("core.side_m", STATUS_USAGE, "write --set section.key=value");
    refused("=3", STATUS_USAGE, "write --set section.key=value");
    refused(long_key, STATUS_USAGE, "write --set section.key=value");
    refused("side=3", STATUS_BAD_DATA, "no such setting");
}

static void test_a_line_too_long_for_a_key_is_refused(void **state)
{
    (void)state;
    Settings s;
    Err err = {0};
    char text[1200] = "[core]\n";
    memset(text + 7, 'k', 900);
    strcpy(text + 907, " = 1\n");
    assert_int_equal(read_text(&s, text, &err), STATUS_BAD_DATA);
    assert_non_null(strstr(err.text, ":2: the line is too long"));
    memset(text + 7, 'k', 900);
    text[907] = 0;
    assert_int_equal(read_text(&s, text, &err), STATUS_BAD_DATA);
    assert_non_null(strstr(err.text, ":2: neither [section] nor key = value"));
}

static void test_a_path_that_becomes_too_long_beside_its_file_stays_what_it_is(void **state)
{
    (void)state;
    Settings s;
    Err err = {0};
    char text[600] = "[motion]\nrecord = ";
    memset(text + 18, 'r', 508);
    strcpy(text + 526, "\n[building]\nmodel = /no/such/folder\n");
    CHECK_OK(read_text(&s, text, &err), &err);
    assert_int_equal(strlen(s.motion.record), 508);
    assert_string_equal(s.building.model, "/no/such/folder");
}

static void test_a_text_that_a_file_would_change_is_refused(void **state)
{
    (void)state;
    static const char *const TEXTS[] = {"motion.record=a ;b.csv", "motion.record= a.csv", "motion.record=a.csv ",
                                        "motion.record=a\nb.csv"};
    Settings s;
    settings_defaults(&s);
    for (size_t i = 0; i < sizeof TEXTS / sizeof TEXTS[0]; i++) {
        Err err = {0};
        assert_int_equal(settings_set(&s, TEXTS[i], &err), STATUS_BAD_DATA);
        assert_non_null(strstr(err.text, "motion.record"));
    }
}

static void test_all_faults_of_a_file_are_listed_with_their_lines(void **state)
{
    (void)state;
    Err err = {0};
    Settings s;
    char path[] = "/tmp/imtet-settings-XXXXXX", *text = NULL;
    size_t length = 0;
    int n = 0;
    close(mkstemp(path));
    write_text(path, "[motion]\npga_g = -1\nstretc = 2\nwhat is this\n[design]\ngap_min_m = 0.6\n"
                     "thickness_max_m = 0.003\n[core]\nsection = tube\n");
    FILE *faults = open_memstream(&text, &length);
    settings_defaults(&s);
    assert_int_equal(settings_read(&s, path, faults, &n, &err), STATUS_BAD_DATA);
    fclose(faults);
    assert_int_equal(n, 6);
    static const char *const WANTED[] = {":2: motion.pga_g",     ":3: motion.stretc",          ":4: neither",
                                         ":6: design.gap_min_m", ":7: design.thickness_min_m", ":9: core.section"};
    for (size_t i = 0; i < sizeof WANTED / sizeof WANTED[0]; i++)
        assert_non_null(strstr(text, WANTED[i]));
    assert_non_null(strstr(err.text, ":2: motion.pga_g"));
    free(text);
    remove(path);
}

static void test_a_path_in_a_file_is_meant_from_its_folder(void **state)
{
    (void)state;
    Err err = {0};
    Settings s;
    char folder[] = "/tmp/imtet-folder-XXXXXX", ini[64], record[64], wanted[128];
    assert_non_null(mkdtemp(folder));
    snprintf(ini, sizeof ini, "%s/a.ini", folder);
    snprintf(record, sizeof record, "%s/quake.csv", folder);
    write_text(ini, "[motion]\nrecord = quake.csv\n");
    settings_defaults(&s);
    CHECK_OK(settings_read(&s, ini, NULL, NULL, &err), &err);
    assert_string_equal(s.motion.record, "quake.csv"); /* not there: left for the working directory */
    write_text(record, "");
    CHECK_OK(settings_read(&s, ini, NULL, NULL, &err), &err);
    assert_string_equal(s.motion.record, record);
    write_text(ini, "[motion]\nrecords = quake.csv, builtin:sylmar-like ,not-there.csv\n[search]\nstart = quake.csv\n");
    CHECK_OK(settings_read(&s, ini, NULL, NULL, &err), &err);
    snprintf(wanted, sizeof wanted, "%s,builtin:sylmar-like,not-there.csv", record);
    assert_string_equal(s.motion.records, wanted);
    assert_string_equal(s.search.start, record);
    remove(ini);
    remove(record);
    rmdir(folder);
}

static Status read_file(const char *path, Err *err)
{
    Settings s;
    settings_defaults(&s);
    return settings_read(&s, path, NULL, NULL, err);
}

static void test_every_bad_file_is_refused_with_file_line_and_key(void **state)
{
    (void)state;
    assert_true(all_refused("tests/bad/config", read_file) >= 20);
}

static void test_a_missing_file_is_told_from_a_bad_one(void **state)
{
    (void)state;
    Err err = {0};
    assert_int_equal(read_file("tests/bad/config/not_there.ini", &err), STATUS_MISSING);
    assert_non_null(strstr(err.text, "not_there.ini"));
    assert_int_equal(read_file("tests", &err), STATUS_MISSING);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_default_is_in_its_range_and_the_rules_hold),
        cmocka_unit_test(test_keys_are_unique),
        cmocka_unit_test(test_saved_settings_load_to_the_same_values),
        cmocka_unit_test(test_a_long_path_survives_saving),
        cmocka_unit_test(test_what_is_not_written_keeps_its_default),
        cmocka_unit_test(test_a_misspelt_key_is_answered_with_the_nearest),
        cmocka_unit_test(test_a_misspelt_word_is_answered_with_the_nearest),
        cmocka_unit_test(test_a_number_that_is_none_is_refused_with_the_unit_that_is_wanted),
        cmocka_unit_test(test_the_rules_between_settings_hold_without_a_file),
        cmocka_unit_test(test_a_building_that_is_built_in_is_a_name_and_no_path),
        cmocka_unit_test(test_an_assignment_has_a_key_and_an_equals_sign),
        cmocka_unit_test(test_a_line_too_long_for_a_key_is_refused),
        cmocka_unit_test(test_a_path_that_becomes_too_long_beside_its_file_stays_what_it_is),
        cmocka_unit_test(test_a_text_that_a_file_would_change_is_refused),
        cmocka_unit_test(test_all_faults_of_a_file_are_listed_with_their_lines),
        cmocka_unit_test(test_a_path_in_a_file_is_meant_from_its_folder),
        cmocka_unit_test(test_every_bad_file_is_refused_with_file_line_and_key),
        cmocka_unit_test(test_a_missing_file_is_told_from_a_bad_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
