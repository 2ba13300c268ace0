#include "study/job_limit.h"

#include <time.h>

static int is_number(const char *text)
{
    return text && *text && strspn(text, "0123456789") == strlen(text);
}

Status job_seconds(double *seconds, Err *err)
{
    static const char KEY[] = " EndTime=";
    const char *end = getenv("SLURM_JOB_END_TIME"), *job = getenv("SLURM_JOB_ID");
    const int is_told = is_number(end);
    double end_s = is_told ? strtod(end, NULL) : NAN;
    if (!is_told && !is_number(job))
        return bad_data(
            err, "search.max_hours = auto: this is no job of Slurm (there is no SLURM_JOB_ID); give hours instead");
    if (!is_told) {
        /* Slurm is asked for one line of KEY=VALUE, of which EndTime is "2026-11-22T15:00:00" in local time; what is no
         * time ("Unknown") is no limit. */
        char command[96], words[8192];
        struct tm parts = {.tm_isdst = -1};
        snprintf(command, sizeof command, "scontrol --oneliner show job %.20s 2>/dev/null", job);
        FILE *f = popen(command, "r");
        words[f ? fread(words, 1, sizeof words - 1, f) : 0] = 0;
        if (f)
            pclose(f);
        end = strstr(words, KEY);
        if (!end)
            return bad_data(err,
                            "search.max_hours = auto: `scontrol show job %.20s` does not say when the job ends; give "
                            "hours instead",
                            job);
        end_s = strptime(end + sizeof KEY - 1, "%Y-%m-%dT%H:%M:%S", &parts) ? (double)mktime(&parts) : INFINITY;
    }
    *seconds = end_s - (double)time(NULL) - JOB_MARGIN_S;
    return *seconds > 0.0
               ? STATUS_OK
               : bad_data(err,
                          "search.max_hours = auto: the job ends in %.0f s, of which the last %g s are needed to store "
                          "the run; give it more time (sbatch --time)",
                          end_s - (double)time(NULL), JOB_MARGIN_S);
}
