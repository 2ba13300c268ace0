/* Buildings from files against closed forms: frames, storeys, units, P-delta, damping. */
#include "program.h"

#include "scene/frame.h"
#include "scene_options.h"

/* ---- folders -------------------------------------------------------------------------------------------------- */

/* An empty folder in the place of this test program; options that name it. */
static BuildingOptions folder_of(const char *name)
{
    BuildingOptions o = scene_defaults().building;
    FREED char *path = in_place(name);
    mkdir(path, 0777);
    snprintf(o.model, sizeof o.model, "%s", path);
    return o;
}

__attribute__((format(printf, 3, 4))) static void write_file(const BuildingOptions *o, const char *name,
                                                             const char *format, ...)
{
    va_list args;
    FILE *f = opened(brief("%s/%s", o->model, name), "w");
    va_start(args, format);
    vfprintf(f, format, args);
    va_end(args);
    assert_int_equal(fclose(f), 0);
}

static Building load(const BuildingOptions *o)
{
    Building b;
    CHECK_OK(building_load(&b, o, &err), &err);
    return b;
}

static void expect_refusal_of(const BuildingOptions *o, const char *wanted)
{
    err = (Err){0};
    assert_int_not_equal(building_load(&(Building){0}, o, &err), STATUS_OK);
    assert_words(err.text, wanted);
}

/* Displacements under a force at one floor. */
static void deflect(const Building *b, int floor, double force, double u[])
{
    double K[FLOORS_MAX * FLOORS_MAX];
    memcpy(K, b->K, (size_t)(b->n * b->n) * sizeof *K);
    memset(u, 0, (size_t)b->n * sizeof *u);
    u[floor] = force;
    CHECK_OK(linalg_solve_spd(b->n, 1, K, u, &err), &err);
}

/* ---- the frame of the benchmark ------------------------------------------------------------------------------- */

static double largest_difference(int n, const double A[], const double B[])
{
    double difference = 0, largest = 0;
    for (int i = 0; i < n * n; i++) {
        difference = fmax(difference, fabs(A[i] - B[i]));
        largest = fmax(largest, fabs(B[i]));
    }
    return difference / largest;
}

TEST(the_20_storey_frame_condenses_to_the_built_in_matrices)
{
    BuildingOptions o = scene_defaults().building;
    OWNED(building_free) Building built_in = load(&o);
    snprintf(o.model, sizeof o.model, "configs/sac20/frame");
    OWNED(building_free) Building frame = load(&o);
    assert_int_equal(frame.n, 20);
    assert_less(largest_difference(20, frame.K, built_in.K), 1e-9);
    assert_less(largest_difference(20, frame.M, built_in.M), 1e-9);
    for (int j = 0; j < 20; j++)
        assert_close(frame.storey_m[j], j == 0 ? 5.4864 : 3.9624, 1e-9);
}

/* ---- frames --------------------------------------------------------------------------------------------------- */

enum { N = 8 };
static const double STOREY = 3.5, EI = 2.1e11 * 4e-4, PER_M = 900;

/* A column of N storeys that are floors, clamped or not, of `parts` elements per storey. */
static BuildingOptions write_column(const char *name, int parts, const char *shear_area)
{
    const BuildingOptions o = folder_of(name);
    char nodes[4096] = "node,x_m,z_m,fix_x,fix_z,fix_rot,floor\nbase,0,0,1,1,1,0\n";
    char elements[4096] = "element,node_i,node_j,section\n1,base,1,c\n";
    for (int k = 1; k <= N * parts; k++) {
        append(nodes, "%d,0,%.17g,0,0,0,%d\n", k, STOREY * k / parts, k % parts == 0 ? k / parts : 0);
        if (k > 1)
            append(elements, "%d,%d,%d,c\n", k, k - 1, k);
    }
    write_file(&o, "nodes.csv", "%s", nodes);
    write_file(&o, "elements.csv", "%s", elements);
    write_file(&o, "sections.csv",
               "section,A_m2,I_m4,E_pa,mass_kg_per_m,shear_area_m2,poisson\nc,0.02,4e-4,2.1e11,%g,%s,0.25\n", PER_M,
               shear_area);
    return o;
}

TEST(a_column_deflects_as_a_cantilever)
{
    const double kGA = 2.1e11 / 2.5 * 5e-4;
    for (int shears = 0; shears < 2; shears++) {
        const BuildingOptions o = write_column("column", 2, shears ? "5e-4" : "0");
        OWNED(building_free) Building b = load(&o);
        double u[N];
        assert_int_equal(b.n, N);
        for (int at = 0; at < N; at++) {
            const double a = STOREY * (at + 1), L = STOREY * N, shear = shears ? 1e4 * a / kGA : 0;
            deflect(&b, at, 1e4, u);
            assert_close(u[at], 1e4 * a * a * a / (3 * EI) + shear, 1e-8);
            assert_close(u[N - 1], 1e4 * a * a / (6 * EI) * (3 * L - a) + shear, 1e-8);
        }
    }
}

TEST(a_column_of_consistent_mass_vibrates_as_a_cantilever)
{
    const BuildingOptions o = write_column("column", 1, "0");
    OWNED(building_free) Building b = load(&o);
    const double L = STOREY * N, beta_l[] = {1.875104069, 4.694091133, 7.854757438}; /* cos x cosh x = -1 */
    for (int i = 0; i < 3; i++)
        assert_close(b.omega[i], pow(beta_l[i] / L, 2) * sqrt(EI / PER_M), 3e-3);
    assert_close(b.omega[0], pow(beta_l[0] / L, 2) * sqrt(EI / PER_M), 1e-5);
}

/* A portal 4 m high and 6 m wide; ends of the columns, of the beam, as given. */
static BuildingOptions write_portal(const char *name, double beam_I, const char *base, const char *pins)
{
    const BuildingOptions o = folder_of(name);
    write_file(&o, "nodes.csv",
               "node,x_m,z_m,fix_x,fix_z,fix_rot\nA,0,0,1,1,%s\nB,6,0,1,1,%s\nC,0,4,0,0,0\nD,6,4,0,0,0\n", base, base);
    write_file(&o, "sections.csv", "section,A_m2,I_m4,E_pa\ncolumn,50,1e-4,2e11\nbeam,50,%.17g,2e11\n", beam_I);
    write_file(&o, "elements.csv",
               "element,node_i,node_j,section,pin_i,pin_j\n1,A,C,column,%s\n2,B,D,column,%s\n"
               "3,C,D,beam,0,0\n",
               pins, pins);
    write_file(&o, "masses.csv", "node,mass_kg\nC,20000\nD,30000\n");
    return o;
}

/* Clamped columns: Chopra, Dynamics of Structures, section 1.3, rho = (EI_b / L) / (2 EI_c / h). */
static double portal_stiffness(double beam_I)
{
    const double h = 4, EIc = 2e11 * 1e-4, rho = (beam_I / 6) / (2 * 1e-4 / h);
    return 24 * EIc / (h * h * h) * (12 * rho + 1) / (12 * rho + 4);
}

TEST(a_portal_frame_has_its_textbook_stiffness)
{
    const double beams[] = {1e-5, 1e-4, 3e-3};
    for (int i = 0; i < 3; i++) {
        BuildingOptions o = write_portal("portal", beams[i], "1", "0,0");
        OWNED(building_free) Building b = load(&o);
        assert_int_equal(b.n, 1);
        assert_close(b.K[0], portal_stiffness(beams[i]), 1e-5);
        assert_close(b.M[0], 50000, 1e-12);
        assert_close(b.storey_m[0], 4, 1e-12);
        o.rigid_floors = SWITCH_OFF; /* a beam of 50 m2 does not stretch either */
        OWNED(building_free) Building elastic = load(&o);
        assert_close(elastic.K[0], portal_stiffness(beams[i]), 1e-4);
    }
}

/* Hinged columns: 3EI_c/h^3 each under a rigid beam, by the base's fixity or by the element's pin. */
TEST(a_hinge_at_the_base_and_a_pin_in_the_column_are_the_same)
{
    BuildingOptions by_base = write_portal("by_base", 10, "0", "0,0"), by_pin = write_portal("by_pin", 10, "1", "1,0");
    OWNED(building_free) Building a = load(&by_base), b = load(&by_pin);
    assert_close(a.K[0], 2 * 3 * 2e11 * 1e-4 / 64, 1e-4);
    assert_close(b.K[0], a.K[0], 1e-9);
}

TEST(a_mechanism_is_refused_with_its_node)
{
    BuildingOptions o = write_portal("swings", 1e-4, "0", "1,1");
    expect_refusal_of(&o, "mechanism");
    o = write_portal("loose", 1e-4, "1", "0,0");
    write_file(&o, "nodes.csv",
               "node,x_m,z_m,fix_x,fix_z,fix_rot\nA,0,0,1,1,1\nB,6,0,1,1,1\nC,0,4,0,0,0\nD,6,4,0,0,0\n"
               "forgotten,3,2,0,0,0\n");
    expect_refusal_of(&o, "node forgotten (x 3 m, z 2 m)");
    write_file(&o, "nodes.csv",
               "node,x_m,z_m,fix_x,fix_z,fix_rot\nA,0,0,1,1,1\nB,6,0,1,1,1\nC,0,4,0,0,0\nD,6,4,0,0,0\n"
               "E,9,4,0,0,0\n");
    write_file(&o, "elements.csv",
               "element,node_i,node_j,section,pin_i,pin_j\n1,A,C,column,0,0\n2,B,D,column,0,0\n"
               "3,C,D,beam,0,0\n4,D,E,beam,1,1\n");
    expect_refusal_of(&o, "node E (x 9 m, z 4 m)");
}

TEST(tied_nodes_move_together)
{
    BuildingOptions o = write_portal("tied", 1e-4, "1", "0,0");
    write_file(&o, "sections.csv", "section,A_m2,I_m4,E_pa\ncolumn,50,1e-4,2e11\nbeam,1e-9,1e-4,2e11\n");
    OWNED(building_free) Building rigid = load(&o);
    o.rigid_floors = SWITCH_OFF;
    write_file(&o, "ties.csv", "node,same_as,x\nC,D,1\n");
    OWNED(building_free) Building tied = load(&o);
    assert_close(tied.K[0], rigid.K[0], 1e-12);
    assert_close(tied.M[0], rigid.M[0], 1e-12);
}

TEST(faults_of_a_frame_name_file_line_and_what_to_do)
{
    static const struct {
        const char *file, *text, *wanted;
    } BAD[] = {
        {"nodes.csv", "node,x_m\nA,0\n", "nodes.csv: has no column z_m"},
        {"nodes.csv", "node,x_m,z_m,fixx\nA,0,0,1\n", "column 'fixx' is not known"},
        {"nodes.csv", "node,x_m,z_m\nA,0,0\nA,1,0\n", "nodes.csv:3: node A is there twice"},
        {"nodes.csv", "node,x_m,z_m,fix_x\nA,0,0,2\n", "nodes.csv:2: fix_x is 2; it is 0 or 1"},
        {"nodes.csv", "node,x_m,z_m\nA,0,high\n", "nodes.csv:2: column 3"},
        {"sections.csv", "section,A_m2,I_m4,E_pa\ncolumn,0,1,1\n", "sections.csv:2: section column: area 0"},
        {"elements.csv", "element,node_i,node_j,section\n1,A,Z,column\n", "elements.csv:2: node_j 'Z' is not in"},
        {"elements.csv", "element,node_i,node_j,section\n1,A,C,beem\n", "elements.csv:2: section 'beem' is not in"},
        {"elements.csv", "element,node_i,node_j,section\n1,A,A,beam\n", "element 1 has no length"},
        {"elements.csv", "element,node_i,node_j,section\n1,A,C,column\n", "a mechanism: nothing resists when node D"},
        {"masses.csv", "node,mass_kg\nC,-1\n", "masses.csv:2: mass_kg is -1"},
        {"ties.csv", "node,same_as,x\nC,Q,1\n", "ties.csv:2: same_as 'Q'"},
        {"masses.csv", "node,mass_kg\nC,\n", "masses.csv:2: column 2"},
        {"masses.csv", "node,mass_kg\nA,5\n", "floor 1 (node C) has no mass"},
        {"elements.csv", "element,node_i,node_j,section\n1,A,C,column\n2,B,D,column\n1,C,D,beam\n",
         "elements.csv:4: element 1 is there twice"},
        {"sections.csv", "section,A_m2,I_m4,E_pa,poisson\ncolumn,1,1,1,0.51\n", "sections.csv:2: poisson is 0.51"},
        {"ties.csv", "node,same_as,x\nC,C,1\n", "ties.csv:2: node C and node C are one"},
        {"ties.csv", "node,same_as,x\nC,D,0\n", "ties.csv:2: ties nothing"},
        {"ties.csv", "node,same_as,z\nC,D,1\nD,C,1\n", "ties.csv:3: node D and node C are one, or tied already"},
        {"elements.csv",
         "element,node_i,node_j,section,pin_i,pin_j\n1,A,C,column,1,0\n2,B,D,column,1,0\n3,C,D,beam,1,1\n",
         "node C (x 0 m, z 4 m) moves along x"},
        {"ties.csv", "node,same_as,x\nC,A,1\n", "floor 1 cannot move by itself"}};
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        const BuildingOptions o = write_portal(brief("bad%zu", i), 1e-4, "1", "0,0");
        write_file(&o, BAD[i].file, "%s", BAD[i].text);
        expect_refusal_of(&o, BAD[i].wanted);
    }
}

/* ---- storeys -------------------------------------------------------------------------------------------------- */

TEST(storeys_that_shear_have_the_frequencies_of_a_chain)
{
    static const char *const HEADS[] = {"height_m,mass_kg,stiffness_n_m", "height_m;mass_t;stiffness_kn_m"};
    const double k = 3e8, m = 2.5e5;
    for (int form = 0; form < 2; form++) {
        BuildingOptions o = folder_of(form ? "storeys_kn" : "storeys");
        char rows[1024] = "";
        for (int j = 0; j < N; j++)
            append(rows, form ? "%g;%g;%g\n" : "%g,%g,%g\n", 3.0 + 0.5 * j, form ? m / 1e3 : m, form ? k / 1e3 : k);
        write_file(&o, "storeys.csv", "%s\n%s", HEADS[form], rows);
        OWNED(building_free) Building b = load(&o);
        assert_int_equal(b.n, N);
        for (int i = 0; i < N; i++) {
            assert_close(b.omega[i], 2 * sqrt(k / m) * sin((2 * i + 1) * M_PI / (2 * (2 * N + 1))), 1e-10);
            assert_close(b.storey_m[i], 3 + 0.5 * i, 1e-12);
        }
    }
}

TEST(storeys_that_bend_and_shear_deflect_as_timoshenkos_cantilever)
{
    const double EI_building = 4e12, k = 5e8, h = 3, L = N * h;
    for (int shears = 0; shears < 2; shears++) {
        BuildingOptions o = folder_of(shears ? "both" : "bending");
        char rows[1024] = "";
        for (int j = 0; j < N; j++)
            append(rows, shears ? "%1$g,2e5,%3$g,%2$g\n" : "%1$g,2e5,%2$g\n", h, EI_building, k);
        write_file(&o, "storeys.csv", "height_m,mass_kg,%sbending_n_m2\n%s", shears ? "stiffness_n_m," : "", rows);
        OWNED(building_free) Building b = load(&o);
        double u[N];
        deflect(&b, N - 1, 1e6, u);
        assert_close(u[N - 1], 1e6 * (L * L * L / (3 * EI_building) + (shears ? N / k : 0)), 1e-9);
    }
}

TEST(faults_of_storeys_are_named)
{
    static const char *const BAD[][2] = {
        {"height_m,mass_kg\n3,1e5\n", "storeys.csv:2: has no stiffness_n_m"},
        {"height_m,stiffness_n_m\n3,1e8\n", "storeys.csv:2: has no mass_kg or mass_t"},
        {"height_m,mass_kg,stiffness_n_m,yield_drift\n3,1e5,1e8,0.01\n3,1e5,1e8,1.5\n",
         "storeys.csv:3: yield_drift is 1.5; it is drift over height, 1 at most"},
        {"height_m,mass_kg,stiffness_n_m,yield_drift\n3,1e5,1e8,0\n",
         "storeys.csv:2: yield_drift is 0; it must be above 0"},
        {"height_m,mass_kg,stiffness_n_m\n3,1e5,1e8\n3,1e5,-1\n", "storeys.csv:3: stiffness_n_m is -1"},
        {"height_m,mass_kg,stiffness_n_m\n4.5,1e5,1e8\n4500,1e5,1e8\n",
         "storeys.csv:3: height_m is 4500; a storey has 0.1 to 100 m: write metres"},
        {"height_m,mass_kg,mass_t,stiffness_n_m\n3,1e5,100,1e8\n", "has both mass_kg and mass_t"},
        {"height_m;mass_t;stiffness_kn_m\n3,5;100;200.000\n", /* a mark of thousands */
         "storeys.csv:2: decimal points and decimal commas are mixed"}};
    const BuildingOptions o = folder_of("bad_storeys");
    for (size_t i = 0; i < N_OF(BAD); i++) {
        write_file(&o, "storeys.csv", "%s", BAD[i][0]);
        expect_refusal_of(&o, BAD[i][1]);
    }
}

TEST(a_folder_holds_one_kind_of_model)
{
    BuildingOptions o = folder_of("kinds");
    expect_refusal_of(&o, "holds no building: K.csv and M.csv, or storeys.csv, or nodes.csv");
    write_file(&o, "M.csv", "1\n");
    write_file(&o, "storeys.csv", "height_m,mass_kg\n3,1e5\n");
    expect_refusal_of(&o, "holds storeys.csv and M.csv, two kinds of model");
    write_file(&o, "nodes.csv", "node,x_m,z_m\nA,0,0\n");
    expect_refusal_of(&o, "holds nodes.csv and storeys.csv, two kinds of model");
}

TEST(heights_may_be_listed_storey_by_storey)
{
    BuildingOptions o = folder_of("matrices");
    write_file(&o, "K.csv", "2e8,-1e8\n-1e8,1e8\n");
    write_file(&o, "M.csv", "2e5,0\n0,2e5\n");
    o.heights_m = LIST_OF(4.5, 3.25);
    OWNED(building_free) Building listed = load(&o);
    assert_close(listed.storey_m[0], 4.5, 1e-15);
    assert_close(listed.storey_m[1], 3.25, 1e-15);
    o.heights_m = LIST_OF(4.5);
    OWNED(building_free) Building alike = load(&o);
    assert_same_number(alike.storey_m[1], 4.5);
    o.heights_m = LIST_OF(4.5, 4, 3);
    expect_refusal_of(&o, "has 3 heights; the building has 2 storeys");
}

/* ---- P-delta -------------------------------------------------------------------------------------------------- */

TEST(p_delta_softens_the_tower_to_its_known_frequency)
{
    BuildingOptions o = scene_defaults().building;
    OWNED(building_free) Building plain = load(&o);
    assert_close(plain.omega[0] / (2 * M_PI), 0.2643, 2e-4);
    o.p_delta = SWITCH_ON;
    OWNED(building_free) Building soft = load(&o);
    assert_close(soft.omega[0] / (2 * M_PI), 0.2553, 2e-4);
}

TEST(p_delta_of_one_storey_is_the_inverted_pendulum)
{
    BuildingOptions o = folder_of("pendulum");
    const double k = 2e6, m = 1e5, h = 4;
    write_file(&o, "storeys.csv", "height_m,mass_kg,stiffness_n_m\n%g,%g,%g\n", h, m, k);
    o.p_delta = SWITCH_ON;
    OWNED(building_free) Building b = load(&o);
    assert_close(b.omega[0] * b.omega[0], k / m - 9.81 / h, 1e-12);
    write_file(&o, "storeys.csv", "height_m,mass_kg,stiffness_n_m\n%g,%g,%g\n", h, m, 0.999 * m * 9.81 / h);
    expect_refusal_of(&o, "buckles under its own weight");
}

/* Does a cantilever of n storeys, 24 m high, stand under a weight at its top? */
static int stands(int n, double weight, double bending)
{
    BuildingOptions o = folder_of("euler");
    char rows[4096] = "";
    for (int j = 0; j < n; j++)
        append(rows, "%.17g,%.17g,%g\n", 24.0 / n, j < n - 1 ? 1e-6 : weight / 9.81, bending);
    write_file(&o, "storeys.csv", "height_m,mass_kg,bending_n_m2\n%s", rows);
    o.p_delta = SWITCH_ON;
    OWNED(building_free) Building b;
    err = (Err){0};
    const int standing = building_load(&b, &o, &err) == STATUS_OK;
    if (!standing)
        assert_non_null(strstr(err.text, "buckles"));
    return standing;
}

TEST(a_column_buckles_at_eulers_load)
{
    const double bending = 8e9, euler = M_PI * M_PI * bending / (4 * 24 * 24);
    double before = 1;
    for (int n = 4; n <= 32; n *= 2) {
        double lo = 0.5 * euler, hi = 2 * euler;
        for (int k = 0; k < 30; k++) {
            const double middle = 0.5 * (lo + hi);
            *(stands(n, middle, bending) ? &lo : &hi) = middle;
        }
        const double error = fabs(lo / euler - 1);
        assert_less(error, before / 3.5); /* straight storeys: order 2 */
        before = error;
    }
    assert_less(before, 1e-3);
}

/* ---- damping -------------------------------------------------------------------------------------------------- */

TEST(rayleigh_damping_goes_through_its_two_modes)
{
    BuildingOptions o = scene_defaults().building;
    o.damping_model = DAMPING_RAYLEIGH;
    o.damping = LIST_OF(0.02);
    o.rayleigh_modes = LIST_OF(1, 4);
    OWNED(building_free) Building b = load(&o);
    assert_close(b.zeta[0], 0.02, 1e-12);
    assert_close(b.zeta[3], 0.02, 1e-12);
    const double w1 = b.omega[0], w4 = b.omega[3];
    for (int i = 0; i < 20; i++)
        assert_close(b.zeta[i], 0.02 * (w1 * w4 / b.omega[i] + b.omega[i]) / (w1 + w4), 1e-12);
    o.rayleigh_modes = LIST_OF(1, 21);
    expect_refusal_of(&o, "21 is none of the 20 modes");
    o.rayleigh_modes = LIST_OF(1, 2.5);
    expect_refusal_of(&o, "2.5 is none of the 20 modes");
    expect(65, "'2, 2' is not two numbers, the first below the second",
           "building guyan --set 'building.rayleigh_modes=2, 2'");
}

TEST(a_list_of_damping_gives_each_mode_its_ratio)
{
    BuildingOptions o = scene_defaults().building;
    o.damping = LIST_OF(0.01, 0.02, 0.05);
    OWNED(building_free) Building b = load(&o);
    assert_true(b.zeta[0] == 0.01 && b.zeta[1] == 0.02 && b.zeta[2] == 0.05 && b.zeta[19] == 0.05);
    o.damping.n = 21;
    expect_refusal_of(&o, "has 21 ratios; the building has 20 modes");
}

/* What `simulate` says by the fast engine and by CVODE, alike; their contacts are in @/contacts-0.csv and -1.csv. */
static json_t *by_two_engines(const char *options)
{
    json_t *both = json_array();
    for (int i = 0; i < 2; i++)
        json_array_append_new(both, as_json("simulate configs/quick.ini --set motion.stretch=1 --set sim.accuracy=fine "
                                            "--json --contacts @/contacts-%d.csv --set sim.engine=%s %s",
                                            i, i ? "cvode" : "fast", options));
    const json_t *fast = json_array_get(both, 0), *cvode = json_array_get(both, 1);
    assert_at_most(10, number(fast, "impacts"));
    assert_int_equal((int)number(fast, "impacts"), (int)number(cvode, "impacts"));
    assert_close(number(fast, "j1_m"), number(cvode, "j1_m"), 1e-4);
    assert_close(number(fast, "j3_g"), number(cvode, "j3_g"), 1e-3);
    return both;
}

/* As many floors as there may be, of which every 18th and the roof strike at once: sets of floors, pads and designs have
 * room for all of them. */
TEST(a_building_of_the_most_floors_is_simulated_alike_by_two_engines)
{
    const BuildingOptions o = folder_of("tall");
    char rows[8192] = "height_m,mass_kg,stiffness_n_m\n", head[2048] = "", gaps[2048] = "";
    for (int j = 0; j < FLOORS_MAX; j++) {
        const int is_near = j % 18 == 0 || j == FLOORS_MAX - 1;
        append(rows, "3.8,4e5,%g\n", 6e9 * (1 - 0.8 * j / FLOORS_MAX));
        append(head, "gap_%02d_m,", j + 1);
        append(gaps, "%g,", is_near ? 5e-6 : 0.01);
    }
    write_file(&o, "storeys.csv", "%s", rows);
    write_file(&o, "design.csv", "%st_base_m,t_top_m\n%s0.02,0.01\n", head, gaps);
    write_file(&o, "push.csv", "time_s,accel_m_s2\n0,0\n0.2,3\n");
    json_decref(by_two_engines("--set building.model=@/tall --design @/tall/design.csv --record @/tall/push.csv "
                               "--set sim.duration_s=0.15"));
    for (int i = 0; i < 2; i++) {
        OWNED(table_free) Table contacts = table_of(brief("contacts-%d.csv", i));
        double highest = 0;
        for (size_t k = 0; k < contacts.n_rows; k++)
            highest = fmax(highest, contacts.values[k * contacts.n_cols + (size_t)table_column(&contacts, "floor")]);
        assert_same_number(highest, FLOORS_MAX);
    }
}

/* ---- more than the floors ------------------------------------------------------------------------------------- */

enum { FULL = 106 };
static const long ALL_MODES = 100000;

TEST(the_full_model_of_the_20_storey_frame_has_the_frequencies_of_its_published_matrices)
{
    static double omega[FULL], phi[FULL * FULL];
    BuildingOptions o = scene_defaults().building;
    OWNED(table_free) Table K, M;
    CHECK_OK(table_read(&K, "configs/sac20/full106/K.csv", 0, &err), &err);
    CHECK_OK(table_read(&M, "configs/sac20/full106/M.csv", 0, &err), &err);
    CHECK_OK(linalg_modes(FULL, K.values, M.values, omega, phi, &err), &err);
    o.modes = ALL_MODES;
    OWNED(building_free) Building b = load(&o);
    assert_int_equal(b.n, 20);
    assert_int_equal(b.model.n, FULL);
    for (int i = 0; i < FULL; i++)
        assert_close(b.model.omega[i], omega[i], 1e-6); /* ten digits of stiffnesses that differ by 1e4 */
    for (int j = 0; j < 20; j++)
        for (int k = 0; k < 20; k++) { /* floors stand first in both */
            assert_less(fabs(b.model.K[j * FULL + k] - K.values[j * FULL + k]), 1e-9 * K.values[0]);
            assert_less(fabs(b.model.M[j * FULL + k] - M.values[j * FULL + k]), 1e-9 * M.values[0]);
        }
}

TEST(a_frame_of_which_no_displacement_is_named_keeps_all_that_have_mass)
{
    BuildingOptions o = write_column("free", 1, "0");
    o.modes = ALL_MODES;
    OWNED(building_free) Building b = load(&o);
    const double L = STOREY * N, beta_l[] = {1.875104069, 4.694091133, 7.854757438, 10.99554073};
    assert_int_equal(b.model.n, 3 * N);
    for (int i = 0, bending = 0; bending < 4; i++)
        if (b.model.like[i] >= 0) { /* the others stretch */
            assert_int_equal(b.model.like[i], bending);
            const double error = pow(beta_l[bending] / N, 4) / 1440; /* of consistent mass, relative */
            assert_close(b.model.omega[i], pow(beta_l[bending] / L, 2) * sqrt(EI / PER_M) * (1 + error), 3e-4);
            bending++;
        }
    o = write_portal("lumped", 1e-4, "1", "0,0");
    o.modes = ALL_MODES;
    OWNED(building_free) Building lumped = load(&o); /* rotations have no mass: they are condensed */
    assert_int_equal(lumped.model.n, 3);
    assert_close(lumped.model.omega[0], lumped.omega[0], 1e-9);
}

/* Sum of what the first twelve horizontal frequencies miss, relative; higher ones mix with vertical ones. */
static double missed_frequencies(const Building *b, const Building *full)
{
    double missed = 0;
    for (int j = 0; j < 12; j++)
        for (int i = 0, k = 0; i < b->model.n && k < full->model.n; i++) {
            if (b->model.like[i] != j)
                continue;
            while (k < full->model.n && full->model.like[k] != j)
                k++;
            missed += fabs(b->model.omega[i] / full->model.omega[k] - 1);
            break;
        }
    return missed;
}

TEST(craig_bampton_converges_to_the_full_model_from_above)
{
    BuildingOptions o = scene_defaults().building;
    o.modes = ALL_MODES;
    OWNED(building_free) Building full = load(&o);
    double last = HUGE_VAL;
    for (o.modes = 4; o.modes < FULL - 20; o.modes *= 2) {
        OWNED(building_free) Building b = load(&o);
        assert_int_equal(b.model.n, 20 + o.modes + 1);
        for (int i = 0; i < b.model.n; i++) /* Rayleigh-Ritz */
            assert_less(full.model.omega[i] * (1 - 1e-9), b.model.omega[i]);
        const double missed = missed_frequencies(&b, &full);
        assert_less(missed, last);
        last = missed;
    }
    assert_less(last, 1e-4);
    o.modes = FULL - 21;
    OWNED(building_free) Building b = load(&o);
    for (int i = 0; i < FULL; i++) /* one mode is missing, and the shape in its place is it */
        assert_close(b.model.omega[i], full.model.omega[i], 1e-7);
}

TEST(whatever_is_kept_the_ground_moves_every_floor_as_one)
{
    BuildingOptions o = scene_defaults().building;
    for (o.modes = 0; o.modes <= 128; o.modes = 2 * o.modes + 4) {
        OWNED(building_free) Building b = load(&o);
        const BuildingModel *m = &b.model;
        for (int j = 0; j < b.n; j++) {
            double one = 0;
            for (int i = 0; i < m->n; i++)
                one += m->phi[j * m->n + i] * m->gamma[i];
            assert_close(one, 1, 1e-9);
        }
        assert_close(building_mass(&b), 5.506e6, 1e-3);
    }
}

/* r is in the span of the floors and the shape that they miss, so that r' M r is the full model's. */
TEST(the_ground_moves_mass_between_the_floors_as_it_does_in_the_full_model)
{
    BuildingOptions o = write_column("heavy", 4, "0");
    double mass[2] = {0}, swing[2];
    for (int i = 0; i < 2; i++) {
        o.modes = i ? ALL_MODES : 0;
        OWNED(building_free) Building b = load(&o);
        const BuildingModel *m = &b.model;
        assert_true(i || m->n == N + 1);
        mass[i] = building_mass(&b);
        swing[i] = m->phi[(N - 1) * m->n] * m->gamma[0];
    }
    assert_close(mass[0], mass[1], 1e-9);
    assert_close(swing[0], swing[1], 1e-3);
}

/* Columns that weigh five times the beam: floors that move by M 1 miss a fifth of J1. */
TEST(a_portal_of_heavy_columns_responds_as_its_full_model_in_two_engines)
{
    enum { PARTS = 8 };
    const BuildingOptions o = folder_of("columns");
    char nodes[1024] = "node,x_m,z_m,fix_x,fix_z,fix_rot,floor\n", elements[1024] = "element,node_i,node_j,section\n";
    for (int k = 0; k <= 2 * PARTS + 1; k++) {
        const int left = k <= PARTS, up = left ? k : k - PARTS - 1;
        append(nodes, "%d,%d,%g,%d,%d,%d,%d\n", k, left ? 0 : 6, 0.5 * up, !up, !up, !up, up == PARTS);
        if (up > 0)
            append(elements, "%d,%d,%d,c\n", k, k - 1, k);
    }
    write_file(&o, "nodes.csv", "%s", nodes);
    write_file(&o, "elements.csv", "%sb,%d,%d,b\n", elements, PARTS, 2 * PARTS + 1);
    write_file(&o, "sections.csv",
               "section,A_m2,I_m4,E_pa,mass_kg_per_m\nc,0.05,1e-4,2e11,6250\nb,0.05,1e-3,2e11,1666.7\n");
    write_file(&o, "far.csv", "gap_01_m,t_base_m,t_top_m\n1,0.01,0.01\n");
    write_file(&o, "near.csv", "gap_01_m,t_base_m,t_top_m\n0.003,0.01,0.01\n");
    static const char *const CASES[] = {"far.csv --set sim.engine=fast --set building.modes=0",
                                        "far.csv --set sim.engine=fast --set building.modes=100000",
                                        "near.csv --set sim.engine=fast", "near.csv --set sim.engine=cvode"};
    json_t *r[4];
    for (int i = 0; i < 4; i++) {
        r[i] = as_json("simulate configs/quick.ini --set building.model=@/columns --set sim.duration_s=20 --set "
                       "sim.accuracy=fine --json --design @/columns/%s",
                       CASES[i]);
    }
    assert_close(number(r[0], "j1_m"), number(r[1], "j1_m"), 0.02);
    assert_at_most(2, number(r[2], "impacts"));
    FOR_EACH (const char *, same, "j1_m", "j3_g", "input_energy_j", "ed1_pct", "base_shear_n")
        assert_close(number(r[2], *same), number(r[3], *same), 1e-4);
    for (int i = 0; i < 4; i++)
        json_decref(r[i]);

    /* consistent mass: of the lowest parts 156 / 420 move with their upper ends */
    const double mass = 6250 * (8 - 2 * 0.5 * (1 - 156.0 / 420)) + 1666.7 * 6;
    double shear[2];
    for (int i = 0; i < 2; i++) {
        json_auto_t *all = as_json("check configs/quick.ini --set building.model=@/columns --json --set %s",
                                   strstr(CASES[i], "building.modes"));
        const json_t *b = json_object_get(all, "building");
        assert_close(number(b, "mass_kg"), mass, 1e-9);
        shear[i] = number(b, "base_shear_share");
    }
    assert_close(shear[0], shear[1], 0.02);
    FREED char *said = output_of("building @/columns");
    json_auto_t *all = as_json("building @/columns --json");
    const double floor = number(json_array_get(json_object_get(all, "floors"), 0), "mass_kg");
    assert_true(floor > 1666.7 * 6 && floor < 0.8 * mass);
    assert_words(said, brief("%.6g t of it are between the floors\n", 1e-3 * (mass - floor)));
}

TEST(vertical_modes_of_the_full_model_resemble_none_of_the_floors)
{
    BuildingOptions o = scene_defaults().building;
    o.modes = ALL_MODES;
    OWNED(building_free) Building b = load(&o);
    int seen[20] = {0};
    for (int i = 0, next = 0; i < 12; i++) { /* ten horizontal, the sixth and the eighth are vertical */
        const int vertical = i == 5 || i == 7;
        assert_int_equal(b.model.like[i], vertical ? -1 : next);
        next += !vertical;
    }
    for (int i = 0; i < b.model.n; i++)
        if (b.model.like[i] >= 0)
            seen[b.model.like[i]]++;
    for (int j = 0; j < 20; j++)
        assert_at_most(1, seen[j]);
}

TEST(p_delta_and_damping_reach_the_full_model)
{
    BuildingOptions o = scene_defaults().building;
    o.modes = ALL_MODES;
    o.p_delta = SWITCH_ON;
    o.damping_model = DAMPING_RAYLEIGH;
    OWNED(building_free) Building rayleigh = load(&o);
    assert_close(rayleigh.model.omega[0], rayleigh.omega[0], 1e-5);
    assert_close(rayleigh.omega[0] / (2 * M_PI), 0.2553, 2e-4);
    assert_close(rayleigh.model.zeta[0], 0.03, 1e-4);
    o.damping_model = DAMPING_MODAL;
    o.damping = LIST_OF(0.01, 0.02, 0.05);
    OWNED(building_free) Building b = load(&o);
    for (int i = 0; i < b.model.n; i++)
        assert_same_number(b.model.zeta[i], (b.model.like[i] == 0 ? 0.01 : b.model.like[i] == 1 ? 0.02 : 0.05));
}

/* Three columns, each with a mass, that soft beams hold together: the middle one knows little of the others. */
TEST(a_floor_that_one_node_stands_for_is_warned_of_where_periods_move)
{
    BuildingOptions o = folder_of("soft");
    write_file(&o, "nodes.csv",
               "node,x_m,z_m,fix_x,fix_z,fix_rot\nA,0,0,1,1,1\nB,6,0,1,1,1\nC,12,0,1,1,1\na,0,4,0,0,0\n"
               "b,6,4,0,0,0\nc,12,4,0,0,0\n");
    write_file(&o, "sections.csv",
               "section,A_m2,I_m4,E_pa\ncolumn,0.05,1e-4,2e11\nstiff,0.05,3e-4,2e11\nbeam,1e-3,1e-4,2e11\n");
    write_file(&o, "elements.csv",
               "element,node_i,node_j,section\n1,A,a,column\n2,B,b,stiff\n3,C,c,column\n4,a,b,beam\n"
               "5,b,c,beam\n");
    write_file(&o, "masses.csv", "node,mass_kg\na,50000\nb,10000\nc,20000\n");
    o.rigid_floors = SWITCH_OFF;
    OWNED(building_free) Building one = load(&o);
    o.modes = ALL_MODES;
    OWNED(building_free) Building full = load(&o);
    const double is = 2 * M_PI / one.model.omega[0], should = 2 * M_PI / full.model.omega[0];
    assert_true(fabs(is / should - 1) > 0.01);
    static const char *const COMMANDS[] = {"building @/soft", "check configs/quick.ini --set building.model=@/soft"};
    for (size_t i = 0; i < 2; i++) {
        OWNED(forget) Said s, all;
        const char *command = brief("%s --set building.rigid_floors=off", COMMANDS[i]);
        const char *wanted = brief("period 1 is %.4g s with one node for each floor, %.4g s in the full", is, should);
        run(&s, "%s", command);
        assert_true(strstr(s.err, wanted) || strstr(s.out, wanted));
        run(&all, "%s --set building.modes=100", command);
        assert_false(strstr(all.err, "one node") || strstr(all.out, "one node"));
    }
    json_auto_t *all = as_json("building @/soft --json --set building.rigid_floors=off --set building.modes=100");
    assert_close(number(json_array_get(json_object_get(all, "modes"), 0), "hz"), 1 / should, 1e-9);
}

TEST(a_built_in_tower_refuses_other_heights)
{
    expect(65, "building.heights_m: guyan is a tower of storeys of 5.4864 and 3.9624 m",
           "building guyan --set building.heights_m=4");
    free(output_of("building appendix --set building.heights_m=5.4864,3.9624"));
}

TEST(only_a_frame_has_more_than_its_floors)
{
    BuildingOptions o = scene_defaults().building;
    o.modes = 3;
    snprintf(o.model, sizeof o.model, "appendix");
    expect_refusal_of(&o, "building.modes: appendix has no more than its floors");
}

/* Both engines on the full model, and the rigid pair's base shear and energies with it. */
TEST(the_full_model_is_simulated_alike_by_two_engines)
{
    char design[1024] = "";
    const BuildingOptions o = folder_of("design");
    for (int j = 0; j < 20; j++)
        append(design, "gap_%02d_m,", j + 1);
    strcat(design, "t_base_m,t_top_m\n");
    for (int j = 0; j < 20; j++)
        append(design, "%g,", 0.001 + 0.0005 * ((j * 7) % 20));
    write_file(&o, "design.csv", "%s0.02,0.008\n", design);
    write_shaking("shaking.csv");
    json_auto_t *both =
        by_two_engines("--set building.modes=100000 --design @/design/design.csv --record @/shaking.csv "
                       "--set sim.duration_s=0.8");
    FOR_EACH (const char *, same, "j1_m", "j2_m", "ed1_pct", "edcs_pct", "base_shear_n", "contact_force_max_n")
        assert_close(number(json_array_get(both, 0), *same), number(json_array_get(both, 1), *same), 1e-4);
}

/* ---- imtet building ------------------------------------------------------------------------------------------- */

TEST(a_building_is_summed_up_and_drawn)
{
    json_auto_t *o = as_json("building configs/sac20/frame %s--json", has_browser() ? "--svg @/frame.svg " : "");
    const BuildingOptions options = scene_defaults().building;
    OWNED(building_free) Building b = load(&options);
    assert_int_equal((int)number(o, "nodes"), 180);
    assert_int_equal((int)number(o, "elements"), 284);
    const json_t *top = json_array_get(json_object_get(o, "floors"), 19);
    assert_close(number(top, "z_m"), 80.772, 1e-9);
    const json_t *first = json_array_get(json_object_get(o, "modes"), 0);
    assert_close(number(first, "hz"), b.omega[0] / (2 * M_PI), 1e-7);
    assert_close(number(first, "damping"), 0.03, 1e-12);
    double shares = 0;
    for (size_t i = 0; i < 20; i++)
        shares += number(json_array_get(json_object_get(o, "modes"), i), "mass_share");
    assert_close(shares, 1, 1e-9);
    if (has_browser()) {
        FREED char *svg = read_in_place("frame.svg");
        assert_int_equal(count(svg, "<title>floor "), 20 * 6);
        assert_int_equal(count(svg, "<title>"), 284 + 20 * 6 + 2 * 5 + 18); /* elements, floors, pins, supports */
        assert_int_equal(count(svg, " fill=\"white\""), 2 * 5 + 18);
        assert_int_equal(count(svg, " stroke=\"#0072b2\""), 10); /* modes */
    }
}

TEST(a_drawing_shows_names_as_text_and_storeys_as_a_stick)
{
    const BuildingOptions o = write_portal("named", 1e-4, "1", "0,0");
    write_file(&o, "elements.csv", "element,node_i,node_j,section\n<b>,A,C,column\n2,B,D,column\n3,C,D,beam\n");
    if (!has_browser())
        skip();
    free(output_of("building @/named --svg @/named.svg"));
    expect_file("named.svg", "<title>&lt;b&gt;: column</title>");
    expect_output("20 floors", "building appendix --svg @/stick.svg --set building.p_delta=on");
    FREED char *svg = read_in_place("stick.svg");
    assert_int_equal(count(svg, "<title>floor "), 20);
    expect(66, "nowhere: there is no such file", "building nowhere");
}

TEST(modes_have_shapes_that_are_listed)
{
    json_auto_t *m = as_json("building configs/quick.ini --json");
    const json_t *shapes = json_object_get(m, "building_shapes"), *share = json_object_get(m, "building_mass_share");
    double sum = 0;
    assert_int_equal((int)json_array_size(shapes), 20);
    for (size_t i = 0; i < 20; i++) {
        const json_t *shape = json_array_get(shapes, i);
        size_t changes = 0;
        double largest = 0;
        for (size_t j = 0; j < 20; j++) {
            const double u = json_number_value(json_array_get(shape, j));
            largest = fmax(largest, fabs(u));
            changes += j > 0 && u * json_number_value(json_array_get(shape, j - 1)) < 0;
        }
        assert_close(largest, 1, 1e-12);
        if (i < 19) /* the last one is local */
            assert_int_equal((int)changes, (int)i);
        sum += json_number_value(json_array_get(share, i));
    }
    assert_close(sum, 1, 1e-12);
}

SUITE(make_place, clear_place)
