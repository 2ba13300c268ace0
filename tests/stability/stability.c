/* stability -- where methods fail: every engine is put through every case, and the outcome is a table.
 *
 *   stability [--quick | --long] [--engine NAME] [--case NAME] [--seconds N] [--out FILE.md]
 *   stability --laws [--out FILE.md] [--csv FILE.csv]
 *
 * Exit 1 when an engine answers wrongly in silence, or when the engine `fast` does anything but hold. Each cell runs in
 * a process of its own: a crash is a failure of that cell, and no answer in time is a refusal. */
#include "laws.h"
#include "trial.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { CASES_MAX = 64 };

typedef struct {
    TrialSize size;
    const char *engine, *one_case, *out, *csv;
    unsigned seconds;
    int laws;
} Arguments;

typedef struct {
    Trial trial[CASES_MAX][ENGINE_COUNT];
    const Case *cases[CASES_MAX];
    const char *group[CASES_MAX]; /* of the first case of a group, else NULL */
    int n;
} Board;

static const char *const WORDS[VERDICTS] = {
    [HOLDS] = "holds", [FLAGGED] = "flagged", [REFUSED] = "refused", [FAILED] = "**FAILS**"};

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void run_here(const Case *c, Trial *t, int to, unsigned seconds)
{
    setrlimit(RLIMIT_CPU, &(struct rlimit){.rlim_cur = seconds, .rlim_max = seconds + 5});
    c->run(t);
    const ssize_t sent = write(to, t, sizeof *t);
    _exit(sent == (ssize_t)sizeof *t ? 0 : 1);
}

static int receive(int from, Trial *t)
{
    size_t got = 0;
    while (got < sizeof *t) {
        const ssize_t n = read(from, (char *)t + got, sizeof *t - got);
        if (n <= 0 && errno != EINTR)
            break;
        got += n > 0 ? (size_t)n : 0;
    }
    return got == sizeof *t;
}

typedef struct {
    pid_t child;
    int from; /* where its answer comes */
    int i, e; /* which cell */
    double start;
} Worker;

static Worker start_cell(const Case *c, Trial *t, unsigned seconds)
{
    int ends[2];
    Worker w = {.start = seconds_now()};
    fflush(NULL);
    if (pipe(ends) != 0 || (w.child = fork()) < 0) {
        perror("stability: no process");
        exit(70);
    }
    if (w.child == 0) {
        close(ends[0]);
        run_here(c, t, ends[1], seconds);
    }
    close(ends[1]);
    w.from = ends[0];
    return w;
}

/* Its answer, or why there is none. */
static void finish_cell(const Worker *w, int state, Trial *t, unsigned seconds)
{
    Trial answer;
    errno = 0;
    const int answered = receive(w->from, &answer);
    close(w->from);
    t->any = 1;
    t->figure = NAN;
    if (answered) {
        *t = answer;
    } else if (WIFSIGNALED(state) && WTERMSIG(state) == SIGXCPU) {
        t->verdict = REFUSED;
        snprintf(t->how, sizeof t->how, "no answer in %u s of processor time", seconds);
    } else {
        t->verdict = FAILED;
        snprintf(t->how, sizeof t->how, "the process ended without an answer (%s %d)",
                 WIFSIGNALED(state) ? "signal" : "status", WIFSIGNALED(state) ? WTERMSIG(state) : WEXITSTATUS(state));
    }
}

static void gather(Board *b, const CaseGroup *group, const Arguments *a)
{
    int first = 1;
    for (int i = 0; i < group->n && b->n < CASES_MAX; i++) {
        const Case *c = &group->cases[i];
        if (a->one_case && strcmp(a->one_case, c->name) != 0)
            continue;
        b->cases[b->n] = c;
        b->group[b->n++] = first ? group->title : NULL;
        first = 0;
    }
}

static int is_wrong(const Trial *t)
{
    return t->any && (t->verdict == FAILED || (t->engine == ENGINE_FAST && t->verdict != HOLDS));
}

static void print_cell(const Case *c, const Trial *t, double seconds)
{
    if (!t->any)
        return;
    printf("%-26s %-19s %-9s %9.2e %6.1f s  %s\n", c->name, trial_engine(t)->name, WORDS[t->verdict], t->figure,
           seconds, t->how);
    if (t->remark[0])
        printf("%-26s   %s\n", "", t->remark);
}

/* `fast` must answer every case, however slowly it was built; the limit is there for the others. */
static unsigned cell_seconds(const Arguments *a, const Trial *t)
{
    enum { PATIENCE = 120 };
    return t->engine == ENGINE_FAST && a->seconds < PATIENCE ? PATIENCE : a->seconds;
}

/* Waits for one of the workers; 1 when its answer is wrong. */
static int reap(Board *b, Worker workers[], int *n, const Arguments *a)
{
    int state = 0, k = 0;
    const pid_t child = wait(&state);
    while (k < *n && workers[k].child != child)
        k++;
    if (k == *n)
        return 0;
    const Worker w = workers[k];
    Trial *t = &b->trial[w.i][w.e];
    workers[k] = workers[--*n];
    finish_cell(&w, state, t, cell_seconds(a, t));
    print_cell(b->cases[w.i], t, seconds_now() - w.start);
    return is_wrong(t);
}

static int run_board(Board *b, const Arguments *a)
{
    enum { WORKERS_MAX = 64 };
    Worker workers[WORKERS_MAX];
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    const int most = processors < 1 ? 1 : processors > WORKERS_MAX ? WORKERS_MAX : (int)processors;
    int wrong = 0, n = 0;
    for (int i = 0; i < b->n; i++)
        for (int e = 0; e < ENGINE_COUNT; e++) {
            Trial *t = &b->trial[i][e];
            *t = (Trial){.engine = (Engine)e, .size = a->size};
            if (a->engine && strcmp(a->engine, trial_engine(t)->name) != 0)
                continue;
            if (n == most)
                wrong += reap(b, workers, &n, a);
            workers[n] = start_cell(b->cases[i], t, cell_seconds(a, t));
            workers[n].i = i;
            workers[n++].e = e;
        }
    while (n > 0)
        wrong += reap(b, workers, &n, a);
    return wrong;
}

static void write_cell(FILE *f, const Trial *t)
{
    if (!t->any)
        fprintf(f, " - |");
    else if (isnan(t->figure))
        fprintf(f, " %s |", WORDS[t->verdict]);
    else
        fprintf(f, " %s %.1e |", WORDS[t->verdict], t->figure);
}

static void write_table(FILE *f, const Board *b)
{
    for (int i = 0; i < b->n; i++) {
        if (b->group[i]) {
            fprintf(f, "\n## %s\n\n| case |", b->group[i]);
            for (int e = 0; e < ENGINE_COUNT; e++)
                fprintf(f, " %s |", engine_entry((Engine)e)->name);
            fprintf(f, "\n|---|");
            for (int e = 0; e < ENGINE_COUNT; e++)
                fprintf(f, "---|");
            fprintf(f, "\n");
        }
        fprintf(f, "| %s |", b->cases[i]->name);
        for (int e = 0; e < ENGINE_COUNT; e++)
            write_cell(f, &b->trial[i][e]);
        fprintf(f, "\n");
    }
}

static void write_notes(FILE *f, const Board *b)
{
    fprintf(f, "\n## What each case asks, and the figure in its cells\n");
    for (int i = 0; i < b->n; i++) {
        fprintf(f, "\n**%s**: %s\n\n", b->cases[i]->name, b->cases[i]->sentence);
        for (int e = 0; e < ENGINE_COUNT; e++) {
            const Trial *t = &b->trial[i][e];
            if (!t->any)
                continue;
            fprintf(f, "- %s: %s: %s", trial_engine(t)->name, WORDS[t->verdict], t->how);
            fprintf(f, t->remark[0] ? ". %s\n" : "\n", t->remark);
        }
    }
}

static void write_page(FILE *f, const Board *b, const Arguments *a)
{
    fprintf(f,
            "# Where methods fail\n\n"
            "Made by `make %s`; a part of it runs in `make test`. Every engine of `sim.engine` is put through every "
            "case, at accuracy `fine` against closed forms and an independent integrator, and at `standard`.\n\n"
            "| word | meaning |\n|---|---|\n"
            "| holds | every figure is within what the case allows; the number is the figure nearest to its bound |\n"
            "| flagged | a figure is off and the result says so: energy residual above 1e-3, or penetration beyond the "
            "contact law |\n"
            "| refused | the engine says that it cannot, or gives no answer in %u s of processor time |\n"
            "| **FAILS** | a wrong answer in silence |\n"
            "| - | the case does not apply |\n\n"
            "Fixed-step engines are given 400 steps per contact at `fine` and 40 at `standard` where masses are built "
            "by hand, else their own step. `fast` and `cvode` are held to the bounds of each accuracy, the others, "
            "which are there "
            "to be compared with, to those of `standard` and to ten times what it promises of the tower.\n",
            a->size == SIZE_LONG ? "stability-long" : "stability", a->seconds);
    write_table(f, b);
    write_notes(f, b);
}

static int stability(const Arguments *a)
{
    static Board board;
    gather(&board, &BOB_CASES, a);
    gather(&board, &TOWER_CASES, a);
    const int wrong = run_board(&board, a);
    if (a->out) {
        FILE *f = fopen(a->out, "w");
        if (!f) {
            perror(a->out);
            return 74;
        }
        write_page(f, &board, a);
        fclose(f);
    }
    printf("%d cases, %d engines: %d wrong answers in silence or cases that `fast` does not hold\n", board.n,
           a->engine ? 1 : (int)ENGINE_COUNT, wrong);
    return wrong ? 1 : 0;
}

int main(int argc, char **argv)
{
    setvbuf(stdout, NULL, _IOLBF, 0);
    Arguments a = {.size = SIZE_FULL, .seconds = 20};
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (!strcmp(argv[i], "--quick"))
            a.size = SIZE_QUICK;
        else if (!strcmp(argv[i], "--long"))
            a.size = SIZE_LONG;
        else if (!strcmp(argv[i], "--laws"))
            a.laws = 1;
        else if (value && !strcmp(argv[i], "--engine"))
            a.engine = argv[++i];
        else if (value && !strcmp(argv[i], "--case"))
            a.one_case = argv[++i];
        else if (value && !strcmp(argv[i], "--out"))
            a.out = argv[++i];
        else if (value && !strcmp(argv[i], "--csv"))
            a.csv = argv[++i];
        else if (value && !strcmp(argv[i], "--seconds"))
            a.seconds = (unsigned)strtoul(argv[++i], NULL, 10);
        else {
            fprintf(stderr, "stability: %s: see the head of tests/stability/stability.c\n", argv[i]);
            return 2;
        }
    }
    return a.laws ? laws(a.out, a.csv) : stability(&a);
}
