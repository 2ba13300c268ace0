/* A run's folder that was copied in part, deleted under a running study, changed bit by bit, or made to lead elsewhere: it is
 * said, nothing is overwritten, and what can go on goes on to the same end. */
#include "runs.h"

#include "store/folder.h"

/* Generations of some ten designs, which take 10 ms each. */
static const char SLOW[] = "[problem]\nkind = external\ncommand = sh tests/worker.sh steady\nvariables = 3\n"
                           "objectives = 2\n[search]\ninitial = 16\npopulation = 12\nmax_evals = 60\n"
                           "threads = 2\n";

/* A study that has finished a generation or two and is at work. */
static pid_t start_and_wait(const char *out)
{
    const pid_t pid = start("slow.ini", out);
    while (finished_in(out) < 20)
        rest(0.02);
    return pid;
}

static void killed_run(const char *out)
{
    const pid_t pid = start_and_wait(out);
    kill(pid, SIGKILL);
    wait_end(pid);
}

/* -- two at once, and starts that were cut short -------------------------------------------------------------------- */

/* The lock's holder seems to be gone, so that the folder seems free; when it lets go there is a run. */
TEST(a_run_that_appears_while_the_lock_is_waited_for_is_not_overwritten)
{
    char path[PATH_MAX], host[65] = "";
    Folder folder;
    gethostname(host, sizeof host - 1);
    shell_in_place("mkdir race");
    CHECK_OK(folder_take(&folder, path_of("race", path), 0, &err), &err);
    FREED char *text = formatted("%d %s\n", 0x3fffff, host);
    assert_int_equal(pwrite(folder.lock, text, strlen(text), 0), strlen(text));
    const pid_t pid = fork();
    if (pid == 0) {
        char *words[] = {getenv("IMTET"),  "optimize", in_place("textbook.ini"), "--new", "--out",
                         in_place("race"), NULL};
        _exit(freopen(in_place("new.txt"), "w", stdout) ? execv(words[0], words) : 127);
    }
    rest(0.3);
    shell_in_place("cp sound/run.sqlite race/");
    folder_release(&folder);
    assert_int_equal(wait_end(pid), 0);
    shell_in_place("cmp sound/run.sqlite race/run.sqlite && test -f race-2/front.csv");
}

/* The second one takes the folder, and what the first one goes on with is not mixed into its rows. */
TEST(where_the_lock_is_removed_one_of_two_processes_ends_and_the_run_is_whole)
{
    const pid_t first = start_and_wait("two");
    shell_in_place("rm two/lock");
    const pid_t second = start("slow.ini", "two");
    const int a = WEXITSTATUS(wait_end(first)), b = WEXITSTATUS(wait_end(second));
    if ((a != 0 || b != 74) && (a != 74 || b != 0))
        fail_msg("%d and %d", a, b);
    free(output_of("optimize @/two"));
    assert_same_run("slow", "two");
}

/* -- journals ------------------------------------------------------------------------------------------------------ */

TEST(a_lost_journal_is_noticed)
{
    killed_run("lost");
    shell_in_place("mv lost/run.sqlite-wal kept && cp -r lost other");
    expect_output("more evaluations were stored: run.sqlite-wal", "status @/lost");
    expect(74, "evaluations were stored, as its file `lock` says; run.sqlite has", "optimize @/lost");
    shell_in_place("mv kept lost/run.sqlite-wal");
    free(output_of("optimize @/lost"));
    assert_same_run("slow", "lost");
    shell_in_place("rm other/lock"); /* as the message says */
    free(output_of("optimize @/slow.ini --out @/other"));
    assert_same_run("slow", "other");
}

TEST(the_journal_of_another_run_stays_out_of_a_new_database)
{
    killed_run("left");
    shell_in_place("mkdir next && cp left/run.sqlite-wal left/run.sqlite-shm next");
    free(output_of("optimize @/textbook.ini --out @/next"));
    assert_same_run("sound", "next");
}

/* -- in flight ----------------------------------------------------------------------------------------------------- */

TEST(a_database_that_is_removed_in_flight_is_put_back)
{
    FOR_EACH (const char *, file, "run.sqlite", "run.sqlite-wal", "run.sqlite*") {
        const pid_t pid = start_and_wait("flight");
        shell_in_place("rm flight/%s", *file);
        const int status = wait_end(pid);
        FREED char *said = read_in_place("said");
        if (!WIFEXITED(status) || WEXITSTATUS(status) != 74 || !strstr(said, "the same command resumes the run"))
            fail_msg("%s: %x: %s", *file, status, said);
        free(output_of("optimize @/flight"));
        assert_same_run("slow", "flight");
        shell_in_place("rm -r flight");
    }
}

TEST(another_database_in_the_place_of_a_run_ends_it)
{
    const pid_t pid = start_and_wait("taken");
    shell_in_place("cp sound/run.sqlite taken/new && mv taken/new taken/run.sqlite");
    const int status = wait_end(pid);
    FREED char *said = read_in_place("said");
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 74 || !strstr(said, "another file took its place"))
        fail_msg("%x: %s", status, said);
}

/* -- bits ---------------------------------------------------------------------------------------------------------- */

TEST(a_damaged_state_gives_way_to_its_copy_with_the_same_end_also_where_there_is_more_to_do)
{
    Said said;
    static const char FURTHER[] = "optimize @/%s --max-evals 60";
    shell_in_place("cp -r sound whole && cp -r sound damaged && cp -r sound hopeless");
    change_database("damaged/run.sqlite", "UPDATE state SET bytes = zeroblob(length(bytes)) WHERE copy = 1");
    change_database("hopeless/run.sqlite", "UPDATE state SET bytes = zeroblob(length(bytes))");
    run(&said, FURTHER, "whole");
    assert_int_equal(said.code, 0);
    forget(&said);
    free(output_of("status @/damaged"));
    run(&said, FURTHER, "damaged");
    if (said.code != 0)
        fail_msg("%d: %s", said.code, said.err);
    forget(&said);
    assert_same_run("whole", "damaged");
    free(output_of("status @/hopeless"));
    run(&said, FURTHER, "hopeless");
    if (said.code != 74 || !strstr(said.err, "the state of the search is damaged"))
        fail_msg("%d: %s", said.code, said.err);
    forget(&said);
}

/* One bit of the statement that made a table: SQLite takes the column for another one. */
TEST(a_bit_in_the_text_of_a_table_is_found)
{
    char path[PATH_MAX], bytes[8192];
    static const char WORDS[] = "PRIMARY KEY, entered";
    shell_in_place("cp -r sound bit");
    FILE *f = opened(path_of("bit/run.sqlite", path), "r+b");
    const size_t n = fread(bytes, 1, sizeof bytes, f);
    const char *at = memmem(bytes, n, WORDS, strlen(WORDS));
    assert_non_null(at);
    assert_int_equal(fseek(f, at - bytes, SEEK_SET), 0);
    fputc('P' ^ 4, f);
    assert_int_equal(fclose(f), 0);
    expect(74, "its table front is not that of this run", "export @/bit --csv -");
    expect(74, "its table front is not that of this run", "optimize @/bit --max-evals 50");
}

TEST(a_damaged_run_says_what_its_tables_still_know_and_another_begins_with_it)
{
    FREED char *advice = formatted("; --new --set search.start=%s/hurt/front.csv begins another run", place.folder);
    shell_in_place("cp -r sound hurt");
    change_database("hurt/run.sqlite", "UPDATE evaluation SET f1 = 0 WHERE id = 2");
    expect(74, advice, "status @/hurt");
    expect(74, advice, "optimize @/hurt");
    expect(74, advice, "optimize @/hurt --max-evals 60"); /* read while the search is built of it */
    shell_in_place("dd if=/dev/zero of=hurt/run.sqlite bs=4096 count=1 conv=notrunc status=none"); /* the first page */
    expect(74, advice, "status @/hurt");
    shell_in_place("rm hurt/run.sqlite* && touch hurt/run.sqlite");
    expect(74, advice, "export @/hurt --csv -");
    free(output_of("optimize @/textbook.ini --new --out @/hurt --set search.start=%s/hurt/front.csv --max-evals 60",
                   place.folder));
    FREED char *all = all_of("hurt-2");
    write_in_place("all.csv", all);
    shell_in_place(
        "cut -d, -f2-7 sound/front.csv | tail -n +2 | head -5 > was; cut -d, -f6-11 all.csv | tail -n +2 | head -5 | "
        "diff was -");
    shell_in_place("rm hurt/front.csv");
    expect(74, "is empty, no database of a run; remove it and `lock`, and the run begins again", "status @/hurt");
    shell_in_place("rm hurt/run.sqlite hurt/lock");
    free(output_of("optimize @/textbook.ini --out @/hurt"));
    assert_same_run("sound", "hurt");
}

static void make_sound(void)
{
    write_in_place("textbook.ini", TEXTBOOK);
    write_in_place("slow.ini", SLOW);
    free(output_of("optimize @/textbook.ini --out @/sound"));
    free(output_of("optimize @/slow.ini --out @/slow"));
}

SUITE_FILLED(prepare, make_sound, clear_place)
