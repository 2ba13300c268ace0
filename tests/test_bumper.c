/* Bumpers: the force of steel and spring in series, and impacts on it in both engines. */
#include "bench/stability/bob.h"

#include "scene_options.h"

static const double STEEL = 4.865e10; /* [N/m^1.5] */

/* p_h of k p_h^1.5 = k_b (p - p_h) by Newton's method, which from above comes down to the root of a convex function. */
static double series_indentation(double k, double bumper, double p)
{
    double at = fmin(p, cbrt(pow(bumper / k * p, 2))), before;
    do {
        before = at;
        at -= (k * at * sqrt(at) - bumper * (p - at)) / (1.5 * k * sqrt(at) + bumper);
    } while (at < before);
    return at;
}

static double series_law(const Contact *c, double mass, double p, double p_dot, double v0)
{
    const double p_h = series_indentation(c->k, c->bumper, p), elastic = c->k * p_h * sqrt(p_h);
    const double soft = 1 / (1.5 * c->k * sqrt(p_h)), share = soft / (soft + 1 / c->bumper); /* of the compliance */
    const double dashpot = p_dot > 0 ? 2 * c->xi * sqrt(mass * elastic / p) : 0;
    const double force = elastic * (1 + (c->a * share + c->bumper_a * (1 - share)) * p_dot / v0);
    return fmax(force + share * dashpot * p_dot, 0);
}

typedef struct {
    Contact contact;
    double mass, core, v; /* [kg], [kg] 0: a wall, [m/s] */
} Blow;

/* Stiffness over ten decades, every damping, and now and then Jankowski's dashpot. */
static Blow random_blow(uint32_t i)
{
    Random r = random_stream(7, RANDOM_REPLICATE, 0, i);
    Blow b = {.contact = {.k = STEEL, .a = 1.5 * random_uniform(&r), .v0_floor = 1e-300}};
    b.contact.bumper = pow(10, 5 + 10 * random_uniform(&r));
    b.contact.bumper_a = 1.5 * random_uniform(&r);
    if (i % 4 == 3) {
        b.contact.a = 0;
        b.contact.xi = 0.4 * random_uniform(&r);
    }
    b.mass = pow(10, 2 + 4 * random_uniform(&r));
    b.core = i % 2 ? b.mass * pow(10, 2 * random_uniform(&r) - 1) : 0;
    b.v = pow(10, 2 * random_uniform(&r) - 1.5);
    return b;
}

TEST(the_force_is_that_of_steel_and_spring_in_series_with_its_slopes)
{
    for (uint32_t i = 0; i < 2000; i++) {
        const Blow b = random_blow(i);
        Random r = random_stream(8, RANDOM_REPLICATE, 0, i);
        const double p = pow(10, -8 + 7 * random_uniform(&r)), p_dot = b.v * (2 * random_uniform(&r) - 1);
        const ContactForce f = contact_force(&b.contact, b.mass, p, p_dot, b.v);
        assert_close(f.force + 1e-9, series_law(&b.contact, b.mass, p, p_dot, b.v) + 1e-9, 1e-9);
        assert_close(contact_indentation(&b.contact, p), series_indentation(STEEL, b.contact.bumper, p), 1e-9);
        if (f.force == 0)
            continue;
        const double dp = 1e-5 * p, dv = 1e-5 * fabs(p_dot);
        const double by_p = (contact_force(&b.contact, b.mass, p + dp, p_dot, b.v).raw -
                             contact_force(&b.contact, b.mass, p - dp, p_dot, b.v).raw) /
                            (2 * dp);
        const double by_v = (contact_force(&b.contact, b.mass, p, p_dot + dv, b.v).raw -
                             contact_force(&b.contact, b.mass, p, p_dot - dv, b.v).raw) /
                            (2 * dv);
        assert_at_most(fabs(by_p - f.dp), 1e-6 * fabs(f.raw) / p);
        assert_at_most(fabs(by_v - f.dv), 1e-6 * (fabs(f.dv) + f.elastic / b.v));
    }
}

TEST(the_stored_energy_is_the_integral_of_the_elastic_force)
{
    for (uint32_t i = 0; i < 200; i++) {
        const Blow b = random_blow(i);
        enum { N = 2000 };
        const double p = 0.01;
        double sum = 0;
        for (int k = 0; k < N; k++) { /* midpoints in x = sqrt(p) */
            const double x = (k + 0.5) / N * sqrt(p);
            sum += contact_force(&b.contact, b.mass, x * x, 0, 1).elastic * 2 * x * sqrt(p) / N;
        }
        assert_close(contact_stored(&b.contact, p), sum, 1e-6);
    }
}

TEST(a_hard_bumper_is_none_and_a_soft_one_is_a_spring)
{
    const Contact steel = {.k = STEEL, .a = 0.45}, hard = {.k = STEEL, .a = 0.45, .bumper = 1e18, .bumper_a = 0.1};
    const Contact soft = {.k = STEEL, .a = 0.45, .bumper = 1e3, .bumper_a = 0.1};
    for (double p = 1e-6; p < 0.1; p *= 3) {
        assert_close(contact_force(&hard, 1, p, 0.2, 1).force, contact_force(&steel, 1, p, 0.2, 1).force, 1e-6);
        assert_close(contact_force(&soft, 1, p, 0.2, 1).force, 1e3 * p * (1 + 0.1 * 0.2), 1e-3);
    }
}

/* -- impacts ------------------------------------------------------------------------------------------------------- */

typedef struct {
    double kept, depth, force, duration; /* share of the energy in the approach that is left, [m], [N], [s] */
} Rebound;

/* Two free bodies, or one and a wall, in the coordinate p alone: m p'' = -F. Runge-Kutta in t = s^2 from the onset. */
static Rebound integrate(const Blow *b)
{
    const double m = b->core > 0 ? 1 / (1 / b->mass + 1 / b->core) : b->mass;
    const double slow = hypot(contact_hertz_duration(b->contact.k, m, b->v), contact_bumper_duration(&b->contact, m));
    enum { STEPS = 4000 };
    const double h = sqrt(6 * slow) / STEPS, share[4] = {0, 0.5, 0.5, 1};
    Rebound r = {0};
    double p = 0, v = b->v;
    for (int i = 0; i < STEPS; i++) {
        double dp[5] = {0}, dv[5] = {0}, sum_p = 0, sum_v = 0;
        for (int k = 0; k < 4; k++) {
            const double s = (i + share[k]) * h, at = p + share[k] * h * dp[k], speed = v + share[k] * h * dv[k];
            dp[k + 1] = 2 * s * speed;
            dv[k + 1] = at > 0 ? -2 * s * series_law(&b->contact, m, at, speed, b->v) / m : 0;
            sum_p += (k % 3 ? 2 : 1) * dp[k + 1] / 6;
            sum_v += (k % 3 ? 2 : 1) * dv[k + 1] / 6;
        }
        p += h * sum_p;
        v += h * sum_v;
        r.depth = fmax(r.depth, p);
        if (p > 0)
            r.force = fmax(r.force, series_law(&b->contact, m, p, v, b->v));
        if (p <= 0) {
            r.duration = pow((i + 1) * h, 2) - p / v;
            break;
        }
    }
    r.kept = v * v / (b->v * b->v);
    return r;
}

/* The ground sets the body in motion by a short push; it then flies to the core. Its share of the energy in the motion
 * of the common centre of gravity is not turned over. */
static SimResult strike(const Blow *b, Engine engine, Accuracy accuracy)
{
    OWNED(model_free) SimModel model;
    SimResult result = {0};
    const double m = b->core > 0 ? 1 / (1 / b->mass + 1 / b->core) : b->mass;
    const double slow = hypot(contact_hertz_duration(b->contact.k, m, b->v), contact_bumper_duration(&b->contact, m));
    const double dt = 3 * slow;
    double accel[12] = {0, -b->v / dt};
    const Motion motion = {.accel = accel, .n = 12, .dt_s = dt};
    bobs_model(&model, 1, &(Bob){.mass = b->mass, .gap = 4.37 * b->v * dt}, b->core, &b->contact);
    CHECK_OK(engine_entry(engine)->run(&model, &motion, &(EngineOptions){.duration = 9 * dt, .accuracy = accuracy},
                                       &result, &err),
             &err);
    assert_ran(&result);
    assert_int_equal(result.impacts, 1);
    return result;
}

/* Of the energy in the approach. */
static double kept_share(const Blow *b, const SimResult *r)
{
    const double m = b->core > 0 ? 1 / (1 / b->mass + 1 / b->core) : b->mass;
    return 1 - (r->contact_loss_j + r->clamp_j) / (0.5 * m * b->v * b->v);
}

TEST(impacts_are_those_of_an_independent_integration)
{
    double worst[3] = {0};
    for (uint32_t i = 0; i < 60; i++) {
        const Blow b = random_blow(i);
        const Rebound want = integrate(&b);
        const SimResult fast = strike(&b, ENGINE_FAST, ACCURACY_FINE);
        const SimResult standard = strike(&b, ENGINE_FAST, ACCURACY_STANDARD);
        /* Jankowski's force grows like t^0.25, for which the quadrature is not made */
        assert_less(fabs(kept_share(&b, &fast) - want.kept), (b.contact.xi > 0 ? 1e-3 : 4e-6));
        assert_less(fabs(kept_share(&b, &standard) - want.kept), 6e-3);
        assert_close(fast.indentation_max_m + fast.bumper_compression_m, want.depth, 3e-4);
        assert_close(fast.j3_g * 9.81 * b.mass, want.force, 1e-4);
        assert_true(fast.energy_balance_error < 1e-5 && fast.contact_stored_j == 0);
        worst[b.contact.xi > 0] = fmax(worst[b.contact.xi > 0], fabs(kept_share(&b, &fast) - want.kept));
        worst[2] = fmax(worst[2], fabs(kept_share(&b, &standard) - want.kept));
        if (i % 6 == 0) {
            const SimResult cvode = strike(&b, ENGINE_CVODE, ACCURACY_FINE);
            assert_less(fabs(kept_share(&b, &cvode) - want.kept), 1e-5);
            assert_close(cvode.bumper_compression_m, fast.bumper_compression_m, 1e-3);
        }
    }
    print_message("energy kept: fine %.1e, with Jankowski's dashpot %.1e; standard %.1e\n", worst[0], worst[1],
                  worst[2]);
}

TEST(steel_and_bumper_of_the_same_damping_rebound_as_either_alone)
{
    for (double bumper = 1e4; bumper < 1e13; bumper *= 10)
        for (int i = 1; i < 4; i++) {
            const double a = 0.3 * i;
            const Blow b = {
                {.k = STEEL, .a = a, .v0_floor = 1e-300, .bumper = bumper, .bumper_a = a}, 1e5, i == 2 ? 3e5 : 0, 0.3};
            const SimResult r = strike(&b, ENGINE_FAST, ACCURACY_FINE);
            assert_close(sqrt(kept_share(&b, &r)), contact_rebound(a), 4e-6);
        }
}

TEST(a_soft_bumper_rebounds_by_its_own_damping_ratio)
{
    SceneOptions s = paper_scene();
    s.contact.bumper_stiffness_n_m = 1e4;
    for (double zeta = 0.02; zeta < 0.5; zeta += 0.07) {
        Blow b = {.mass = 1e6, .v = 0.5};
        s.contact.bumper_damping = zeta;
        CHECK_OK(contact_make(&b.contact, &s.contact, &err), &err);
        const SimResult r = strike(&b, ENGINE_FAST, ACCURACY_FINE);
        assert_close(sqrt(kept_share(&b, &r)), exp(-M_PI * zeta / sqrt(1 - zeta * zeta)), 1e-3);
        assert_same_number(r.clamp_j, 0);
    }
}

/* A spring meets a mass for half a period, and is compressed by v sqrt(m/k). */
TEST(an_undamped_soft_bumper_is_a_spring_in_depth_and_force)
{
    const Blow b = {{.k = STEEL, .v0_floor = 1e-300, .bumper = 1e5}, 1e5, 0, 0.4};
    const SimResult r = strike(&b, ENGINE_FAST, ACCURACY_FINE);
    assert_close(r.bumper_compression_m, 0.4, 1e-3);
    assert_close(r.j3_g * 9.81 * b.mass, 1e5 * r.bumper_compression_m, 1e-4);
    assert_close(integrate(&b).duration, M_PI, 1e-3);
}

/* -- the tower ----------------------------------------------------------------------------------------------------- */

static void run_tower(const SceneOptions *o, SimResult *r)
{
    double x[22];
    OWNED(motion_free) Motion motion = motion_of("builtin:kobe-like", 0.3, 1.5);
    paper_design(x, 0.002, 0.002);
    *r = run_once(o, &motion, SCENE_IMPACT, x);
}

TEST(softer_bumpers_press_less_and_a_thin_one_bottoms_out)
{
    SceneOptions s = paper_scene();
    SimResult r;
    double force = HUGE_VAL;
    s.sim.duration_s = 12;
    s.sim.forces = 1;
    run_tower(&s, &r);
    assert_true(r.bumper_strain == 0 && r.bumper_compression_m == 0 && !r.bumper_bottoms_out);
    for (double bumper = 1e11; bumper > 1e7; bumper /= 10) {
        s.contact.bumper_stiffness_n_m = bumper;
        run_tower(&s, &r);
        assert_true(r.impacts > 10 && r.forces.contact_force_max_n < force);
        assert_less(r.energy_balance_error, 1e-3);
        force = r.forces.contact_force_max_n;
        assert_close(r.bumper_strain, r.bumper_compression_m / s.contact.bumper_thickness_m, 1e-12);
    }
    assert_false(r.bumper_bottoms_out);
    s.contact.bumper_thickness_m = r.bumper_compression_m;
    run_tower(&s, &r);
    assert_true(r.bumper_bottoms_out);
}

SUITE(NULL, NULL)
