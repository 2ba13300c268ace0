#include "bench/stability/stability.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "store/output.h"

enum { CASES_MAX = 64 };

typedef struct {
    Trial trial[CASES_MAX][BENCH_ENGINES];
    const Case *cases[CASES_MAX];
    int n;
} Board;

static const char *const WORDS[VERDICTS] = {
    [HOLDS] = "holds", [FLAGGED] = "flagged", [REFUSED] = "refused", [FAILED] = "fails"};

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
    Worker w = {.start = clock_seconds()};
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

static void gather(Board *b, const CaseGroup *group, const StabilityPlan *a)
{
    for (int i = 0; i < group->n && b->n < CASES_MAX; i++)
        if (!a->one_case || strcmp(a->one_case, group->cases[i].name) == 0)
            b->cases[b->n++] = &group->cases[i];
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
static unsigned cell_seconds(const StabilityPlan *a, const Trial *t)
{
    enum { PATIENCE = 120 };
    return (unsigned)(t->engine == ENGINE_FAST && a->seconds < PATIENCE ? PATIENCE : a->seconds);
}

/* Waits for one of the workers; 1 when its answer is wrong. */
static int reap(Board *b, Worker workers[], int *n, const StabilityPlan *a)
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
    print_cell(b->cases[w.i], t, clock_seconds() - w.start);
    return is_wrong(t);
}

static int run_board(Board *b, const StabilityPlan *a)
{
    enum { WORKERS_MAX = 64 };
    Worker workers[WORKERS_MAX];
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    const int most = processors < 1 ? 1 : processors > WORKERS_MAX ? WORKERS_MAX : (int)processors;
    int wrong = 0, n = 0;
    for (int i = 0; i < b->n; i++)
        for (int e = 0; e < BENCH_ENGINES; e++) {
            Trial *t = &b->trial[i][e];
            *t = (Trial){.engine = e, .size = a->size};
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

static void write_cell(FILE *f, const Case *c, const Trial *t)
{
    fprintf(f, "%s,%s,%s,", c->name, trial_engine(t)->name, WORDS[t->verdict]);
    if (isfinite(t->figure))
        fprintf(f, "%.1e", t->figure);
    fprintf(f, ",\"%s\",\"%s\"\n", t->how, t->remark);
}

static Status write_csv(const char *path, const Board *b, Err *err)
{
    Output o;
    TRY(output_open(&o, path, err));
    fprintf(o.stream, "case,engine,verdict,figure,what,remark\n");
    for (int i = 0; i < b->n; i++)
        for (int e = 0; e < BENCH_ENGINES; e++)
            if (b->trial[i][e].any)
                write_cell(o.stream, b->cases[i], &b->trial[i][e]);
    return output_close(&o, err);
}

Status stability(const StabilityPlan *plan, Err *err)
{
    if (plan->engine && bench_engine_named(plan->engine) == BENCH_ENGINES)
        return fail(err, STATUS_USAGE, "unknown engine '%.60s'; docs/measured/stability.csv lists them", plan->engine);
    Board *board = calloc(1, sizeof *board);
    if (!board)
        return fail(err, STATUS_NO_MEMORY, "stability: out of memory");
    gather(board, &BOB_CASES, plan);
    gather(board, &TOWER_CASES, plan);
    if (board->n == 0) {
        free(board);
        return fail(err, STATUS_USAGE, "unknown case '%.60s'; docs/measured/stability.csv lists them", plan->one_case);
    }
    const int n = board->n, wrong = run_board(board, plan);
    Status status = plan->out ? write_csv(plan->out, board, err) : STATUS_OK;
    free(board);
    TRY(status);
    printf("%d cases, %d engines: %d wrong answers in silence or cases that `fast` does not hold\n", n,
           plan->engine ? 1 : (int)BENCH_ENGINES, wrong);
    return wrong ? fail(err, STATUS_INTERNAL, "%d cells are wrong", wrong) : STATUS_OK;
}
