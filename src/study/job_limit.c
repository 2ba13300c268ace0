#include "study/job_limit.h"

#include <time.h>

/* Asks Slurm for one line of KEY=VALUE, of which EndTime is "2026-11-22T15:00:00" in local time; INFINITY where that is
 * no time ("Unknown": there is no limit), NAN where Slurm does not answer. */
static double ask_slurm(const char *job)
{
    static const char KEY[] = " EndTime=";
    char command[96], words[8192];
    struct tm parts = {.tm_isdst = -1};
    snprintf(command, sizeof command, "scontrol --oneliner show job %.20s 2>/dev/null", job);
    FILE *f = popen(command, "r");
    const size_t n = f ? fread(words, 1, sizeof words - 1, f) : 0;
    if (f)
        pclose(f);
    words[n] = 0;
    const char *end = strstr(words, KEY);
    return !end                                                                  ? NAN
           : strptime(end + sizeof KEY - 1, "%Y-%m-%dT%H:%M:%S", &parts) != NULL ? (double)mktime(&parts)
                                                                                 : INFINITY;
}

static int is_number(const char *text)
{
    return text && *text && strspn(text, "0123456789") == strlen(text);
}

Status job_seconds(double *seconds, Err *err)
{
    const char *end = getenv("SLURM_JOB_END_TIME"), *job = getenv("SLURM_JOB_ID");
    if (!is_number(end) && !is_number(job))
        return bad_data(
            err, "search.max_hours = auto: this is no job of Slurm (there is no SLURM_JOB_ID); give hours instead");
    const double end_s = is_number(end) ? strtod(end, NULL) : ask_slurm(job);
    if (isnan(end_s))
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
