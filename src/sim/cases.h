/* sim/cases.h -- what can be simulated of a design: the design itself, and what it is compared with.
 *
 *   with core          building and core, with the gaps and devices of the design
 *   no core            the building alone
 *   rigidly connected  floors and core without gaps, in the modes of both with the building's damping ratios
 *                      (sim/joined.h)
 *   tuned mass damper  no core, but its mass on a spring and a dashpot at the roof; frequency and damping optimized
 *   viscous links      the core, and a dashpot between it and every floor; one constant, optimized
 *
 * A further case is a row here and, where its devices are new, what case_design makes of a design. Its device is
 * found by evaluate/device.h.
 *
 * Threads  pure functions */
#pragma once

#include "scene/design.h"
#include "sim/options.h"

/* Parts that a scene has; a set of bits. */
enum { HAS_CORE = 1, HAS_GAPS = 2, HAS_DEVICE = 4, IS_JOINED = 8 };

/* id, key in files, words for people, what there is. The first is the design, the others are its baselines. */
#define SCENE_LIST(X)                                                                                                  \
    X(IMPACT, "with_core", "with core", HAS_CORE | HAS_GAPS)                                                           \
    X(NO_CORE, "no_core", "no core", 0)                                                                                \
    X(RIGID, "rigid", "rigidly connected", HAS_CORE | IS_JOINED)                                                       \
    X(TMD, "tmd", "tuned mass damper", HAS_DEVICE)                                                                     \
    X(LINKS, "links", "viscous links", HAS_CORE | HAS_DEVICE)

typedef enum {
#define X(id, key, words, has) SCENE_##id,
    SCENE_LIST(X)
#undef X
        N_SCENES
} SceneKind;

typedef struct {
    const char *key, *words;
    unsigned has;
} SceneCase;

extern const SceneCase SCENES[N_SCENES];

static inline int case_has_device(SceneKind kind)
{
    return (SCENES[kind].has & HAS_DEVICE) != 0;
}

/* Makes the design of a case: n floors, a core of core_kg, and the device as the only contact. */
void case_design(SceneKind kind, const LinearDevice *device, double core_kg, int n, Design *design);

/* Number i of the device, by its name in files; NULL: it has no more. */
const char *case_device_number(SceneKind kind, const LinearDevice *device, int i, double *value);

/* The device in words, "0.241 Hz, damping 0.13"; empty where the case has none. Returns text. */
enum { DEVICE_TEXT_MAX = 64, CASE_TEXT_MAX = 128 };
const char *case_device_text(SceneKind kind, const LinearDevice *device, char text[DEVICE_TEXT_MAX]);

/* The case and its device: "tuned mass damper (0.241 Hz, damping 0.13)". Returns text. */
const char *case_text(SceneKind kind, const LinearDevice *device, char text[CASE_TEXT_MAX]);
