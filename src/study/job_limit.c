#include "study/job_limit.h"

#include <time.h>

/* "2026-11-22T15:00:00" in local time; INFINITY where it is no time ("Unknown": there is no limit). */
static double time_of(const char *text)
{
    struct tm parts = {.tm_isdst = -1};
    return strptime(text, "%Y-%m-%dT%H:%M:%S", &parts) ? (double)mktime(&parts) : INFINITY;
}

/* One line of KEY=VALUE, of which EndTime; 0: Slurm does not answer. */
static int ask_slurm(const char *job, double *end_s)
{
    char command[96], words[8192];
    snprintf(command, sizeof command, "scontrol --oneliner show job %.20s 2>/dev/null", job);
    FILE *f = popen(command, "r");
    const size_t n = f ? fread(words, 1, sizeof words - 1, f) : 0;
    if (f)
        pclose(f);
    words[n] = 0;
    const char *end = strstr(words, " EndTime=");
    if (end)
        *end_s = time_of(end + strlen(" EndTime="));
    return end != NULL;
}

static int is_number(const char *text)
{
    return text && *text && strspn(text, "0123456789") == strlen(text);
}

Status job_seconds(double *seconds, Err *err)
{
    const char *end = getenv("SLURM_JOB_END_TIME"), *job = getenv("SLURM_JOB_ID");
    double end_s = NAN;
    if (is_number(end))
        end_s = strtod(end, NULL);
    else if (!is_number(job))
        return bad_data(
            err, "search.max_hours = auto: this is no job of Slurm (there is no SLURM_JOB_ID); give hours instead");
    else if (!ask_slurm(job, &end_s))
        return bad_data(
            err,
            "search.max_hours = auto: `scontrol show job %.20s` does not say when the job ends; give hours instead",
            job);
    *seconds = end_s - (double)time(NULL) - JOB_MARGIN_S;
    return *seconds > 0.0
               ? STATUS_OK
               : bad_data(err,
                          "search.max_hours = auto: the job ends in %.0f s, of which the last %g s are needed to store "
                          "the run; give it more time (sbatch --time)",
                          end_s - (double)time(NULL), JOB_MARGIN_S);
}
