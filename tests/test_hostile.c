/* OpenSees models that wait, fill the memory, crash Tcl or reach for files: each is refused within seconds, and its caller
 * goes on. */
#include "program.h"

#include <limits.h>
#include <sys/resource.h>

#include "scene/opensees.h"

#define HEAD "model b -ndm 2 -ndf 3\nnode 1 0 0\nnode 2 0 1\n"

/* HERE stands for the folder of the models; says: of the refusal, beside the file. */
static const struct {
    const char *text, *says;
} HOSTILE[] = {
    {"source 00.tcl\n", "source each other"},
    {"proc f {} { source 01.tcl }\nf\n", "source each other"},
    {"set x a; while 1 {append x $x}\n", "more than"},
    {"binary format a2000000000 x\n", "more than"},
    {HEAD "string repeat x 2000000000\n", ":4: "},
    {"set x [lrepeat 500000000 [lrepeat 10 a]]\n", "more than"},
    {"set x 1\n\nset l a; for {set i 0} {$i < 60} {incr i} {set l [list $l $l]}; string length $l\n", ":3: "},
    {"format %2000000000d 1\n", ":1: "},
    {"regexp {(a*)*b} [string repeat a 5000]; expr {7**900000000}\n", ":1: "},
    {"expr {3**100000000}\n", ":1: takes more than 10 s"},
    {"\n\n\nwhile 1 {}\n", ":4: takes more than"},
    {"for {set i 0} {1} {incr i} {set x $i}\n", "takes more than"},
    {"proc f {} {while 1 {}}\nf\n", ":2: takes more than"},
    {"for {set i 0} {1} {incr i} {catch {error x}}\n", "takes more than"},
    {HEAD "for {set i 3} {1} {incr i} {node $i 0 $i}\n", "takes more than"},
    {"lassign [chan pipe] r w; gets $r\n", ":1: 'chan' is not among"},
    {"fcopy stdin stdout\n", ":1: 'fcopy' is not among"},
    {"gets stdin\n", ":1: can not find channel"},
    {"read stdin\n", ":1: can not find channel"},
    {"after 100000\n", ":1: 'after' is not among"},
    {"vwait forever\n", ":1: 'vwait' is not among"},
    {"socket localhost 80\n", ":1: 'socket' is not among"},
    {"exec true\n", ":1: 'exec' is not among"},
    {"open |true\n", ":1: open: "},
    {"open /etc/passwd\n", ":1: open: /etc/passwd is not below the folder of the model"},
    {"open ../up.txt\n", ":1: open: ../up.txt is not below the folder of the model"},
    {"open link.txt\n", ":1: open: link.txt is not below the folder of the model"},
    {"source fifo.tcl\n", ":1: source: fifo.tcl is not below the folder of the model"},
    {"open fifo.tcl\n", ":1: open: fifo.tcl is not below the folder of the model"},
    {"cd /\n", ":1: cd: / is not below the folder of the model"},
    {"cd ..\n", ":1: cd: .. is not below the folder of the model"},
    {"set f [open out.txt w]; puts $f x; close $f\nfile delete 00.tcl\nfile exists /etc/passwd\nsource nowhere.tcl\n",
     ":4: source: nowhere.tcl: there is no such file"},
    {"interp create x\n", ":1: 'interp' is not among"},
    {"load libc.so.6\n", "holds no element"},
    {"glob *\n", ":1: 'glob' is not among"},
    {"package require Thread\n", ":1: "},
    {"rename node {}\nrename info {}\nrename unknown {}\nnode 1 0 0\n", "is not among"},
    {"namespace delete ::\nnode 1 0 0\n", ""},
    {"proc f {} {f}\nf\n", ":2: too many nested evaluations"},
    {"proc unknown args {eval $args}\nfoo\n", "too many nested evaluations"},
    {"trace add variable x write {apply {args {incr ::x}}}\nset x 1\nset y $z\n", "z\": no such variable"},
    {"coroutine c apply {{} {while 1 {yield}}}; while 1 {c}\n", "takes more than"},
    {"node [string repeat 1 1000000] 0 0\n", ":1: node: "},
    {"eval [string repeat \\[ 300000]\n", ":1: "},
    {"expr [string repeat ( 300000]1[string repeat ) 300000]\n", "holds no element"},
    {HEAD "fix 1 1 1 1\nequalDOF 1 2 1\nequalDOF 2 1 1\n", ":6: equalDOF: node 1 and node 2 are one"},
    {HEAD "set s [socket -server x 0]\n", ":4: 'socket' is not among"}};
enum { N_HOSTILE = sizeof HOSTILE / sizeof HOSTILE[0] };

static Status read_model(const char *path, Err *why)
{
    OWNED(frame_free) Frame f;
    return opensees_read(&f, path, 1, 1, 0, why);
}

TEST(forty_hostile_models_are_refused_with_their_line_and_leave_the_caller_alone)
{
    static Err errors[N_HOSTILE];
    char path[PATH_MAX];
    FREED char *folder = in_place("models"), *fifo = in_place("models/fifo.tcl"), *link = in_place("models/link.txt");
    assert_int_equal(mkdir(folder, 0777), 0);
    assert_int_equal(mkfifo(fifo, 0777), 0);
    assert_int_equal(symlink("/etc/passwd", link), 0);
    write_in_place("up.txt", "x\n");
    for (int i = 0; i < N_HOSTILE; i++)
        write_in_place(brief("models/%02d.tcl", i), HOSTILE[i].text);
    const double begin = clock_seconds();
#pragma omp parallel for schedule(dynamic) num_threads(4) private(path)
    for (int i = 0; i < N_HOSTILE; i++) {
        snprintf(path, sizeof path, "%s/%02d.tcl", folder, i);
        read_model(path, &errors[i]);
    }
    for (int i = 0; i < N_HOSTILE; i++) {
        snprintf(path, sizeof path, "%s/%02d.tcl", folder, i);
        if (errors[i].code != STATUS_BAD_DATA || strncmp(errors[i].text, folder, strlen(folder)) != 0 ||
            !strstr(errors[i].text, HOSTILE[i].says))
            fail_msg("%d: %s\n  said: %s\n  wanted: %s", i, HOSTILE[i].text, errors[i].text, HOSTILE[i].says);
    }
    assert_less(clock_seconds() - begin, 12.0 * N_HOSTILE / 4);
    assert_int_equal(access(fifo, F_OK), 0);
    snprintf(path, sizeof path, "%s/out.txt", folder);
    assert_int_equal(access(path, F_OK), -1); /* what a model writes goes nowhere */
}

/* Brackets in brackets; a model that is a device, a pipe or a folder, by a link too. */
TEST(files_that_are_no_models_are_refused)
{
    FREED char *text = malloc(50020);
    memset(text, '[', 50000);
    memcpy(text, "set x ", 6);
    strcpy(text + 50000, "\n");
    char *deep = in_place("deep.tcl"), *zero = in_place("zero.tcl"), *pipe = in_place("pipe.tcl"),
         *folder = in_place("folder.tcl");
    write_in_place("deep.tcl", text);
    assert_int_equal(symlink("/dev/zero", zero), 0);
    assert_int_equal(mkfifo(pipe, 0777), 0);
    assert_int_equal(mkdir(folder, 0777), 0);
    assert_refused(read_model(deep, &err), STATUS_BAD_DATA, "deep.tcl:1: brackets in brackets, more than 200 deep");
    char *const others[] = {zero, pipe, folder};
    for (int i = 0; i < 3; i++) {
        err = (Err){0};
        assert_true(read_model(others[i], &err) != STATUS_OK);
        assert_non_null(strstr(err.text, others[i]));
        free(others[i]);
    }
    free(deep);
}

/* The server reads a model again for a design that is asked for; nothing of the program changes by a model. */
TEST(a_model_changes_neither_locale_nor_signals_nor_limits_of_its_caller)
{
    struct rlimit before, after;
    write_in_place("bad.tcl", "set x a; while 1 {append x $x}\n");
    err = (Err){0};
    getrlimit(RLIMIT_AS, &before);
    assert_int_equal(read_model(there("bad.tcl"), &err), STATUS_BAD_DATA);
    getrlimit(RLIMIT_AS, &after);
    assert_true(before.rlim_cur == after.rlim_cur);
    expect(65, "bad.tcl:1: ", "building @/bad.tcl --set building.units=N_m_kg");
}

SUITE(make_place, clear_place)
