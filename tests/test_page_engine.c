/* The simulator that a report carries (src/wasm, evaluate/portable.h): its linear algebra against LAPACK, its scene against
 * that of the files, and forty designs by the very code of the page, in node, against the program. */
/* Before cmocka, which has a macro `fail` of its own. */
#define linalg_modes         page_modes
#define linalg_solve_spd     page_solve_spd
#define linalg_indefinite_at page_indefinite_at
#include "../src/wasm/linalg.c"
#undef linalg_modes
#undef linalg_solve_spd
#undef linalg_indefinite_at

#include "program.h"

#include "evaluate/portable.h"
#include "evaluate/scenario.h"
#include "motion/motion_scale.h"

Status linalg_modes(int n, const double K[], const double M[], double omega[], double phi[], Err *why);
Status linalg_solve_spd(int n, int m, double A[], double B[], Err *why);
int linalg_indefinite_at(int n, const double A[]);

enum { N_MAX = 60 };

static double next(uint64_t *x)
{
    *x = *x * 6364136223846793005u + 1442695040888963407u;
    return (double)(*x >> 11) * 0x1p-53;
}

/* B' B + n I of random B: symmetric and positive definite. */
static void random_spd(int n, uint64_t *x, double A[])
{
    static double B[N_MAX * N_MAX];
    for (int i = 0; i < n * n; i++)
        B[i] = next(x) - 0.5;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            A[i * n + j] = i == j ? 0.1 * n : 0;
            for (int k = 0; k < n; k++)
                A[i * n + j] += B[k * n + i] * B[k * n + j];
        }
}

TEST(modes_and_equations_without_lapack_are_those_of_lapack)
{
    static double K[N_MAX * N_MAX], M[N_MAX * N_MAX], phi[2][N_MAX * N_MAX], omega[2][N_MAX], X[2][3 * N_MAX];
    uint64_t x = 1;
    for (int n = 1; n <= N_MAX; n += n < 8 ? 1 : 13) {
        random_spd(n, &x, K);
        random_spd(n, &x, M);
        CHECK_OK(linalg_modes(n, K, M, omega[0], phi[0], &err), &err);
        CHECK_OK(page_modes(n, K, M, omega[1], phi[1], &err), &err);
        for (int i = 0; i < n; i++)
            assert_close(omega[1][i], omega[0][i], 1e-11);
        for (int i = 0; i < n * n; i++)
            assert_at_most(fabs(phi[1][i] - phi[0][i]), 1e-8);
        for (int i = 0; i < 3 * n; i++)
            X[0][i] = X[1][i] = next(&x);
        memcpy(M, K, (size_t)(n * n) * sizeof *M);
        CHECK_OK(linalg_solve_spd(n, 3, K, X[0], &err), &err);
        assert_int_equal(page_indefinite_at(n, M), 0);
        CHECK_OK(page_solve_spd(n, 3, M, X[1], &err), &err);
        for (int i = 0; i < 3 * n; i++)
            assert_at_most(fabs(X[1][i] - X[0][i]), 1e-11);
    }
}

TEST(a_matrix_that_is_not_positive_definite_is_refused_without_lapack_at_the_same_row)
{
    double A[] = {2, 1, 0, 1, 2, 0, 0, 0, -1}, B[] = {1, 1, 1}, omega[3], phi[9];
    const double I[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    Err why;
    assert_int_equal(linalg_indefinite_at(3, A), 3);
    assert_int_equal(page_indefinite_at(3, A), 3);
    assert_int_equal(page_modes(3, I, A, omega, phi, &why), STATUS_BAD_DATA);
    assert_int_equal(page_modes(3, A, I, omega, phi, &why), STATUS_BAD_DATA);
    assert_int_equal(page_solve_spd(3, 1, A, B, &why), STATUS_BAD_DATA);
}

TEST(a_scene_of_bytes_has_the_matrices_records_and_settings_of_the_files)
{
    static Settings s, again;
    static Portable p;
    FREED unsigned char *bytes;
    size_t n;
    settings_defaults(&s);
    FOR_EACH (const char *, change, "building.modes=4", "motion.records=builtin:elcentro-like", "motion.stretch=1.5",
              "core.model=configs/neighbours/tower", "contact.restitution=0.55")
        CHECK_OK(settings_set(&s, *change, &err), &err);
    s.sim.steps_per_contact = 7;
    CHECK_OK(portable_make(&s, &bytes, &n, &err), &err);
    CHECK_OK(portable_read(&p, bytes, n, &err), &err);
    again = p.settings;
    char *const texts[] = {settings_text(&s), settings_text(&again)};
    assert_string_equal(texts[0], texts[1]);
    assert_same_number(again.sim.steps_per_contact, 7);
    assert_int_equal(p.n_records, 2);

    /* The records as they are opened from their names, the buildings as they are read. */
    for (size_t i = 0; i < 2; i++) {
        MotionOptions o = s.motion;
        OWNED(motion_free) Motion m;
        snprintf(o.record, sizeof o.record, "%s", p.source[i]);
        CHECK_OK(motion_open(&m, &o, &err), &err);
        assert_int_equal(m.n, p.record[i].n);
        assert_memory_equal(m.accel, p.record[i].accel, m.n * sizeof *m.accel);
    }
    for (size_t i = 0; i < 2; i++) {
        BuildingOptions o = s.building;
        OWNED(building_files_free) BuildingFiles file, byte;
        if (i == 1) {
            memcpy(o.model, s.core.model, sizeof o.model);
            o.modes = 0;
        }
        CHECK_OK(building_read(&file, &o, &err), &err);
        CHECK_OK(portable_building(&p, o.model, &byte, &err), &err);
        assert_int_equal(file.floors.n, byte.floors.n);
        assert_int_equal(file.full.n, byte.full.n);
        assert_memory_equal(file.floors.K, byte.floors.K, (size_t)(byte.floors.n * byte.floors.n) * sizeof(double));
        if (file.full.n > 0)
            assert_memory_equal(file.full.M, byte.full.M, (size_t)(byte.full.n * byte.full.n) * sizeof(double));
    }

    /* Bytes that end early, or begin otherwise, are no scene. */
    portable_free(&p);
    for (size_t cut = 0; cut < n; cut += n / 50 + 1) {
        BuildingFiles b = {0};
        Err why;
        if (portable_read(&p, bytes, cut, &why) == STATUS_OK) {
            assert_int_not_equal(portable_building(&p, s.core.model, &b, &why), STATUS_OK);
            building_files_free(&b);
            portable_free(&p);
        }
    }
    bytes[0] ^= 1;
    assert_int_equal(portable_read(&p, bytes, n, &err), STATUS_BAD_DATA);
    free(texts[0]);
    free(texts[1]);
}

/* n designs of so many floors; of the first three no gap closes. */
static void write_designs(const char *name, int floors, int n)
{
    uint64_t x = 7;
    FILE *f = opened(brief("%s/%s", place.folder, name), "w");
    for (int j = 0; j < floors; j++)
        fprintf(f, "gap_%02d_m,", j + 1);
    fputs("t_base_m,t_top_m\n", f);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < floors; j++)
            fprintf(f, "%.6f,", i < 3 ? 4 : 0.02 * pow(25, next(&x)));
        fprintf(f, "%.6f,%.6f\n", 0.01 + 0.02 * next(&x), 0.008);
    }
    fclose(f);
}

/* By the page of the run's report, and by the program. */
static void expect_alike(const char *run)
{
    if (system("command -v node >/dev/null") != 0)
        skip();
    expect(0, "", brief("report @/%s --out @/%s.html", run, run));
    expect_shell("d='%s/%s'; node tests/engine/forty.mjs '%s' $d.html $d.csv $d/settings.ini >$d.said 2>&1 || { "
                 "cat $d.said; exit 1; }; cat $d.said",
                 place.folder, run, getenv("IMTET"));
}

TEST(forty_designs_simulated_by_the_page_of_a_report_are_those_of_the_program)
{
    expect(0, "", "optimize configs/quick.ini --max-evals 24 --set sim.duration_s=20 --out @/run");
    write_designs("run.csv", 20, 40);
    expect_alike("run");
}

TEST(by_all_records_with_their_rates_the_page_finds_the_annual_loss_of_the_program)
{
    expect(0, "",
           "optimize configs/quick.ini " SIX_FLOORS "--max-evals 16 --set search.initial=12 --set search.population=8 "
           "--set sim.duration_s=8 --set 'motion.record=builtin:elcentro-like factor=0.5 rate=0.02' --set "
           "'motion.records=builtin:sylmar-like factor=1.5 rate=7e-4' --set motion.pga_g=0 --set sim.robust=mean --set "
           "search.objectives=annual_loss,j1_m,mcore_kg --out @/year");
    write_designs("year.csv", 6, 8);
    expect_alike("year");
}

SUITE(make_place, clear_place)
