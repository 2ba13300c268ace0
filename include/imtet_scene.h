/* imtet_scene.h -- the simulator of the library: a tower, the core inside it and the gaps between them under a ground
 * motion. It simulates a design of gaps and thicknesses in some 10 ms.
 *
 *     const char *settings[] = {"motion.record=builtin:kobe-like", NULL};
 *     imtet_scene *scene;
 *     imtet_result *result = NULL;
 *     imtet_error error;
 *     const double *j1;
 *     double x[22] = {[20] = 0.012, [21] = 0.008}; // gap_01_m..gap_20_m, t_base_m, t_top_m
 *     for (int j = 0; j < 20; j++) x[j] = 0.05;
 *     if (imtet_scene_open("configs/quick.ini", settings, &scene, &error) ||
 *         imtet_scene_simulate(scene, "with_core", x, 22, &result, &error) ||
 *         imtet_result_numbers(result, "j1_m", &j1, NULL, NULL, &error))
 *         fprintf(stderr, "%s\n", error.text);
 *     else
 *         printf("%s: %g m\n", imtet_result_text(result, "outcome"), *j1);
 *     imtet_result_free(&result);
 *     imtet_scene_free(&scene);
 *
 * Equations, scaling of records and settings are those of the program: `imtet settings` lists every setting, and
 * `imtet simulate` gives the same numbers.
 *
 * Results    named numbers, tables (rows, columns) row-major, and texts. Units stand at the ends of the names: j1_m
 *            [m], j3_g [g], peak_drift_m. results/README.md of the program explains each
 * Ownership  a result belongs to the caller, who frees it; its numbers and texts hold until then. A scene may be
 *            freed before its results
 * Threads    any: one scene may simulate in several threads at once (each has an integrator of its own), one result may
 *            be read by several
 * Errors     as in imtet.h. A simulation that fails (its energy balance does not close, say) is a result whose text
 *            `outcome` is not "ok" and whose numbers are not to be used */
#ifndef IMTET_SCENE_H
#define IMTET_SCENE_H

#include "imtet.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct imtet_scene imtet_scene;
typedef struct imtet_result imtet_result;

/* Opens the scene of a settings file (NULL: the defaults) and of further settings "section.key=value", NULL behind the
 * last (settings NULL: none). Paths in the file begin at its folder. Only the first of motion.records and the first of
 * sim.replicates is simulated: the design as designed. */
IMTET_API imtet_status imtet_scene_open(const char *path, const char *const settings[], imtet_scene **out,
                                        imtet_error *error);
IMTET_API void imtet_scene_free(imtet_scene **scene); /* sets it to NULL; no simulation may be under way */

/* Describes the scene: floors (1, 1); lower, upper (variables, 1): the box of a search; building_hz (floors, 1): its
 * natural frequencies without core; texts: variables, objectives: comma lists of names; senses: min or max of each
 * objective; record. */
IMTET_API imtet_status imtet_scene_describe(imtet_scene *scene, imtet_result **out, imtet_error *error);

/* Simulates a design x (n) under the record; n are the scene's variables in their order. kind is with_core or a
 * baseline: no_core, the building alone (x may be NULL); rigid, floors and core rigidly connected; tmd, the core's
 * mass as a tuned mass damper at the roof; links, a viscous dashpot between core and every floor. A baseline takes the
 * thicknesses of x; its device is the best one (numbers tmd_hz, tmd_damping or link_ns_m), found by some 100
 * simulations.
 * Numbers (1, 1): j1_m, j2_m, j3_g, ed1_pct, ed5_10_pct, edcs_pct, mcore_kg and all others of `imtet simulate --json`,
 * those of forces only with "sim.forces=yes"; NAN where the scene has none. Per floor or storey from the bottom
 * (floors, 1): peak_displacement_m, peak_drift_m, peak_acceleration_g, peak_drift_ratio and others; per mode
 * mode_share_pct; per side of the core, u > v first, (2, floors): contact_force_n and others.
 * Texts: outcome, reason. */
IMTET_API imtet_status imtet_scene_simulate(imtet_scene *scene, const char *kind, const double x[], size_t n,
                                            imtet_result **out, imtet_error *error);

/* Simulates the design again and gives its response over time. Rows are at most every_s [s] apart, by halving the step
 * of the motion; 0: that step. Tables (times, 1): t_s, ground_g, and energies kinetic_j, strain_j, damped_building_j,
 * core_j, damped_core_j, contacts_j, input_j; (times, floors): floor_m, floor_m_s, drift_m, accel_g (absolute), core_m,
 * core_m_s, contact_n. Displacements are relative to the ground. Only with sim.engine=fast. */
IMTET_API imtet_status imtet_scene_history(imtet_scene *scene, const char *kind, const double x[], size_t n,
                                           double every_s, imtet_result **out, imtet_error *error);

/* Reads a record as the program does, in any of its formats, or builtin:NAME: acceleration (samples, 1) [m/s2], dt_s
 * (1, 1) [s]; texts: name, format, channel, processed, warning. settings as above: "motion.unit=g", "motion.channel=2",
 * "motion.pga_g=0.3"; without them the record is as recorded. */
IMTET_API imtet_status imtet_motion_read(const char *path, const char *const settings[], imtet_result **out,
                                         imtet_error *error);

/* Gives the name of number or text i = 0, 1, ...; NULL behind the last, or where result is NULL. */
IMTET_API const char *imtet_result_name(const imtet_result *result, size_t i);

/* Gives the table (rows, columns) of that name; rows and columns NULL: not wanted. */
IMTET_API imtet_status imtet_result_numbers(const imtet_result *result, const char *name, const double **numbers,
                                            size_t *rows, size_t *columns, imtet_error *error);
IMTET_API const char *imtet_result_text(const imtet_result *result, const char *name); /* NULL: there is none */
IMTET_API void imtet_result_free(imtet_result **result);

#ifdef __cplusplus
}
#endif

#endif
