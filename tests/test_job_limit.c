/* search.max_hours = auto: what a Slurm job has left, from its environment or from scontrol. */
#include "program.h"

#include "study/job_limit.h"

TEST(the_environment_says_when_the_job_ends)
{
    double seconds;
    setenv("SLURM_JOB_END_TIME", brief("%ld", (long)time(NULL) + 3600), 1);
    CHECK_OK(job_seconds(&seconds, &err), &err);
    assert_less(fabs(seconds - (3600.0 - JOB_MARGIN_S)), 3.0);
    unsetenv("SLURM_JOB_END_TIME");
}

TEST(else_scontrol_does)
{
    double seconds;
    char day[64];
    const time_t end = time(NULL) + 1000;
    struct tm parts;
    localtime_r(&end, &parts);
    strftime(day, sizeof day, "%Y-%m-%dT%H:%M:%S", &parts);
    write_in_place("scontrol", brief("#!/bin/sh\n[ \"$4\" = 17 ] || exit 1\n"
                                     "echo 'JobId=17 StartTime=x EndTime=%s Deadline=N/A'\n",
                                     day));
    assert_int_equal(chmod(there("scontrol"), 0755), 0);
    setenv("PATH", brief("%s:%s", place.folder, getenv("PATH")), 1);
    setenv("SLURM_JOB_ID", "17", 1);
    CHECK_OK(job_seconds(&seconds, &err), &err);
    assert_less(fabs(seconds - (1000.0 - JOB_MARGIN_S)), 3.0);
    write_in_place("scontrol", "#!/bin/sh\necho 'JobId=17 StartTime=x EndTime=Unknown Deadline=N/A'\n");
    CHECK_OK(job_seconds(&seconds, &err), &err);
    assert_true(isinf(seconds));
    setenv("SLURM_JOB_ID", "18; true", 1);
    assert_int_equal(job_seconds(&seconds, &err), STATUS_BAD_DATA);
    unsetenv("SLURM_JOB_ID");
}

TEST(without_a_job_or_with_too_short_a_one_it_is_refused)
{
    expect(65, "this is no job of Slurm", "optimize configs/quick.ini --out @/none --max-hours auto");
    setenv("SLURM_JOB_END_TIME", brief("%ld", (long)time(NULL) + 60), 1);
    expect(65, "give it more time", "optimize configs/quick.ini --out @/none --max-hours auto");
    unsetenv("SLURM_JOB_END_TIME");
}

/* 122 s from now, of which 120 are kept back; resumed with the same words, which are no other limit. */
TEST(a_run_ends_before_its_job_and_goes_on_in_the_next)
{
    write_in_place("slow.ini", "[problem]\nkind = external\ncommand = sh tests/worker.sh steady\nvariables = 3\n"
                               "objectives = 2\n[search]\nmax_evals = 4000\nsurrogate = off\nmax_hours = auto\n");
    for (int i = 0; i < 2; i++) {
        setenv("SLURM_JOB_END_TIME", brief("%ld", (long)time(NULL) + 124), 1);
        expect(75, "Resume it with", i ? "optimize @/slow" : "optimize @/slow.ini --out @/slow");
    }
    unsetenv("SLURM_JOB_END_TIME");
    expect_file("slow/settings.ini", "max_hours = auto");
}

static void write_program(const char *name, const char *text)
{
    write_in_place(name, text);
    assert_int_equal(chmod(there(name), 0755), 0);
}

static int status_of_wrapper(int mpirun_status)
{
    const int status =
        system(brief("STATUS=%d PATH='%s':\"$PATH\" scripts/imtet-mpirun -n 2 '%s/imtet_mpi' optimize x.ini --out "
                     "'%s/lost_run' >/dev/null 2>&1",
                     mpirun_status, place.folder, place.folder, place.folder));
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

/* 205: Open MPI, where the daemon of a node is gone. */
TEST(a_lost_node_is_75_until_three_attempts_have_brought_no_evaluation)
{
    write_program("mpirun", "#!/bin/sh\nexit $STATUS\n");
    write_program("imtet_mpi", "#!/bin/sh\n[ \"$1\" = status ] && cat \"$2/n\"\n");
    write_in_place("lost_run/n", "{\n  \"simulated\": 40,\n}\n");
    for (int i = 0; i < 3; i++)
        assert_int_equal(status_of_wrapper(205), 75);
    assert_int_equal(status_of_wrapper(137), 70);
    write_in_place("lost_run/n", "{\n  \"simulated\": 41,\n}\n");
    assert_int_equal(status_of_wrapper(1), 75);
    assert_int_equal(status_of_wrapper(139), 70);
    FOR_EACH (int, listed, 0, 2, 65, 66, 69, 70, 71, 74, 75)
        assert_int_equal(status_of_wrapper(*listed), *listed);
    for (int i = 0; i < 3; i++)
        assert_int_equal(status_of_wrapper(205), 75);
    assert_int_equal(status_of_wrapper(205), 70);
}

SUITE(make_place, clear_place)
