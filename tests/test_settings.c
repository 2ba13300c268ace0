/* The settings table: defaults, ranges, files, messages. */
#include "bad_inputs.h"
#include "program.h"

#include <limits.h>

enum { KEYS_MAX = 200 };

typedef struct {
    int n;
    char key[KEYS_MAX][64], value[KEYS_MAX][OPTION_TEXT_MAX];
} Pairs;

/* What settings_write says, line by line. The caller frees the text. */
static char *written(const Settings *s, int described, const char *word)
{
    char *text = NULL;
    size_t length = 0;
    FILE *f = open_memstream(&text, &length);
    settings_write(s, f, (SettingsForm)described, word);
    fclose(f);
    return text;
}

static void take_pair(const char *key, const char *value, void *user)
{
    Pairs *p = user;
    snprintf(p->key[p->n], sizeof *p->key, "%s", key);
    snprintf(p->value[p->n++], sizeof *p->value, "%s", value);
}

static Status read_text(Settings *s, const char *text, Err *why)
{
    write_in_place("settings.ini", text);
    settings_defaults(s);
    return settings_read(s, there("settings.ini"), NULL, NULL, why);
}

static void set(Settings *s, const char *key, const char *value)
{
    CHECK_OK(settings_set(s, brief("%s=%s", key, value), &err), &err);
}

TEST(every_key_is_there_once_its_default_is_in_its_range_and_the_rules_hold)
{
    Settings s = default_settings(), again = s;
    Pairs p = {0};
    CHECK_OK(settings_check(&s, &err), &err);
    settings_each(&s, NULL, take_pair, &p);
    assert_less(40, p.n);
    for (int i = 0; i < p.n; i++) {
        set(&again, p.key[i], p.value[i]);
        for (int j = 0; j < i; j++)
            assert_string_not_equal(p.key[i], p.key[j]);
    }
    assert_memory_equal(&s, &again, offsetof(Settings, given));
}

typedef struct {
    const char *key; /* that was changed */
    int n_found;
} Changed;

static void is_the_changed_one(const char *key, unsigned flags, const char *was, const char *is, void *user)
{
    Changed *c = user;
    unsigned wanted = 0;
    FOR_EACH (const char *, limit, "search.max_evals", "search.max_hours", "search.stop_after", "problem.timeout_s")
        wanted |= strcmp(key, *limit) == 0 ? SETTING_LIMIT : 0u;
    FOR_EACH (const char *, free, "search.threads", "search.failures_max", "run.out", "run.isolate", "search.start",
              "motion.record", "motion.records", "motion.forces", "building.model")
        wanted |= strcmp(key, *free) == 0 ? SETTING_FREE : 0u;
    wanted |= strcmp(key, "run.out") == 0 ? SETTING_OUTPUT : 0u;
    assert_string_equal(key, c->key);
    assert_int_equal(flags & ~(unsigned)SETTING_BASIC, wanted);
    assert_string_not_equal(was, is);
    c->n_found++;
}

/* Another value: the next word, a text or a number in range. */
static void change_one(Settings *s, int i, const char *was)
{
    static const char *const VALUES[] = {"0.0123", "0.31",          "2",           "7",   "90",
                                         "1000",   "damping=0.3",   "0.31,0.32",   "2,3", "2e3,3e3",
                                         "link=2", "structure=0.3", "strength=0.3"};
    const char *words = settings_words(i), *bar = words ? strchr(words, '|') : NULL;
    char assignment[2 * OPTION_TEXT_MAX];
    err = (Err){0};
    if (bar)
        snprintf(assignment, sizeof assignment, "%s=%.*s", settings_key(i),
                 strncmp(was, words, strlen(was)) == 0 ? (int)strcspn(bar + 1, "|") : (int)(bar - words),
                 strncmp(was, words, strlen(was)) == 0 ? bar + 1 : words);
    for (size_t k = 0; k < sizeof VALUES / sizeof *VALUES; k++) {
        if (!bar || k > 0)
            snprintf(assignment, sizeof assignment, "%s=%s", settings_key(i), VALUES[k]);
        if (settings_set(s, assignment, &err) == STATUS_OK)
            return;
    }
    fail_msg("%s: %s", settings_key(i), err.text);
}

TEST(a_change_is_reported_for_its_key_with_the_flags_of_the_table)
{
    Pairs p = {0};
    Settings s = default_settings();
    settings_each(&s, NULL, take_pair, &p);
    for (int i = 0; settings_key(i); i++) {
        Settings changed = s;
        Changed c = {settings_key(i), 0};
        change_one(&changed, i, p.value[i]);
        settings_compare(&s, &changed, is_the_changed_one, &c);
        assert_int_equal(c.n_found, 1);
    }
}

static void change_everything(Settings *s)
{
    static const char *const VALUES[][2] = {{"building.model", "/somewhere/a tower"},
                                            {"building.damping", "0.30000000000000004"},
                                            {"core.section", "effective"},
                                            {"core.inertias_m4", "1.1, 3.3333333333333335"},
                                            {"contact.law", "exact"},
                                            {"contact.radius_m", "1.0000000000000002e-6"},
                                            {"motion.record", "/a/path/with = and # in it.csv"},
                                            {"motion.unit", "cm_s2"},
                                            {"sim.engine", "cvode"},
                                            {"sim.accuracy", "fine"},
                                            {"search.seed", "4294967295"},
                                            {"search.max_evals", "1000000"},
                                            {"run.out", "a/folder"}};
    settings_defaults(s);
    for (size_t i = 0; i < sizeof VALUES / sizeof VALUES[0]; i++)
        set(s, VALUES[i][0], VALUES[i][1]);
}

TEST(saved_settings_load_to_the_same_values)
{
    Settings s, back;
    change_everything(&s);
    for (int described = 0; described < 2; described++) {
        FREED char *text = written(&s, described, NULL);
        CHECK_OK(read_text(&back, text, &err), &err);
        FREED char *plain = written(&s, 0, NULL), *returned = written(&back, 0, NULL);
        assert_string_equal(plain, returned);
        assert_memory_equal(&s, &back, offsetof(Settings, given));
        assert_true(back.building.damping.at[0] == s.building.damping.at[0] && back.search.seed == 4294967295);
    }
}

TEST(what_is_not_written_keeps_its_default)
{
    const Settings defaults = default_settings();
    Settings s;
    CHECK_OK(read_text(&s, "\xEF\xBB\xBF; a comment\r\n\r\n  [motion]\r\n\tpga_g = 0.25 ; of gravity\r\n", &err), &err);
    assert_same_number(s.motion.pga_g, 0.25);
    assert_true(settings_gives(&s, "motion.pga_g") && !settings_gives(&s, "motion.factor"));
    s.motion.pga_g = defaults.motion.pga_g;
    assert_memory_equal(&s, &defaults, offsetof(Settings, given));
    CHECK_OK(read_text(&s, "", &err), &err);
    assert_memory_equal(&s, &defaults, sizeof s);
}

TEST(a_misspelt_key_is_answered_with_the_nearest)
{
    static const char *const PAIRS[][2] = {
        {"motion.strech=2", "motion.stretch"},           {"contact.restitutoin=0.5", "contact.restitution"},
        {"search.max_eval=10", "search.max_evals"},      {"sim.duration=3", "sim.duration_s"},
        {"pga_g=0.3", "did you mean motion.pga_g?"},     {"damping=0.02", "did you mean building.damping?"},
        {"recrds=a.csv", "did you mean motion.records?"}};
    Settings s = default_settings();
    for (size_t i = 0; i < sizeof PAIRS / sizeof PAIRS[0]; i++) {
        assert_refused(settings_set(&s, PAIRS[i][0], &err), STATUS_BAD_DATA, "did you mean");
        assert_non_null(strstr(err.text, PAIRS[i][1]));
    }
    err = (Err){0};
    assert_int_equal(settings_set(&s, "nonsense", &err), STATUS_USAGE);
    assert_int_equal(settings_set(&s, "=3", &err), STATUS_USAGE);
    assert_refused(settings_set(&s, "qqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqq=3", &err), STATUS_BAD_DATA,
                   "imtet settings");
}

/* Else the copy that is saved with a run would say something else than the run used. */
static void refused(const char *assignment, Status status, const char *says)
{
    Settings s = default_settings();
    assert_refused(settings_set(&s, assignment, &err), status, says);
}

TEST(a_misspelt_word_is_answered_with_the_nearest)
{
    refused("sim.engine=cvod", STATUS_BAD_DATA, "did you mean cvode?");
    refused("contact.law=lankarani-nikravech", STATUS_BAD_DATA, "did you mean lankarani-nikravesh?");
    refused("motion.baseline=meen", STATUS_BAD_DATA, "did you mean mean?");
    refused("core.section=xxxxxxxxxx", STATUS_BAD_DATA, "is not one of box|plate|effective");
}

TEST(a_number_that_is_none_is_refused_with_the_unit_that_is_wanted)
{
    refused("core.width_m=wide", STATUS_BAD_DATA, "core.width_m: 'wide' is not a number [m]");
    refused("core.damping=much", STATUS_BAD_DATA, "core.damping: 'much' is not a number");
    refused("core.width_m=1000", STATUS_BAD_DATA, "core.width_m: 1000 is outside 0.1..200 m");
}

TEST(a_price_is_a_number_that_is_given_once)
{
    refused("design.prices=gap=0, gap=4", STATUS_BAD_DATA, "design.prices: gap stands twice; the second is 'gap=4'");
    refused("design.prices=", STATUS_BAD_DATA, "design.prices: is empty");
}

TEST(the_rules_between_settings_hold_without_a_file)
{
    Settings s = default_settings();
    s.problem.kind = PROBLEM_EXTERNAL;
    s.motion.highpass_hz = 2;
    s.motion.lowpass_hz = 1;
    assert_refused(settings_check(&s, &err), STATUS_BAD_DATA, "motion.highpass_hz: 2 must be below"); /* of two */
    s.motion.lowpass_hz = 0;
    assert_refused(settings_check(&s, &err), STATUS_BAD_DATA, "problem.command: is none");
    CHECK_OK(settings_set(&s, "problem.command=./worker", &err), &err);
    CHECK_OK(settings_check(&s, &err), &err);
}

TEST(a_building_that_is_built_in_is_a_name_and_no_path)
{
    Settings s;
    CHECK_OK(read_text(&s, "[building]\nmodel = appendix\n[motion]\nrecord = builtin:sylmar-like\n", &err), &err);
    assert_string_equal(s.building.model, "appendix");
    assert_string_equal(s.motion.record, "builtin:sylmar-like");
    assert_int_equal(read_text(&s, "[motion]\nrecord = \x01\n=1\n", &err), STATUS_BAD_DATA);
}

TEST(an_assignment_has_a_key_and_an_equals_sign)
{
    char long_key[300];
    memset(long_key, 'k', sizeof long_key);
    strcpy(long_key + 200, "=1");
    refused("core.width_m", STATUS_USAGE, "write --set section.key=value");
    refused("=3", STATUS_USAGE, "write --set section.key=value");
    refused(long_key, STATUS_USAGE, "write --set section.key=value");
    refused("side=3", STATUS_BAD_DATA, "no such setting");
}

TEST(a_path_that_becomes_too_long_beside_its_file_stays_what_it_is)
{
    Settings s;
    char text[600] = "[motion]\nrecord = ";
    memset(text + 18, 'r', 508);
    strcpy(text + 526, "\n[building]\nmodel = /no/such/folder\n");
    CHECK_OK(read_text(&s, text, &err), &err);
    assert_int_equal(strlen(s.motion.record), 508);
    assert_string_equal(s.building.model, "/no/such/folder");
}

static int comes_back(const char *text)
{
    static Settings s, back;
    if (settings_put(&s, "motion.record", text, &err) != STATUS_OK)
        return 0;
    FREED char *file = written(&s, 0, "motion.record");
    settings_defaults(&back);
    CHECK_OK(settings_parse(&back, "settings.ini", file, &err), &err);
    assert_string_equal(back.motion.record, text);
    return 1;
}

/* All texts of up to four letters, and one as long as can be. */
TEST(a_text_comes_back_from_a_file_as_it_was_or_is_refused)
{
    static const char LETTERS[] = "a \t;#\"'[]\\"; /* its zero ends a shorter one */
    char path[OPTION_TEXT_MAX] = "";
    int n_kept = 0;
    for (int k = 0, n = sizeof LETTERS; k < n * n * n * n; k++) {
        const char text[] = {LETTERS[k % n], LETTERS[k / n % n], LETTERS[k / n / n % n], LETTERS[k / n / n / n], 0};
        const int is_kept = comes_back(text);
        assert_true(is_kept || !*text || strchr(" \t", *text) || strchr(" \t", text[strlen(text) - 1]) ||
                    strchr(text, '\\') || (strchr(text, '"') && strchr(text, '\'')));
        n_kept += is_kept;
    }
    assert_less(7000, n_kept);
    assert_true(comes_back(memset(path, 'x', sizeof path - 1)));
    FOR_EACH (const char *, refusal, " a.csv", "a.csv ", "a\nb.csv", "'a' \"b\" #1")
        refused(brief("motion.record=%s", *refusal), STATUS_BAD_DATA, "motion.record");
}

TEST(all_faults_of_a_file_are_listed_with_their_lines)
{
    Settings s = default_settings();
    char *text = NULL;
    size_t length = 0;
    int n = 0;
    write_in_place("faults.ini", "[motion]\npga_g = -1\nstretc = 2\nwhat is this\n[design]\ngap_m = 0.6, 0.5\n"
                                 "thickness_m = 0.003\n[core]\nsection = tube\n");
    FILE *faults = open_memstream(&text, &length);
    assert_int_equal(settings_read(&s, there("faults.ini"), faults, &n, &err), STATUS_BAD_DATA);
    fclose(faults);
    assert_int_equal(n, 6);
    assert_words(text, ":2:9: motion.pga_g", ":3:1: motion.stretc", ":4:1: neither", ":6:9: design.gap_m",
                 ":7:15: design.thickness", ":9:11: core.section");
    assert_words(err.text, ":2:9: motion.pga_g");
    free(text);
}

TEST(a_path_in_a_file_is_meant_from_its_folder)
{
    Settings s = default_settings();
    const char *ini = there("a.ini"), *record = there("quake.csv");
    write_to(ini, "[motion]\nrecord = quake.csv\n");
    CHECK_OK(settings_read(&s, ini, NULL, NULL, &err), &err);
    assert_string_equal(s.motion.record, "quake.csv"); /* not there: left for the working directory */
    write_to(record, "");
    CHECK_OK(settings_read(&s, ini, NULL, NULL, &err), &err);
    assert_string_equal(s.motion.record, record);
    write_to(ini, "[motion]\nrecords = quake.csv, builtin:sylmar-like ,not-there.csv\n[search]\nstart = quake.csv\n");
    CHECK_OK(settings_read(&s, ini, NULL, NULL, &err), &err);
    assert_string_equal(s.motion.records, brief("%s,builtin:sylmar-like,not-there.csv", record));
    assert_string_equal(s.search.start, record);
}

TEST(paths_become_absolute_where_they_lead_somewhere)
{
    Settings s = default_settings();
    char wanted[PATH_MAX];
    set(&s, "building.model", "tests");
    set(&s, "motion.records", "configs/quick.ini,builtin:sylmar-like,not-there.csv");
    set(&s, "search.start", "none");
    settings_make_absolute(&s);
    assert_string_equal(s.building.model, realpath("tests", wanted));
    assert_non_null(realpath("configs/quick.ini", wanted));
    assert_string_equal(s.motion.records, brief("%s,builtin:sylmar-like,not-there.csv", wanted));
    assert_string_equal(s.motion.record, "builtin:kobe-like");
    assert_string_equal(s.search.start, "none");
    set(&s, "building.model", "guyan");
    settings_make_absolute(&s);
    assert_string_equal(s.building.model, "guyan");
}

TEST(paths_from_a_folder_lead_to_the_same_files)
{
    static const struct {
        const char *path, *folder, *wanted;
    } CASES[] = {{"tests/bad", "tests", "./bad"},
                 {"tests", "tests", "."},
                 {"configs/quick.ini", "tests/bad", "../../configs/quick.ini"},
                 {"tests/bad", "tests/bad/config", ".."},
                 {"/proc/self/cwd/tests", "tests", "/proc/self/cwd/tests"},
                 {"not-there", "tests", "not-there"},
                 {"guyan", "tests", "guyan"}};
    char folder[PATH_MAX];
    for (size_t i = 0; i < N_OF(CASES); i++) {
        Settings s = default_settings();
        FREED char *list = formatted("%s factor=2,builtin:sylmar-like", CASES[i].wanted);
        set(&s, "building.model", CASES[i].path);
        set(&s, "motion.records", brief("%s factor=2,builtin:sylmar-like", CASES[i].path));
        assert_non_null(realpath(CASES[i].folder, folder));
        settings_make_relative(&s, folder);
        assert_string_equal(s.building.model, CASES[i].wanted);
        assert_string_equal(s.motion.records, list);
    }
}

/* As in an editor. */
TEST(columns_count_characters_and_not_the_mark_of_utf_8)
{
    Settings s;
    assert_refused(read_text(&s, "\xEF\xBB\xBF[\n[core]\n  width_m =\twide\n", &err), STATUS_BAD_DATA, ":1:1: neither");
    assert_refused(read_text(&s, "[core]\n  width_m =\twide\n", &err), STATUS_BAD_DATA, ":2:13: core.width_m");
    assert_refused(read_text(&s, "[core]\ns\u00efde_m = 3\n", &err), STATUS_BAD_DATA, ":2:1: core.");
}

static Status read_file(const char *path, Err *why)
{
    Settings s = default_settings();
    return settings_read(&s, path, NULL, NULL, why);
}

TEST(every_bad_file_is_refused_with_file_line_and_key)
{
    assert_at_most(20, all_refused("tests/bad/config", read_file));
}

TEST(a_missing_file_is_told_from_a_bad_one)
{
    assert_refused(read_file("tests/bad/config/not_there.ini", &err), STATUS_MISSING, "not_there.ini");
    assert_int_equal(read_file("tests", &err), STATUS_MISSING);
    assert_string_equal(err.text, "tests: is a folder without a run (run.sqlite) or a settings file (*.ini)");
    assert_refused(read_file("tests/bad/config", &err), STATUS_MISSING, "is a folder; did you mean tests/bad/config/");
}

/* Whatever has no end is given up after 1 MiB. */
TEST(what_is_too_large_or_a_device_or_a_left_pipe_is_no_settings_file)
{
    assert_refused(read_file("/dev/zero", &err), STATUS_BAD_DATA, "/dev/zero: larger than 1 MiB");
    FILE *f = opened(there("large.ini"), "w");
    for (int i = 0; i < 1 << 17; i++)
        fputs("; filler\n", f);
    fclose(f);
    assert_refused(read_file(there("large.ini"), &err), STATUS_BAD_DATA, "larger than 1 MiB");
    assert_int_equal(mkfifo(there("pipe"), 0600), 0);
    assert_refused(read_file(there("pipe"), &err), STATUS_MISSING, "named pipe");
}

TEST(a_first_study_touches_sixteen_settings)
{
    Settings s = default_settings(), again;
    int n = 0;
    FREED char *text = written(&s, SETTINGS_BASIC, NULL);
    for (const char *line = text; line; line = strchr(line + 1, '\n'))
        n += strstr(line, " = ") && strcspn(line + 1, ";[\n") > strcspn(line + 1, "=");
    assert_int_equal(n, 16);
    s.design.gap_m.at[1] = 0.2;
    s.core.poisson = 0.2; /* none of the sixteen, but no default */
    FREED char *more = written(&s, SETTINGS_BASIC, NULL);
    CHECK_OK(read_text(&again, more, &err), &err);
    assert_memory_equal(&s, &again, offsetof(Settings, given));
}

/* Quoted texts and arrays; a number and a section are the same in both. */
TEST(a_file_that_is_toml_as_well_is_read)
{
    Settings toml, ini;
    CHECK_OK(read_text(&toml,
                       "# a study\n[building]\nrayleigh_modes = [1, 3]\np_delta = \"on\"\n[motion]\npga_g = 0.3\n"
                       "records = [\"builtin:sylmar-like\", 'builtin:elcentro-like']\n[problem]\n"
                       "command = \"python3 a.py 'b c'\"\n",
                       &err),
             &err);
    CHECK_OK(read_text(&ini,
                       "[building]\nrayleigh_modes = 1, 3\np_delta = on\n[motion]\npga_g = 0.3\n"
                       "records = builtin:sylmar-like, builtin:elcentro-like\n[problem]\n"
                       "command = python3 a.py 'b c'\n",
                       &err),
             &err);
    assert_memory_equal(&toml, &ini, sizeof toml);
    CHECK_OK(read_text(&ini, "[problem]\ncommand = \"a b\" \"c\"\n", &err), &err); /* no text of TOML: as it is */
    assert_string_equal(ini.problem.command, "\"a b\" \"c\"");
}

TEST(notes_switches_and_arrays_over_several_lines_are_read_as_in_toml)
{
    Settings toml, ini;
    CHECK_OK(
        read_text(&toml,
                  "[building] # the frame\nheights_m = [ # from the bottom: ], \"\n  5.5,\n  4.0, # all others\n]\n"
                  "p_delta = true # on\n[motion]\npga_g = 0.3 # of gravity\nrecords = [\n'builtin:sylmar-like'\n]\n"
                  "record = \"run#1;a.csv\"# as it was delivered\n",
                  &err),
        &err);
    CHECK_OK(read_text(&ini,
                       "[building]\nheights_m = 5.5, 4.0\np_delta = on\n[motion]\npga_g = 0.3\n"
                       "records = builtin:sylmar-like\nrecord = run#1;a.csv\n",
                       &err),
             &err);
    assert_memory_equal(&toml, &ini, sizeof toml);
    assert_refused(read_text(&ini, "[building]\nheights_m = [\n3,\n,4]\nnone_such = 1\n", &err), STATUS_BAD_DATA,
                   ":2:13: building.heights_m");
    assert_refused(read_text(&ini, "[building]\nheights_m = [\n3]\nnone_such = 1\n", &err), STATUS_BAD_DATA,
                   ":4:1: building.none_such");
    assert_int_equal(read_text(&ini, "[building]\nheights_m = [3,\n4\np_delta = on\n", &err), STATUS_BAD_DATA);
}

TEST(fidelity_needs_replicates_that_average_no_noise)
{
    Settings s = default_settings();
    s.search.fidelity = FIDELITY_REPLICATES;
    assert_false(settings_screens(&s));
    s.sim.replicates = 4;
    assert_true(settings_screens(&s));
    s.problem.noisy = NOISY_YES;
    assert_false(settings_screens(&s));
    s.search.replicate_share = 0;
    assert_true(settings_screens(&s));
    s.search.fidelity = FIDELITY_RECORDS;
    assert_false(settings_screens(&s));
    snprintf(s.motion.records, sizeof s.motion.records, "builtin:suite");
    assert_true(settings_screens(&s));
}

TEST(a_key_of_an_earlier_version_is_passed_over_where_a_run_has_it_and_whole_numbers_are_written_in_full)
{
    Settings s = default_settings();
    CHECK_OK(settings_parse(&s, "run.sqlite", "[search]\nasynchronous = on\nseed = 7\n", &err), &err);
    assert_int_equal(s.search.seed, 7);
    CHECK_OK(settings_parse(&s, "run.sqlite", "[contact]\nv0_min_m_s = 0.001\n", &err), &err);
    assert_refused(settings_parse(&s, "run.sqlite", "[contact]\nv0_min_m_s = 0.01\n", &err), STATUS_BAD_DATA,
                   "run.sqlite:2:1: contact.v0_min_m_s is no setting any more");
    CHECK_OK(settings_parse(&s, "run.sqlite", "[contact]\npoisson = 0.3\n[building]\nstrength_degradation = 0\n", &err),
             &err);
    FOR_EACH (const char *, other, "[contact]\npoisson = 0.2\n", "[building]\nstiffness_degradation = 0.1\n")
        assert_refused(settings_parse(&s, "run.sqlite", *other, &err), STATUS_BAD_DATA, "any more: it is");
    assert_refused(settings_set(&s, "search.asynchronous=on", &err), STATUS_BAD_DATA,
                   "is no setting any more: every search looks ahead");
    CHECK_OK(settings_set(&s, "search.max_evals=1000000", &err), &err);
    assert_words_in(settings_text(&s), "\nmax_evals = 1000000\n");
}

SUITE(make_place, clear_place)
