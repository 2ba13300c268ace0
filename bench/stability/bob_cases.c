/* Properties that a mass in front of a wall shows, against closed forms and the oracle. */
#include "bench/stability/trial.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static const double STEEL = 4.865e10; /* [N/m^1.5] */

/* ---- a throw: the ground pushes once, the mass flies to the wall ---------------------------------------------- */

typedef struct {
    double mass, k, v, r;
    double dt;        /* [s] sampling interval; the push takes two of them, the flight to the wall three more */
    double until;     /* [s] end of the run; 0: as long after the closing as before it, and twice the contact */
    double tolerance; /* < 0: steps per contact as the accuracy says */
    double bumper;    /* [N/m], of the same damping as the steel; 0: none */
} Throw;

typedef struct {
    double penetration, duration, closing, end, energy; /* Hertz's */
    SimResult result;
} Thrown;

static Contact paper_law(double k, double r, double v0_floor)
{
    return (Contact){.k = k, .a = 1.5 * (1 - r), .v0_floor = v0_floor};
}

static Throw throw_of(double mass, double k, double v, double r)
{
    return (Throw){mass, k, v, r, 7.3 * contact_hertz_duration(k, mass, v), 0, -1, 0};
}

static Contact law_of(const Throw *x)
{
    Contact c = paper_law(x->k, x->r, 1e-300);
    c.bumper = x->bumper;
    c.bumper_a = c.a;
    return c;
}

static void throw_mass(Trial *t, const Throw *x, Thrown *out)
{
    SimModel model;
    double accel[3] = {0, -x->v / x->dt, 0};
    const Motion motion = {.accel = accel, .n = 3, .dt_s = x->dt};
    const Bob bob = {.mass = x->mass, .gap = x->v * 4 * x->dt};
    const Contact contact = law_of(x);
    out->penetration = contact_hertz_indentation(x->k, x->mass, x->v);
    out->duration = hypot(contact_hertz_duration(x->k, x->mass, x->v), contact_bumper_duration(&contact, x->mass));
    out->closing = 5 * x->dt;
    out->energy = 0.5 * x->mass * x->v * x->v;
    out->end = x->until > 0 ? x->until : 2 * out->closing - x->dt + 2 * out->duration;
    bobs_model(&model, 1, &bob, 0, &contact);
    const double tolerance = x->tolerance < 0 ? trial_tolerance(t, out->duration, trial_steps(t)) : x->tolerance;
    out->result = trial_run(t, &model, &motion, out->end, tolerance);
    model_free(&model);
}

static double rebound(const Thrown *x)
{
    return sqrt(x->result.kinetic_strain_j / x->energy);
}

static void hertz_impact(Trial *t)
{
    TRIAL_EACH_ACCURACY(t)
    {
        Throw x = throw_of(280000, STEEL, 0.4, 1);
        Thrown out;
        throw_mass(t, &x, &out);
        const SimResult *r = &out.result;
        trial_close(t, r, rebound(&out), 1, trial_allowed(t, 1e-4, 2e-2), "rebound ratio of r = 1");
        trial_close(t, r, r->indentation_max_m, out.penetration, trial_allowed(t, 1e-3, 3e-2), "maximum indentation");
        trial_close(t, r, r->j3_g * 9.81 * x.mass, x.k * pow(out.penetration, 1.5), trial_allowed(t, 1e-3, 5e-2),
                    "largest force");
        for (int late = 0; late < 2; late++) {
            const double off = trial_allowed(t, 2e-3, 5e-2);
            x.until = out.closing + out.duration * (late ? 1 + off : 1 - off);
            Thrown cut;
            throw_mass(t, &x, &cut);
            trial_note(t, &cut.result, (cut.result.contact_stored_j > 0) != late ? 0 : 1, 0.5,
                       "in contact %g durations after closing", late ? 1 + off : 1 - off);
        }
    }
}

/* Where so much energy [J] is stored. */
static double approach_of(const Contact *c, double energy)
{
    double low = 0, high = 1;
    while (contact_stored(c, high) < energy)
        high *= 2;
    for (int i = 0; i < 100; i++) {
        const double middle = 0.5 * (low + high);
        *(contact_stored(c, middle) < energy ? &low : &high) = middle;
    }
    return high;
}

static void bumper_impact(Trial *t)
{
    TRIAL_EACH_ACCURACY(t)
    {
        for (double bumper = 1e6; bumper < 1e12; bumper *= t->size == SIZE_QUICK ? 1e3 : 10)
            for (int damped = 0; damped < 2; damped++) {
                Throw x = throw_of(280000, STEEL, 0.4, damped ? 0.7 : 1);
                x.bumper = bumper;
                x.dt = 7.3 * hypot(contact_hertz_duration(x.k, x.mass, x.v), M_PI * sqrt(x.mass / bumper));
                const Contact law = law_of(&x);
                const double want = contact_rebound(law.a);
                Thrown out;
                throw_mass(t, &x, &out);
                const SimResult *r = &out.result;
                trial_close(t, r, rebound(&out), want, trial_allowed(t, 1e-4, 2e-2), "rebound ratio, %g N/m", bumper);
                if (damped)
                    continue;
                const double depth = approach_of(&law, out.energy);
                const double force = contact_force(&law, x.mass, depth, 0, 1).elastic;
                trial_close(t, r, r->indentation_max_m + r->bumper_compression_m, depth, trial_allowed(t, 1e-3, 3e-2),
                            "largest approach, %g N/m", bumper);
                trial_close(t, r, r->j3_g * 9.81 * x.mass, force, trial_allowed(t, 1e-3, 5e-2), "largest force, %g N/m",
                            bumper);
            }
    }
}

/* By what the engine's tolerance is: a step, steps per contact, or relative. */
static double tolerance_of(const Trial *t, double step, double steps_per_contact, double relative)
{
    const int kind = trial_engine(t)->tolerance;
    return kind == TOLERANCE_STEP ? step : kind == TOLERANCE_RELATIVE ? relative : steps_per_contact;
}

/* Worst error of the rebound ratio at r = 0.7 over impacts that begin anywhere in a step. */
static double rebound_error(Trial *t, double factor)
{
    double worst = 0;
    for (int i = 0; i < 12; i++) {
        Throw x = throw_of(1000, STEEL, 0.3 * (1 + 0.037 * i), 0.7);
        Thrown out;
        const double duration = contact_hertz_duration(x.k, x.mass, x.v);
        x.tolerance = tolerance_of(t, duration * factor / 15, 8 / factor, 1e-4 * factor * factor * factor);
        throw_mass(t, &x, &out);
        trial_note(t, &out.result, 0, 1, "rebound at r = 0.7");
        worst = fmax(worst, fabs(rebound(&out) - contact_rebound(0.45)));
    }
    return worst;
}

static void convergence(Trial *t)
{
    t->accuracy = ACCURACY_FINE;
    const double coarse = rebound_error(t, 1), middle = rebound_error(t, 0.25), fine = rebound_error(t, 0.0625);
    const int by_tolerance = trial_engine(t)->tolerance == TOLERANCE_RELATIVE;
    const double order = log(coarse / fine) / log(16) / (by_tolerance ? 3 : 1);
    trial_remark(t, "Errors %.2g, %.2g, %.2g at %s 1 : 1/%d : 1/%d: order %.2f", coarse, middle, fine,
                 by_tolerance ? "tolerances" : "steps", by_tolerance ? 64 : 4, by_tolerance ? 4096 : 16, order);
    trial_note(t, NULL, fine, by_tolerance ? 1e-4 : 2e-2, "rebound error at the finest setting; order %.2f", order);
    trial_note(t, NULL, order > (by_tolerance ? 0.3 : 0.8) || fine < 1e-10 ? 0 : 1, 0.5, "order of convergence %.2f",
               order);
}

static void twelve_decades(Trial *t)
{
    static const double R[] = {0, 0.3, 0.5, 0.7, 0.9, 0.99}, DECADE[] = {1e-6, 1e-3, 1, 1e3, 1e6};
    TRIAL_EACH_ACCURACY(t)
    {
        for (int r = 0; r < 6; r += t->size == SIZE_QUICK ? 3 : 1)
            for (int d = 0; d < 5; d++)
                for (int which = 0; which < (DECADE[d] == 1 ? 1 : 3); which++) {
                    const double f = DECADE[d];
                    const Throw x = throw_of(1000 * (which == 0 ? f : 1), STEEL * (which == 1 ? f : 1),
                                             0.3 * (which == 2 ? f : 1), R[r]);
                    Thrown out;
                    throw_mass(t, &x, &out);
                    trial_compare(t, &out.result, rebound(&out), contact_rebound(1.5 * (1 - R[r])), 1,
                                  trial_allowed(t, 1e-4, 3e-2), "rebound ratio, r = %g, %s x %g", R[r],
                                  which == 0   ? "mass"
                                  : which == 1 ? "stiffness"
                                               : "speed",
                                  f);
                }
    }
}

/* Largest share of energy that a run gains where none can be gained. */
static void long_steps(Trial *t)
{
    static const double LENGTH[] = {0.1, 0.25, 0.5, 1, 2, 5, 10};
    int flagged = 0, refused = 0, runs = 0;
    t->accuracy = ACCURACY_STANDARD;
    for (int l = 0; l < 7; l++)
        for (int i = 0; i < 15; i++) {
            Throw x = throw_of(1000, STEEL, 0.1 * (1 + 0.13 * i), 1 - 0.5 * (i % 3));
            Thrown out;
            const double duration = contact_hertz_duration(x.k, x.mass, x.v);
            x.tolerance = tolerance_of(t, duration * LENGTH[l], 1 / LENGTH[l], 1e-3 * LENGTH[l]);
            throw_mass(t, &x, &out);
            const SimResult *r = &out.result;
            runs++;
            flagged += r->outcome == RUN_OK && r->energy_balance_error > 1e-3;
            refused += r->outcome != RUN_OK;
            if (r->outcome == RUN_OK && r->energy_balance_error <= 1e-3)
                trial_note(t, r, fmax(0, r->kinetic_strain_j / out.energy - 1), 1e-2,
                           "energy made without a flag, step %g durations (or tolerance %g), r = %g", LENGTH[l],
                           1e-3 * LENGTH[l], x.r);
        }
    trial_note(t, NULL, 0, 1, "energy made without a flag");
    trial_remark(t, "%d of %d runs flagged by their energy-balance error, %d refused", flagged, runs, refused);
}

/* ---- any record, against the oracle --------------------------------------------------------------------------- */

typedef struct {
    Bob bob;
    Contact contact;
    Motion motion;
    double duration, contact_duration, free_step, tolerance; /* tolerance < 0: as trial_tolerance says */
    double energy_scale;                                     /* at least the oracle's turnover */
    double fine, standard;                                   /* allowed; 0: 1e-3, 3e-2 */
} Run;

/* The paper's law at r = 0.7. */
static Run run_of(Bob bob, double accel[], size_t n, double dt, double duration, double contact_duration,
                  double free_step)
{
    return (Run){.bob = bob,
                 .contact = paper_law(STEEL, 0.7, 1e-3),
                 .motion = {.accel = accel, .n = n, .dt_s = dt},
                 .duration = duration,
                 .contact_duration = contact_duration,
                 .free_step = free_step,
                 .tolerance = -1};
}

static SimResult run_engine(Trial *t, const Run *x)
{
    SimModel model;
    bobs_model(&model, 1, &x->bob, 0, &x->contact);
    const SimResult r =
        trial_run(t, &model, &x->motion, x->duration,
                  x->tolerance < 0 ? trial_tolerance(t, x->contact_duration, trial_steps(t)) : x->tolerance);
    model_free(&model);
    return r;
}

/* Both accuracies; the last result, at standard. */
__attribute__((format(printf, 3, 4))) static SimResult against_oracle(Trial *t, const Run *x, const char *format, ...)
{
    Oracle o;
    SimResult r = {0};
    char what[80];
    va_list list;
    va_start(list, format);
    vsnprintf(what, sizeof what, format, list);
    va_end(list);
    oracle_run(&o, &x->bob, &x->contact, &x->motion, x->duration, x->free_step, x->contact_duration / 1000);
    TRIAL_EACH_ACCURACY(t)
    {
        r = run_engine(t, x);
        const double energy = fmax(x->energy_scale, o.turnover);
        const double allowed = trial_allowed(t, x->fine > 0 ? x->fine : 1e-3, x->standard > 0 ? x->standard : 3e-2);
        trial_compare(t, &r, r.kinetic_strain_j, o.kinetic_strain, energy, allowed, "%s: energy at the end", what);
        trial_close(t, &r, r.j1_m, o.peak_u, allowed, "%s: largest displacement", what);
        trial_compare(t, &r, r.input_energy_j, o.input, energy, allowed, "%s: input energy", what);
        trial_compare(t, &r, r.clamp_j, o.clamp, energy, allowed, "%s: energy removed by the no-tension condition",
                      what);
        trial_compare(t, &r, r.contact_loss_j, o.lost, energy, allowed, "%s: energy lost in contact", what);
        trial_compare(t, &r, r.damped_building_j, o.damped, energy, allowed, "%s: energy damped", what);
    }
    return r;
}

/* Push to speed v, then a constant pull back: the top of the flight is known. */
static void grazing(Trial *t)
{
    const double m = 1000, v = 0.5, pull = 2, dt = 0.01;
    enum { N = 61 };
    double accel[N] = {0, -v / dt, 0, 0};
    for (int i = 4; i < N; i++)
        accel[i] = pull;
    /* the pull ramps up over one interval, from t = 3 dt */
    const double v4 = v - pull * dt / 2, x4 = v * dt + v * dt + v * dt - pull * dt * dt / 6;
    const double top = x4 + v4 * v4 / (2 * pull);
    Run x = run_of((Bob){.mass = m}, accel, N, dt, 0.5, 0, 1e-4);
    x.fine = 5e-3;
    x.standard = 0.1; /* the speed at the wall is the root of how deep the gap would be passed */
    x.energy_scale = 0.5 * m * v * v;
    for (int e = 3; e <= 15; e++)
        for (int side = -1; side <= 1; side += 2) {
            x.bob.gap = top * (1 + side * pow(10, -e));
            x.contact_duration = contact_hertz_duration(STEEL, m, fmax(sqrt(2 * pull * top * pow(10, -e)), 1e-3));
            const char sign = side > 0 ? '+' : '-';
            const SimResult r = against_oracle(t, &x, "gap = peak (1 %c 1e-%d)", sign, e);
            if (side > 0 && e < (t->engine == ENGINE_FAST ? 12 : 4)) /* the others' flight is not exact */
                trial_note(t, &r, (double)r.impacts, 0.5, "gap = peak (1 %c 1e-%d): impacts", sign, e);
        }
}

static void start_at_the_wall(Trial *t)
{
    enum { N = 41 };
    double accel[N];
    const double dt = 0.01, m = 1000, duration = contact_hertz_duration(STEEL, m, 0.3);
    for (int i = 0; i < N; i++)
        accel[i] = -12 * sin(2 * M_PI * i / (N - 1.0));
    for (int f = 3; f <= 6; f += 3) {
        Run x = run_of((Bob){.mass = m, .omega = 20, .zeta = 0.03}, accel, N, dt, 0.6, duration, 1e-5);
        x.contact.v0_floor = pow(10, -f);
        against_oracle(t, &x, "no gap, at rest, v0 floor 1e-%d m/s", f);
    }
}

static void slow_touch_fast_pull_off(Trial *t)
{
    enum { N = 41 };
    double accel[N];
    const double dt = 0.002, m = 1000, v = 2e-3;
    for (int i = 0; i < N; i++)
        accel[i] = i == 1 ? -v / dt : i < 10 ? 0 : i < 20 ? -20 : i < 24 ? 400 : 0;
    for (int r = 0; r < 3; r++) {
        const double duration = contact_hertz_duration(STEEL, m, 0.1);
        Run x = run_of((Bob){.mass = m, .gap = v * 4 * dt}, accel, N, dt, 0.07, duration, 1e-5);
        x.contact = paper_law(STEEL, 0.5 * r, 1e-3);
        against_oracle(t, &x, "touch at 2 mm/s, pull at 400 m/s2, r = %g", 0.5 * r);
    }
}

static void within_one_step(Trial *t)
{
    const double m = 1, v = 10, duration = contact_hertz_duration(STEEL, m, v);
    for (int i = 0; i < 3; i++) {
        const double dt = duration * (i == 0 ? 137.1 : i == 1 ? 1.13e4 : 1.03e5);
        double accel[3] = {0, -v / dt, 0};
        Run x = run_of((Bob){.mass = m, .gap = 1.07 * v * dt}, accel, 3, dt, 6.9 * dt, duration, dt / 100);
        x.tolerance = 0;
        against_oracle(t, &x, "intervals of %.3g contact durations", dt / duration);
    }
}

static void step_does_not_divide(Trial *t)
{
    enum { N = 200 };
    double accel[N];
    for (int i = 0; i < N; i++)
        accel[i] = 3 * sin(0.09 * i) + 2 * sin(0.31 * i);
    for (int i = 0; i < 4; i++) {
        const double dt = 0.0137 * (1 + 0.217 * i), duration = contact_hertz_duration(STEEL, 1e5, 0.3);
        const Bob bob = {.mass = 1e5, .omega = 7, .zeta = 0.03, .gap = 0.05};
        Run x = run_of(bob, accel, N, dt, dt * (71.37 + 0.41 * i), duration, 1e-4);
        x.standard = 0.1;
        against_oracle(t, &x, "interval %.6g s, %.6g intervals long", dt, 71.37 + 0.41 * i);
    }
}

static void damping_ratios(Trial *t)
{
    static const double ZETA[] = {0, 0.03, 1, 1 + 1e-9, 1.5, 20}, OMEGA[] = {0, 0.5, 9};
    enum { N = 60 };
    double accel[N];
    const double dt = 0.05, duration = contact_hertz_duration(STEEL, 1e4, 0.3);
    for (int i = 0; i < N; i++)
        accel[i] = 3 * sin(0.09 * i) + 2 * sin(0.31 * i);
    for (int z = 0; z < 6; z += t->size == SIZE_QUICK && z > 0 ? 2 : 1)
        for (int w = 0; w < 3; w++)
            for (int touch = 0; touch < 2; touch++) {
                const Bob bob = {.mass = 1e4, .omega = OMEGA[w], .zeta = ZETA[z], .gap = touch ? 0.02 : 1e3};
                Run x = run_of(bob, accel, N, dt, 1.7, duration, 4e-4);
                x.standard = 0.1;
                against_oracle(t, &x, "zeta = %.10g, w = %g, %s", ZETA[z], OMEGA[w], touch ? "touching" : "free");
            }
}

/* ---- resonance, rest, endless bounces, long runs --------------------------------------------------------------- */

static void half_periods(Trial *t)
{
    enum { N = 12 };
    static const double SAMPLE[N] = {0, 1, -2, 0.5, 3, -1, 2, 2, -3, 1, -0.5, 0};
    double accel[N];
    const double omega = 2 * M_PI * 5;
    memcpy(accel, SAMPLE, sizeof accel);
    const int quick = t->size == SIZE_QUICK;
    for (int k = 1; k <= (quick ? 4 : 10); k += 3)
        for (int off = quick ? 0 : -1; off <= 1; off++) {
            const double h = k * M_PI / omega * (1 + 1e-9 * off);
            Run x = run_of((Bob){.mass = 1, .omega = omega, .gap = 1e3}, accel, N, h, 14 * h, h, 2e-4);
            x.tolerance = 0;
            x.energy_scale = 4.5 / (omega * omega); /* of the largest sample: even intervals almost cancel */
            against_oracle(t, &x, "interval %d pi / w", k);
            if (trial_engine(t)->tolerance != TOLERANCE_STEP)
                continue;
            /* a step as long as that cannot be accurate, but free vibration must neither grow nor die in silence */
            x.tolerance = h;
            const SimResult early = run_engine(t, &x);
            x.duration = 414 * h;
            const SimResult late = run_engine(t, &x);
            trial_close(t, &late, late.kinetic_strain_j, early.kinetic_strain_j, 1e-3,
                        "step %d pi / w: energy of 400 steps of free vibration", k);
        }
}

static void static_rest(Trial *t)
{
    const long n = t->size == SIZE_QUICK ? 5000 : t->size == SIZE_FULL ? 100000 : 1000000;
    const double dt = 0.01, m = 280000, load = 9.81;
    double *accel = malloc(sizeof(double) * (size_t)n);
    for (long i = 0; i < n; i++)
        accel[i] = -load * fmin(1, (double)i * dt / 2);
    const double p = pow(m * load / STEEL, 2.0 / 3);
    const double period = 2 * M_PI / sqrt(1.5 * STEEL * sqrt(p) / m);
    const Bob bob = {.mass = m, .gap = 1e-9};
    const Run x = run_of(bob, accel, (size_t)n, dt, (double)(n - 1) * dt, period / 2, 0);
    TRIAL_EACH_ACCURACY(t)
    {
        const SimResult r = run_engine(t, &x);
        const double energy = m * load * p;
        trial_close(t, &r, pow(r.contact_stored_j / (0.4 * STEEL), 0.4), p, trial_allowed(t, 1e-6, 1e-4),
                    "static indentation after %ld intervals", n);
        trial_compare(t, &r, r.kinetic_strain_j, 0, energy, trial_allowed(t, 1e-6, 1e-4), "energy of motion at rest");
        trial_note(t, &r, r.energy_balance_error, trial_allowed(t, 1e-4, 1e-3), "energy-balance error at rest");
        trial_note(t, &r, (double)r.impacts, 3, "contact onsets while resting");
    }
    free(accel);
}

/* A ball dropped on a steel floor: flights of a geometric series end in finite time, and it lies still. */
static void endless_bounces(Trial *t)
{
    enum { N = 401 };
    double accel[N];
    const double dt = 0.01, m = 1000, h = 0.5, g = 9.81, e = 0.7, fall = sqrt(2 * h / g);
    for (int i = 0; i < N; i++)
        accel[i] = -g;
    const double end = fall * (1 + 2 * e / (1 - e)), p = pow(m * g / STEEL, 2.0 / 3);
    const double shortest = contact_hertz_duration(STEEL, m, sqrt(2 * g * h));
    Run x = run_of((Bob){.mass = m, .gap = h}, accel, N, dt, 0.6 * end, shortest, 1e-3);
    x.contact.a = contact_damping(e);
    against_oracle(t, &x, "after the first bounces");
    x.duration = end + 1;
    TRIAL_EACH_ACCURACY(t)
    {
        const double energy = m * g * h;
        const SimResult r = run_engine(t, &x);
        trial_compare(t, &r, r.kinetic_strain_j, 0, energy, trial_allowed(t, 1e-9, 1e-5),
                      "energy of motion at the end");
        trial_compare(t, &r, r.input_energy_j, m * g * (h + p), energy, trial_allowed(t, 1e-4, 1e-2),
                      "work of gravity");
        trial_note(t, &r, (double)r.impacts, 200, "contact onsets");
        trial_remark(t, "%ld contact onsets, %ld steps; ", r.impacts, r.steps);
    }
}

static double push_energy(double mass, double v)
{
    return 0.5 * mass * v * v;
}

/* Processor time of one run, from as many as it takes for a clock that may tick only every hundredth of a second. */
static SimResult time_engine(Trial *t, const Run *x, double *seconds)
{
    SimResult r;
    int runs = 0;
    const clock_t start = clock();
    do {
        r = run_engine(t, x);
        runs++;
    } while (clock() - start < CLOCKS_PER_SEC / 4);
    *seconds = (double)(clock() - start) / CLOCKS_PER_SEC / runs;
    return r;
}

/* Free vibration over so many intervals, undamped (nothing is lost) and damped (until there is nothing left: no slower
 * for that). */
static void many_steps(Trial *t)
{
    const double n = t->size == SIZE_QUICK ? 2e4 : t->size == SIZE_FULL ? 2e5 : 1e7;
    const double dt = 0.02, omega = 2 * M_PI;
    double accel[3] = {0, -1 / dt, 0}, seconds[2];
    t->accuracy = ACCURACY_STANDARD;
    Run x = run_of((Bob){.mass = 1000, .omega = omega, .gap = 1e3}, accel, 3, dt, 2.37 * dt, 0, 0);
    x.tolerance = tolerance_of(t, dt, 0, 0);
    const SimResult early = run_engine(t, &x);
    x.duration = n * dt;
    const SimResult late = run_engine(t, &x);
    trial_close(t, &late, late.kinetic_strain_j, early.kinetic_strain_j, 1e-3, "undamped energy after %g intervals", n);
    /* exp(-zeta w t) passes the least normal number long before the end, or never */
    for (int still = 0; still < 2; still++) {
        x.bob.zeta = still ? 0.9 : 1e-9;
        const SimResult r = time_engine(t, &x, &seconds[still]);
        if (still)
            trial_close(t, &r, r.damped_building_j, r.input_energy_j, 1e-3, "energy damped in the end, of the input");
    }
    trial_note(t, NULL, seconds[1] / seconds[0], 3, "time of a run that dies away over that of one that does not");
}

/* Without losses the motion from the turning point on is the motion to it, backwards: the same push stops the mass. */
static void time_reversal(Trial *t)
{
    enum { N = 41 };
    const double m = 1000, v = 0.3, dt = 0.01, middle = (N - 1) / 2 * dt;
    TRIAL_EACH_ACCURACY(t)
    {
        for (int sprung = 0; sprung < 2; sprung++) {
            double accel[N] = {0};
            accel[1] = accel[N - 2] = -v / dt;
            const double duration = contact_hertz_duration(STEEL, m, v);
            Run x = run_of((Bob){.mass = m, .omega = sprung ? 2 : 0}, accel, N, dt, (N - 1) * dt, duration, 1e-4);
            x.contact.a = 0; /* r = 1 */
            /* the gap at which the mass turns in the middle of the record: by bisection on the oracle */
            double low = 0.5 * v * middle, high = 1.2 * v * middle;
            for (int i = 0; i < 60; i++) {
                Oracle o;
                x.bob.gap = 0.5 * (low + high);
                oracle_run(&o, &x.bob, &x.contact, &x.motion, middle, x.free_step, x.contact_duration / 2000);
                *(o.v > 0 ? &high : &low) = x.bob.gap;
            }
            const SimResult r = run_engine(t, &x);
            trial_compare(t, &r, sqrt(fmax(r.kinetic_strain_j, 0) / push_energy(m, v)), 0, 1,
                          trial_allowed(t, 3e-3, 0.1), "speed left over when the record has run backwards, w = %g",
                          x.bob.omega);
        }
    }
}

/* ---- several at once ------------------------------------------------------------------------------------------- */

enum { BALLS = 4 };

/* Heavy balls of one speed meet a light free core at the same moment. */
static SimResult ball_row(Trial *t, const int order[BALLS], double duration, double *momentum_error)
{
    static const double MASS[BALLS] = {3000, 7000, 5000, 11000};
    const double core = 400, v = 0.3, dt = 0.02;
    double accel[3] = {0, -v / dt, 0}, total = 0, sum = 0, kinetic = 0;
    const Motion motion = {.accel = accel, .n = 3, .dt_s = dt};
    const Contact contact = paper_law(STEEL, 0.7, 1e-3);
    Bob bobs[BALLS];
    for (int j = 0; j < BALLS; j++) {
        bobs[j] = (Bob){.mass = MASS[order[j]], .gap = 4 * v * dt};
        total += bobs[j].mass * v;
    }
    SimModel model;
    bobs_model(&model, BALLS, bobs, core, &contact);
    const double tolerance = trial_tolerance(t, contact_hertz_duration(STEEL, core, v), trial_steps(t));
    const SimResult r = trial_run(t, &model, &motion, duration, tolerance);
    if (momentum_error) {         /* every ball flies on: its largest displacement is where it is */
        const double later = 0.1; /* before the core meets the other side of its gaps, 0.2 s after the first */
        const SimResult further = trial_run(t, &model, &motion, duration + later, tolerance);
        for (int j = 0; j < BALLS; j++) {
            const double speed = (further.peak_displacement_m[j] - r.peak_displacement_m[j]) / later;
            sum += bobs[j].mass * speed;
            kinetic += 0.5 * bobs[j].mass * speed * speed;
        }
        const double left = fmax(further.kinetic_strain_j - kinetic, 0);
        *momentum_error = (sum + sqrt(2 * core * left) - total) / total;
    }
    model_free(&model);
    return r;
}

static void simultaneous(Trial *t)
{
    static const int ORDER[4][BALLS] = {{0, 1, 2, 3}, {3, 2, 1, 0}, {1, 3, 0, 2}, {2, 0, 3, 1}};
    TRIAL_EACH_ACCURACY(t)
    {
        double error;
        const SimResult first = ball_row(t, ORDER[0], 0.15, &error);
        trial_note(t, &first, fabs(error), trial_allowed(t, 1e-5, 3e-3), "momentum");
        trial_note(t, &first, first.impacts >= BALLS ? 0 : 1, 0.5, "all four touch");
        for (int i = 1; i < 4; i++) {
            const SimResult r = ball_row(t, ORDER[i], 0.15, NULL);
            trial_close(t, &r, r.kinetic_strain_j, first.kinetic_strain_j, trial_allowed(t, 1e-9, 1e-3),
                        "energy with floors in another order");
            for (int j = 0; j < BALLS; j++)
                for (int k = 0; k < BALLS; k++)
                    if (ORDER[i][j] == ORDER[0][k])
                        trial_compare(t, &r, r.peak_displacement_m[j], first.peak_displacement_m[k],
                                      first.peak_displacement_m[k], trial_allowed(t, 1e-9, 1e-4),
                                      "displacement with floors in another order");
        }
    }
}

static const Case CASES[] = {
    {"hertz-impact", "one impact with r = 1 returns its speed; indentation, force and duration are Hertz's",
     hertz_impact},
    {"bumper-impact",
     "impacts on bumpers from 1e6 to 1e11 N/m: rebound of steel and bumper alike; approach and force by energy",
     bumper_impact},
    {"order-of-convergence", "the rebound at r = 0.7 converges, and its order is measured", convergence},
    {"twelve-decades",
     "the rebound has its closed form over 12 decades of mass, stiffness and speed and r from 0 to 0.99",
     twelve_decades},
    {"grazing", "a gap of peak (1 +- 1e-3 .. 1e-15) is touched or not, and nothing jumps", grazing},
    {"start-at-the-wall", "a contact that closes at speed 0, without a gap", start_at_the_wall},
    {"slow-touch-fast-pull-off",
     "the no-tension condition removes what the law would pull, and the energy account has it",
     slow_touch_fast_pull_off},
    {"static-rest", "a mass pressed against the wall comes to rest and stays (5e3, 1e5, 1e6 intervals)", static_rest},
    {"endless-bounces", "infinitely many bounces end in finite time", endless_bounces},
    {"half-periods", "an undamped mode with steps of k pi / w neither resonates nor hides its peaks", half_periods},
    {"long-steps", "steps of up to ten contact durations create no energy, or the energy-balance error shows it",
     long_steps},
    {"simultaneous-impacts", "floors that close together: their order does not matter, momentum is kept", simultaneous},
    {"within-one-step", "a contact shorter than the interval, and than the engine's own step", within_one_step},
    {"step-does-not-divide", "intervals, steps and durations that do not divide each other", step_does_not_divide},
    {"damping-ratios", "damping 0, 1, above 1, and a rigid-body mode", damping_ratios},
    {"many-steps", "2e4, 2e5 or 1e7 intervals without drift, and no slower at denormal amplitudes", many_steps},
    {"time-reversal", "with r = 1 and no damping a mirrored record brings the mass back to rest", time_reversal}};

const CaseGroup BOB_CASES = {CASES, sizeof CASES / sizeof CASES[0]};
