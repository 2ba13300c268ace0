/* Files that somebody else wrote do no harm: where a run may go, what a spreadsheet makes of a name, what is run. */
#include "program.h"

#include <dirent.h>
#include <fcntl.h>

#include "base/visible.h"
#include "store/output.h"
#include "study/output_place.h"

/* ---- places ---------------------------------------------------------------------------------------------------- */

/* In a folder of its own with results/, a link in it to somewhere else, and one to a folder beside it. */
static void go_to_a_place_of_its_own(char before[], size_t size)
{
    assert_non_null(getcwd(before, size));
    assert_int_equal(chdir(place.folder), 0);
    mkdir("results", 0777);
    mkdir("results/inside", 0777);
    mkdir("elsewhere", 0777);
    assert_same_number(symlink("/tmp", "results/out"), 0);
    assert_same_number(symlink("inside", "results/in"), 0);
    assert_same_number(symlink("elsewhere", "resultsx"), 0);
}

TEST(a_settings_file_writes_below_results_only)
{
    char before[4096];
    go_to_a_place_of_its_own(before, sizeof before);
    FOR_EACH (const char *, good, "results/study", "./results/a/b", "results/in/new", "results", "results/..a")
        CHECK_OK(output_place_check(*good, "some/where/my.ini", &err), &err);
    FOR_EACH (const char *, bad, "../../etc/x", "/etc/x", "results/../../x", "results/..", "resultsx/a", "elsewhere",
              "results/out/new", "results/out", "~/results", "./../result") {
        if (output_place_check(*bad, "some/where/my.ini", &err) != STATUS_BAD_DATA || !strstr(err.text, *bad))
            fail_msg("%s is accepted, or not named: %s", *bad, err.text);
        assert_non_null(strstr(err.text, "--out"));
    }
    assert_int_equal(chdir(before), 0);
}

TEST(a_run_may_go_on_where_its_own_settings_lie)
{
    FREED char *own = formatted("%s/kept", place.folder), *file = formatted("%s/settings.ini", own);
    assert_int_equal(mkdir(own, 0777), 0);
    CHECK_OK(output_place_check(own, file, &err), &err);
    assert_int_equal(output_place_check(place.folder, file, &err), STATUS_BAD_DATA);
}

/* ---- cells ----------------------------------------------------------------------------------------------------- */

TEST(no_text_begins_a_cell_like_a_formula)
{
    static const char *const PAIRS[][2] = {{"=cmd()", "'=cmd()"},
                                           {"+1", "'+1"},
                                           {"-x", "'-x"},
                                           {"@sum", "'@sum"},
                                           {"\t=x", " '=x"},
                                           {"  =x", "  '=x"},
                                           {"a,=b", "a;'=b"},
                                           {"a; @b", "a; '@b"},
                                           {"a=b-c", "a=b-c"},
                                           {"mass_kg", "mass_kg"},
                                           {"say \"no\"", "say  no "},
                                           {"\r\n-1", "  '-1"},
                                           {"\u00a0=x", "\u00a0'=x"},
                                           {"\u2003 \u3000\ufeff+x", "\u2003 \u3000\ufeff'+x"},
                                           {"\uff1dx", "'\uff1dx"},
                                           {"a, \uff20b", "a; '\uff20b"},
                                           {"\u00a0", "\u00a0"},
                                           {"\u00e4=\uff1d", "\u00e4=\uff1d"},
                                           {"", ""}};
    char cell[64];
    for (size_t i = 0; i < sizeof PAIRS / sizeof PAIRS[0]; i++) {
        cell_text(cell, sizeof cell, PAIRS[i][0]);
        assert_string_equal(cell, PAIRS[i][1]);
    }
    char small[4];
    cell_text(small, sizeof small, "==========");
    assert_less(strlen(small), sizeof small);
    cell_text(small, sizeof small, "\u3000\u3000=");
    assert_less(strlen(small), sizeof small);
}

/* No cell of the file begins like a formula; numbers may have a sign. */
static void demand_harmless(const char *csv)
{
    for (const char *cell = csv; *cell;) {
        const size_t n = strcspn(cell, ",\n");
        char *end;
        strtod(cell, &end);
        if (n > 0 && strchr("=+-@\t", *cell) && end != cell + n)
            fail_msg("a cell is '%.*s'", (int)n, cell);
        cell += n + (cell[n] != 0);
    }
}

TEST(names_and_reasons_of_users_are_harmless_in_every_table)
{
    static const char STUDY[] =
        "[problem]\nkind = external\ncommand = sh tests/worker.sh formula\nvariables = 2\nobjectives = 2\n"
        "variable_names = =cmd(),+x\nobjective_names = -f,@g\n[search]\ninitial = 12\npopulation = 8\nmax_evals = 12\n";
    write_in_place("formulas.ini", STUDY);
    free(output_of("optimize @/formulas.ini --out @/formulas --threads 1"));
    free(output_of("export @/formulas --csv @/front.csv"));
    free(output_of("export @/formulas --all --csv @/all.csv"));
    FREED char *front = read_in_place("front.csv"), *all = read_in_place("all.csv");
    assert_non_null(strstr(front, "id,'=cmd(),'+x,'-f,'@g\n"));
    assert_non_null(strstr(all, ",'=1+1;'=2"));
    demand_harmless(front);
    demand_harmless(all);
    free(output_of("choose @/formulas"));
}

/* ---- commands -------------------------------------------------------------------------------------------------- */

static int count_files(const char *folder)
{
    int n = 0;
    DIR *d = opendir(folder);
    assert_non_null(d);
    for (struct dirent *e; (e = readdir(d));)
        n += e->d_name[0] != '.';
    closedir(d);
    return n;
}

/* As a process leaves it that is killed before the file is whole. */
TEST(a_file_half_written_has_no_name)
{
    Output o;
    FREED char *folder = in_place("half"), *path = in_place("half/out.csv");
    assert_int_equal(mkdir(folder, 0777), 0);
    const int fd = open(folder, O_TMPFILE | O_WRONLY, 0600);
    if (fd < 0)
        skip(); /* not on this file system */
    close(fd);
    CHECK_OK(output_open(&o, path, &err), &err);
    fputs("1\n", o.stream);
    assert_int_equal(fflush(o.stream), 0);
    assert_int_equal(count_files(folder), 0);
    CHECK_OK(output_close(&o, &err), &err);
    assert_int_equal(count_files(folder), 1);
    assert_text(read_in_place("half/out.csv"), "1\n");
}

SUITE(make_place, clear_place)
