/* simulate.c -- one design of the 20-storey tower under a built-in motion: peaks, and the roof over time.
 *
 *   cc simulate.c $(pkg-config --cflags --libs imtet) -o simulate && ./simulate */
#include <imtet_scene.h>
#include <math.h>
#include <stdio.h>

static int complain(const imtet_error *error)
{
    fprintf(stderr, "%s\n", error->text);
    return 1;
}

static double number(const imtet_result *result, const char *name)
{
    const double *value;
    imtet_error error;
    if (imtet_result_numbers(result, name, &value, NULL, NULL, &error) == IMTET_OK)
        return *value;
    complain(&error);
    return NAN;
}

int main(void)
{
    const char *const settings[] = {"motion.record=builtin:kobe-like", "motion.pga_g=0.3", "sim.duration_s=20", NULL};
    imtet_error error;
    imtet_scene *scene;
    imtet_result *result, *history;
    const double *floors;
    double x[22];
    size_t times, columns;
    if (imtet_scene_open(NULL, settings, &scene, &error) != IMTET_OK)
        return complain(&error);
    for (int j = 0; j < 20; j++)
        x[j] = 0.05; /* gaps [m] */
    x[20] = 0.012;   /* wall of the core at its foot [m] */
    x[21] = 0.008;   /* ... at its top */
    if (imtet_scene_simulate(scene, "with_core", x, 22, &result, &error) != IMTET_OK)
        return complain(&error);
    printf("%s: displacement %.4g m, drift %.4g m, acceleration %.4g g, %.0f impacts\n",
           imtet_result_text(result, "outcome"), number(result, "j1_m"), number(result, "j2_m"), number(result, "j3_g"),
           number(result, "impacts"));
    if (imtet_scene_history(scene, "with_core", x, 22, 0.01, &history, &error) != IMTET_OK ||
        imtet_result_numbers(history, "floor_m", &floors, &times, &columns, &error) != IMTET_OK)
        return complain(&error);
    printf("%zu times of %zu floors, the roof at the end %.3g m\n", times, columns, floors[times * columns - 1]);
    imtet_result_free(&history);
    imtet_result_free(&result);
    imtet_scene_free(&scene);
    return 0;
}
