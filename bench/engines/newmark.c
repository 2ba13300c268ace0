/* Newmark's average acceleration, mode by mode, contact forces by Newton:
 *
 *   q1 = q + h q' + h^2 (a + a1)/4,   q1' = q' + h (a + a1)/2,   a1 + 2 zeta w q1' + w^2 q1 = P1 */
#include <string.h>

#include "base/clones.h"
#include "bench/engines/implicit.h"
#include "bench/engines/engines.h"
#include "bench/engines/fixed_step.h"

static const double BETA = 0.25;

typedef struct {
    double D[MODES_MAX];                         /* 1 + zeta w h + w^2 h^2 / 4 */
    double a[MODES_MAX];                         /* the scheme's acceleration at the start of the step */
    double q_free[MODES_MAX], v_free[MODES_MAX]; /* q*, v*: without a1 */
    double a_free[MODES_MAX];                    /* a1 without the contacts at the end of the step */
    int started;
    Implicit contacts;
} Newmark;

static void prepare(const FixedStep *m, void *work)
{
    Newmark *k = work;
    const SimModel *model = m->model;
    const double h = m->h;
    for (int i = 0; i < model->m; i++) {
        const double w = model->omega[i];
        k->D[i] = 1 + model->zeta[i] * w * h + w * w * BETA * h * h;
    }
    for (int j = 0; j < k->contacts.N; j++)
        for (int l = 0; l < k->contacts.N; l++) {
            double sum = 0;
            for (int i = 0; i < model->m; i++)
                sum += model->R[i * model->n_pad + j] * model->R[i * model->n_pad + l] / k->D[i];
            k->contacts.A[l * model->n + j] = BETA * h * h * sum;
            k->contacts.B[l * model->n + j] = 0.5 * h * sum;
        }
}

/* Everything that the step's start and the ground decide. */
CLONED static void predict(Newmark *k, const FixedStep *m, double a1)
{
    const SimModel *model = m->model;
    const double h = m->h;
    for (int i = 0; i < model->m; i++) {
        const double w = model->omega[i];
        const double q = m->q[i] + h * m->v[i] + h * h * (0.5 - BETA) * k->a[i];
        const double v = m->v[i] + 0.5 * h * k->a[i];
        k->q_free[i] = q;
        k->v_free[i] = v;
        k->a_free[i] = (-model->gamma[i] * a1 - 2 * model->zeta[i] * w * v - w * w * q) / k->D[i];
    }
}

/* q, q' and a at the end, when the contacts there push with the modal forces g. */
CLONED static void finish(Newmark *k, FixedStep *m, const double g[])
{
    const double h = m->h;
    for (int i = 0; i < m->model->m; i++) {
        k->a[i] = k->a_free[i] + g[i] / k->D[i];
        m->q[i] = k->q_free[i] + h * h * BETA * k->a[i];
        m->v[i] = k->v_free[i] + 0.5 * h * k->a[i];
    }
}

static void start(Newmark *k, const FixedStep *m, double a0)
{
    for (int i = 0; i < m->model->m && !k->started; i++)
        k->a[i] = -m->model->gamma[i] * a0;
    k->started = 1;
}

static int advance(FixedStep *m, double a0, double a1, void *work)
{
    Newmark *k = work;
    Implicit *x = &k->contacts;
    const SimModel *model = m->model;
    double g[MODES_MAX] = {0}, w[FLOORS_MAX], wd[FLOORS_MAX];
    start(k, m, a0);
    predict(k, m, a1);
    if (model->nc > 0) {
        double q[MODES_MAX], v[MODES_MAX];
        for (int i = 0; i < model->m; i++) {
            q[i] = k->q_free[i] + m->h * m->h * BETA * k->a_free[i];
            v[i] = k->v_free[i] + 0.5 * m->h * k->a_free[i];
        }
        floors_from_modes(model, 0, model->m, q, w);
        floors_from_modes(model, 0, model->m, v, wd);
        memcpy(x->w_free, w, sizeof *w * (size_t)model->n);
        memcpy(x->wd_free, wd, sizeof *wd * (size_t)model->n);
        if (!implicit_solve(x, &m->contacts)) {
            m->trouble = "Newton's iteration for the contact forces did not converge";
            return 0;
        }
        for (int j = 0; j < model->n; j++)
            for (int i = 0; i < model->m && x->f[j] != 0; i++)
                g[i] += x->f[j] * model->RT[(size_t)j * (size_t)model->m_pad + (size_t)i];
    }
    finish(k, m, g);
    return 1;
}

Status engine_newmark(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                      Err *err)
{
    static const FixedStepMethod METHOD = {{5e-4, 1e-4, 2e-5}, 0.5, 0.5, prepare, advance};
    Newmark k = {0};
    Status status = implicit_create(&k.contacts, model->n, 1, err);
    THEN(status, fixed_step_run(&METHOD, &k, model, motion, options, result));
    implicit_free(&k.contacts);
    return status;
}
