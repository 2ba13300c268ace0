/* The exponential Runge-Kutta method of order 4 with fixed steps: the linear part of every mode flows exactly, its load
 * is a polynomial in time; all modes, no free intervals.
 *
 * S. M. Cox and P. C. Matthews, J. Comput. Phys. 176 (2002) 430-455; stages of S. Krogstad, J. Comput. Phys. 203 (2005)
 * 72-88.
 *
 * With x = t/h, a load P x^k / k! on a mode moves (q, q') by h phi_{k+1} (0, P) = (y_{k+2}, y_{k+1}) P / h^k, y_k the
 * flow integrals of sim/flow.h, which do not cancel at small w h. */
#include <string.h>

#include "sim/flow.h"
#include "base/clones.h"
#include "bench/engines/engines.h"
#include "bench/engines/fixed_step.h"

/* Per mode: the flow of (q, q') and what h phi_1, h phi_2, h phi_3 make of a load. */
typedef struct {
    double qq[MODES_MAX], qv[MODES_MAX], vq[MODES_MAX], vv[MODES_MAX];
    double q_phi[3][MODES_MAX], v_phi[3][MODES_MAX];
} Flow;

typedef struct {
    Flow whole, half;
    double qa[MODES_MAX], va[MODES_MAX], qb[MODES_MAX], vb[MODES_MAX]; /* stages */
    double load[4][MODES_MAX]; /* at the start, twice in the middle, at the end */
} Etdrk4;

static void set_flow(Flow *f, const SimModel *model, double h)
{
    for (int i = 0; i < model->m; i++) {
        double y[FLOW_INTEGRALS];
        const double w = model->omega[i], b = 2 * model->zeta[i] * w;
        flow_integrals(w, model->zeta[i], h, y);
        f->qq[i] = y[0] + b * y[1];
        f->qv[i] = y[1];
        f->vq[i] = -w * w * y[1];
        f->vv[i] = y[0];
        double power = 1;
        for (int k = 0; k < 3; k++) {
            f->q_phi[k][i] = y[k + 2] / power;
            f->v_phi[k][i] = y[k + 1] / power;
            power *= h;
        }
    }
}

static void prepare(const FixedStep *m, void *work)
{
    Etdrk4 *e = work;
    set_flow(&e->whole, m->model, m->h);
    set_flow(&e->half, m->model, 0.5 * m->h);
}

/* (q1, v1) = e^{hL} (q, v) + h phi_1 (0, A) + h phi_2 (0, B) + h phi_3 (0, C) with loads
 *     A = N_0,  B = b[0] N_0 + b[1] N_1 + b[2] N_2 + b[3] N_3,  C likewise */
CLONED static void flow(const Flow *f, int m, const double q[], const double v[], const double N[4][MODES_MAX],
                        const double b[4], const double c[4], double q1[], double v1[])
{
#pragma GCC ivdep
    for (int i = 0; i < m; i++) {
        const double A = N[0][i], B = b[0] * A + b[1] * N[1][i] + b[2] * N[2][i] + b[3] * N[3][i];
        const double C = c[0] * A + c[1] * N[1][i] + c[2] * N[2][i] + c[3] * N[3][i];
        const double q0 = q[i], v0 = v[i];
        q1[i] = f->qq[i] * q0 + f->qv[i] * v0 + f->q_phi[0][i] * A + f->q_phi[1][i] * B + f->q_phi[2][i] * C;
        v1[i] = f->vq[i] * q0 + f->vv[i] * v0 + f->v_phi[0][i] * A + f->v_phi[1][i] * B + f->v_phi[2][i] * C;
    }
}

static ContactPower set_load(FixedStep *m, const double q[], const double v[], double a, double load[])
{
    const ContactPower power = fixed_step_forces(m, q, v, load);
    for (int i = 0; i < m->model->m; i++)
        load[i] -= m->model->gamma[i] * a;
    return power;
}

static int advance(FixedStep *m, double a0, double a1, void *work)
{
    static const double NONE[4] = {0}, SECOND[4] = {-2, 2, 0, 0}, THIRD[4] = {-2, 0, 2, 0};
    static const double LINEAR[4] = {-3, 2, 2, -1}, SQUARE[4] = {4, -4, -4, 4};
    Etdrk4 *e = work;
    const int n = m->model->m;
    const double middle = 0.5 * (a0 + a1);
    for (int i = 0; i < n; i++)
        e->load[0][i] = m->contact[i] - m->model->gamma[i] * a0;
    flow(&e->half, n, m->q, m->v, e->load, NONE, NONE, e->qa, e->va);
    set_load(m, e->qa, e->va, middle, e->load[1]);
    flow(&e->half, n, m->q, m->v, e->load, SECOND, NONE, e->qb, e->vb);
    const ContactPower power = set_load(m, e->qb, e->vb, middle, e->load[2]);
    energy_account_add(&m->account, m->h * 2 / 3, e->vb, middle, &power); /* Simpson, with the driver's ends */
    flow(&e->whole, n, m->q, m->v, e->load, THIRD, NONE, e->qa, e->va);
    set_load(m, e->qa, e->va, a1, e->load[3]);
    flow(&e->whole, n, m->q, m->v, e->load, LINEAR, SQUARE, m->q, m->v);
    return 1;
}

Status engine_etdrk4(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                     Err *err)
{
    static const FixedStepMethod METHOD = {{1e-3, 2e-4, 2e-5}, 1 / 6.0, 1 / 6.0, prepare, advance};
    Etdrk4 work = {0};
    (void)err;
    return fixed_step_run(&METHOD, &work, model, motion, options, result);
}
