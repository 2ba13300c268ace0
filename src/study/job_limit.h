/* study/job_limit.h -- search.max_hours = auto: the time that the Slurm job around this program has left.
 *
 *   seconds = end of the job - now - JOB_MARGIN_S        INFINITY: the job has no limit
 *
 * The end is SLURM_JOB_END_TIME [s since 1970], where this Slurm sets it, else EndTime of `scontrol show job`.
 *
 * Threads  call it from one thread
 * Errors   STATUS_BAD_DATA: no job, or less than the margin is left
 * Source   https://slurm.schedmd.com/sbatch.html, https://slurm.schedmd.com/scontrol.html */
#pragma once

#include "base/status.h"

/* To finish what is under way and to write everything. */
static const double JOB_MARGIN_S = 120.0;

Status job_seconds(double *seconds, Err *err);
