#include "evaluate/isolated.h"

#include <sys/wait.h>
#include <unistd.h>

/* The child: an order after the other, until nobody sends any. */
static void serve(void *self, size_t worker)
{
    const Isolated *q = self;
    const size_t size = order_bytes(1, q->doer.n_var);
    Order *order = malloc(size);
    FILE *in = fdopen(STDIN_FILENO, "r"), *out = fdopen(STDOUT_FILENO, "w");
    while (order && in && out && fread(order, size, 1, in) == 1) {
        size_t n_bytes;
        Answer *a = order_do(order, worker, &q->doer, &n_bytes);
        if (!a || fwrite(a, n_bytes, 1, out) != 1 || fflush(out) != 0)
            break;
        free(a);
    }
    free(order);
}

static size_t write_order(void *self, const Worker *w, char *request)
{
    return order_write((void *)request, w, ((const Isolated *)self)->doer.n_var);
}

/* An answer comes whole or not at all; its length says of how many tasks it is. */
static void look(void *, Worker *w)
{
    const Answer *a = (const void *)w->line;
    const size_t n_line = w->n_line;
    if (n_line < sizeof *a || n_line < sizeof *a + (a->n_done > 0 ? w->task->size : 0))
        return;
    w->n_line = 0;
    if (!order_take(a, n_line, w))
        pool_settle(w, OUTCOME_GARBLED, 1, "its process answered what is no answer");
}

static void tell(void *self, Worker *w, Outcome, const char *)
{
    char words[REASON_MAX];
    snprintf(words, sizeof words, "its process ended: %s",
             WIFSIGNALED(w->how) ? strsignal(WTERMSIG(w->how)) : "no answer");
    ((const Isolated *)self)->lost(&w->task[w->n_done], words);
}

Status isolated_open(Isolated *q, size_t n_workers, Err *err)
{
    const Protocol protocol = {.name = "run.isolate",
                               .work = {.serve = serve, .self = q},
                               .request_bytes = order_bytes(1, q->doer.n_var),
                               .timeout_s = INFINITY,
                               .grace_s = PROCESS_GRACE_S,
                               .write = write_order,
                               .look = look,
                               .tell = tell,
                               .self = q};
    return pool_open(&q->pool, &protocol, n_workers, err);
}
