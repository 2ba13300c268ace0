/* cmd/show_model.h -- what is to be said of a model that a study has chosen (study/study_model.h).
 *
 * Threads  no state */
#pragma once

#include "cmd/document.h"

/* Says which effects are on, which are left out, and what each changes; `model` is borrowed. */
void document_model(Document *d, const json_t *model);

/* At the end: whether it is enough for the designs that the study names, and what to do where it is not; NULL: the
 * model was given. */
void document_model_confirmed(Document *d, const json_t *model, const char *folder);
