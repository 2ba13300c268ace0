/* Runs whose answers are noisy: what their tables say, and that stopping them changes nothing. */
#include "runs.h"

/* 60 simulations, of which (60 - 18 * 2) / 2 are repeats. */
#define PROBLEM(noise, noisy)                                                                                          \
    "[problem]\nkind = external\ncommand = " TEXTBOOK_WORKER " dtlz2 2 2 " noise "\nvariables = 2\nobjectives = 2\n"   \
    "noisy = " noisy "\n[search]\ninitial = 8\npopulation = 8\nmax_evals = 60\nreplicate_share = 0.5\n"                \
    "replicates_max = 3\n"
static const char NOISY[] = PROBLEM("0.05", "yes"), QUIET[] = PROBLEM("0", "no");
enum { SIMULATIONS = 60, REPEATS = 12 };

/* In pieces of so many questions; 0: in one. */
static void study(const char *text, const char *out, long piece)
{
    const Settings s = settings_of(text, out);
    Status status;
    StudySummary summary;
    do {
        int left = (int)piece;
        const StudyOptions options = {.stop = piece > 0 ? stop_after : NULL, .user = &left};
        status = study_run(&s, &options, &summary, NULL, &err);
    } while (status == STATUS_STOPPED);
    CHECK_OK(status, &err);
}

TEST(a_noisy_run_stopped_after_every_kth_simulation_is_the_run_that_never_stopped)
{
    study(NOISY, "whole", 0);
    study(NOISY, "pieces", 7);
    assert_same_run("whole", "pieces");
}

TEST(the_front_has_means_spreads_and_members_of_what_was_simulated)
{
    OWNED(run_free) Run h = run_in("whole");
    size_t repeats = 0, confirmed = 0;
    assert_true(h.schema.has_spread && h.table.n == SIMULATIONS);
    for (size_t i = 0; i < h.table.n; i++) {
        double n = 0.0, mean[2] = {0.0, 0.0};
        repeats += h.table.row[i].kind == KIND_REPEAT;
        for (size_t j = 0; j < h.table.n; j++)
            if (h.table.x[2 * j] == h.table.x[2 * i] && h.table.x[2 * j + 1] == h.table.x[2 * i + 1]) {
                n += 1.0;
                mean[0] += h.table.f[2 * j];
                mean[1] += h.table.f[2 * j + 1];
            }
        assert_true(h.table.row[i].kind == KIND_REPEAT ? h.table.row[i].replicates == 0 && !h.place[i].on_front
                                                       : h.table.row[i].replicates == (long)n && n <= 3.0);
        for (int k = 0; k < 2 && h.place[i].on_front; k++) {
            assert_close(h.F[2 * i + k], mean[k] / n, 1e-12);
            const double f = h.F[2 * i + k], spread = h.table.sd[2 * i + k]; /* the noise is a share of the value */
            assert_true(f > 0.0 ? spread > 0.0 && spread < 0.3 * f : spread == 0.0);
        }
        confirmed += h.place[i].on_front && n > 1.0;
    }
    assert_int_equal(repeats, h.n_repeats); /* at most the share that is asked for: none is made when the search ends */
    assert_at_most(h.n_repeats, REPEATS);
    assert_at_most(REPEATS / 2, h.n_repeats);
    assert_at_most(2, confirmed);
}

TEST(the_exports_and_status_tell_of_repeats)
{
    free(output_of("export @/whole --csv @/exported.csv"));
    FREED char *front = read_in_place("whole/front.csv"), *exported = read_in_place("exported.csv");
    assert_string_equal(front, exported);
    assert_non_null(strstr(front, ",f1,f2,f1_sd,f2_sd,replicates\n"));
    FREED char *all = all_of("whole");
    json_auto_t *said = as_json("status @/whole --json");
    size_t n = 0;
    for (const char *at = all; (at = strstr(at, ",repeat,")); at++)
        n++;
    assert_at_most(REPEATS / 2, n);
    assert_same_number(number(said, "repeats"), (double)n);
}

TEST(without_noise_nothing_is_repeated_and_the_tables_are_as_ever)
{
    study(QUIET, "quiet", 0);
    OWNED(run_free) Run h = run_in("quiet");
    FREED char *front = read_in_place("quiet/front.csv");
    assert_true(!h.schema.has_spread && h.n_repeats == 0);
    assert_null(strstr(front, "replicates"));
}

SUITE(prepare, clear_place)
