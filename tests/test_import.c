/* OpenSees models written for the test, read as plane frames: closed forms, a frame there and back, refusals. */
#include "program.h"

#include "scene/building.h"
#include "scene/frame.h"
#include "scene_options.h"

static Building import(const char *name, const char *units, const char *model)
{
    char command[256];
    BuildingOptions o = scene_defaults().building;
    Building b;
    Err err = {0};
    write_in_place("model.tcl", model);
    snprintf(command, sizeof command, "import @/model.tcl --units %s --out @/%s", units, name);
    free(output_of(command));
    char *folder = in_place(name);
    snprintf(o.model, sizeof o.model, "%s", folder);
    free(folder);
    CHECK_OK(building_load(&b, &o, &err), &err);
    return b;
}

static const char PORTAL[] = "# a portal in kip and inches\n"
                             "wipe\n"
                             "model BasicBuilder -ndm 2 -ndf 3\n"
                             "set E 29000.; set H [expr 12.*13] ;# storey\n"
                             "set L 240\n"
                             "node 1 0 0\nnode 2 $L 0.0\nnode 3 0 $H -mass 0.7 0.2 0\nnode 4 $L $H\n"
                             "fix 1 1 1 1\nfix 2 1 1 1\n"
                             "mass 4 [expr {(0.1+0.3)/2}] 0.0 0.\n"
                             "mass 3 0.2 0.2 0; # replaces that of the node\n"
                             "equalDOF 3 4 1\n"
                             "geomTransf Linear 1\n"
                             "element elasticBeamColumn 1 1 3 1e6 $E 1000. 1\n"
                             "element elasticBeamColumn 2 2 4 1e6 \\\n   $E [expr -2*-5e2] 1\n"
                             "element elasticBeamColumn 3 3 4 1e6 $E 5e2 1 -mass 1e-4\n";

/* Chopra, Dynamics of Structures, section 1.3. */
static void test_a_portal_in_kip_and_inches_has_its_textbook_stiffness_in_newtons(void **state)
{
    (void)state;
    const double kip_in = 4448.2216152605 / 0.0254, h = 156, EI = 29000.0 * 1000, rho = (500.0 / 240) / (2 * 1000 / h);
    Building b = import("portal", "kip_in", PORTAL);
    assert_int_equal(b.n, 1);
    assert_close(b.K[0], kip_in * 24 * EI / (h * h * h) * (12 * rho + 1) / (12 * rho + 4), 1e-5);
    assert_close(b.M[0], kip_in * (0.2 + 0.2 + 240 * 1e-4), 1e-12); /* lumped */
    assert_close(b.storey_m[0], 156 * 0.0254, 1e-12);
    building_free(&b);
}

/* The 20-storey frame as a model in kN, m and t. */
static char *write_model(const Frame *f)
{
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    fprintf(out, "model BasicBuilder -ndm 2 -ndf 3\ngeomTransf Linear 1\n");
    for (int i = 0; i < f->n_nodes; i++) {
        const FrameNode *n = &f->node[i];
        fprintf(out, "node %s %.17g %.17g\n", n->name, n->x, n->z);
        if (n->fixed[0] || n->fixed[1] || n->fixed[2])
            fprintf(out, "fix %s %d %d %d\n", n->name, n->fixed[0], n->fixed[1], n->fixed[2]);
    }
    for (int i = 0; i < f->n_elements; i++) {
        const FrameElement *e = &f->element[i];
        const FrameSection *s = &f->section[e->section];
        const FrameNode *a = &f->node[e->node[0]], *b = &f->node[e->node[1]];
        const double per_m = s->mass_per_m + e->added_mass / hypot(b->x - a->x, b->z - a->z);
        fprintf(out, "element elasticBeamColumn %s %s %s %.17g %.17g %.17g 1 -mass %.17g -cMass -release %d\n", e->name,
                a->name, b->name, s->area, s->E / 1e3, s->inertia, per_m / 1e3, e->pinned[0] + 2 * e->pinned[1]);
    }
    fclose(out);
    return text;
}

static void test_the_20_storey_frame_as_a_model_gives_the_same_matrices(void **state)
{
    (void)state;
    Frame f;
    Building wanted;
    BuildingOptions o = scene_defaults().building;
    Err err = {0};
    snprintf(o.model, sizeof o.model, "configs/sac20/frame");
    CHECK_OK(building_load(&wanted, &o, &err), &err);
    CHECK_OK(frame_read(&f, o.model, FLOORS_MAX, &err), &err);
    char *model = write_model(&f);
    Building b = import("sac20", "kN_m", model);
    assert_int_equal(b.n, 20);
    double scale_k = 0, scale_m = 0;
    for (int i = 0; i < 400; i++) {
        scale_k = fmax(scale_k, fabs(wanted.K[i]));
        scale_m = fmax(scale_m, fabs(wanted.M[i]));
    }
    for (int i = 0; i < 400; i++) {
        assert_less(fabs(b.K[i] - wanted.K[i]), 1e-11 * scale_k);
        assert_less(fabs(b.M[i] - wanted.M[i]), 1e-11 * scale_m);
    }
    free(model);
    frame_free(&f);
    building_free(&b);
    building_free(&wanted);
}

static void expect_import(int code, const char *message, const char *model)
{
    char arguments[256];
    write_in_place("model.tcl", model);
    snprintf(arguments, sizeof arguments, "import %s/model.tcl --units N_m --out %s/refused", place.folder,
             place.folder);
    expect(code, message, arguments);
}

static void test_every_command_outside_the_subset_is_refused_with_its_line(void **state)
{
    (void)state;
    static const char *const BAD[][2] = {
        {"recorder Node -file x.out\n", "model.tcl:1: 'recorder' is outside the elastic subset"},
        {"\n\nset x 1\nfor {set i 0} {$i < 3} {incr i} {\nnode 1 0 0\n}\n", "model.tcl:4: 'for' is outside"},
        {"model BasicBuilder -ndm 3 -ndf 6\n", "model.tcl:1: model: only -ndm 2 -ndf 3"},
        {"geomTransf Corotational 1\n", "model.tcl:1: geomTransf: only Linear"},
        {"node 1 0 0\nelement truss 1 1 1\n", "model.tcl:2: element truss"},
        {"node 1 0 $y\n", "model.tcl:1: node: '$y' is no number"},
        {"node 1 0 [expr sin(1)]\n", "model.tcl:1: node: '[expr sin(1)]' is no number"},
        {"node 1 0 [expr 1/0]\n", "is no number"},
        {"fix 7 1 1 1\n", "model.tcl:1: fix: there is no node 7 above"},
        {"node 1 0 0\nnode 2 0 1\nequalDOF 1 2 4\n", "model.tcl:3: equalDOF: '4' is no degree of freedom"},
        {"node 1 0 0 -mass 1 1\n", "model.tcl:1: node: '' is no number"},
        {"node 1 0 0\nnode 2 0 1\nelement elasticBeamColumn 1 1 2 1 1 1 1 -foo\n", "'-foo' is not supported"},
        {"node 1 0 0\nnode 2 0 1\ngeomTransf Linear 1\nelement elasticBeamColumn 1 1 2 0 1 1 1\n",
         "A, E and I must be above 0"},
        {"model BasicBuilder -ndm 2 -ndf 3\nnode 1 0 0\n", "holds no element"},
        {"node 1 0 0\n", "model.tcl:1: node: 'model BasicBuilder -ndm 2 -ndf 3' must stand above"},
        {"node 1 0 0\nnode 1 0 1\n", "model.tcl:2: node: 1 is there twice"},
        {"node 1 0 0\nwipe\n", "model.tcl:2: wipe: only above the nodes"},
        {"node 1 0 0\nmass 1 1 1 -0.1\n", "model.tcl:2: mass: a mass of -0.1; it must not be negative"},
        {"node 1 0 0\nmass 1 1 1 1 5\n", "model.tcl:2: mass: '5' is not supported"},
        {"node 1 0 010\n", "'010' is no number"},
        {"node 1 0 0\nnode 2 0 1\nequalDOF 1 2 1\nequalDOF 2 1 3 1\n",
         "model.tcl:4: equalDOF: nodes 2 and 1 are tied in 1"},
        {"node 1 0 0\nnode 2 0 1\nequalDOF 1 2\n", "model.tcl:3: equalDOF: wants two nodes"},
        {"node 1 0 0\nfix 1 1 1 1 0\n", "model.tcl:2: fix: '0' is not supported"},
        {"node 1 0 0\nnode 2 0 1\nelement elasticBeamColumn 1 1 2 1 1 1 7\n", "no geomTransf 7 above"},
        {"geomTransf Linear 1\nnode 1 0 0\nnode 2 0 1\nelement elasticBeamColumn 4 1 2 1 1 1 1\n"
         "element elasticBeamColumn 4 1 2 1 1 1 1\n",
         "model.tcl:5: element 4: is there twice"},
        {"node 1 0 0\nnode 2 0 1\nelement elasticBeamColumn 1 1 2 1 1 1 1 -release 4\n", "-release 4 is none of 0"},
        {"node 1 0 0\nnode 2 0 1\nelement elasticBeamColumn 1 1 2 1 1 1 1 -mass -1\n", "mass of -1; it must not"},
        {"pattern\x1b(0 Plain\n", "'pattern\\x1B(0'"},
    };
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++)
        expect_import(65, BAD[i][1], BAD[i][0]);
    expect_import(65, "2 commands are outside", "recorder a\npattern b\n");
}

static const char CANTILEVER[] = "model BasicBuilder -ndm 2 -ndf 3\ngeomTransf Linear 1\n"
                                 "set H [expr 7/2*1000] ;# 3000, as in Tcl\nset B [expr -7/2*-1000.] ;# 4000\n"
                                 "node 1 0 0\nnode 2 $B 0\nnode 3 0 $H -mass 1e7 1e7 0\nnode 4 $B $H\n"
                                 "fix 1 1 1 1\nfix 2 1 1 1\n"
                                 "element elasticBeamColumn 1 1 3 1e3 2e8 1e6 1\n"
                                 "element elasticBeamColumn 2 2 4 1e3 2e8 1e6 1\n";

static void test_integers_divide_as_integers_and_a_failed_import_leaves_no_folder(void **state)
{
    (void)state;
    char model[1200];
    snprintf(model, sizeof model, "%selement elasticBeamColumn 3 3 4 1e3 2e8 1e6 1\n", CANTILEVER);
    Building b = import("whole", "N_m", model);
    assert_same_number(b.storey_m[0], 3000);
    building_free(&b);
    char *text = read_in_place("whole/nodes.csv");
    assert_non_null(strstr(text, "4,4000,3000"));
    free(text);
    expect_import(65, "model.tcl: no floors: no level", CANTILEVER);
    snprintf(model, sizeof model, "%selement elasticBeamColumn 3 3 4 1e3 2e8 1e6 1\nmass 4 1e40 0 0\n", CANTILEVER);
    expect_import(65, "model.tcl: the first period is ", model);
    snprintf(model, sizeof model, "%snode 5 9 9\nelement elasticBeamColumn 3 3 4 1e3 2e8 1e6 1\n", CANTILEVER);
    expect_import(65, "model.tcl: a mechanism: nothing resists when node 5 ", model);
    char *folder = in_place("refused");
    assert_int_not_equal(access(folder, F_OK), 0);
    free(folder);
}

static void test_an_import_wants_units_and_an_empty_place(void **state)
{
    (void)state;
    write_in_place("model.tcl", PORTAL);
    expect(2, "--units is missing", "import @/model.tcl --out @/none");
    expect(2, "--units feet", "import @/model.tcl --units feet --out @/none");
    expect(2, "--out FOLDER is missing", "import @/model.tcl --units kip_in");
    expect(66, "nowhere.tcl", "import nowhere.tcl --units kip_in --out @/none");
    Building b = import("once", "kip_in", PORTAL);
    building_free(&b);
    expect(74, "nodes.csv", "import @/model.tcl --units kip_in --out @/once");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_portal_in_kip_and_inches_has_its_textbook_stiffness_in_newtons),
        cmocka_unit_test(test_the_20_storey_frame_as_a_model_gives_the_same_matrices),
        cmocka_unit_test(test_every_command_outside_the_subset_is_refused_with_its_line),
        cmocka_unit_test(test_integers_divide_as_integers_and_a_failed_import_leaves_no_folder),
        cmocka_unit_test(test_an_import_wants_units_and_an_empty_place),
    };
    return cmocka_run_group_tests(tests, make_place, clear_place);
}
