/* The library as others see it: its simulator, its symbols, what is installed, the examples and Python. */
#include "runs.h"

#include <pthread.h>

#include "imtet_scene.h"

#define LIBRARY "build/release/libimtet.so"

static const char *const SIX[] = {"building.model=configs/neighbours/tower",
                                  "core.width_m=5",
                                  "design.gap_m=0.001,0.05",
                                  "motion.pga_g=0.3",
                                  "motion.stretch=1",
                                  "sim.forces=yes",
                                  NULL};
static const double DESIGN[8] = {0.003, 0.004, 0.005, 0.006, 0.007, 0.008, 0.02, 0.01};

/* What the last call said of its fault. */
static imtet_error error;

static void must(imtet_status status)
{
    if (status != IMTET_OK)
        fail_msg("%s", error.text);
}

static imtet_scene *six_floors(void)
{
    imtet_scene *scene;
    must(imtet_scene_open("configs/quick.ini", SIX, &scene, &error));
    return scene;
}

static imtet_result *response(imtet_scene *scene, const char *kind)
{
    imtet_result *r;
    must(imtet_scene_simulate(scene, kind, DESIGN, 8, &r, &error));
    return r;
}

static const double *numbers(const imtet_result *r, const char *name, size_t *rows, size_t *columns)
{
    const double *at;
    must(imtet_result_numbers(r, name, &at, rows, columns, &error));
    return at;
}

/* -- the simulator ------------------------------------------------------------------------------------------------- */

TEST(a_design_has_the_numbers_of_imtet_simulate)
{
    static const struct {
        const char *kind, *options;
    } KINDS[] = {
        {"with_core", "--design @/d.csv"}, {"no_core", "--design none"}, {"rigid", "--design @/d.csv --rigid"}};
    OWNED(imtet_scene_free) imtet_scene *scene = six_floors();
    write_in_place("d.csv", "gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,gap_06_m,t_base_m,t_top_m\n"
                            "0.003,0.004,0.005,0.006,0.007,0.008,0.02,0.01\n");
    for (size_t k = 0; k < N_OF(KINDS); k++) {
        OWNED(imtet_result_free) imtet_result *r = response(scene, KINDS[k].kind);
        free(output_of("simulate configs/quick.ini %s " SIX_FLOORS "--set sim.forces=yes --csv @/table.csv",
                       KINDS[k].options));
        FREED char *table = read_in_place("table.csv");
        char *names = table, *cells = strchr(table, '\n') + 1, *name;
        size_t known = 0;
        cells[-1] = 0;
        while ((name = strsep(&names, ","))) {
            const char *cell = strsep(&cells, ",");
            const double *own;
            if (imtet_result_numbers(r, name, &own, NULL, NULL, NULL) != IMTET_OK || isnan(*own))
                continue;
            assert_close(*own, strtod(cell, NULL), 1e-12);
            known++;
        }
        assert_less(8, known);
        assert_string_equal(imtet_result_text(r, "outcome"), "ok");
    }
}

static double value_of(const json_t *value)
{
    return json_is_boolean(value) ? json_is_true(value) : json_number_value(value);
}

/* A list is a column, a list of two lists has them as rows. */
static void assert_same_list(const imtet_result *r, const char *name, const json_t *list)
{
    size_t rows, columns, i, k;
    const double *own = numbers(r, name, &rows, &columns);
    json_t *item, *value;
    assert_int_equal(rows, json_array_size(list));
    json_array_foreach(list, i, item)
    {
        if (!json_is_array(item))
            assert_close(own[i], value_of(item), 1e-12);
        json_array_foreach(item, k, value) assert_close(own[i * columns + k], value_of(value), 1e-12);
    }
}

TEST(every_case_has_the_numbers_of_imtet_evaluate)
{
    OWNED(imtet_scene_free) imtet_scene *scene = six_floors();
    json_auto_t *all =
        as_json("evaluate configs/quick.ini --design @/d.csv:1 --set sim.forces=yes " SIX_FLOORS "--json");
    json_t *one;
    const char *kind;
    size_t n = 0;
    json_object_foreach(json_array_get(json_object_get(all, "records"), 0), kind, one)
    {
        if (!json_is_object(one))
            continue;
        OWNED(imtet_result_free) imtet_result *r = response(scene, kind);
        FOR_EACH (const char *, same, "j1_m", "j3_g", "tmd_hz", "tmd_damping", "link_ns_m", "settled_s", "core_top_m",
                  "overturning_nm", "core_stress_storey", "contact_yields")
            if (json_object_get(one, *same))
                assert_close(*numbers(r, *same, NULL, NULL), value_of(json_object_get(one, *same)), 1e-12);
        FOR_EACH (const char *, list, "peak_drift_ratio", "mode_share_pct", "core_shear_n", "contact_force_n",
                  "contacts")
            if (json_object_get(one, *list))
                assert_same_list(r, *list, json_object_get(one, *list));
        n++;
    }
    assert_int_equal(n, 5);
}

TEST(a_history_has_the_peaks_of_the_result_and_keeps_the_energy)
{
    OWNED(imtet_scene_free) imtet_scene *scene = six_floors();
    OWNED(imtet_result_free) imtet_result *r = response(scene, "with_core"), *h;
    size_t n, floors;
    must(imtet_scene_history(scene, "with_core", DESIGN, 8, 0.001, &h, &error));
    const double *t = numbers(h, "t_s", &n, NULL), *u = numbers(h, "floor_m", NULL, &floors);
    const double *peak = numbers(r, "peak_displacement_m", NULL, NULL), *drift = numbers(h, "drift_m", NULL, NULL);
    const double input = *numbers(r, "input_energy_j", NULL, NULL), *sum = numbers(h, "input_j", NULL, NULL);
    assert_true(n > 10000 && floors == 6 && t[0] == 0);
    for (size_t j = 0; j < floors; j++) {
        double most = 0;
        for (size_t i = 0; i < n; i++)
            most = fmax(most, fabs(u[i * floors + j]));
        assert_at_most(most, peak[j] * (1 + 1e-9));
        assert_close(most, peak[j], 1e-3);
    }
    for (size_t i = 0; i < n; i += 97) {
        double parts = 0;
        FOR_EACH (const char *, part, "kinetic_j", "strain_j", "damped_building_j", "core_j", "damped_core_j",
                  "contacts_j")
            parts += numbers(h, *part, NULL, NULL)[i];
        assert_at_most(fabs(parts - sum[i]), 1e-6 * input);
        assert_close(drift[i * floors + 3], u[i * floors + 3] - u[i * floors + 2], 1e-12);
    }
}

typedef struct {
    imtet_scene *scene;
    double j3_g;
} Together;

static void *simulate_often(void *user)
{
    Together *t = user;
    for (int i = 0; i < (SANITIZED ? 2 : 8); i++) {
        OWNED(imtet_result_free) imtet_result *r = response(t->scene, "with_core");
        t->j3_g = *numbers(r, "j3_g", NULL, NULL);
    }
    return NULL;
}

TEST(threads_simulate_on_one_scene_at_once)
{
    pthread_t thread[4];
    Together t[4];
    OWNED(imtet_scene_free) imtet_scene *scene = six_floors();
    OWNED(imtet_result_free) imtet_result *r = response(scene, "with_core");
    for (int i = 0; i < 4; i++) {
        t[i] = (Together){scene, 0};
        assert_int_equal(pthread_create(&thread[i], NULL, simulate_often, &t[i]), 0);
    }
    for (int i = 0; i < 4; i++) {
        pthread_join(thread[i], NULL);
        assert_same_number(t[i].j3_g, *numbers(r, "j3_g", NULL, NULL));
    }
}

TEST(a_scene_says_what_its_designs_are)
{
    OWNED(imtet_scene_free) imtet_scene *scene = six_floors();
    OWNED(imtet_result_free) imtet_result *about;
    size_t n;
    must(imtet_scene_describe(scene, &about, &error));
    assert_string_equal(imtet_result_text(about, "variables"),
                        "gap_01_m,gap_02_m,gap_03_m,gap_04_m,gap_05_m,gap_06_m,t_base_m,t_top_m");
    assert_memory_equal(imtet_result_text(about, "objectives"), "j1_m,j2_m,j3_g", 14);
    assert_memory_equal(imtet_result_text(about, "senses"), "min,min,min", 11);
    assert_same_number(*numbers(about, "floors", NULL, NULL), 6);
    assert_same_number(numbers(about, "upper", &n, NULL)[0], 0.05);
    assert_int_equal(n, 8);
}

TEST(a_record_is_read_as_it_is_and_scaled_on_request)
{
    imtet_result *r;
    size_t n;
    double peak = 0;
    must(imtet_motion_read("builtin:sylmar-like", (const char *const[]){"motion.pga_g=0.2", NULL}, &r, &error));
    const double *a = numbers(r, "acceleration", &n, NULL);
    for (size_t i = 0; i < n; i++)
        peak = fmax(peak, fabs(a[i]));
    assert_close(peak, 0.2 * 9.81, 1e-12);
    assert_string_equal(imtet_result_text(r, "format"), "builtin");
    imtet_result_free(&r);
    assert_int_equal(imtet_motion_read("configs/beam.py", NULL, &r, &error), IMTET_BAD_DATA);
    assert_null(r);
}

static void says(imtet_status status, const char *words)
{
    assert_int_not_equal(status, IMTET_OK);
    assert_words(error.text, words);
}

TEST(what_makes_no_sense_is_named)
{
    imtet_scene *scene = six_floors(), *none = (imtet_scene *)(uintptr_t)1;
    imtet_result *r, *gone = NULL;
    const double *at;
    double x[8];
    says(imtet_scene_open("no.ini", NULL, &none, &error), "no.ini");
    assert_null(none);
    says(imtet_scene_open(NULL, (const char *const[]){"motion.pga=1", NULL}, &none, &error), "motion.pga_g?");
    says(imtet_scene_open(NULL, (const char *const[]){"problem.kind=external", "problem.command=true", NULL}, &none,
                          &error),
         "this needs problem.kind = tower");
    says(imtet_scene_simulate(scene, "with_core", DESIGN, 7, &r, &error),
         "x: has 7 numbers; a design of this scene has 8");
    says(imtet_scene_simulate(scene, "with_core", NULL, 8, &r, &error), "x: has 0 numbers");
    says(imtet_scene_simulate(scene, "impact", DESIGN, 8, &r, &error), "kind: impact is no case");
    memcpy(x, DESIGN, sizeof x);
    x[2] = -0.01;
    says(imtet_scene_simulate(scene, "with_core", x, 8, &r, &error), "gap_03_m is -0.01; a gap is not negative");
    x[2] = NAN;
    says(imtet_scene_simulate(scene, "with_core", x, 8, &r, &error), "x: number 3 is nan");
    assert_null(r);
    says(imtet_scene_history(scene, "with_core", DESIGN, 8, 1e-9, &r, &error), "every_s: 1e-09");
    says(imtet_scene_history(scene, "with_core", DESIGN, 8, -1, &r, &error), "every_s: -1 is not");
    says(imtet_scene_simulate(none, "with_core", x, 8, &r, &error), "the scene is NULL");
    r = response(scene, "no_core");
    says(imtet_result_numbers(r, "j3g", &at, NULL, NULL, &error), "did you mean j3_g?");
    says(imtet_result_numbers(r, "outcome", &at, NULL, NULL, &error), "outcome is a text");
    says(imtet_result_numbers(gone, "j3_g", &at, NULL, NULL, &error), "the result is NULL");
    assert_null(imtet_result_name(gone, 0));
    assert_null(imtet_result_text(r, "j3_g"));
    imtet_result_free(&r);
    imtet_result_free(&r);
    imtet_scene_free(&scene);
    imtet_scene_free(&scene);
}

/* -- the files ----------------------------------------------------------------------------------------------------- */

static char *shell(const char *command)
{
    char out[PATH_MAX];
    const int status = system(brief("(%s) >%s 2>&1", command, path_of("shell", out)));
    char *said = text_of(out);
    if (status != 0)
        fail_msg("%s\n%s", command, said);
    return said;
}

static int is_built(void)
{
    return !SANITIZED && access(LIBRARY, R_OK) == 0;
}

TEST(the_shared_library_shows_the_functions_of_its_headers_and_nothing_else)
{
    if (!is_built())
        skip();
    FREED char *shown = shell("nm -D --defined-only " LIBRARY " | awk '$2 == \"T\" { sub(/@.*/, \"\", $3); print $3 } "
                              "$2 != \"T\" && $2 != \"A\" { print \"other:\", $3 }' | sort");
    FREED char *wanted =
        shell("sed -n 's/^IMTET_API .*[ *]\\(imtet_[a-z_]*\\)(.*/\\1/p' include/imtet.h include/imtet_scene.h | sort");
    assert_string_equal(shown, wanted);
    assert_at_most(count(wanted, "\n"), 25);
    assert_text(
        shell("nm --defined-only build/release/libimtet.a | awk '$2 ~ /[ABDRTVW]/ && $3 !~ /^imtet_/ { print }'"), "");
}

TEST(the_headers_stand_alone_in_c_and_in_cpp)
{
    if (!is_built())
        skip();
    free(shell("for h in imtet imtet_scene; do echo \"#include <$h.h>\" | cc -std=c99 -Wall -Wextra -Werror -pedantic "
               "-Iinclude -fsyntax-only -x c - && echo \"#include <$h.h>\" | c++ -Wall -Wextra -Werror -Iinclude "
               "-fsyntax-only -x c++ - || exit 1; done"));
}

TEST(the_examples_in_the_headers_compile_run_and_say_what_fails)
{
    static const char BUILD[] =
        "for h in imtet imtet_scene; do { echo '#include <'$h'.h>'; echo '#include <stdio.h>'; echo 'void "
        "evaluate(const double x[], double f[]) { f[0] = x[0]; f[1] = %s(1 - x[0] * x[1]); }'; echo 'int main(void) "
        "{'; sed -n '/^ \\*     [^ ]/,/^ \\*$/s/^ \\*     //p' include/$h.h; echo '}'; } | cc -std=c11 -Wall -Wextra "
        "-Werror -Wno-unused-function -Iinclude -x c - -o %s/$h -Lbuild/release -limtet -Wl,-rpath,$PWD/build/release "
        "&& %s/$h || exit 1; done";
    if (!is_built())
        skip();
    FREED char *right = formatted(BUILD, "", place.folder, place.folder), *said = shell(right);
    assert_memory_equal(said, "ok: ", 4); /* of the scene; the search says nothing */
    FREED char *wrong = formatted(BUILD, "0 / 0. * ", place.folder, place.folder), *refused = shell(wrong);
    assert_words(refused, "F of design 1: number 2 is");
}

TEST(the_examples_run)
{
    if (!is_built())
        skip();
    static const char *const SAYS[][2] = {{"build/release/examples/ask_tell", "designs on the front"},
                                          {"build/release/examples/simulate", "2001 times of 20 floors"},
                                          {"build/release/examples/executor", "120 evaluations by 4 threads"}};
    for (size_t i = 0; i < N_OF(SAYS); i++)
        assert_words_in(shell(SAYS[i][0]), SAYS[i][1]);
}

TEST(what_is_installed_compiles_and_links_by_pkg_config_and_is_gone_again)
{
    if (!is_built())
        skip();
    assert_words_in(
        shell(brief("P=%s/root && make -s install-library DESTDIR=$P PREFIX=/opt && export PKG_CONFIG_SYSROOT_DIR=$P "
                    "PKG_CONFIG_LIBDIR=$P/opt/lib/pkgconfig && cc examples/ask_tell.c $(pkg-config --cflags --libs "
                    "imtet) -lm -o $P/a && LD_LIBRARY_PATH=$P/opt/lib $P/a && rm $P/a && make -s uninstall-library "
                    "DESTDIR=$P PREFIX=/opt && find $P -type f -o -type l",
                    place.folder)),
        "designs on the front", "!root/");
}

TEST(python_does_what_its_tests_say)
{
    static const char *const PYTHONS[] = {"python3", "/usr/bin/python3"}; /* that of Debian has Debian's numpy */
    const char *python = NULL;
    for (size_t k = 0; k < N_OF(PYTHONS) && !python; k++)
        python = system(brief("%s -c 'import numpy' 2>/dev/null", PYTHONS[k])) == 0 ? PYTHONS[k] : NULL;
    if (!is_built() || !python) {
        print_message("python3 with numpy (python3-numpy) is not here: python/imtet is not tested\n");
        skip();
    }
    free(shell(brief("IMTET=$PWD/imtet %s tests/python/test_imtet.py %s", python, place.folder)));
}

static int begin(void **state)
{
    linalg_pin();
    return prepare(state);
}

SUITE(begin, clear_place)
