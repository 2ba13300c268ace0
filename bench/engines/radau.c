/* Radau IIA with three stages, order 5, fixed step; the linear part of every mode is solved once for all, the contact
 * forces of the three stages together by Newton.
 *
 *   Q = 1 q + h A V,   V = 1 q' + h A (P - 2 zeta w V - w^2 Q)       A the method's matrix, 1 = (1,1,1), A 1 = c
 *   V = S (1 q' - w^2 h c q + h A P),   S = (I + 2 zeta w h A + w^2 h^2 A^2)^-1
 *
 * The third stage is the end of the step. E. Hairer and G. Wanner, Solving Ordinary Differential Equations II (1996),
 * table IV.5.6. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/clones.h"
#include "bench/engines/implicit.h"
#include "bench/engines/engines.h"
#include "bench/engines/fixed_step.h"

enum { S = 3 };

typedef struct {
    double c[S], A[S][S];
    double Qq[S][MODES_MAX], Qv[S][MODES_MAX], QP[S][S][MODES_MAX]; /* stage Q of q, q' and the stages' loads */
    double Vq[S][MODES_MAX], Vv[S][MODES_MAX], VP[S][S][MODES_MAX];
    double q[S][MODES_MAX], v[S][MODES_MAX], load[S][MODES_MAX]; /* stages */
    Implicit contacts;
} Radau;

static void set_method(Radau *r)
{
    const double s = sqrt(6);
    const double c[S] = {(4 - s) / 10, (4 + s) / 10, 1};
    const double A[S][S] = {{(88 - 7 * s) / 360, (296 - 169 * s) / 1800, (-2 + 3 * s) / 225},
                            {(296 + 169 * s) / 1800, (88 + 7 * s) / 360, (-2 - 3 * s) / 225},
                            {(16 - s) / 36, (16 + s) / 36, 1.0 / 9}};
    memcpy(r->c, c, sizeof c);
    memcpy(r->A, A, sizeof A);
}

static void invert(const double M[S][S], double inverse[S][S])
{
    double det = 0;
    for (int i = 0; i < S; i++)
        for (int j = 0; j < S; j++) {
            const int a = (i + 1) % S, b = (i + 2) % S, c = (j + 1) % S, d = (j + 2) % S;
            inverse[j][i] = M[a][c] * M[b][d] - M[a][d] * M[b][c];
            det += i == 0 ? M[0][j] * inverse[j][0] : 0;
        }
    for (int i = 0; i < S; i++)
        for (int j = 0; j < S; j++)
            inverse[i][j] /= det;
}

/* C = A B */
static void multiply(const double A[S][S], const double B[S][S], double C[S][S])
{
    for (int i = 0; i < S; i++)
        for (int j = 0; j < S; j++) {
            C[i][j] = 0;
            for (int k = 0; k < S; k++)
                C[i][j] += A[i][k] * B[k][j];
        }
}

static void set_mode(Radau *r, int i, double w, double zeta, double h)
{
    double square[S][S], M[S][S], inverse[S][S], load[S][S], twice[S][S];
    multiply(r->A, r->A, square);
    for (int a = 0; a < S; a++)
        for (int b = 0; b < S; b++)
            M[a][b] = (a == b) + 2 * zeta * w * h * r->A[a][b] + w * w * h * h * square[a][b];
    invert(M, inverse);
    multiply(inverse, r->A, load);
    multiply(r->A, load, twice);
    for (int a = 0; a < S; a++) {
        r->Vq[a][i] = r->Vv[a][i] = 0;
        for (int b = 0; b < S; b++) {
            r->Vv[a][i] += inverse[a][b];
            r->Vq[a][i] -= w * w * h * inverse[a][b] * r->c[b];
            r->VP[a][b][i] = h * load[a][b];
            r->QP[a][b][i] = h * h * twice[a][b];
        }
    }
    for (int a = 0; a < S; a++) {
        r->Qq[a][i] = 1;
        r->Qv[a][i] = 0;
        for (int b = 0; b < S; b++) {
            r->Qq[a][i] += h * r->A[a][b] * r->Vq[b][i];
            r->Qv[a][i] += h * r->A[a][b] * r->Vv[b][i];
        }
    }
}

/* The answer of w and w' at stage a to forces at stage b. */
static void set_contacts(Radau *r, const SimModel *model, int a, int b)
{
    Implicit *x = &r->contacts;
    for (int j = 0; j < model->n; j++)
        for (int l = 0; l < model->n; l++) {
            double w = 0, wd = 0;
            for (int i = 0; i < model->m; i++) {
                const double both = model->R[i * model->n_pad + j] * model->R[i * model->n_pad + l];
                w += both * r->QP[a][b][i];
                wd += both * r->VP[a][b][i];
            }
            x->A[(b * model->n + l) * x->N + a * model->n + j] = w;
            x->B[(b * model->n + l) * x->N + a * model->n + j] = wd;
        }
}

static void prepare(const FixedStep *m, void *work)
{
    Radau *r = work;
    for (int i = 0; i < m->model->m; i++)
        set_mode(r, i, m->model->omega[i], m->model->zeta[i], m->h);
    for (int a = 0; a < S; a++)
        for (int b = 0; b < S; b++)
            set_contacts(r, m->model, a, b);
}

/* Stages from the start of the step and the stages' loads. */
CLONED static void set_stages(Radau *r, const FixedStep *m)
{
    for (int a = 0; a < S; a++)
        for (int i = 0; i < m->model->m; i++) {
            double q = r->Qq[a][i] * m->q[i] + r->Qv[a][i] * m->v[i];
            double v = r->Vq[a][i] * m->q[i] + r->Vv[a][i] * m->v[i];
            for (int b = 0; b < S; b++) {
                q += r->QP[a][b][i] * r->load[b][i];
                v += r->VP[a][b][i] * r->load[b][i];
            }
            r->q[a][i] = q;
            r->v[a][i] = v;
        }
}

static int any_force(const Implicit *x)
{
    for (int k = 0; k < x->N; k++)
        if (x->f[k] != 0)
            return 1;
    return 0;
}

static int solve_contacts(Radau *r, FixedStep *m)
{
    const SimModel *model = m->model;
    Implicit *x = &r->contacts;
    double w[FLOORS_MAX];
    for (int a = 0; a < S; a++) {
        floors_from_modes(model, 0, model->m, r->q[a], w);
        memcpy(x->w_free + a * model->n, w, sizeof *w * (size_t)model->n);
        floors_from_modes(model, 0, model->m, r->v[a], w);
        memcpy(x->wd_free + a * model->n, w, sizeof *w * (size_t)model->n);
    }
    if (!implicit_solve(x, &m->contacts)) {
        m->trouble = "Newton's iteration for the contact forces did not converge";
        return 0;
    }
    if (!any_force(x))
        return 1;
    for (int k = 0; k < x->N; k++)
        for (int i = 0; i < model->m && x->f[k] != 0; i++)
            r->load[k / model->n][i] += x->f[k] * model->RT[(size_t)(k % model->n) * (size_t)model->m_pad + (size_t)i];
    set_stages(r, m);
    return 1;
}

static int advance(FixedStep *m, double a0, double a1, void *work)
{
    Radau *r = work;
    const SimModel *model = m->model;
    double unused[MODES_MAX];
    for (int a = 0; a < S; a++)
        for (int i = 0; i < model->m; i++)
            r->load[a][i] = -model->gamma[i] * (a0 + (a1 - a0) * r->c[a]);
    set_stages(r, m);
    if (model->nc > 0 && !solve_contacts(r, m))
        return 0;
    for (int a = 0; a + 1 < S; a++) { /* the driver adds the third, the end of the step */
        const ContactPower power = fixed_step_forces(m, r->q[a], r->v[a], unused);
        energy_account_add(&m->account, m->h * r->A[S - 1][a], r->v[a], a0 + (a1 - a0) * r->c[a], &power);
    }
    memcpy(m->q, r->q[S - 1], sizeof *m->q * (size_t)model->m);
    memcpy(m->v, r->v[S - 1], sizeof *m->v * (size_t)model->m);
    return 1;
}

Status engine_radau(const SimModel *model, const Motion *motion, const EngineOptions *options, SimResult *result,
                    Err *err)
{
    static const FixedStepMethod METHOD = {{2e-3, 5e-4, 1e-4}, 0, 1.0 / 9, prepare, advance};
    Radau *r = calloc(1, sizeof *r);
    if (!r)
        return fail(err, STATUS_NO_MEMORY, "radau: no memory for its work space");
    set_method(r);
    Status status = implicit_create(&r->contacts, model->n, S, err);
    THEN(status, fixed_step_run(&METHOD, r, model, motion, options, result));
    implicit_free(&r->contacts);
    free(r);
    return status;
}
