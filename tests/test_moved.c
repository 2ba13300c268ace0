/* A run whose ground motions were moved: it says so, and takes them from their new place if they are the same. And one
 * that is moved to a processor whose linear algebra rounds otherwise. */
#include "program.h"

#define STUDY                                                                                                          \
    "optimize configs/quick.ini " SIX_FLOORS                                                                           \
    "--set sim.duration_s=2 --set sim.accuracy=coarse --set search.initial=24 "                                        \
    "--set search.population=8 --threads 1 --set search.polish=0 "
#define FIRST "--set motion.record=@/one.csv"
#define BOTH  FIRST " --set motion.records=@/two.csv,builtin:sylmar-like"

/* A pulse of one period: 4 s in steps of 0.01 s. */
static void write_record(const char *name, double period_s)
{
    char *text = NULL;
    size_t length = 0;
    FILE *f = open_memstream(&text, &length);
    fputs("time_s,accel_m_s2\n", f);
    for (int i = 0; i <= 400; i++)
        fprintf(f, "%.2f,%.6f\n", 0.01 * i, 0.01 * i < period_s ? 3 * sin(2 * M_PI * 0.01 * i / period_s) : 0.0);
    fclose(f);
    write_in_place(name, text);
    free(text);
}

static void rename_in_place(const char *from, const char *to)
{
    char *old = in_place(from), *new = in_place(to);
    assert_int_equal(rename(old, new), 0);
    free(old);
    free(new);
}

static int make_run(void **state)
{
    if (make_place(state) != 0)
        return -1;
    write_record("first.csv", 1.5);
    write_record("second.csv", 0.8);
    free(output_of(STUDY "--out @/run --max-evals 24 --set motion.record=@/first.csv "
                         "--set motion.records=@/second.csv,builtin:sylmar-like"));
    rename_in_place("first.csv", "one.csv");
    rename_in_place("second.csv", "two.csv");
    return 0;
}

TEST(every_command_says_which_record_was_moved_and_what_to_do)
{
    static const char *const COMMANDS[] = {"report @/run", "report @/run --pictures @/run/pictures",
                                           "polish @/run --design knee",
                                           "optimize @/run --max-evals 32 --force-settings"};
    for (size_t i = 0; i < sizeof COMMANDS / sizeof COMMANDS[0]; i++) {
        char with_one[256];
        expect(66, "--set motion.record=PATH", COMMANDS[i]);
        snprintf(with_one, sizeof with_one, "%s " FIRST, COMMANDS[i]);
        expect(66, "second.csv: a record of the run is not there; where it was moved, say so: --set motion.records=",
               with_one);
    }
}

TEST(a_finished_run_is_shown_without_its_records)
{
    Said s;
    run(&s, "optimize @/run");
    assert_int_equal(s.code, 0);
    assert_non_null(strstr(s.err, "first.csv: a record of the run is not there"));
    assert_non_null(strstr(s.out, " of 24 simulated designs, 0 simulations failed, "));
    assert_non_null(strstr(s.out, "(all simulations spent)"));
    assert_non_null(strstr(s.out, "nothing new was simulated"));
    forget(&s);
}

TEST(another_content_does_not_take_the_place_of_a_record)
{
    expect(65, "motion.record: ",
           "report @/run --set motion.record=@/two.csv --set motion.records=@/two.csv,builtin:sylmar-like");
    expect(65, "motion.records: ", "report @/run " FIRST " --set motion.records=builtin:sylmar-like,@/two.csv");
    expect(65, "two.csv does not hold what it held for the run",
           "report @/run " FIRST " --set motion.records=@/two.csv");
    expect(65, "motion.records has other content than when the run began; put that back, or",
           "optimize @/run " FIRST " --set motion.records=builtin:sylmar-like,@/two.csv");
    expect(2, "given twice", "report @/run " FIRST " " FIRST);
    expect(2, "only motion.record=PATH, motion.records=PATH,... and motion.forces",
           "report @/run --set motion.pga_g=1");
}

TEST(records_are_taken_from_where_they_are_now)
{
    free(output_of("report @/run " BOTH));
    free(output_of("polish @/run --design knee --evals 6 --replicates 1 " BOTH));
    free(output_of("optimize @/run --max-evals 32 --force-settings " BOTH));
    free(output_of("report @/run")); /* the run knows its new places from there on */
    free(output_of("optimize @/run"));
}

/* A push that ends, so that the roof swings freely after it. */
static void write_push(const char *name, double force_n)
{
    char text[128];
    snprintf(text, sizeof text, "time_s,floor_06_n\n0,%g\n1,%g\n1.01,0\n3,0\n", force_n, force_n);
    write_in_place(name, text);
}

#define PUSHED "--set motion.record=none --set motion.forces=@/push.csv "

TEST(forces_are_moved_with_their_run_and_other_forces_are_noticed_by_every_command)
{
    static const char CHANGED[] = "push.csv does not hold what it held for the run";
    Said s;
    write_push("push.csv", 1e7);
    free(output_of(STUDY PUSHED "--out @/pushed --max-evals 24"));
    rename_in_place("push.csv", "gone.csv");
    expect(66, "push.csv: a file of the run is not there; where it was moved, say so: --set motion.forces=PATH",
           "report @/pushed");
    free(output_of("report @/pushed --set motion.forces=@/gone.csv"));
    free(output_of("evaluate @/pushed --design 1 --set motion.forces=@/gone.csv"));
    write_push("push.csv", 2e7);
    expect(65, CHANGED, "report @/pushed");
    expect(65, CHANGED, "report @/pushed --set motion.forces=@/push.csv");
    expect(65, CHANGED, "evaluate @/pushed --design 1");
    expect(65, CHANGED, "polish @/pushed --design 1");
    expect(65, "motion.forces has other content than when the run began",
           "optimize @/pushed --max-evals 32 --force-settings");
    run(&s, "simulate configs/quick.ini --set building.model=configs/neighbours/tower --set core.width_m=5 "
            "--set motion.stretch=1 --set sim.duration_s=3 " PUSHED "--design @/pushed:1");
    assert_int_equal(s.code, 0); /* of other settings, which may have another motion */
    assert_non_null(strstr(s.err, CHANGED));
    forget(&s);
    free(output_of("optimize @/pushed --max-evals 32 --force-settings --set motion.forces=@/gone.csv"));
    free(output_of("report @/pushed"));
}

TEST(a_record_that_has_changed_at_its_place_is_noticed_by_every_command)
{
    static const char CHANGED[] = "motion.record: ";
    write_record("here.csv", 1.0);
    free(output_of(STUDY "--out @/here --max-evals 24 --set motion.record=@/here.csv"));
    free(output_of("evaluate @/here --design 1"));
    write_record("here.csv", 1.1);
    expect(65, CHANGED, "report @/here");
    expect(65, CHANGED, "evaluate @/here --design 1");
    free(output_of("evaluate @/here --design 1 --record @/here.csv")); /* another ground motion, as it says */
}

static char *front_of(const char *under, const char *name)
{
    char file[64], command[256];
    snprintf(place.under, sizeof place.under, "%s", under);
    snprintf(command, sizeof command,
             "optimize configs/quick.ini --set problem.kind=dtlz2 --threads 1 --max-evals 100 --set search.initial=40 "
             "--set search.population=20 "
             "--out @/%s",
             name);
    free(output_of(command));
    place.under[0] = 0;
    snprintf(file, sizeof file, "%s/front.csv", name);
    return read_in_place(file);
}

/* OPENBLAS_CORETYPE stands for the processor. */
TEST(linear_algebra_rounds_as_on_haswell_and_a_resumed_run_says_where_it_does_not)
{
    Said s;
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
        skip();
    char *plain = front_of("", "plain"), *haswell = front_of("env OPENBLAS_CORETYPE=Haswell", "haswell"),
         *prescott = front_of("env OPENBLAS_CORETYPE=Prescott", "prescott");
    assert_string_equal(plain, haswell);
    assert_string_not_equal(plain, prescott);
    snprintf(place.under, sizeof place.under, "env OPENBLAS_CORETYPE=Prescott");
    run(&s, "optimize @/plain --max-evals 110");
    assert_int_equal(s.code, 0);
    assert_non_null(strstr(s.err, "by the kernels Haswell in the run, now Prescott"));
    forget(&s);
    place.under[0] = 0;
    run(&s, "optimize @/haswell --max-evals 110");
    assert_int_equal(s.code, 0);
    assert_null(strstr(s.err, "kernels"));
    forget(&s);
    expect(65, "search.blas is pinned there, now native",
           "optimize @/haswell --max-evals 120 --set search.blas=native");
    free(plain);
    free(haswell);
    free(prescott);
}

SUITE(make_run, clear_place)
