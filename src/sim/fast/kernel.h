/* sim/fast/kernel.h -- the work space of the fast engine, and its kernel compiled twice per instruction set.
 *
 * Shapes   (m_pad) modes: building from 0, the kept ones of the core from nb_pad; (n_pad) floors; (c_pad)
 *          channels: the gaps of the floors, from n_pad on the storeys where some may yield, from at_device on the
 *          devices
 * Storeys  w is z, the elastic drift, while p, the plastic one, is as at the start of the step: drift from `middle`;
 *          its bound `gap` is the yield drift; its force the change of c k p within the step. `held` is the rest.
 * Padding  a padded mode has omega = 1 and no coupling; a padded floor has an unreachable gap and unreachable peaks
 * Threads  one FastWork per thread */
#pragma once

#include "sim/engine.h"
#include "sim/fast/tolerances.h"
#include "sim/fast/vec.h"
#include "sim/flow.h"

/* The vectors below are storage only to fast.c: each kernel reads them in its own width, and every array is padded to
 * the widest. */
enum {
    PAD = 8,
    LEVEL_MAX = 24, /* the shortest step is 2^-24 of a sampling interval */
    FLOORS_PAD_MAX = FLOORS_MAX,
    ACTIVE_MAX = 2 * FLOORS_PAD_MAX + PAD,   /* floors and devices */
    CHANNELS_MAX = 3 * FLOORS_PAD_MAX + PAD, /* and storeys */
    POINTS_PAD_MAX = POINTS_MAX,
    HELD_MAX = 128
};

/* Compliances of w (and w') at the end of a step to a unit ramp x and a unit bubble x (1 - x) of force. */
enum { RAMP_W, BUBBLE_W, RAMP_V, BUBBLE_V, COMPLIANCES };

/* The tables of one step length. */
typedef struct {
    double h;         /* [s] */
    double speed_max; /* [m/s] fine enough for contacts up to here */
    int has_flow, has_compliance;
    vec *coef;        /* (FLOW_ROWS, m_pad) */
    vec *slow;        /* (m_pad) 1: the Hermite cubic follows this mode, 0: it does not */
    vec *kappa;       /* (m_pad) error of the cubic, or 1, per unit of amplitude */
    vec *kappa_accel; /* (m_pad) the same for -2 zeta w q' - w^2 q */
    vec *cubic;       /* (m_pad) what the cubic misses of w on any floor, per unit of a mode's amplitude */
    vec *parabola, *parabola_accel; /* (m_pad) what the parabola misses of the mode, of its acceleration */
    double *compliance;  /* (COMPLIANCES, rows, c_pad) of all channels, a row per floor or device with a force */
    v4 *compliance_pair; /* (rows, rows) of i to j: d (w1_i, w1_i') / d (F, M) of j, its force at the end of the
                            step and its mean force */
    vec *own;            /* (n_pad / LANES, 2) d w1 / d (F, M) of a storey by itself */
} Level;

/* The state at one end of a step. */
typedef struct {
    vec *q, *v;                      /* (m_pad) modal coordinates and velocities */
    vec *load;                       /* (m_pad) modal load of the contacts and of plastic drifts */
    vec *contact_work, *ground_work; /* (m_pad) [J] done on each mode since the start */
    vec *defect;                     /* (m_pad) by how much the equation of motion was missed, summed over the steps */
    vec *w, *w_dot;                  /* (c_pad) [m], [m/s] floor minus core, w from the middle of the gap; current where
                                      * state_valid */
    vec *force;                      /* (c_pad) [N] of the contact on the floor */
    double flexible;                 /* [J] stored in the core modes that are left out */
} State;

/* A free flight step: modes (m_pad), floors (n_pad). _q and _a are of displacement and of acceleration. */
typedef struct {
    vec *amplitude;                             /* of the free vibration around the quasi-static answer */
    vec *start_q, *start_v, *start_a, *start_j; /* what the Hermite cubic follows: fast modes are quasi-static */
    vec *end_q, *end_v, *end_a, *end_j;
    vec *bound_q, *bound_a;                     /* error of the cubics; largest acceleration, or its cubic's error */
    vec *u0, *u0_dot, *u1, *u1_dot;             /* floors */
    vec *core0, *core0_dot, *core1, *core1_dot; /* the core's part of w, and the middle of the gap */
    vec *a0, *a0_dot, *a1, *a1_dot;             /* accelerations of the floors */
    vec *error_u, *error_core, *error_a;        /* bounds of what the cubics miss */
    vec *reach_a;                               /* largest acceleration by the bounds of the modes */
    int would_yield;                            /* a storey may, so that there is no flight */
    int by_floor;                               /* are errors and reach those of each floor, or of all at once? */
} FlightScratch;

/* A contact step: modes (m_pad), floors (n_pad). */
typedef struct {
    vec *bubble;                      /* modal load of the forces' bubbles */
    vec *middle_q, *middle_a, *end_a; /* building modes: displacement and acceleration there */
    vec *bend_q, *bend_a;             /* how far the parabola through start, middle and end may leave its ends */
    vec *bound_q, *bound_a;           /* what the parabola misses of each mode */
    vec *missed;                      /* what it misses of the floors */
    vec *sample[3][3];                /* [start, middle, end][u, drift, acceleration] of the floors */
    int has_middle[2];                /* [u and drift, acceleration] is the middle known? */
    double bend[3];                   /* of any floor: that of all modes together */
    int may_rise[3];                  /* [u, drift, acceleration] may this step raise a peak? */
} ContactScratch;

/* Each of the three monotone pieces of a storey's path may have one edge and one end. */
enum { PIECES = 3, KINKS_MAX = 2 * PIECES };

/* Storeys that yield (n_pad), in a step where some may. */
typedef struct {
    vec *per_yield, *stiff; /* [1/m]; [N/m] of what is not linear, 0: the storey stays elastic */
    vec *slope, *bend;      /* [N/s], [N/s2] f' and f''/2 of c k p at the end of the last step */
    vec *work, *work_next;  /* [m2] int z d' dt of a storey, at both ends of the step */
    vec *beside;            /* [J] int c k p dd, less the same of the parabola of its end and mean */
    vec *load, *bubble;     /* (m_pad) modal load of their forces */
    vec *kink;              /* (n_pad / LANES, KINKS_MAX) shares of the step where their forces bend, else 0 */
} StoreyScratch;

/* Certified free intervals: the largest that modes (m_pad) and floors (n_pad) can reach. */
typedef struct {
    vec *bound_q, *bound_a;
    vec *u, *drift, *a, *core;
} ReachScratch;

/* A flight whose samples may not be wanted. */
typedef struct {
    double t, a0, a1; /* [s] of its start; [m/s2] ground acceleration at both ends */
    int level;
    vec *q, *v; /* (nb_pad) at its start */
} HeldFlight;

/* A point inside a step, for a force monitor or a sample: modes (m_pad), floors (n_pad). */
typedef struct {
    vec *q, *v, *force;
    vec *plastic;                             /* (n_pad) [m] of the storeys */
    int in_step;                              /* forces of storeys are those of the step from now to next */
    vec *ground_work, *contact_work, *damped; /* [J] on each mode, of it dissipated */
    vec *batch_q[4], *batch_u[4];             /* of four samples: modes, floors */
    vec *most, *per_most; /* [2 J] energy that a mode has reached at most, rounded up, and its inverse */
    double share[4];      /* energy over `most` at the start of the step: first mode, others, of building and core */
    HeldFlight held[HELD_MAX]; /* n_held of them from first_held on, round the end */
    int first_held, n_held, samples_held;
    double spacing;           /* [s] of samples */
    int memory, samples_sent; /* samples that are wanted beside others, 0: all are; sent since then */
} RecordScratch;

typedef struct FastWork {
    const SimModel *model;
    const EngineOptions *options;
    const FastTolerances *tolerances;

    /* the design */
    int m_max;                             /* room for so many modes */
    int n, n_pad, nb_pad, m_pad;           /* building modes first, padded apart: core modes start at nb_pad */
    int nc;                                /* core modes that are kept */
    int nf, mf, bf;                        /* n_pad, m_pad, nb_pad in vectors of LANES */
    int pf;                                /* points of the model in vectors */
    int point_modes, uf;                   /* the first modes, with those between, that move them; their vectors */
    vec *U, *U_abs, *D_abs;                /* (m_pad, pf) of the points, of their distances from those below */
    vec *W;                                /* (m_pad, nf) what w has beside the first of them: R of the core */
    vec *room[3];                          /* of U, U_abs and W, else R and R_abs */
    vec *omega, *zeta, *gamma;             /* (m_pad) */
    vec *wd_inverse, *decay, *flexibility; /* (m_pad) 1/w_d, 2 zeta w, 1/w^2 */
    vec *max_shape, *max_shape_drift;      /* (m_pad) largest |R| of a mode over the floors, over the storeys */
    double *R, *R_abs;                     /* (m_pad, n_pad) of the floors; of W */
    double *RT;                            /* (c_pad, m_pad) of the channels */
    vec *gap, *middle;                     /* (c_pad) as in SimModel */
    int may_yield, devices_max;            /* room for storeys that yield, for so many devices */
    int yields, rows;                      /* some do; floors and devices */
    int n_devices, at_device;              /* the first of their channels */
    int c_pad, cf;                         /* c_pad in vectors of LANES */
    double *E, *E_room;                    /* (m_pad, c_pad) of the channels: R where they are the gaps alone */
    int has_middle;                        /* some are not 0 */
    double *flex;                          /* (n, n_pad) [m/N] static flexibility of the core modes left out: of w */
    int has_flex;                          /* some are left out */
    FloorSet floors;                       /* all of them */
    double shortest_at_1;                  /* [s] shortest Hertz contact of any floor at 1 m/s */
    double shortest_bumper;                /* [s] shortest contact of any bumper alone; 0: steel on steel somewhere */
    int oscillatory;                       /* every mode is below critical damping and has a frequency */
    double base;                           /* [s] the interval that the levels divide */
    int sample_level;                      /* samples are as far apart as a step of this level */
    Level level[LEVEL_MAX + 1];

    /* the motion so far */
    State now, next;
    vec *held;                 /* (m_pad) modal load of the plastic drifts at the start of the step */
    vec *rest;                 /* (n_pad) [m] |z| of the storeys at rest under it */
    int yielding_level;        /* of the steps in which storeys yield, at least: steps are of a fixed share at fine */
    double storey_rate;        /* [1/s2] times the square of a step: what the other storeys change of one, at most */
    m22 *newton_g, *newton_LU; /* (rows, rows) of Active */
    double LU_of;              /* [s] the step whose matrix of linear devices alone newton_LU is; 0: it is not */
    int are_linear;            /* all devices */
    vec *bubble;               /* (c_pad) [N] of the contact forces over the step under way */
    vec *peak_u, *peak_d, *peak_a; /* (n_pad) */
    double v0[FLOORS_PAD_MAX];     /* [m/s] of the open contact */
    double step_start;             /* [s] of the step under way */

    /* step control */
    int flight_level, contact_level; /* where the next free flight, the next contact step is tried */
    int may_grow;                    /* the last contact step could have been twice as long */
    double energy_scale;             /* [J] */
    double calm;                     /* >= 1, by which the tolerances of a step may grow: is_settled */
    double crowd;                    /* >= 1, by which the energy tolerance of the step under way is divided */
    double mass_ratio;               /* building and core over the building */
    double settled;                  /* [s] where contacts ended */
    long free_from, free_count;      /* the interval from which free intervals are tried, and over how many */

    int forced;               /* there are forces on the floors in this run */
    vec *push[2], *push_rise; /* (m_pad) modal load of these forces at both ends of the step under way; its rise */
    vec *swing[2];            /* (m_pad) the same of the interval */

    FlightScratch flight;
    ContactScratch contact;
    StoreyScratch storeys;
    ReachScratch reach;
    RecordScratch record;

    /* From here on all is 0 at rest. */
    int side[FLOORS_PAD_MAX];                                   /* 0 no contact, +1 or -1 */
    double force_slope[CHANNELS_MAX], force_bend[CHANNELS_MAX]; /* [N/s], [N/s2] f' and f''/2 of the open contact */
    FloorSet in_contact;
    int yielding;                       /* some storey did in the last step */
    int lifting;                        /* the mat of the core was up, or its cone moved, at its end: */
    double mat[MAT_STATES], mat_turned; /* there; [rad] the most so far */
    double hysteresis;                  /* [J] */
    int state_valid;                    /* 0: after free flight w, w' and sample[0] are not current */
    double speed;                       /* [m/s] largest |w'| */
    double most_energy;                 /* [J] of the modes at any sample */
    int has_push;                       /* forces on the floors act in the interval under way */
    double push_accel;                  /* [m/s2] at most, of any floor, by these forces in the interval */

    /* energy account and counts */
    double contact_lost, contact_clamped;
    double device_taken;                 /* [J] */
    DevicePeak device[FLOORS_MAX + 2];   /* (n_devices) */
    double approach_max[FLOORS_PAD_MAX]; /* [m] deepest, of steel and bumper together */
    long closings[FLOORS_PAD_MAX];
    long impacts, v0_limited, steps, flights, forces;
} FastWork;

typedef void FastKernel(FastWork *k, const SimModel *model, const Motion *motion, const EngineOptions *options,
                        const FastTolerances *tolerances, SimResult *result);

/* fast_plain_*: for models without storeys that yield and devices, and motions without forces on floors. They alone
 * gain from the widest vectors. */
FastKernel fast_kernel_base, fast_kernel_avx2, fast_plain_base, fast_plain_avx2, fast_plain_avx512;

enum { FAST_BASE, FAST_AVX2, FAST_AVX512, FAST_SETS };
typedef struct {
    const char *name;
    FastKernel *run, *plain;
} FastKernels;

/* Those of an instruction set; NULL: this processor or this build does not have it. */
const FastKernels *fast_kernels(int set);
