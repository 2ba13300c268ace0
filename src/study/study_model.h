/* study/study_model.h -- the model of a study whose settings leave it open (sim.model = auto; analysis/model_choice.h):
 * chosen before its first design, kept with the run, and tried at the end on the designs that the study names.
 *
 *   provenance.json   "model": the ladder of the choice (ladder_json), designs, records, simulations, speed_factor of
 *                     the set against all effects; at the end "confirmed": designs (design, record, is_enough,
 *                     by_the_set, with_more) and `more`, the settings that they need beside
 *
 * A run keeps what it has chosen: its settings have it, and those of a file that leaves it open get it. */
#pragma once

#include <jansson.h>

#include "evaluate/problem.h"
#include "store/store.h"

/* run NULL: a new one, whose model is chosen; *model, for json_decref, NULL: nothing was open. */
Status study_model(Settings *s, const Run *run, const Observer *stop, json_t **model, Err *err);

/* The knee and the best of each objective; nothing where nothing was open. */
Status study_model_confirm(RunStore *store, const Observer *stop, Err *err);

/* Of a run, for json_decref; NULL: it was given. */
json_t *study_model_of(const Run *run);
