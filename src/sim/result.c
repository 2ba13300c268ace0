#include "sim/result.h"

#include <stddef.h>

#include "sim/cases.h"

const char *run_outcome_words(RunOutcome outcome)
{
    static const char *const WORDS[] = {
#define X(name, words) words,
        RUN_OUTCOME_LIST(X)
#undef X
    };
    return WORDS[outcome];
}

const char *uplift_words(const SimResult *r, char text[UPLIFT_WORDS_MAX])
{
    const SimForces *f = &r->forces;
    if (r->mat_rotation_rad > 0)
        snprintf(text, UPLIFT_WORDS_MAX, "the core's mat lifts: it turns by %.3g rad", f->base_rotation_rad);
    else
        snprintf(text, UPLIFT_WORDS_MAX,
                 "the core's moment is %.3g times that at which its mat begins to lift: anchors must hold it down "
                 "by %.3g MN",
                 f->uplift_ratio, 1e-6 * f->anchor_force_n);
    return text;
}

/* What a part needs beside HAS_CORE, HAS_GAPS and HAS_DEVICE of the case. */
enum { IF_FORCES = 32, IF_STRESS = 64, IF_BUCKLING = 128, IF_BUMPER = 256, IF_YIELDING = 512, IF_NEIGHBOUR = 1024 };

#define NAMED(name, shape, needs, member)                                                                              \
    {                                                                                                                  \
        name, shape, needs, offsetof(SimResult, member)                                                                \
    }
#define FIELD(shape, needs, member) NAMED(#member, shape, needs, member)
#define BESIDE(member)              NAMED("neighbour_" #member, PART_NEIGHBOUR, IF_NEIGHBOUR, neighbour.member)
#define FORCE(shape, needs, member) NAMED(#member, shape, IF_FORCES | (needs), forces.member)
const ResultPart RESULT_PARTS[] = {FIELD(PART_LONG, 0, impacts),
                                   FIELD(PART_NUMBER, HAS_DEVICE, stroke_m),
                                   FIELD(PART_NUMBER, HAS_DEVICE, dashpot_n),
                                   FIELD(PART_LONG, 0, v0_limited),
                                   FIELD(PART_NUMBER, 0, settled_s),
                                   FIELD(PART_INT, 0, repeated),
                                   FIELD(PART_FLOORS, 0, peak_displacement_m),
                                   FIELD(PART_FLOORS, 0, peak_drift_m),
                                   FIELD(PART_FLOORS, 0, peak_acceleration_g),
                                   FIELD(PART_STOREY, 0, drift_ratio_storey),
                                   NAMED("peak_drift_ratio", PART_FLOORS, 0, drift_ratio),
                                   FIELD(PART_MODES, 0, mode_share_pct),
                                   FORCE(PART_NUMBER, 0, building_overturning_nm),
                                   FORCE(PART_FLOORS, 0, building_shear_n),
                                   FORCE(PART_NUMBER, 0, base_shear_ratio),
                                   FORCE(PART_NUMBER, 0, overturning_nm),
                                   FORCE(PART_FLOORS, 0, peak_velocity_m_s),
                                   FORCE(PART_NUMBER, HAS_CORE, core_top_m),
                                   FORCE(PART_NUMBER, HAS_CORE, base_translation_m),
                                   FORCE(PART_FLOORS, HAS_CORE, core_shear_n),
                                   FORCE(PART_FLOORS, HAS_CORE, core_moment_nm),
                                   FORCE(PART_STOREY, IF_STRESS, core_stress_storey),
                                   FORCE(PART_FLOORS, IF_STRESS, core_storey_stress_pa),
                                   FORCE(PART_NUMBER, IF_STRESS, core_shear_stress_pa),
                                   FORCE(PART_FLOORS, IF_BUCKLING, core_slenderness),
                                   FORCE(PART_FLOORS, IF_BUCKLING, core_buckling_pa),
                                   FORCE(PART_FLOORS, IF_BUCKLING, core_wall_share),
                                   FORCE(PART_NUMBER, IF_BUCKLING, core_wall_share_off),
                                   FORCE(PART_SIDES, HAS_GAPS, contact_force_n),
                                   FORCE(PART_SIDES, HAS_GAPS, contact_impulse_ns),
                                   FORCE(PART_COUNTS, HAS_GAPS, contacts),
                                   FORCE(PART_SIDES, HAS_GAPS, indentation_m),
                                   FIELD(PART_NUMBER, 0, damped_building_j),
                                   FIELD(PART_NUMBER, 0, damped_core_j),
                                   FIELD(PART_NUMBER, 0, kinetic_strain_j),
                                   FIELD(PART_NUMBER, IF_YIELDING, hysteresis_j),
                                   FIELD(PART_FLOORS, IF_YIELDING, plastic_drift_m),
                                   FIELD(PART_FLOORS, IF_YIELDING, residual_drift_m),
                                   FIELD(PART_NUMBER, 0, contact_loss_j),
                                   FIELD(PART_NUMBER, 0, contact_stored_j),
                                   FIELD(PART_NUMBER, 0, clamp_j),
                                   FIELD(PART_NUMBER, 0, indentation_max_m),
                                   FIELD(PART_FLAG, 0, contact_yields),
                                   FIELD(PART_NUMBER, IF_BUMPER, bumper_compression_m),
                                   FIELD(PART_FLAG, IF_BUMPER, bumper_bottoms_out),
                                   BESIDE(displacement_m),
                                   BESIDE(drift_m),
                                   BESIDE(acceleration_g),
                                   BESIDE(peak_drift_ratio),
                                   FIELD(PART_LONG, 0, steps),
                                   FIELD(PART_LONG, 0, force_evaluations),
                                   FIELD(PART_NUMBER, 0, seconds),
                                   {0}};

size_t result_part(const SimResult *r, unsigned scene, const ResultPart *part, double values[], size_t *rows)
{
    const unsigned has = scene | (r->forces_known ? IF_FORCES : 0u) | (r->forces.stress_known ? IF_STRESS : 0u) |
                         (r->forces.buckling_known ? IF_BUCKLING : 0u) | (r->bumper_strain > 0 ? IF_BUMPER : 0u) |
                         (r->yields ? IF_YIELDING : 0u) | (r->neighbour.n > 0 ? IF_NEIGHBOUR : 0u);
    const size_t n = part->shape < PART_FLOORS ? 1
                                               : (size_t)(part->shape == PART_MODES       ? r->n_modes
                                                          : part->shape == PART_NEIGHBOUR ? r->neighbour.n
                                                                                          : r->n_floors);
    const void *member = (const char *)r + part->at;
    *rows = part->shape == PART_SIDES || part->shape == PART_COUNTS ? SIDES : 1;
    if (part->needs & ~has)
        return 0;
    for (size_t i = 0; i < *rows * n; i++) {
        const size_t at = i / n * FLOORS_MAX + i % n;
        switch (part->shape) {
        case PART_LONG:
        case PART_COUNTS:
            values[i] = (double)((const long *)member)[at];
            break;
        case PART_INT:
        case PART_FLAG:
        case PART_STOREY:
            values[i] = *(const int *)member + (part->shape == PART_STOREY);
            break;
        default:
            values[i] = ((const double *)member)[at];
        }
    }
    return n;
}
