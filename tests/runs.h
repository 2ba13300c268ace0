/* tests/runs.h -- small runs for tests of the run store, in the test's own folder or as a process of their own. */
#pragma once

#include "program.h"

#include <fcntl.h>
#include <limits.h>
#include <omp.h>
#include <spawn.h>
#include <sqlite3.h>

#include "store/export.h"
#include "store/run_read.h"
#include "store/store.h"
#include "study/study.h"

static const char TEXTBOOK[] = "[problem]\nkind = external\ncommand = " TEXTBOOK_WORKER
                               " dtlz2 6 3 0.05\nvariables = 6\nobjectives = 3\nnoisy = yes\n"
                               "[search]\ninitial = 12\npopulation = 12\nmax_evals = 40\n"
                               "limits = f1<=1.2\n";
#define EXACT "--set problem.noisy=no --set 'problem.command=" TEXTBOOK_WORKER " dtlz2 6 3' "
/* A worker that never answers. */
static const char DEAF[] = "[problem]\nkind = external\ncommand = sh tests/worker.sh deaf\nvariables = 3\n"
                           "objectives = 2\n[search]\nmax_evals = 8\nthreads = 1\n";

/* Lets so many questions pass, then stops. */
static inline int stop_after(void *user)
{
    int left;
#pragma omp atomic capture
    left = --*(int *)user;
    return left < 0;
}

static inline StudySummary study_to_its_end(const Settings *s)
{
    StudySummary summary;
    CHECK_OK(study_run(s, &(StudyOptions){0}, &summary, NULL, &err), &err);
    return summary;
}

static inline StudySummary study_stopped_after(int questions, const Settings *s)
{
    StudySummary summary;
    const StudyOptions options = {.stop = stop_after, .user = &questions};
    assert_int_equal(study_run(s, &options, &summary, NULL, &err), STATUS_STOPPED);
    return summary;
}

static inline char *path_of(const char *name, char path[PATH_MAX])
{
    snprintf(path, PATH_MAX, "%s/%s", place.folder, name);
    return path;
}

/* In the test's own folder. */
#define shell_in_place(...) expect_shell("cd '%s' && %s", place.folder, brief(__VA_ARGS__))

/* `database` is a file there. */
static inline void change_database(const char *database, const char *statements)
{
    char path[PATH_MAX], *why = NULL;
    sqlite3 *db;
    assert_int_equal(sqlite3_open(path_of(database, path), &db), SQLITE_OK);
    if (sqlite3_exec(db, statements, NULL, NULL, &why) != SQLITE_OK)
        fail_msg("%s: %s", statements, why);
    sqlite3_close(db);
}

static inline Run run_in(const char *name)
{
    Run run;
    char path[PATH_MAX];
    CHECK_OK(run_read(&run, path_of(name, path), &err), &err);
    return run;
}

static inline Settings settings_of(const char *text, const char *out)
{
    Settings s;
    settings_defaults(&s);
    CHECK_OK(settings_parse(&s, "here.ini", text, &err), &err);
    snprintf(s.run.out, sizeof s.run.out, "%s/%s", place.folder, out);
    if (s.search.threads == 0)
        s.search.threads = 1;
    return s;
}

/* As JSON, without the name of its folder. */
static inline char *json_export(const char *folder)
{
    static const char OUT[] = "\"run.out\":\"";
    char *text = NULL;
    size_t length;
    FILE *f = open_memstream(&text, &length);
    OWNED(run_free) Run run;
    CHECK_OK(run_read(&run, folder, &err), &err);
    CHECK_OK(export_json(f, &run, &err), &err);
    fclose(f);
    char *name = strstr(text, OUT);
    assert_non_null(name);
    name += sizeof OUT - 1;
    memmove(name, strchr(name, '"'), strlen(strchr(name, '"')) + 1);
    return text;
}

static inline void assert_same_run(const char *a, const char *b)
{
    char name[2][64], path[2][PATH_MAX];
    snprintf(name[0], sizeof name[0], "%s/front.csv", a);
    snprintf(name[1], sizeof name[1], "%s/front.csv", b);
    assert_same_files(name[0], name[1]);
    FREED char *first = json_export(path_of(a, path[0])), *second = json_export(path_of(b, path[1]));
    assert_string_equal(first, second);
}

/* `imtet optimize` in the background, what it says in @/said. */
static inline pid_t start(const char *config, const char *out)
{
    char paths[3][PATH_MAX];
    pid_t pid;
    posix_spawn_file_actions_t quiet;
    char *words[] = {getenv("IMTET"), "optimize", path_of(config, paths[0]), "--out", path_of(out, paths[1]), NULL};
    posix_spawn_file_actions_init(&quiet);
    posix_spawn_file_actions_addopen(&quiet, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, path_of("said", paths[2]), O_WRONLY | O_CREAT | O_TRUNC,
                                     0666);
    assert_int_equal(posix_spawn(&pid, words[0], &quiet, NULL, words, environ), 0);
    posix_spawn_file_actions_destroy(&quiet);
    return pid;
}

/* Designs from outside into the run of a folder. */
static inline Status add_to_run(const char *folder, size_t n, const Evaluation designs[], long *first_id, Err *why)
{
    RunStore *store;
    Run now;
    long id = 0;
    TRY(run_wanted(folder, why));
    TRY(store_open(&store, folder, 0, why));
    Status status = STATUS_OK;
    for (size_t i = 0; i < n && status == STATUS_OK; i++) {
        const Run *run = store_run(store);
        status = store_polished(store, &designs[i], (size_t)run->tried_to_polish, (size_t)run->polished_at, &id, why);
    }
    if (status == STATUS_OK && first_id)
        *first_id = id - (long)n + 1;
    if (status == STATUS_OK && (status = store_write_front(store, &now, why)) == STATUS_OK)
        run_free(&now);
    store_free(store);
    return status;
}

static inline int wait_end(pid_t pid)
{
    int status;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return status;
}

static inline int prepare(void **state)
{
    setenv("OMP_WAIT_POLICY", "passive", 0);
    omp_set_num_threads(1);
    return make_place(state);
}
