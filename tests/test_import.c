/* OpenSees models written for the test, read as plane frames: closed forms, a frame there and back, refusals. */
#include "program.h"

#include "scene/frame.h"
#include "scene_options.h"

/* model.tcl in these units. */
static BuildingOptions options_of(const char *model, BuildingUnits units)
{
    BuildingOptions o = scene_defaults().building;
    write_in_place("model.tcl", model);
    snprintf(o.model, sizeof o.model, "%s/model.tcl", place.folder);
    o.units = units;
    return o;
}

static Building import(const char *model, BuildingUnits units)
{
    const BuildingOptions o = options_of(model, units);
    Building b;
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
TEST(a_portal_in_kip_and_inches_has_its_textbook_stiffness_in_newtons)
{
    const double kip_in = 4448.2216152605 / 0.0254, h = 156, EI = 29000.0 * 1000, rho = (500.0 / 240) / (2 * 1000 / h);
    OWNED(building_free) Building b = import(PORTAL, BUILDING_KIP_IN);
    assert_int_equal(b.n, 1);
    assert_close(b.K[0], kip_in * 24 * EI / (h * h * h) * (12 * rho + 1) / (12 * rho + 4), 1e-5);
    assert_close(b.M[0], kip_in * (0.2 + 0.2 + 240 * 1e-4), 1e-12); /* lumped */
    assert_close(b.storey_m[0], 156 * 0.0254, 1e-12);
}

/* The 20-storey frame as a model in kN, m and t. */
static char *write_model(const Frame *f)
{
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    fprintf(out, "model BasicBuilder -ndm 2 -ndf 3\ngeomTransf Linear 1\n");
    for (int i = 0; i < f->n[FRAME_NODES]; i++) {
        const FrameNode *n = &f->node[i];
        fprintf(out, "node %s %.17g %.17g\n", n->name, n->x, n->z);
        if (n->fixed[0] || n->fixed[1] || n->fixed[2])
            fprintf(out, "fix %s %d %d %d\n", n->name, n->fixed[0], n->fixed[1], n->fixed[2]);
    }
    for (int i = 0; i < f->n[FRAME_ELEMENTS]; i++) {
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

TEST(the_20_storey_frame_as_a_model_gives_the_same_matrices)
{
    OWNED(frame_free) Frame f;
    OWNED(building_free) Building wanted;
    BuildingOptions o = scene_defaults().building;
    snprintf(o.model, sizeof o.model, "configs/sac20/frame");
    CHECK_OK(building_load(&wanted, &o, &err), &err);
    CHECK_OK(frame_read(&f, &o, &err), &err);
    FREED char *model = write_model(&f);
    OWNED(building_free) Building b = import(model, BUILDING_KN_M_T);
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
}

TEST(loops_procedures_and_sections_give_the_frame_written_out)
{
    static const char HEAD[] = "model basic -ndm 2\nset n [expr 7/2]; # 3, as in Tcl\ngeomTransf PDelta 1\n";
    static const char LOOPS[] =
        "proc column {tag i j} { global A\n element elasticBeamColumn $tag $i $j $A 2e8 1e-3 1 }\n"
        "pset A 1e-1\nset lists {{1 0 0} {2 6 0}}\n"
        "foreach l $lists { node [lindex $l 0] [lindex $l 1] [lindex $l 2]; fix [lindex $l 0] 1 1 1 }\n"
        "for {set k 1} {$k <= $n} {incr k} {\n"
        "  node 1$k 0 [expr 3.*$k] -mass 20 20 0; node 2$k 6 [expr 3.*$k]\n"
        "  if {$k == 1} { column 1 1 11; column 2 2 21 } else {\n"
        "    column 1$k 1[expr $k-1] 1$k; column 2$k 2[expr $k-1] 2$k }\n"
        "  source more/beam.tcl\n}\n"
        "exit\nthis is not read\n";
    static const char PLAIN[] =
        "node 1 0 0\nnode 2 6 0\nfix 1 1 1 1\nfix 2 1 1 1\nsection Elastic 7 2e8 0.1 1e-3\n"
        "node 11 0 3 -mass 20 20 0\nnode 21 6 3\nnode 12 0 6 -mass 20 20 0\nnode 22 6 6\nnode 13 0 9 -mass 20 20 0\n"
        "node 23 6 9\nelement forceBeamColumn 1 1 11 5 7 1\nelement dispBeamColumn 2 2 21 5 7 1\n"
        "element elasticBeamColumn 3 11 12 7 1\nelement elasticBeamColumn 4 21 22 7 1\n"
        "element elasticBeamColumn 5 12 13 7 1\nelement elasticBeamColumn 6 22 23 7 1\n"
        "uniaxialMaterial Elastic 1 2e8\nelement truss 7 11 21 0.1 1\nelement truss 8 12 22 0.1 1\n"
        "element truss 9 13 23 0.1 1\n";
    write_in_place("more/beam.tcl", "element elasticBeamColumn 9$k 1$k 2$k 0.1 2e8 1e-3 1 -release 3\n");
    OWNED(building_free) Building loops = import(brief("%s%s", HEAD, LOOPS), BUILDING_KN_M_T);
    OWNED(building_free) Building plain = import(brief("%s%s", HEAD, PLAIN), BUILDING_KN_M_T);
    assert_int_equal(loops.n, 3);
    for (int i = 0; i < 9; i++) {
        assert_close(loops.K[i], plain.K[i], 1e-12);
        assert_same_number(loops.M[i], plain.M[i]);
    }
}

/* Those of OpenSees' verification manual carry masses of 1e-10 along z and about the node. */
TEST(negligible_masses_leave_the_lowest_periods_of_the_full_model)
{
    BuildingOptions o = options_of(brief("%s\nmass 3 0.2 1e-10 1e-10\n", PORTAL), BUILDING_KIP_IN);
    OWNED(building_free) Building b, full;
    CHECK_OK(building_load(&b, &o, &err), &err);
    o.modes = 100000;
    CHECK_OK(building_load(&full, &o, &err), &err);
    assert_close(full.model.omega[0], b.omega[0], 1e-3);
}

TEST(loads_analysis_and_output_are_skipped_with_one_note)
{
    OWNED(forget) Said s;
    FREED char *text =
        formatted("%srecorder Node -file x.out\npattern Plain 1 Linear { load 3 1. 0. 0. }\nset lambda [eigen 2]\n"
                  "puts \"[expr sqrt([lindex $lambda 1])]\"\nrecorder Node\nanalyze 10\nset d [lindex [nodeDisp 3] 4]\n"
                  "puts [expr $d*2]\nfoo\n",
                  PORTAL);
    write_in_place("model.tcl", text);
    run(&s, "building @/model.tcl --set building.units=kip_in");
    assert_int_equal(s.code, 0);
    assert_words(s.err, "skipped: recorder, pattern, eigen, analyze, nodeDisp, all from", "model.tcl:27 on");
    assert_non_null(strstr(s.out, "1 floor"));
}

/* OpenSees would have run on, with elements that would be missing here. */
TEST(a_script_that_fails_after_its_analysis_is_refused_where_it_goes_on_building)
{
    static const char *const REST[][2] = {{"puts \"element 9\"\n# element 9\nset mass 3\n", NULL},
                                          {"if {1} {\n  element truss 9 1 2 1. 1\n}\n", "line 26 goes on"},
                                          {"\nbrace 9\n", "line 26 goes on with the structure"},
                                          {"for {set i 0} {$i < 2} {incr i} { fix 3 0 0 1 }\n", "line 25 goes on"}};
    for (size_t i = 0; i < sizeof REST / sizeof REST[0]; i++) {
        OWNED(forget) Said s;
        FREED char *text = formatted(
            "%sproc brace {tag} {\n element truss $tag 1 2 1. 1\n}\nset l [eigen 1]\nset f [expr [lindex $l 7] * "
            "2]\n%s",
            PORTAL, REST[i][0]);
        write_in_place("model.tcl", text);
        run(&s, "building @/model.tcl --set building.units=kip_in");
        assert_int_equal(s.code, REST[i][1] ? 65 : 0);
        assert_words(s.err, REST[i][1] ? REST[i][1] : "on,");
    }
    write_in_place("later.tcl", "eigen 1\nexpr [nodeDisp 3 1] +\n");
    write_in_place("model.ops", brief("%ssource later.tcl\nmass 3 1 1 1\n", PORTAL));
    expect(65, "line 21 goes on", "building @/model.ops --set building.units=kip_in");
}

TEST(whatever_is_not_read_is_refused_with_its_line)
{
#define NODES "model b -ndm 2 -ndf 3\nnode 1 0 0\nnode 2 0 1\ngeomTransf Linear 1\n"
    static const char *const BAD[][2] = {
        {"\n\nset x 1\nfor {set i 0} {$i < 3} {incr i} {\nnode 1 0 0\n}\n", "model.tcl:5: node: 'model BasicBuilder"},
        {"model BasicBuilder -ndm 3 -ndf 6\n", "model.tcl:1: model: only -ndm 2 -ndf 3"},
        {"model BasicBuilder -ndm 1 -ndf 2\n", "model.tcl:1: model: only -ndm 2 -ndf 3 (or 2), and -ndm 1 -ndf 1"},
        {"model b -ndm 1\nnode 1 0 0\n", "model.tcl:2: node: behind TAG x only -mass mx is read"},
        {"geomTransf Bent 1\n", "model.tcl:1: geomTransf: only Linear"},
        {"geomTransf Linear 1 -jntOffset 1 2\n", "only -jntOffset dXi dYi dXj dYj"},
        {NODES "element zeroLength 1 1 2 -mat 1 -dir 1\n",
         "model.tcl:5: element: there is no uniaxialMaterial 1 above"},
        {NODES "element zeroLength 1 1 2 -mat 1 2 -dir 1\n", "element zeroLength: wants TAG i j -mat"},
        {NODES "proc p {} {\n  catch { rigidArm beam 1 2 }\n}\np\n", "model.tcl:6: 'rigidArm' is not among"},
        {NODES "section Fiber 1 {}\n", "model.tcl:5: section Fiber: E A is 0"},
        {NODES "section Hybrid 1 {}\n", "model.tcl:5: section Hybrid: only Elastic"},
        {NODES
         "section Elastic 1 2 3 4\nsection Elastic 2 2 3 5\nelement forceBeamColumn 1 1 2 1 HingeRadau 1 1 2 1 1\n",
         "its sections differ along the element"},
        {"remove element 6\n", "model.tcl:1: remove: remove element takes away"},
        {"remove sp 6 1\n", "takes away"},
        {"sp 6 1 0.1\n", "model.tcl:1: sp: sp holds a displacement"},
        {"pattern Plain 1 Linear {\n  sp 6 1 0.1\n}\n", "model.tcl:1: pattern: sp holds a displacement"},
        {"rigidLink rope 1 2\n", "there is no node 2 above"},
        {"uniaxialMaterial Steel01 1 1 1 1\n",
         "Steel01: only Elastic TAG E is read; building.elastic = initial takes what"},
        {"model b -ndm 2\nnode 1 0 $y\n", "model.tcl:2: can't read \"y\""},
        {"model b -ndm 2\nnode 1 0 [expr 1./0]\n", "model.tcl:2: node: 'Inf' is no number"},
        {"model b -ndm 2\nnode 1 0 {\n", "model.tcl:2: missing close-brace"},
        {"fix 7 1 1 1\n", "model.tcl:1: fix: there is no node 7 above"},
        {NODES "fix 1 1 1\n", "model.tcl:5: fix: wants TAG x y rot"},
        {NODES "equalDOF 1 2 4\n", "model.tcl:5: equalDOF: '4' is no degree of freedom"},
        {"model b -ndm 2\nnode 1 0 0 -mass 1 1\n", "model.tcl:2: node: behind TAG x y only -mass"},
        {NODES "element elasticBeamColumn 1 1 2 1 1 1 1 -foo\n", "'-foo' is not read"},
        {NODES "element elasticBeamColumn 1 1 2 0 1 1 1\n", "area 0, inertia 1 and E 1 must be above 0"},
        {NODES "element elasticBeamColumn 1 1 2 1 1 1 7\n", "no geomTransf 7 above"},
        {NODES "element elasticBeamColumn 4 1 2 1 1 1 1\nelement elasticBeamColumn 4 1 2 1 1 1 1\n",
         "model.tcl:6: element: element 4 is there twice"},
        {NODES "element elasticBeamColumn 1 1 2 1 1 1 1 -release 4\n", "-release 4 is none of 0"},
        {NODES "element elasticBeamColumn 1 1 2 1 1 1 1 -mass -1\n", "mass of -1; it must not"},
        {NODES "mass 1 1 1 -0.1\n", "model.tcl:5: mass: a mass of -0.1; it must not be negative"},
        {NODES, "holds no element"},
        {NODES "wipe\nnode 3 1 1\n", "model.tcl:6: node: the model above was wiped"},
        {NODES "node 1 0 1\n", "model.tcl:5: node: node 1 is there twice"},
        {"source ../../etc/passwd\n", "model.tcl:1: source: "},
        {"source /etc/passwd\n", "model.tcl:1: source: /etc/passwd is not below the folder"},
        {"exec true\n", "model.tcl:1: 'exec' is not among"},
        {"node 1 0 0 \\\rx\n", "model.tcl:1: node: 'model"},
        {"while 1 { set x 1 }\n", "takes more than"},
        {"pattern\x1b(0 Plain\n", "'pattern\\x1B(0'"},
        {NODES "node 3 4 0\nnode 4 4 1\nfix 1 1 1 1\nfix 3 1 1 1\nelement elasticBeamColumn 1 1 2 1 2e8 1 1\n"
               "element elasticBeamColumn 2 3 4 1 2e8 1 1\n",
         "model.tcl: no floors: no level"}};
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        const BuildingOptions o = options_of(BAD[i][0], BUILDING_N_M_KG);
        assert_refused(building_load(&(Building){0}, &o, &err), STATUS_BAD_DATA, BAD[i][1]);
    }
    write_in_place("model.tcl", PORTAL);
    expect(65, "model.tcl says none; set it to N_m_kg", "building @/model.tcl");
    expect(65, "set it to N_m_kg", "building @/model.tcl --set building.units=kN_m_kg");
    expect(66, "nowhere.tcl: there is no such file", "building nowhere.tcl"); /* before it asks for units */
    write_in_place("other.ini", "[problem]\nkind = external\ncommand = true\n");
    expect(65, "is not tower: ", "building @/other.ini");
}

/* A portal of one storey whose columns and beam come in the forms of the table; all are the same frame. */
TEST(one_frame_in_every_form_that_elastic_models_are_written_in)
{
#define FEET                                                                                                           \
    "model basic -ndm 2 -ndf 3\nnode 1 0 0; node 2 6 0; node 3 0 3; node 4 6 3\nmass 3 20 20 0; mass 4 20 20 0\n"
#define HELD  "fix 1 1 1 1; fix 2 1 1 1\ngeomTransf Linear 1\n"
#define BEAM  "element elasticBeamColumn 3 3 4 0.1 2e8 1e-3 1\n"
#define RIGHT "element elasticBeamColumn 2 2 4 0.1 2e8 1e-3 1\n"
    static const char PLAIN[] = FEET HELD "element elasticBeamColumn 1 1 3 0.1 2e8 1e-3 1\n" RIGHT BEAM;
    write_in_place("cards.txt", "steel,2e8\n");
    OWNED(building_free) Building plain = import(PLAIN, BUILDING_KN_M_T);
    FOR_EACH (
        const char *, same,
        FEET HELD "section Elastic 7 2e8 0.1 1e-3\nelement forceBeamColumn 1 1 3 1 Lobatto 7 5\n" RIGHT BEAM,
        FEET HELD
        "section Elastic 7 2e8 0.1 1e-3\nelement dispBeamColumn 1 1 3 1 \"Legendre 7 2\" -mass 0\n" RIGHT BEAM,
        FEET HELD "section Elastic 7 2e8 0.1 1e-3\nbeamIntegration HingeRadau 4 7 0.3 7 0.3 7\n"
                  "element forceBeamColumn 1 1 3 1 4 -iter 10 1e-12\n" RIGHT BEAM,
        FEET HELD "uniaxialMaterial Elastic 1 2e7; uniaxialMaterial Elastic 2 2e5\nsection Aggregator 7 1 P 2 Mz\n"
                  "element nonlinearBeamColumn 1 1 3 5 7 1\n" RIGHT BEAM,
        FEET HELD "uniaxialMaterial Elastic 2 2e5\nsection Uniaxial 6 2 Mz\nuniaxialMaterial Elastic 1 2e7\n"
                  "section Aggregator 7 1 P -section 6\nelement elasticBeamColumn 1 1 3 7 1\n" RIGHT BEAM,
        FEET "fixY 0 1 1 1\ngeomTransf Corotational 1\nelement ElasticBeamColumn 1 1 3 0.1 2e8 1e-3 1\n" RIGHT BEAM,
        FEET "fixX 0.0 0 0 0 -tol 0.1\n" HELD "element elasticBeamColumn 1 1 3 0.1 2e8 1e-3 1\n" RIGHT BEAM,
        FEET HELD "element ElasticTimoshenkoBeam 1 1 3 2e8 8e7 0.1 1e-3 1e9 1\n" RIGHT BEAM,
        FEET HELD "element elasticBeamColumn 1 1 3 0.1 2e8 1e-3 1\n" RIGHT
                  "node 33 0 3\nuniaxialMaterial Elastic 9 1e30\nelement zeroLength 9 3 33 -mat 9 9 9 -dir 1 2 6\n"
                  "element elasticBeamColumn 3 33 4 0.1 2e8 1e-3 1\n",
        FEET HELD "element elasticBeamColumn 1 1 3 0.1 2e8 1e-3 1\n" RIGHT
                  "node 33 0 3\nrigidLink beam 3 33\nelement elasticBeamColumn 3 33 4 0.1 2e8 1e-3 1\n",
        FEET HELD "element elasticBeamColumn 1 1 3 0.1 2e8 1e-3 1\nrigidDiaphragm 2 3 4\n" RIGHT BEAM,
        FEET HELD "set f [open cards.txt r]; gets $f line; close $f; cd [file dirname [info script]]\n"
                  "set E [lindex [split $line ,] 1]\nset out [open out.txt w]; puts $out $E; close $out\n"
                  "element elasticBeamColumn 1 1 3 0.1 $E 1e-3 1\n" RIGHT BEAM) {
        OWNED(building_free) Building b = import(*same, BUILDING_KN_M_T);
        if (fabs(b.K[0] / plain.K[0] - 1) > 2e-6 || fabs(b.M[0] / plain.M[0] - 1) > 1e-12)
            fail_msg("%s\n  K %.9g, not %.9g", *same, b.K[0], plain.K[0]);
    }
}

/* 12 EI / l^3 of a column that cannot turn at its ends, l between the ends of its arms. */
TEST(rigid_arms_by_offsets_and_by_links_shorten_what_bends)
{
    static const char *const ARMS[] = {
        "geomTransf Linear 1 -jntOffset 0 0.5 0 -0.25\nelement elasticBeamColumn 1 1 3 1e6 2e8 1e-3 1\n"
        "geomTransf Linear 2\nelement elasticBeamColumn 3 3 4 1 2e8 1 2\n", /* the beam has no arms */
        "node 5 0 0.5; node 6 0 2.75; rigidLink beam 1 5; rigidLink beam 3 6\ngeomTransf Linear 1\n"
        "element elasticBeamColumn 1 5 6 1e6 2e8 1e-3 1\nelement elasticBeamColumn 3 3 4 1 2e8 1 1\n"};
    for (int i = 0; i < 2; i++) {
        const char *text = brief("model basic -ndm 2 -ndf 3\nnode 1 0 0; node 3 0 3; node 4 1 3\nmass 3 7 7 0\n"
                                 "fix 1 1 1 1; fix 3 0 1 1; fix 4 0 1 1\n%s",
                                 ARMS[i]);
        OWNED(building_free) Building b = import(text, BUILDING_KN_M_T);
        assert_close(b.K[0], 1e3 * 12 * 2e8 * 1e-3 / pow(2.25, 3), 1e-9);
    }
}

/* A mass m on an arm r turns with its carrier: of a frame that rotates alone, k / (m r^2). Here the carrier may not turn,
 * and the mass counts as at the carrier. */
TEST(a_mass_on_a_rigid_arm_moves_with_its_carrier)
{
    static const char MODEL[] =
        "model basic -ndm 2 -ndf 3\nnode 1 0 0; node 3 0 3; node 4 1 3; node 5 0 4 -mass 5 5 0.5\nmass 3 7 7 0\n"
        "fix 1 1 1 1; fix 3 0 1 1; fix 4 0 1 1\ngeomTransf Linear 1\nrigidLink beam 3 5\n"
        "element elasticBeamColumn 1 1 3 1e6 2e8 1e-3 1\nelement elasticBeamColumn 3 3 4 1 2e8 1 1\n";
    OWNED(building_free) Building b = import(MODEL, BUILDING_KN_M_T);
    assert_close(b.M[0], 12e3, 1e-12);
}

/* 48 fibres of a rectangle, two springs that yield, and what says so. */
TEST(what_yields_is_refused_or_taken_by_its_initial_stiffness)
{
    static const char MODEL[] = FEET HELD
        "uniaxialMaterial Steel01 1 300 2e8 0.01\nsection Fiber 7 {\n  patch rect 1 12 4 -0.3 -0.1 0.3 0.1\n}\n"
        "element forceBeamColumn 1 1 3 5 7 1\nelement elasticBeamColumn 2 2 4 0.12 2e8 3.575e-3 1\n"
        "uniaxialMaterial Concrete01 2 -30e3 -0.002 0 -0.01\nnode 33 0 3; equalDOF 3 33 1 2\n"
        "element zeroLength 9 3 33 -mat 2 -dir 3\nelement elasticBeamColumn 3 33 4 0.1 2e8 1e-3 1\n";
    static const char ELASTIC[] = FEET HELD
        "element elasticBeamColumn 1 1 3 0.12 2e8 3.575e-3 1\nelement elasticBeamColumn 2 2 4 0.12 2e8 3.575e-3 1\n"
        "uniaxialMaterial Elastic 2 3e7\nnode 33 0 3; equalDOF 3 33 1 2\n"
        "element zeroLength 9 3 33 -mat 2 -dir 6\nelement elasticBeamColumn 3 33 4 0.1 2e8 1e-3 1\n";
    BuildingOptions o = options_of(MODEL, BUILDING_KN_M_T);
    OWNED(building_free) Building b;
    assert_refused(building_load(&b, &o, &err), STATUS_BAD_DATA,
                   "uniaxialMaterial Steel01: only Elastic TAG E is read; building.elastic");
    o.elastic = ELASTIC_INITIAL;
    CHECK_OK(building_load(&b, &o, &err), &err);
    OWNED(building_free) Building wanted = import(ELASTIC, BUILDING_KN_M_T);
    assert_close(b.K[0], wanted.K[0], 1e-9);
    write_in_place("model.tcl", MODEL);
    expect(0, "Steel01, Concrete01", "building @/model.tcl --set building.units=kN_m_t --set building.elastic=initial");
}

/* Of masses alone, without a level element, every mass is a floor: 3 EI / h^3 of a cantilever. */
TEST(a_cantilever_of_one_mass_is_a_building_of_one_floor)
{
    OWNED(building_free)
    Building b =
        import("model basic -ndm 2 -ndf 3\nnode 1 0 0; node 2 0 4 -mass 5 5 0\nfix 1 1 1 1\ngeomTransf Linear 1\n"
               "element elasticBeamColumn 1 1 2 1 2e8 1e-3 1\n",
               BUILDING_KN_M_T);
    assert_int_equal(b.n, 1);
    assert_close(b.K[0], 1e3 * 3 * 2e8 * 1e-3 / 64, 1e-9);
}

/* A shear building as it is written without a plane: floors in the order of the script, heights by the setting. */
TEST(a_stick_of_springs_at_one_place_is_a_shear_building_whose_heights_the_settings_say)
{
#define STICK(x, y, held)                                                                                              \
    "node 7 " x y "\nnode 2 " x y " -mass 5" y "\nnode 9 " x y "; mass 9 4" y "\nfixZ 0 1 1 1\nfix 7 1" held           \
    "\nuniaxialMaterial Elastic 1 3e4; uniaxialMaterial Elastic 2 1e4\nelement zeroLength 1 7 2 -mat 1 -dir 1\n"       \
    "element twoNodeLink 2 2 9 -mat 2 -dir 1 -orient 1 0 0\n"
    FOR_EACH (const char *, stick, "model b -ndm 1 -ndf 1\n" STICK("0", "", ""),
              "model b -ndm 2 -ndf 2\n" STICK("3", " 0", " 1") "fix 2 0 1; fix 9 0 1\n") {
        BuildingOptions o = options_of(*stick, BUILDING_KN_M_T);
        OWNED(building_free) Building b;
        o.heights_m = (NumberList){2, {5, 3}};
        CHECK_OK(building_load(&b, &o, &err), &err);
        const double K[] = {4e7, -1e7, -1e7, 1e7}, M[] = {5e3, 0, 0, 4e3};
        assert_int_equal(b.n, 2);
        assert_false(b.heights_assumed);
        assert_true(b.storey_m[0] == 5 && b.storey_m[1] == 3);
        for (int k = 0; k < 4; k++) {
            assert_close(b.K[k], K[k], 1e-12);
            assert_true(fabs(b.M[k] - M[k]) <= 1e-9);
        }
    }
}

/* Inputs that were refused or read wrongly once, where the folder that holds them is there. */
TEST(the_models_of_the_shared_cases_are_read_or_refused)
{
    static const char *const CASES[][2] = {{"frame_ok", NULL},
                                           {"display", NULL},
                                           {"fixy", NULL},
                                           {"lobatto", NULL},
                                           {"beamintegration", NULL},
                                           {"zerolength", NULL},
                                           {"section_table", NULL},
                                           {"info_script", NULL},
                                           {"cd", NULL},
                                           {"defaultunits", NULL},
                                           {"remove_ele", "remove element takes away"}};
    const char *folder = access("../shared/cases", F_OK) == 0 ? "../shared/cases" : "../../shared/cases";
    if (access(folder, F_OK) != 0)
        skip();
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        BuildingOptions o = scene_defaults().building;
        Building b;
        err = (Err){0};
        snprintf(o.model, sizeof o.model, "%s/%s.tcl", folder, CASES[i][0]);
        o.units = BUILDING_KIP_IN;
        const Status s = building_load(&b, &o, &err);
        if (CASES[i][1] ? s != STATUS_BAD_DATA || !strstr(err.text, CASES[i][1]) : s != STATUS_OK)
            fail_msg("%s: %s", o.model, err.text);
        if (s == STATUS_OK) {
            assert_close(2 * M_PI / b.model.omega[0], 0.6803, 1e-4);
            assert_close(2 * M_PI / b.model.omega[1], 0.1891, 1e-3);
            building_free(&b);
        }
    }
}

SUITE(make_place, clear_place)
