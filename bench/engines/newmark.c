/* Newmark's family, mode by mode, contact forces by Newton:
 *
 *   q1 = q + h q' + h^2 ((1/2 - beta) a + beta a1),   q1' = q' + h ((1 - gamma) a + gamma a1)
 *   (1 - am) a1 + am a + 2 zeta w q'_{1-af} + w^2 q_{1-af} = P_{1-af},      x_{1-af} = (1 - af) x1 + af x
 *
 *   newmark   beta = 1/4, gamma = 1/2, am = af = 0: average acceleration
 *   hht       generalised alpha, spectral radius 0.8 at infinity. J. Chung and G. M. Hulbert, J. Appl. Mech. 60 (1993)
 *             371-375
 *   central   beta = 0, gamma = 1/2, am = af = 0: central differences; forces from q1 and the velocity predicted there
 */
#include <string.h>

#include "base/clones.h"
#include "bench/engines/implicit.h"
#include "bench/engines/engines.h"
#include "bench/engines/fixed_step.h"

typedef struct {
    double beta, gamma, am, af;
    double D[MODES_MAX];                         /* (1 - am) + (1 - af) (2 zeta w gamma h + w^2 beta h^2) */
    double a[MODES_MAX];                         /* the scheme's acceleration at the start of the step */
    double load[MODES_MAX];                      /* P there */
    double q_free[MODES_MAX], v_free[MODES_MAX]; /* q*, v*: without a1 */
    double a_free[MODES_MAX];                    /* a1 without the contacts at the end of the step */
    int started;
    Implicit contacts; /* unused by central */
} Newmark;

static void prepare(const FixedStep *m, void *work)
{
    Newmark *k = work;
    const SimModel *model = m->model;
    const double h = m->h;
    for (int i = 0; i < model->m; i++) {
        const double w = model->omega[i];
        k->D[i] = (1 - k->am) + (1 - k->af) * (2 * model->zeta[i] * w * k->gamma * h + w * w * k->beta * h * h);
    }
    for (int j = 0; j < k->contacts.N; j++)
        for (int l = 0; l < k->contacts.N; l++) {
            double sum = 0;
            for (int i = 0; i < model->m; i++)
                sum += model->R[i * model->n_pad + j] * model->R[i * model->n_pad + l] / k->D[i];
            k->contacts.A[l * model->n + j] = k->beta * h * h * (1 - k->af) * sum;
            k->contacts.B[l * model->n + j] = k->gamma * h * (1 - k->af) * sum;
        }
}

/* Everything that the step's start and the ground decide. */
CLONED static void predict(Newmark *k, const FixedStep *m, double a0, double a1)
{
    const SimModel *model = m->model;
    const double h = m->h, now = 1 - k->af;
    for (int i = 0; i < model->m; i++) {
        const double w = model->omega[i], b = 2 * model->zeta[i] * w, ground = -model->gamma[i] * a1;
        const double q = m->q[i] + h * m->v[i] + h * h * (0.5 - k->beta) * k->a[i];
        const double v = m->v[i] + h * (1 - k->gamma) * k->a[i];
        k->load[i] = m->contact[i] - model->gamma[i] * a0;
        k->q_free[i] = q;
        k->v_free[i] = v;
        k->a_free[i] = (now * ground + k->af * k->load[i] - k->am * k->a[i] - b * (k->af * m->v[i] + now * v) -
                        w * w * (k->af * m->q[i] + now * q)) /
                       k->D[i];
    }
}

/* q, q' and a at the end, when the contacts there push with the modal forces g. */
CLONED static void finish(Newmark *k, FixedStep *m, const double g[])
{
    const double h = m->h, now = 1 - k->af;
    for (int i = 0; i < m->model->m; i++) {
        k->a[i] = k->a_free[i] + now * g[i] / k->D[i];
        m->q[i] = k->q_free[i] + h * h * k->beta * k->a[i];
        m->v[i] = k->v_free[i] + h * k->gamma * k->a[i];
    }
}

static void start(Newmark *k, const FixedStep *m, double a0)
{
    for (int i = 0; i < m->model->m && !k->started; i++)
        k->a[i] = -m->model->gamma[i] * a0;
    k->started = 1;
}

static int advance_implicit(FixedStep *m, double a0, double a1, void *work)
{
    Newmark *k = work;
    Implicit *x = &k->contacts;
    const SimModel *model = m->model;
    double g[MODES_MAX] = {0}, w[FLOORS_MAX], wd[FLOORS_MAX];
    start(k, m, a0);
    predict(k, m, a0, a1);
    if (model->nc > 0) {
        double q[MODES_MAX], v[MODES_MAX];
        for (int i = 0; i < model->m; i++) {
            q[i] = k->q_free[i] + m->h * m->h * k->beta * k->a_free[i];
            v[i] = k->v_free[i] + m->h * k->gamma * k->a_free[i];
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

static int advance_central(FixedStep *m, double a0, double a1, void *work)
{
    Newmark *k = work;
    double v[MODES_MAX], g[MODES_MAX];
    start(k, m, a0);
    predict(k, m, a0, a1);
    for (int i = 0; i < m->model->m; i++)
        v[i] = m->v[i] + m->h * k->a[i];
    fixed_step_forces(m, k->q_free, v, g);
    finish(k, m, g);
    return 1;
}

static Status run(const FixedStepMethod *method, double beta, double gamma, double am, double af, const SimModel *model,
                  const Motion *motion, const EngineOptions *options, SimResult *result, Err *err)
{
    Newmark k = {.beta = beta, .gamma = gamma, .am = am, .af = af};
    Status status = STATUS_OK;
    if (beta > 0)
        status = implicit_create(&k.contacts, model->n, 1, err);
    if (status == STATUS_OK)
        status = fixed_step_run(method, &k, model, motion, options, result);
    implicit_free(&k.contacts);
    return status;
}

static const FixedStepMethod IMPLICIT = {{5e-4, 1e-4, 2e-5}, 0.5, 0.5, prepare, advance_implicit};
static const FixedStepMethod EXPLICIT = {{1e-4, 5e-5, 1e-5}, 0.5, 0.5, prepare, advance_central};

Status engine_newmark(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                      Err *err)
{
    return run(&IMPLICIT, 0.25, 0.5, 0, 0, model, motion, options, result, err);
}

Status engine_hht(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                  Err *err)
{
    const double radius = 0.8, am = (2 * radius - 1) / (radius + 1), af = radius / (radius + 1);
    const double beta = 0.25 * (1 - am + af) * (1 - am + af), gamma = 0.5 - am + af;
    return run(&IMPLICIT, beta, gamma, am, af, model, motion, options, result, err);
}

Status engine_central(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                      Err *err)
{
    return run(&EXPLICIT, 0, 0.5, 0, 0, model, motion, options, result, err);
}
