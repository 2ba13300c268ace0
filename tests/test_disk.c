/* Disks that are full, read-only or damaged, other processes at the same run: said, and nothing lost. */
#include "runs.h"

#include <sys/mount.h>
#include <sys/resource.h>

#include "store/folder.h"

/* An answer takes 40 ms; a run of it is killed. */
static const char STEADY[] = "[problem]\nkind = external\ncommand = sh tests/worker.sh steady\nvariables = 3\n"
                             "objectives = 2\n[search]\ninitial = 1000\nmax_evals = 1000\nthreads = 2\n";

/* -- other processes, full disks, damage --------------------------------------------------------------------------- */

TEST(a_second_process_is_refused_with_the_first_ones_number)
{
    LockHolder holder;
    char path[PATH_MAX];
    write_in_place("steady.ini", STEADY);
    const pid_t pid = start("steady.ini", "locked");
    while (!folder_is_held(path_of("locked", path), &holder) || holder.pid != pid)
        rest(0.02);
    while (access(path_of("locked/run.sqlite", path), F_OK) != 0)
        rest(0.02);
    expect(74, brief("is in use by process %ld on ", (long)pid), "optimize @/steady.ini --out @/locked");
    expect_output("running (process", "status @/locked");
    kill(pid, SIGKILL);
    wait_end(pid);
    assert_false(folder_is_held(path_of("locked", path), &holder));
    expect_output("interrupted", "status @/locked");
}

/* All of `before` is in the run as it is now. */
static void assert_nothing_lost(const char *folder, const Run *before)
{
    OWNED(run_free) Run after = run_in(folder);
    assert_at_most(before->table.n, after.table.n);
    for (size_t i = 0; i < before->table.n; i++) {
        const size_t j = run_find(&after, before->table.row[i].id), n = before->schema.n_var;
        assert_less(j, after.table.n);
        assert_memory_equal(before->table.x + i * n, after.table.x + j * n, n * sizeof(double));
    }
}

/* No file may grow beyond some blocks: as a full disk, but without one. */
TEST(a_run_that_can_write_no_more_says_so_and_goes_on_later)
{
    Said s;
    write_in_place("textbook.ini", TEXTBOOK);
    free(output_of("optimize @/textbook.ini --out @/unlimited"));
    int refused = 0;
    for (int blocks = 8; blocks < 400; blocks += SANITIZED ? 72 : 24) {
        shell_in_place("rm -rf small");
        snprintf(place.under, sizeof place.under, "ulimit -f %d;", blocks);
        run(&s, "optimize @/textbook.ini --out @/small");
        place.under[0] = 0;
        if (s.code == 0) {
            forget(&s);
            break;
        }
        refused++;
        if (s.code != 74 || !strstr(s.err, "/small/"))
            fail_msg("%d blocks: exit %d: %s", blocks, s.code, s.err);
        forget(&s);
        OWNED(run_free) Run before = {0};
        if (access(there("small/run.sqlite"), F_OK) == 0)
            before = run_in("small");
        free(output_of("optimize @/textbook.ini --out @/small"));
        assert_nothing_lost("small", &before);
        assert_same_run("unlimited", "small");
    }
    assert_at_most(2, refused);
}

/* A disk of 300 kB, where this user may mount one. */
TEST(a_full_disk_is_named_and_what_was_stored_stays_readable)
{
    char disk[PATH_MAX];
    OWNED(forget) Said s;
    OWNED(run_free) Run saved;
    assert_int_equal(mkdir(path_of("disk", disk), 0777), 0);
    if (mount("none", disk, "tmpfs", 0, "size=300k") != 0)
        skip();
    run(&s, "optimize @/textbook.ini --max-evals 400 --out @/disk/run");
    const int right = s.code == 74 && strstr(s.err, "/disk/run/") &&
                      (strstr(s.err, "the disk is full") || strstr(s.err, "No space left"));
    const Status readable = run_read(&saved, there("disk/run"), &err);
    const size_t n = saved.table.n;
    umount2(disk, MNT_DETACH);
    if (!right)
        print_error("exit %d: %s", s.code, s.err);
    CHECK_OK(readable, &err);
    assert_true(right && n > 12);
}

/* Disks that are full at some moment of a quick run: given more room, it goes on at once and to the same end. */
TEST(a_run_on_a_disk_that_was_full_goes_on_at_once)
{
    static const char OFF[] = "[problem]\nkind = external\ncommand = sh tests/worker.sh good\nvariables = 3\n"
                              "objectives = 2\n[search]\npopulation = 6\ninitial = 16\nmax_evals = 90\nthreads = 1\n";
    char disk[PATH_MAX];
    Said s;
    write_in_place("off.ini", OFF);
    free(output_of("optimize @/off.ini --out @/roomy"));
    assert_int_equal(mkdir(path_of("tight", disk), 0777), 0);
    for (int kb = 110; kb < 270; kb += SANITIZED ? 40 : 20) {
        if (mount("none", disk, "tmpfs", 0, brief("size=%dk", kb)) != 0)
            skip();
        run(&s, "optimize @/off.ini --out @/tight/run");
        const int code = s.code;
        forget(&s);
        assert_int_equal(mount("none", disk, "tmpfs", MS_REMOUNT, "size=50m"), 0);
        run(&s, "optimize @/off.ini --out @/tight/run");
        if ((code != 0 && code != 74) || s.code != 0) {
            umount2(disk, MNT_DETACH);
            fail_msg("%d kB: exit %d, then %d: %s", kb, code, s.code, s.err);
        }
        forget(&s);
        assert_same_run("roomy", "tight/run");
        umount2(disk, MNT_DETACH);
    }
}

TEST(a_folder_that_is_read_only_is_named)
{
    char folder[PATH_MAX];
    OWNED(run_free) Run saved;
    assert_int_equal(mkdir(path_of("fixed", folder), 0777), 0);
    if (mount(folder, folder, NULL, MS_BIND, NULL) != 0)
        skip();
    free(output_of("optimize @/textbook.ini --max-evals 20 --out @/fixed/run"));
    assert_int_equal(mount(folder, folder, NULL, MS_BIND | MS_REMOUNT | MS_RDONLY, NULL), 0);
    OWNED(forget) Said new_run, old_run;
    run(&new_run, "optimize @/textbook.ini --out @/fixed/other");
    run(&old_run, "optimize @/fixed/run --max-evals 30");
    const Status readable = run_read(&saved, there("fixed/run"), &err);
    const size_t n = saved.table.n;
    umount2(folder, MNT_DETACH);
    CHECK_OK(readable, &err);
    assert_int_equal(n, 20);
    assert_true(new_run.code == 74 && strstr(new_run.err, "/fixed/other: cannot be made a folder: Read-only"));
    assert_true(old_run.code == 74 && strstr(old_run.err, "/fixed/run/lock: cannot be written: Read-only"));
}

static size_t simulated_in(const char *name)
{
    OWNED(run_free) Run saved;
    err = (Err){0};
    const Status status = run_read(&saved, there(name), &err);
    const size_t n = saved.table.n;
    if (status != STATUS_OK)
        print_error("%s\n", err.text);
    return n;
}

/* Killed, then put where nothing can be written, with and without what SQLite shares between processes (-shm). */
TEST(a_killed_run_in_a_read_only_folder_is_read_with_its_journal)
{
    char folder[PATH_MAX];
    struct stat journal;
    const pid_t pid = start("steady.ini", "killed");
    do {
        rest(0.05);
    } while (stat(there("killed/run.sqlite-wal"), &journal) != 0 || journal.st_size < 80000);
    kill(pid, SIGKILL);
    wait_end(pid);
    assert_int_equal(mkdir(path_of("archive", folder), 0777), 0);
    if (mount(folder, folder, NULL, MS_BIND, NULL) != 0)
        skip();
    shell_in_place("cp -r killed archive/all && cp -r killed archive/two && rm archive/two/run.sqlite-shm");
    assert_int_equal(mount(folder, folder, NULL, MS_BIND | MS_REMOUNT | MS_RDONLY, NULL), 0);
    const size_t n_all = simulated_in("archive/all"), n_two = simulated_in("archive/two");
    OWNED(forget) Said said;
    run(&said, "status @/archive/two");
    umount2(folder, MNT_DETACH);
    assert_int_equal(said.code, 0);
    const size_t n = simulated_in("killed");
    assert_true(n > 2 && n_all == n && n_two == n);
}

TEST(a_database_that_somebody_keeps_locked_is_busy)
{
    sqlite3 *other;
    free(output_of("optimize @/textbook.ini --max-evals 20 --out @/busy"));
    assert_int_equal(sqlite3_open(there("busy/run.sqlite"), &other), SQLITE_OK);
    assert_int_equal(sqlite3_exec(other, "BEGIN IMMEDIATE", NULL, NULL, NULL), SQLITE_OK);
    expect(74, "busy/run.sqlite: is busy", "optimize @/busy --max-evals 30");
    free(output_of("export @/busy --csv @/while-busy.csv"));
    sqlite3_close(other);
    free(output_of("optimize @/busy --max-evals 30"));
}

static void overwrite(const char *name, long offset, const char *bytes, size_t n)
{
    FILE *f = opened(there(name), "r+b");
    assert_int_equal(fseek(f, offset, SEEK_SET), 0);
    assert_int_equal(fwrite(bytes, 1, n, f), n);
    assert_int_equal(fclose(f), 0);
}

TEST(damage_is_found_on_opening_whatever_was_hit)
{
    static const char JUNK[4096] = "junk";
    char path[PATH_MAX];
    struct stat size;
    free(output_of("optimize @/textbook.ini --max-evals 30 --out @/sound"));
    assert_int_equal(stat(path_of("sound/run.sqlite", path), &size), 0);
    for (long page = 1; page < size.st_size / 4096; page += 5) {
        shell_in_place("rm -rf hurt; cp -r sound hurt");
        overwrite("hurt/run.sqlite", 4096 * page, JUNK, sizeof JUNK);
        expect(74, "hurt/run.sqlite: ", "status @/hurt");
        expect(74, "hurt/run.sqlite: ", "optimize @/hurt");
        expect(74, "hurt/run.sqlite: ", "export @/hurt --csv @/none.csv");
    }
    overwrite("hurt/run.sqlite", 0, "this is a letter", 16);
    expect(74, "is no database of a run; --new --set search.start=", "status @/hurt");
    write_in_place("hurt/letter.txt", "this is a letter");
    expect(66, "holds no run", "choose @/hurt/letter.txt");
    expect(65, "letter.txt: is a file, not a run or a folder of runs", "status @/hurt/letter.txt");
    assert_int_equal(truncate(path_of("hurt/run.sqlite", path), 0), 0);
    expect(74, "is empty, no database of a run; --new --set search.start=", "optimize @/hurt");
    assert_int_equal(unlink(path_of("hurt/run.sqlite", path)), 0);
    assert_int_equal(mkdir(path, 0777), 0);
    expect(74, "hurt/run.sqlite: is no file", "status @/hurt");
    overwrite("sound/run.sqlite", 60, "\0\0\0\x63", 4); /* user_version */
    expect(74, "has format 99, this program reads 10; a newer imtet wrote it", "status @/sound");
    overwrite("sound/run.sqlite", 60, "\0\0\0\1", 4);
    expect(74, "has format 1, this program reads 10; an older imtet wrote it", "status @/sound");
    expect(74, "an older imtet wrote it: only that one can resume it", "optimize @/sound");
    expect_output("unreadable", "status @");
}

static long peak_kib(void)
{
    struct rusage used;
    assert_int_equal(getrusage(RUSAGE_CHILDREN, &used), 0);
    return used.ru_maxrss;
}

/* Somebody's file that would compute rows without end or of a gigabyte is refused, and costs no memory. */
TEST(a_database_runs_nothing_and_needs_no_more_memory_than_its_size)
{
    free(output_of("optimize @/textbook.ini --max-evals 30 --out @/own"));
    free(output_of("status @/own"));
    const long usual = peak_kib();
    FOR_EACH (
        const char *, change,
        "ALTER TABLE evaluation RENAME TO was; CREATE VIEW evaluation AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL "
        "SELECT i + 1 FROM n) SELECT i AS id, 0 AS generation, 'sampled' AS kind, 'ok' AS outcome, '' AS reason, 0.1 "
        "AS seconds, 0 AS violation, 0 AS digest, was.x1 FROM n, was WHERE was.id = 1",
        "ALTER TABLE state RENAME TO was; CREATE VIEW state AS SELECT 1 AS id, 0 AS generation, zeroblob(900000000) AS "
        "bytes",
        "CREATE TRIGGER more AFTER INSERT ON session BEGIN DELETE FROM evaluation; END",
        "CREATE VIRTUAL TABLE words USING fts5(a)",
        /* a column that is computed: a row of a gigabyte in a small file */
        "ALTER TABLE state RENAME TO was; CREATE TABLE state(id INTEGER, generation INTEGER, bytes AS "
        "(zeroblob(900000000))); INSERT INTO state VALUES (1, 0)") {
        shell_in_place("rm -rf sent; cp -r own sent");
        change_database("sent/run.sqlite", *change);
        expect(74, "sent/run.sqlite: ", "status @/sent");
        expect(74, "sent/run.sqlite: ", "optimize @/sent --max-evals 40");
    }
    assert_less(peak_kib(), usual + 64 * 1024);
}

/* The first files that are opened must not get the numbers of standard output and error. */
TEST(who_closes_the_standard_streams_finds_nothing_of_them_in_the_run)
{
    OWNED(forget) Said s;
    free(output_of("optimize @/textbook.ini --max-evals 30 --out @/open"));
    run(&s, "optimize @/textbook.ini --max-evals 30 --out @/shut <&- >&- 2>&-");
    assert_int_equal(s.code, 74); /* its table could not be printed */
    assert_same_run("open", "shut");
    assert_words_in(read_in_place("shut/log.jsonl"), "!imtet:", "!knee");
}

SUITE(prepare, clear_place)
