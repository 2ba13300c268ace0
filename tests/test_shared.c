/* A run on a file system of several machines: a rollback journal, the same bytes, killed and read by others at any moment.
 * statfs says NFS in this process alone (--wrap=statfs); studies run in children of it. */
#include "runs.h"

#include <sys/vfs.h>

static unsigned file_system;

int __real_statfs(const char *path, struct statfs *about);
int __wrap_statfs(const char *path, struct statfs *about);
int __wrap_statfs(const char *path, struct statfs *about)
{
    const int code = __real_statfs(path, about);
    if (file_system)
        about->f_type = (__typeof__(about->f_type))file_system;
    return code;
}

static const unsigned NFS = 0x6969;
static const char STEADY[] = "[problem]\nkind = external\ncommand = sh tests/worker.sh steady\nvariables = 3\n"
                             "objectives = 2\n[search]\ninitial = 20\npopulation = 12\nmax_evals = 60\n"
                             "surrogate = off\nthreads = 2\n";

/* After so many evaluations it waits to be killed. */
static int wait_after(void *left)
{
    int now;
#pragma omp atomic capture
    now = --*(int *)left;
    if (now <= 0)
        for (;;)
            pause();
    return 0;
}

static pid_t study_in_child(const char *out, int evaluations)
{
    const pid_t pid = fork();
    assert_at_most(0, pid);
    if (pid > 0)
        return pid;
    StudySummary summary;
    err = (Err){0};
    const Settings s = settings_of(STEADY, out);
    const Status status = study_run(&s, &(StudyOptions){.stop = evaluations ? wait_after : NULL, .user = &evaluations},
                                    &summary, NULL, &err);
    _exit(status_exit_code(status));
}

static int ended_well(pid_t pid)
{
    const int status = wait_end(pid);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

static int is_there(const char *name)
{
    return access(there(name), F_OK) == 0;
}

/* A run in which nothing was evaluated is begun again. */
static int has_evaluations(const char *run)
{
    return finished_in(run) > 0;
}

static void finish_alone(void)
{
    write_in_place("steady.ini", STEADY);
    if (!is_there("alone/front.csv"))
        free(output_of("optimize @/steady.ini --out @/alone"));
}

TEST(every_such_file_system_gets_a_rollback_journal_and_no_other_does)
{
    char path[PATH_MAX];
    path_of("one.sqlite", path);
    FOR_EACH (unsigned, kind, 0x6969, 0x0bd00bd0, 0x47504653, 0x00c36400, 0x19830326, 0xff534d42, 0xfe534d42, 0xef53) {
        Database *d;
        unlink(path);
        file_system = *kind;
        CHECK_OK(database_create(&d, path, &err), &err);
        CHECK_OK(database_do(d, &err, "CREATE TABLE t (x)", ""), &err);
        database_close(d);
        CHECK_OK(database_open(&d, path, DATABASE_WRITE, &err), &err);
        CHECK_OK(database_do(d, &err, "INSERT INTO t VALUES (1)", ""), &err);
        assert_int_equal(is_there("one.sqlite-wal"), *kind == 0xef53);
        database_close(d);
    }
    file_system = 0;
}

TEST(a_run_there_has_the_same_bytes)
{
    finish_alone();
    file_system = NFS;
    assert_true(ended_well(study_in_child("there", 0)));
    file_system = 0;
    assert_same_run("alone", "there");
}

/* Others look without a pause; the run is killed again and again. */
TEST(it_is_killed_and_read_at_any_moment)
{
    int kills = 0, looks = 0;
    finish_alone();
    for (int is_done = 0; !is_done; kills++) {
        file_system = NFS;
        const pid_t pid = study_in_child("killed", kills < 9 ? 30 : 0);
        file_system = 0;
        const double until = clock_seconds() + 0.15 + 0.05 * kills;
        while (clock_seconds() < until || (looks <= kills / 2 && has_evaluations("killed"))) {
            if (!has_evaluations("killed")) {
                rest(0.01);
                continue;
            }
            assert_false(is_there("killed/run.sqlite-wal"));
            free(output_of("status @/killed"));
            looks++;
        }
        if (kills < 9)
            kill(pid, SIGKILL);
        is_done = ended_well(pid);
        if (has_evaluations("killed"))
            free(output_of("status @/killed"));
    }
    assert_true(kills > 3 && looks > 3);
    assert_same_run("alone", "killed");
}

TEST(a_run_that_was_begun_on_a_disk_of_its_own_goes_on_there)
{
    finish_alone();
    const pid_t pid = study_in_child("moved", 0);
    while (!is_there("moved/run.sqlite-wal"))
        rest(0.01);
    rest(0.5);
    kill(pid, SIGKILL);
    assert_false(ended_well(pid));
    file_system = NFS;
    const pid_t second = study_in_child("moved", 0);
    file_system = 0;
    rest(0.3);
    assert_false(is_there("moved/run.sqlite-wal"));
    assert_true(ended_well(second));
    assert_same_run("alone", "moved");
}

SUITE(prepare, clear_place)
