/* miniSEED 2 by libmseed (FDSN, SEED Reference Manual 2.4): every continuous trace is a channel NET.STA.LOC.CHA; a
 * gap makes two. Samples are counts, or numbers whose unit the file does not say. */
#include <libmseed.h>

#include "motion/formats/record.h"

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
        return ((const float *)t->datasamples)[i];
    default:
        return ((const double *)t->datasamples)[i];
    }
}

static Status take_trace(Record *r, const Lines *l, const MSTrace *t, Err *err)
{
    Channel *c;
    if (!t->datasamples || !strchr("ifd", t->sampletype) || t->numsamples < 2)
        return STATUS_OK; /* a log, or nothing */
    if (!(t->samprate >= 1 / MOTION_STEP_MAX_S && t->samprate <= 1e5))
        return STATUS_OK; /* state of health */
    TRY(record_channel(r, l, &c, err));
    channel_named(c, "%s.%s.%s.%s", t->network, t->station, t->location, t->channel);
    c->counts = 1;
    c->dt = 1 / t->samprate;
    c->n = t->numsamples;
    for (int64_t i = 0; i < t->numsamples; i++)
        TRY(record_add(r, (Row){.a = sample_of(t, i), .line = 1}, err));
    return STATUS_OK;
}

/* Bytes that a sample takes at least, times two; of what is not listed, 1: a Steim frame of 64 bytes holds 105 samples
 * at most. */
static const char HALF_BYTES[] = {[DE_ASCII] = 2,    [DE_INT16] = 4,      [DE_INT32] = 8,       [DE_FLOAT32] = 8,
                                  [DE_FLOAT64] = 16, [DE_GEOSCOPE24] = 6, [DE_GEOSCOPE163] = 4, [DE_GEOSCOPE164] = 4,
                                  [DE_CDSN] = 4,     [DE_SRO] = 4,        [DE_DWWSSN] = 4};

static int half_bytes(int encoding)
{
    const int is_listed = encoding >= 0 && encoding < (int)sizeof HALF_BYTES && HALF_BYTES[encoding];
    return is_listed ? HALF_BYTES[encoding] : 1;
}

/* The library decodes as many samples as the header announces, wherever the record ends. */
static int announces_too_much(const MSRecord *r)
{
    const int64_t room = (int64_t)r->reclen - r->fsdh->data_offset;
    return r->samplecnt > 0 && (r->fsdh->data_offset < 48 || r->samplecnt * half_bytes(r->encoding) > 2 * room);
}

/* The record at `bytes`: its header alone, then with its samples. 0: as it should be. */
static int parse_record(const char *bytes, size_t n, MSRecord **record)
{
    const int left = n > (1 << 30) ? 1 << 30 : (int)n;
    if (!MS_ISVALIDHEADER(bytes) || msr_parse((char *)bytes, left, record, 0, 0, 0) != 0)
        return -1;
    if ((*record)->reclen < 64 || announces_too_much(*record))
        return -1;
    return msr_parse((char *)bytes, left, record, (*record)->reclen, 1, 0);
}

enum { TRACES_MAX = 8 * CHANNELS_MAX }; /* logs and the state of health are no channels */

static Status collect(MSTraceGroup *group, const char *path, const char *bytes, size_t n, Err *err)
{
    MSRecord *record = NULL;
    Status status = STATUS_OK;
    for (size_t at = 0; at + 48 < n && status == STATUS_OK;) {
        if (parse_record(bytes + at, n - at, &record) != 0) {
            if (at == 0 || MS_ISVALIDHEADER(bytes + at)) /* else padding behind the records */
                status = bad_data(err, "%s: miniSEED: no usable record at byte %zu", path, at);
            break;
        }
        if (group->numtraces > TRACES_MAX) /* each record is compared with all of them */
            status = bad_data(err, "%s: miniSEED: more than %d channels", path, CHANNELS_MAX);
        else if (!mst_addmsrtogroup(group, record, 0, -1, -1))
            status = bad_data(err, "%s: miniSEED: the record at byte %zu fits no trace", path, at);
        at += record->reclen;
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
        return bad_data(err, "%s: miniSEED without samples", path);
    return status;
}

const BinaryFormat FORMAT_MSEED = {"mseed", recognise, read_traces};
