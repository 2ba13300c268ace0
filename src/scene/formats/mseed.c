/* miniSEED 2 by libmseed (FDSN, SEED Reference Manual 2.4): every continuous trace is a channel NET.STA.LOC.CHA; a
 * gap makes two. Samples are counts, or numbers whose unit the file does not say. */
#include <libmseed.h>
#include <stdio.h>
#include <string.h>

#include "scene/formats/record.h"

static int recognise(const unsigned char bytes[], size_t n)
{
    return n >= 64 && MS_ISVALIDHEADER((const char *)bytes);
}

static void say_nothing(char *message)
{
    (void)message;
}

static double sample_of(const MSTrace *t, int64_t i)
{
    switch (t->sampletype) {
    case 'i':
        return ((const int32_t *)t->datasamples)[i];
    case 'f':
        return (double)((const float *)t->datasamples)[i];
    default:
        return ((const double *)t->datasamples)[i];
    }
}

static Status take_trace(Record *r, const Lines *l, const MSTrace *t, Err *err)
{
    Channel *c;
    char name[CHANNEL_NAME_MAX];
    if (!t->datasamples || !strchr("ifd", t->sampletype) || t->numsamples < 2)
        return STATUS_OK; /* a log, or nothing */
    if (!(t->samprate >= 1 / MOTION_STEP_MAX_S && t->samprate <= 1e5))
        return STATUS_OK; /* state of health */
    TRY(record_channel(r, l, &c, err));
    snprintf(name, sizeof name, "%s.%s.%s.%s", t->network, t->station, t->location, t->channel);
    channel_name(c, name, name + strlen(name));
    c->counts = 1;
    c->dt = 1 / t->samprate;
    c->n = (size_t)t->numsamples;
    for (int64_t i = 0; i < t->numsamples; i++)
        TRY(record_add(r, l, (Row){.a = sample_of(t, i), .line = 1}, err));
    return STATUS_OK;
}

static Status collect(MSTraceGroup *group, const char *path, const char *bytes, size_t n, Err *err)
{
    MSRecord *record = NULL;
    Status status = STATUS_OK;
    for (size_t at = 0; at + 48 < n && status == STATUS_OK;) {
        const int left = n - at > (1 << 30) ? 1 << 30 : (int)(n - at);
        const int code = MS_ISVALIDHEADER(bytes + at) ? msr_parse((char *)bytes + at, left, &record, 0, 1, 0) : -1;
        if (code != 0 || record->reclen < 64) {
            status =
                at ? STATUS_OK : fail(err, STATUS_BAD_DATA, "%s: miniSEED: no usable record at byte %zu", path, at);
            break;
        }
        if (!mst_addmsrtogroup(group, record, 0, -1, -1))
            status = fail(err, STATUS_BAD_DATA, "%s: miniSEED: the record at byte %zu fits no trace", path, at);
        at += (size_t)record->reclen;
    }
    msr_free(&record);
    return status;
}

static Status read_traces(Record *r, const char *path, const char *bytes, size_t n, Err *err)
{
    const Lines l = {.path = path, .number = 1};
#pragma omp critical(libmseed) /* records are read side by side, and the library keeps this for all of them */
    ms_loginit(say_nothing, NULL, say_nothing, NULL);
    MSTraceGroup *group = mst_initgroup(NULL);
    if (!group)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for its traces", path);
    Status status = collect(group, path, bytes, n, err);
    for (const MSTrace *t = group->traces; t && status == STATUS_OK; t = t->next)
        status = take_trace(r, &l, t, err);
    mst_freegroup(&group);
    if (status == STATUS_OK && r->n_channels == 0)
        return fail(err, STATUS_BAD_DATA, "%s: miniSEED without samples", path);
    return status;
}

const BinaryFormat FORMAT_MSEED = {"mseed", recognise, read_traces};
