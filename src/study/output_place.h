/* study/output_place.h -- where a settings file may send a run: below results/ of the working directory, or into the
 * folder that the file itself lies in (a run's own settings). A file of another origin writes nowhere else; a place
 * given on the command line is the user's own word and is not asked about.
 *
 * Threads  no state.   Errors  STATUS_BAD_DATA with the place and what to do; a link that leads out is refused too */
#pragma once

#include "base/status.h"

Status output_place_check(const char *out, const char *settings_file, Err *err);
