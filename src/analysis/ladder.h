/* analysis/ladder.h -- which effects a scene needs: each is left out of a model that has them all.
 *
 *   all        the settings with every effect that they have, and by a common value every one that they do not have
 *   change     measure m without the effect over that with it, less 1
 *   scenes     the design, the same core rigidly connected and the building alone: whether the design is the better one
 *              hangs on all three
 *   tolerance  LADDER_TOLERANCE; of the design the larger of it and the scatter as built: standard deviation over
 *              STRUCTURES of the model with all, whose gaps differ by sim.gap_tolerance_m (0: GAP_SD_M) and by what
 *              sim.uncertain says
 *   needed     in one of the scenes a change of J1, of the drift ratio or of J3 exceeds it (or is not known: a
 *              simulation failed)
 *   the set    effects that are needed; where the model with these alone is not within the tolerance of the one with
 *              all in every scene, the largest change that is left out is put back, until it is
 *
 * Effects: what is between the floors of a frame (building.modes), shear of the core, P-delta, the ground under the
 * core, a mat that lifts from it (behind the ground, whose setting it shares: it goes with the ground), walls of a box
 * that buckle, storeys that yield, flexibility at a contact, contacts off the centre by 5 % of the plan, the weak end
 * of the record (behind what motion_strong_part says), and the steps: the other changes are found at sim.accuracy, this
 * one by accuracy fine, which has more steps per contact and all modes of the core. A building of core.model shears and
 * stands as it is. A scene that an effect cannot reach is not simulated without it: the building alone has neither core
 * nor contacts, a rigid connection no contacts. Under motion.record; impacts. The objectives and limits of the settings
 * have no part in it: some need an effect that is left out. analysis/model_choice.c simulates.
 *
 * Storeys that yield keep the share building.hardening of their stiffness, more where the building would not stand with
 * that (scene/building.h): where P-delta softens it, so that the change by P-delta has that in it as well.
 *
 * Threads  tasks of the queue; the numbers but the times do not depend on how many workers there are */
#pragma once

#include <jansson.h>

#include "evaluate/tower.h"

enum { LADDER_MAX = 11, LADDER_MEASURES = 3, LADDER_SCENES = 3 };
static const MeasureId LADDER_MEASURE[LADDER_MEASURES] = {MEASURE_J1, MEASURE_DRIFT_RATIO, MEASURE_J3};

static const SceneKind LADDER_SCENE[LADDER_SCENES] = {SCENE_IMPACT, SCENE_RIGID, SCENE_NO_CORE};

/* Two digits, which is what such results are read with. */
static const double LADDER_TOLERANCE = 0.02;

typedef struct {
    const char *words, *key;
    char with[OPTION_TEXT_MAX], without[OPTION_TEXT_MAX]; /* values of the setting */
    int is_set;                                           /* the settings have it */
    double change[LADDER_SCENES][LADDER_MEASURES];        /* [-] NAN: a simulation failed */
    double most;            /* the largest of them, in tolerances; INFINITY: one is not known */
    int decided_in;         /* the scene that has it */
    double cost_s;          /* what it adds to a simulation; NAN: not known */
    int is_needed, is_kept; /* by itself; in the set */
    int is_added;           /* steps; between floors, of LADDER_BRIEF: the model with all has the other value */
} LadderEffect;

typedef struct {
    size_t n;
    LadderEffect effect[LADDER_MAX];
    double value[LADDER_MEASURES], tolerance[LADDER_MEASURES]; /* with all; [-] */
    double off[LADDER_SCENES][LADDER_MEASURES];                /* [-] the set from the model with all */
    double set[LADDER_SCENES][LADDER_MEASURES];                /* by the set; NAN: a simulation failed */
    double all_s, set_s;                                       /* of a simulation */
    double hardening; /* [-] of the model with all, raised where the building would not stand; 0: nothing yields */
} Ladder;

/* Does effect i have a say in its setting? Not a mat that lifts from a ground that is left out. */
static inline int ladder_says(const Ladder *l, size_t i)
{
    return i == 0 || strcmp(l->effect[i].key, l->effect[i - 1].key) != 0 || l->effect[i - 1].is_kept;
}

/* LADDER_BRIEF: without the steps and the weak end, on the strong part of the record but for the values by the set;
 * every effect is left out once, so that no costs are known (NAN), but nodes between floors, with which a simulation
 * takes three times as long: they are added once to all others. LADDER_OPEN: a study's choice
 * (analysis/model_choice.h): without the steps, and what the settings give stays, be it the default. */
typedef enum { LADDER_WHOLE, LADDER_BRIEF, LADDER_OPEN } LadderForm;

/* Of the design x. */
Status ladder_find(const Settings *s, const double x[], LadderForm form, Ladder *out, Err *err);

/* By the names of effects, measures, scenes and settings; what check, report and a run's provenance.json have of it. */
json_t *ladder_json(const Ladder *l);

/* The text of core.foundation with anchors of that factor. */
void ladder_anchors(const char *foundation, double anchors, char to[OPTION_TEXT_MAX]);

/* -- its steps ----------------------------------------------------------------------------------------------------- */

/* The effects that there are, where the strong part of the record ends at strong_s; is_set: the settings have it, or of
 * LADDER_OPEN give it. all: the settings with all of them. */
Status ladder_effects(const Settings *s, double strong_s, LadderForm form, Ladder *out, Settings *all, Err *err);
double ladder_change(const Measured *to, const Measured *from, int k);
double ladder_in_tolerances(const Ladder *l, const double change[LADDER_MEASURES], int scene);      /* the largest */
double ladder_largest(const Ladder *l, double changes[LADDER_SCENES][LADDER_MEASURES], int *scene); /* of all scenes */
LadderEffect *ladder_largest_left_out(Ladder *l);                                                   /* NULL: none is */
void ladder_keep(Ladder *l, LadderEffect *e); /* and the ground that a mat lifts from */
Status ladder_put_set(const Ladder *l, Settings *s, Err *err);
