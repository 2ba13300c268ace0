/* imtet evaluate --full-model: a design on the full model of the building beside the reduced one. */
#include "program.h"

static void write_design(const char *name)
{
    FILE *f = opened(there(name), "w");
    for (int j = 0; j < 20; j++)
        fprintf(f, "gap_%02d_m,", j + 1);
    fprintf(f, "t_base_m,t_top_m\n");
    for (int row = 0; row < 2; row++) {
        for (int j = 0; j < 20; j++)
            fprintf(f, "%g,", 0.02 + 0.01 * ((j * 7 + row) % 20));
        fprintf(f, "0.02,0.008\n");
    }
    assert_int_equal(fclose(f), 0);
}

static const char *const KEYS[] = {"j1_m",       "j2_m",     "j3_g",         "ed1_pct",
                                   "ed5_10_pct", "edcs_pct", "base_shear_n", "peak_drift_m"};

static void expect_same(const json_t *a, const json_t *b)
{
    for (size_t k = 0; k < sizeof KEYS / sizeof KEYS[0]; k++)
        assert_true(json_equal(json_object_get(a, KEYS[k]), json_object_get(b, KEYS[k])));
}

TEST(both_models_are_what_simulate_gives)
{
    write_design("d.csv");
    json_auto_t *v =
        as_json("evaluate --full-model configs/quick.ini --design @/d.csv:1 --set sim.duration_s=40 --json");
    json_auto_t *all = as_json("simulate configs/quick.ini --design @/d.csv --set sim.duration_s=40 --json");
    json_auto_t *full = as_json(
        "simulate configs/quick.ini --design @/d.csv:1 --set sim.duration_s=40 --set building.modes=100000 --json");
    json_t *reduced = json_object_get(v, "reduced"), *error = json_object_get(v, "error");
    expect_same(reduced, json_array_get(all, 0));
    expect_same(json_object_get(v, "full"), full);
    assert_int_equal((int)number(json_object_get(v, "degrees_of_freedom"), "reduced"), 20);
    assert_int_equal((int)number(json_object_get(v, "degrees_of_freedom"), "full"), 106);
    assert_close(number(error, "j2_m"), number(reduced, "j2_m") / number(full, "j2_m") - 1, 1e-9);
    assert_at_most(10, number(full, "impacts"));
    assert_true(fabs(number(error, "j1_m")) < 0.005 && fabs(number(error, "ed1_pct")) < 0.01);
}

TEST(designs_and_records_make_a_list_in_their_order)
{
    write_design("d.csv");
    json_auto_t *v = as_json("evaluate --full-model configs/quick.ini --design @/d.csv --set sim.duration_s=5 --record "
                             "builtin:kobe-like --record builtin:elcentro-like --json");
    assert_int_equal((int)json_array_size(v), 4);
    for (size_t i = 0; i < 4; i++) {
        const json_t *o = json_array_get(v, i);
        assert_int_equal((int)number(o, "design"), 1 + (int)i % 2);
        assert_string_equal(json_string_value(json_object_get(o, "record")),
                            i < 2 ? "builtin:kobe-like" : "builtin:elcentro-like");
    }
}

TEST(fixed_interface_modes_are_verified_as_the_reduced_model)
{
    json_auto_t *v = as_json(
        "evaluate --full-model configs/quick.ini --design none --set sim.duration_s=20 --set building.modes=30 --json");
    const json_t *error = json_object_get(v, "error");
    assert_int_equal((int)number(json_object_get(v, "degrees_of_freedom"), "reduced"), 51);
    assert_true(fabs(number(error, "j1_m")) < 1e-4 && fabs(number(error, "j3_g")) < 1e-3);
    assert_null(json_object_get(v, "design"));
}

SUITE(make_place, clear_place)
