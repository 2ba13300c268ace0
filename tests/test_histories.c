/* Responses over time: `imtet simulate --history`, --floor-spectra and j3_filtered_g, against the contact law, the equations
 * of motion, the other engine and closed forms. */
#include "runs.h"
#include "scene_options.h"

#include "sim/floor_filter.h"

static double cell(const Table *t, size_t row, const char *column)
{
    const int c = table_column(t, column);
    if (c < 0)
        fail_msg("there is no column %s", column);
    return t->values[row * t->n_cols + (size_t)c];
}

static double cell_of(const Table *t, size_t row, const char *format, int floor)
{
    return cell(t, row, brief(format, floor));
}

/* ---- the command ----------------------------------------------------------------------------------------------- */

enum { FLOORS = 6 };
#define GAP(floor) (0.002 + 0.001 * (floor)) /* [m] */

/* Six floors with gaps of 2 to 7 mm, and a record. */
static void write_design(void)
{
    char head[256] = "", gaps[256] = "";
    write_shaking("shaking.csv");
    for (int j = 0; j < FLOORS; j++) {
        append(head, "gap_%02d_m,", j + 1);
        append(gaps, "%g,", GAP(j));
    }
    write_in_place("design.csv", brief("%st_base_m,t_top_m\n%s0.02,0.02\n", head, gaps));
}

/* What goes on in the window is written every EVERY seconds, to fast.csv, by the first test that needs it. */
#define SIX    "configs/quick.ini " SIX_FLOORS "--record @/shaking.csv --set sim.duration_s=1 "
#define TOWER  SIX "--design @/design.csv "
#define EVERY  "2e-4 "
#define WINDOW TOWER "--set sim.accuracy=fine "

TEST(forces_of_a_history_are_those_of_the_contact_law)
{
    write_design();
    json_auto_t *o =
        as_json("simulate " WINDOW "--json --history @/fast.csv --every " EVERY "--contacts @/contacts.csv");
    OWNED(table_free) Table h = table_of("fast.csv"), contacts = table_of("contacts.csv");
    double largest = 0;
    const double nu = 0.3, k = 2 * 2.1e11 * sqrt(0.1) / (3 * (1 - nu * nu)), a = 1.5 * (1 - 0.7);
    size_t compared = 0;
    assert_less(5, contacts.n_rows);
    assert_int_equal(contacts.n_rows, (size_t)number(o, "impacts"));
    for (size_t i = 0; i < contacts.n_rows; i++) {
        const int floor = (int)cell(&contacts, i, "floor"), side = (int)cell(&contacts, i, "side");
        const double from = cell(&contacts, i, "t_s"), to = from + cell(&contacts, i, "duration_s");
        const double v0 = fmax(cell(&contacts, i, "approach_m_s"), 1e-3), peak = cell(&contacts, i, "force_n");
        largest = fmax(largest, peak);
        for (size_t r = 0; r < h.n_rows; r++) {
            const double t = cell(&h, r, "t_s");
            if (!(t > from && t < to))
                continue;
            const double u = cell_of(&h, r, "floor_%02d_m", floor) - cell_of(&h, r, "core_%02d_m", floor);
            const double v = cell_of(&h, r, "floor_%02d_m_s", floor) - cell_of(&h, r, "core_%02d_m_s", floor);
            const double force = cell_of(&h, r, "contact_%02d_n", floor), p = side * u - GAP(floor - 1);
            const double law = p > 0 ? fmax(k * pow(p, 1.5) * (1 + a * side * v / v0), 0) : 0;
            if (fabs(law + side * force) > 5e-4 * peak)
                fail_msg("t = %.6g s, floor %d: force %g N, by the law %g", t, floor, force, -side * law);
            compared++;
        }
    }
    assert_less(10, compared);
    assert_close(largest, number(o, "contact_force_max_n"), 1e-12);
}

TEST(histories_of_both_engines_agree_before_the_horizon)
{
    free(output_of("simulate " WINDOW "--set sim.engine=cvode --history @/cvode.csv --every " EVERY));
    OWNED(table_free) Table a = table_of("fast.csv"), b = table_of("cvode.csv");
    assert_int_equal(a.n_rows, b.n_rows);
    assert_int_equal(a.n_cols, b.n_cols);
    for (size_t c = 1; c < a.n_cols; c++) {
        double apart = 0, most = 0;
        for (size_t r = 0; r < a.n_rows; r++) {
            apart = fmax(apart, fabs(a.values[r * a.n_cols + c] - b.values[r * b.n_cols + c]));
            most = fmax(most, fabs(b.values[r * b.n_cols + c]));
        }
        if (!(apart <= 2e-4 * most))
            fail_msg("%s: %g apart, largest %g", a.names[c], apart, most);
    }
}

TEST(a_history_reaches_the_peaks_and_its_energies_add_up)
{
    FOR_EACH (const char *, walls, "", "--set core.wall=effective ") {
        json_auto_t *o = as_json("simulate " WINDOW "%s--json --every 5e-5 --history @/walls.csv", *walls);
        OWNED(table_free) Table h = table_of("walls.csv");
        double u = 0, drift = 0, accel = 0, input = 0, error = 0;
        for (size_t r = 0; r < h.n_rows; r++) {
            double parts = 0;
            for (int j = 1; j <= FLOORS; j++) {
                u = fmax(u, fabs(cell_of(&h, r, "floor_%02d_m", j)));
                drift = fmax(drift, fabs(cell_of(&h, r, "drift_%02d_m", j)));
                accel = fmax(accel, fabs(cell_of(&h, r, "accel_%02d_g", j)));
            }
            FOR_EACH (const char *, part, "kinetic_j", "strain_j", "damped_building_j", "core_j", "damped_core_j",
                      "contacts_j")
                parts += cell(&h, r, *part);
            input = cell(&h, r, "input_j");
            error = fmax(error, fabs(parts - input));
        }
        assert_close(u, number(o, "j1_m"), 1e-6);
        assert_close(drift, number(o, "j2_m"), 1e-6);
        assert_close(accel, number(o, "j3_g"), 1e-2);
        assert_less(error, 1e-12 * input);
        assert_less(0, number(o, "j3_filtered_g"));
    }
    free(output_of("simulate " SIX "--design none --history @/none.csv"));
    free(output_of("simulate " TOWER "--rigid --history @/rigid.csv --every 0.01"));
    OWNED(table_free) Table none = table_of("none.csv");
    assert_close(cell(&none, 1, "t_s"), 0.02, 1e-12);
    OWNED(table_free) Table rigid = table_of("rigid.csv"); /* floor and core are one */
    for (size_t r = 0; r < rigid.n_rows; r++) {
        assert_close(cell(&rigid, r, "t_s"), 0.01 * (double)r, 1e-9);
        assert_same_number(cell(&rigid, r, "floor_06_m"), cell(&rigid, r, "core_06_m"));
        assert_same_number(cell(&rigid, r, "floor_06_m_s"), cell(&rigid, r, "core_06_m_s"));
    }
}

TEST(options_of_time_files_are_checked_before_the_simulation)
{
    static const char *const WRONG[][2] = {
        {"--history @/x.csv --every nan", "--every"},       {"--history @/x.csv --every 1e-9", "not a number"},
        {"--history @/none/x.csv", "none/x.csv"},           {"--contacts @/none/x.csv", "none/x.csv"},
        {"--rigid --contacts @/x.csv", "--contacts needs"}, {"--floor-spectra @/none/x.csv", "none/x.csv"}};
    write_design();
    for (size_t i = 0; i < sizeof WRONG / sizeof WRONG[0]; i++) {
        OWNED(forget) Said said;
        run(&said, "simulate " TOWER "%s", WRONG[i][0]);
        if (said.code == 0 || !strstr(said.err, WRONG[i][1]) || said.out[0]) /* nor is a simulation printed */
            fail_msg("%s: exit %d, said %s", WRONG[i][0], said.code, said.err);
    }
}

/* ---- equations of motion --------------------------------------------------------------------------------------- */

enum { N = 20 };

/* Of building or core: what displacements add to the sum over its nodes of K u, velocities to that of M u', and
 * displacements to that of C u, where C = M Phi diag(2 zeta w) Phi' M. */
typedef struct {
    double stiffness[N], mass[N], damping[N];
} Weights;

static Weights weights_of(const double K[], const double M[], const double phi[], const double omega[],
                          const double zeta[])
{
    Weights w = {0};
    for (int j = 0; j < N; j++)
        for (int l = 0; l < N; l++) {
            w.stiffness[l] += K[j * N + l];
            w.mass[l] += M[j * N + l];
        }
    for (int i = 0; i < N; i++) {
        double of_one = 0;
        for (int j = 0; j < N; j++)
            of_one += phi[j * N + i] * w.mass[j];
        for (int j = 0; j < N; j++)
            for (int l = 0; l < N; l++)
                w.damping[l] += of_one * 2 * zeta[i] * omega[i] * phi[j * N + i] * M[j * N + l];
    }
    return w;
}

static double sum_of(const double weights[N], const double u[])
{
    double sum = 0;
    for (int j = 0; j < N; j++)
        sum += weights[j] * u[j];
    return sum;
}

typedef struct {
    const SimWorker *worker;
    Weights building, core;
    size_t n, room;
    double (*at)[5]; /* t, base shear, momentum relative to the ground, damping impulse, ground */
    double mass;
} Sums;

static void add_sums(const SimSample *s, void *user)
{
    Sums *sums = user;
    FloorMotion f;
    if (s->t == 0)
        sums->n = 0;
    assert_less(sums->n, sums->room);
    sim_worker_motion(sums->worker, s, &f);
    double *at = sums->at[sums->n++];
    at[0] = s->t;
    at[1] = sum_of(sums->building.stiffness, f.u) + sum_of(sums->core.stiffness, f.core);
    at[2] = sum_of(sums->building.mass, f.u_dot) + sum_of(sums->core.mass, f.core_dot);
    at[3] = sum_of(sums->building.damping, f.u) + sum_of(sums->core.damping, f.core);
    at[4] = s->ground;
}

TEST(the_base_shear_is_what_inertia_and_damping_need)
{
    SimResult r;
    CoreBeam core;
    double x[22];
    SceneOptions o = paper_scene();
    o.sim.duration_s = 6;
    o.sim.accuracy = ACCURACY_FINE;
    o.sim.forces = FORCES_YES;
    OWNED(motion_free) Motion motion = motion_of("builtin:elcentro-like", 0, 1);
    OWNED(one_scene_free) OneScene stage = one_scene_of(&o, &motion);
    const Building *of = scene_building(stage.scene);
    paper_design(x, 0.004, 0.001);
    CHECK_OK(core_beam_make(&core, &o.core, N, of->storey_m, x[20], x[21], &err), &err);
    double core_zeta[N];
    for (int i = 0; i < N; i++)
        core_zeta[i] = o.core.damping;
    Sums s = {.worker = stage.worker,
              .building = weights_of(of->K, of->M, of->phi, of->omega, of->zeta),
              .core = weights_of(core.K, core.M, core.phi, core.omega, core_zeta),
              .room = 80000};
    s.at = malloc(s.room * sizeof *s.at);
    for (int j = 0; j < N; j++)
        s.mass += s.building.mass[j] + s.core.mass[j];
    sim_worker_sample(stage.worker, 1.6e-4, add_sums, &s);
    CHECK_OK(sim_run(stage.worker, SCENE_IMPACT, x, &r, &err), &err);
    assert_ran(&r);
    assert_true(r.impacts > 20 && s.n > 30000);
    double shear = 0, inertia = 0, largest = 0, worst = 0, peak = 0;
    for (size_t k = 0; k + 2 < s.n; k += 2) { /* Simpson: base shear and ground over two samples */
        const double *a = s.at[k], *b = s.at[k + 1], *c = s.at[k + 2], h = c[0] - a[0];
        shear += h / 6 * (a[1] + 4 * b[1] + c[1]);
        inertia += c[2] - a[2] + s.mass * h / 6 * (a[4] + 4 * b[4] + c[4]) + c[3] - a[3];
        worst = fmax(worst, fabs(shear + inertia));
        largest = fmax(largest, fabs(shear));
        peak = fmax(peak, fmax(fabs(a[1]), fabs(b[1])));
    }
    if (!(worst < 1e-6 * largest))
        fail_msg("base shear and inertia with damping differ by %g of %g N s", worst, largest);
    assert_close(r.forces.base_shear_n, peak, 1e-3);
    free(s.at);
}

/* ---- the filter ------------------------------------------------------------------------------------------------ */

static const double CUTOFF = 25;

/* Peak of floor 0 where its displacement is u(t) [m] for four seconds, samples h apart. */
static double filtered_peak(double h, double (*u)(double t, double parameter), double parameter, double ground)
{
    FloorFilter *f;
    double peaks[3];
    CHECK_OK(floor_filter_create(&f, 3, CUTOFF, &err), &err);
    floor_filter_start(f, h);
    for (size_t i = 0; (double)i * h < 4; i++) {
        double *row = floor_filter_add(f, ground);
        assert_non_null(row);
        for (int j = 0; j < 8; j++)
            row[j] = j == 0 ? u((double)i * h, parameter) : 0;
    }
    CHECK_OK(floor_filter_peaks(f, peaks, &err), &err);
    assert_true(peaks[1] <= fabs(ground) * 1.2 && peaks[1] >= fabs(ground));
    floor_filter_free(f);
    return peaks[0];
}

/* A sine that begins and ends softly, of acceleration 1. */
static double sine(double t, double hz)
{
    const double w = 2 * M_PI * hz, envelope = t > 0 && t < 4 ? pow(sin(M_PI * t / 4), 2) : 0;
    return envelope * sin(w * t) / (w * w);
}

TEST(a_sine_keeps_the_gain_of_butterworth)
{
    const double h = floor_filter_spacing(CUTOFF), shares[] = {0.1, 0.3, 0.5, 0.7, 0.9, 1};
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) {
        const double gain = 1 / (1 + pow(shares[i], 8));
        assert_close(filtered_peak(h, sine, shares[i] * CUTOFF, 0), gain, shares[i] > 0.8 ? 0.02 : 5e-3);
        assert_close(filtered_peak(h / 4, sine, shares[i] * CUTOFF, 0), gain, 4e-3);
    }
    assert_less(filtered_peak(h, sine, 4 * CUTOFF, 0), 1e-3);
    assert_less(filtered_peak(h, sine, 9 * CUTOFF, 0), 0.01); /* 225 Hz, near the sampling rate of 250 Hz */
}

/* A speed of 1 m/s, gained at t0. */
static double kink(double t, double t0)
{
    return t > t0 && t < 4 ? t - t0 : 0;
}

/* A spike of 1 m/s, however short, is the filter's response to an impulse: int G df = 2 fc (pi/8) / sin(pi/8). */
TEST(an_impact_between_two_samples_is_the_response_to_an_impulse)
{
    const double h = floor_filter_spacing(CUTOFF), wanted = 2 * CUTOFF * (M_PI / 8) / sin(M_PI / 8);
    for (int i = 0; i < 10; i++) {
        assert_close(filtered_peak(h, kink, 2 + 0.1 * i * h, 0), wanted, 0.03);
        assert_close(filtered_peak(h / 8, kink, 2 + 0.1 * i * h, 0), wanted, 3e-3);
    }
}

static double nothing(double t, double parameter)
{
    (void)t;
    return 0 * parameter;
}

TEST(what_stands_still_feels_the_ground)
{
    const double felt = filtered_peak(1e-3, nothing, 0, 3.7);
    assert_true(felt >= 3.7 && felt < 1.2 * 3.7); /* overshoots where it sets in */
}

/* Displacements of the floors, all of them, for a filter of its own. */
typedef struct {
    const SimWorker *worker;
    FloorFilter *filter;
    long samples;
} AllSamples;

static void add_sample(const SimSample *s, void *user)
{
    AllSamples *all = user;
    if (s->t == 0) {
        floor_filter_start(all->filter, s->spacing);
        all->samples = 0;
    }
    sim_worker_floors(all->worker, s, floor_filter_add(all->filter, s->ground));
    all->samples++;
}

TEST(samples_that_are_left_out_change_no_filtered_peak)
{
    SimResult r;
    double x[22], peaks[20], worst = 0;
    SceneOptions o = paper_scene();
    o.sim.filtered = 1;
    o.sim.filter_hz = CUTOFF;
    OWNED(motion_free) Motion motion = motion_of("builtin:kobe-like", 0.3, 3.1);
    OWNED(one_scene_free) OneScene stage = one_scene_of(&o, &motion);
    AllSamples all = {.worker = stage.worker};
    CHECK_OK(floor_filter_create(&all.filter, 20, CUTOFF, &err), &err);
    for (int design = 0; design < 4; design++) {
        paper_design(x, 0.05 + 0.03 * design, 0.01);
        sim_worker_sample(stage.worker, 0, NULL, NULL);
        CHECK_OK(sim_run(stage.worker, SCENE_IMPACT, x, &r, &err), &err);
        assert_true(r.filtered_known && r.impacts > 20 && r.j3_filtered_g < r.j3_g);
        const SimResult few = r;
        sim_worker_sample(stage.worker, floor_filter_spacing(CUTOFF), add_sample, &all);
        CHECK_OK(sim_run(stage.worker, SCENE_IMPACT, x, &r, &err), &err);
        assert_less(r.settled_s / floor_filter_spacing(CUTOFF), (double)all.samples);
        CHECK_OK(floor_filter_peaks(all.filter, peaks, &err), &err);
        for (int j = 0; j < 20; j++)
            worst = fmax(worst, fabs(few.peak_filtered_g[j] * 9.81 / peaks[j] - 1));
    }
    if (!(worst < 1e-4))
        fail_msg("a filtered peak differs by %g", worst);
    floor_filter_free(all.filter);
}

/* ---- floor spectra ----------------------------------------------------------------------------------------------- */

/* On a building that is as stiff as rock the floor does as the ground: a sine of 1 Hz in resonance with an oscillator of 5 %
 * damping, 1 / (2 zeta) = 10 times the acceleration, and the acceleration itself far above. */
TEST(a_sine_has_ten_times_its_acceleration_in_the_floor_spectrum)
{
    write_storeys_in_place("stiff", "4,1e3,4e10\n4,1e3,4e10\n");
    FILE *f = opened(there("sine.csv"), "w");
    fputs("t_s,a_m_s2\n", f);
    for (int i = 0; i <= 4000; i++)
        fprintf(f, "%.2f,%.12g\n", 0.01 * i, 0.981 * sin(2 * M_PI * 0.01 * i));
    fclose(f);
    free(output_of("simulate configs/quick.ini --design none --record @/sine.csv --set building.model=@/stiff "
                   "--set motion.pga_g=0 --set motion.stretch=1 --floor-spectra @/spectra.csv"));
    OWNED(table_free) Table t = table_of("spectra.csv");
    size_t nearest = 0;
    for (size_t r = 0; r < t.n_rows; r++) {
        if (fabs(cell(&t, r, "period_s") - 1) < fabs(cell(&t, nearest, "period_s") - 1))
            nearest = r;
        assert_close(cell(&t, r, "floor_01_psa_g"), cell(&t, r, "ground_psa_g"), 5e-3);
    }
    const double ratio = cell(&t, nearest, "period_s"), wanted = 0.1 / hypot(1 - ratio * ratio, 0.1 * ratio);
    assert_close(cell(&t, nearest, "floor_02_psa_g"), wanted, 2e-2);
    assert_close(cell(&t, 0, "floor_02_psa_g"), 0.1, 5e-3);
}

/* ---- contacts that begin where a sample is ------------------------------------------------------------------------ */

/* A floor of its own period between walls, shaken so that it swings up slowly. */
static void write_one_floor(void)
{
    FREED char *text = NULL;
    size_t length;
    write_storeys_in_place("one", "4,3e5,2e7\n");
    FILE *f = open_memstream(&text, &length);
    fprintf(f, "time_s,accel_m_s2\n");
    for (int i = 0; i < 400; i++)
        fprintf(f, "%.2f,%.17g\n", 0.02 * i, 2 * sin(2 * M_PI * 0.024 * i) * pow(sin(M_PI * i / 400), 2));
    fclose(f);
    write_in_place("one/record.csv", text);
    write_in_place("one/one.ini", "[building]\nmodel = .\n[motion]\nrecord = record.csv\n");
}

/* Impacts of the floor with that gap, which the list of contacts has as well. */
static long impacts_with(double gap, const char *law, const char *engine)
{
    write_in_place("one/gap.csv", brief("gap_01_m,t_base_m,t_top_m\n%.17g,0.02,0.02\n", gap));
    json_auto_t *o = as_json("simulate @/one/one.ini --design @/one/gap.csv --json --contacts @/one/contacts.csv --set "
                             "sim.duration_s=3.5 --set sim.engine=%s --set contact.law=%s",
                             engine, law);
    const long n = (long)number(o, "impacts");
    OWNED(table_free) Table t = table_of("one/contacts.csv");
    if (t.n_rows != (size_t)n)
        fail_msg("%s, %s, gap %.17g: %ld impacts, %zu contacts", engine, law, gap, n, t.n_rows);
    return n;
}

/* The gap is what lies between the two bodies at a sample, where nothing has touched before. */
TEST(an_impact_that_begins_at_a_sample_counts_once)
{
    static const char *const LAWS[] = {"paper", "jankowski"}, *const ENGINES[] = {"fast", "cvode"};
    write_one_floor();
    write_in_place("one/gap.csv", "gap_01_m,t_base_m,t_top_m\n5,0.02,0.02\n");
    free(output_of("simulate @/one/one.ini --design @/one/gap.csv --csv /dev/null --history @/one/h.csv --every 0.02"));
    OWNED(table_free) Table h = table_of("one/h.csv");
    FOR_EACH (int, sample, 38, 142) {
        const size_t k = (size_t)*sample;
        const double gap = fabs(cell(&h, k, "floor_01_m") - cell(&h, k, "core_01_m"));
        for (int law = 0; law < 2; law++)
            for (int engine = 0; engine < 2; engine++) {
                const long n = impacts_with(gap, LAWS[law], ENGINES[engine]);
                assert_less(1, n);
                assert_int_equal(impacts_with(gap * (1 - 1e-9), LAWS[law], ENGINES[engine]), n);
                assert_int_equal(impacts_with(gap * (1 + 1e-9), LAWS[law], ENGINES[engine]), n);
            }
    }
}

SUITE(prepare, clear_place)
