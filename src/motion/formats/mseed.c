/* miniSEED 2 by libmseed (FDSN, SEED Reference Manual 2.4): every continuous trace is a channel NET.STA.LOC.CHA; a
 * gap makes two. Samples are counts, or numbers whose unit the file does not say. */
#include <libmseed.h>

#include "motion/formats/record.h"

static int recognise(const char bytes[], size_t n)
{
    return n >= 64 && MS_ISVALIDHEADER(bytes);
}

static void say_nothing(char *message)
{
    (void)message;
}

/* Bytes that a sample takes at least, times two; of what is not listed, 1: a Steim frame of 64 bytes holds 105 samples
 * at most. */
static const char HALF_BYTES[] = {[DE_ASCII] = 2,    [DE_INT16] = 4,      [DE_INT32] = 8,       [DE_FLOAT32] = 8,
                                  [DE_FLOAT64] = 16, [DE_GEOSCOPE24] = 6, [DE_GEOSCOPE163] = 4, [DE_GEOSCOPE164] = 4,
                                  [DE_CDSN] = 4,     [DE_SRO] = 4,        [DE_DWWSSN] = 4};

/* The record at `bytes`: its header alone, then with its samples. 0: as it should be. The library decodes as many
 * samples as the header announces, wherever the record ends. */
static int parse_record(const char *bytes, size_t n, MSRecord **record)
{
    const int left = n > (1 << 30) ? 1 << 30 : (int)n;
    if (!MS_ISVALIDHEADER(bytes) || msr_parse((char *)bytes, left, record, 0, 0, 0) != 0)
        return -1;
    const MSRecord *r = *record;
    const int encoding = (unsigned char)r->encoding, /* -1, none, is no row of the table */
        is_listed = encoding < (int)sizeof HALF_BYTES && HALF_BYTES[encoding];
    const int64_t room = (int64_t)r->reclen - r->fsdh->data_offset;
    if (r->reclen < 64 || (r->samplecnt > 0 && (r->fsdh->data_offset < 48 ||
                                                r->samplecnt * (is_listed ? HALF_BYTES[encoding] : 1) > 2 * room)))
        return -1;
    return msr_parse((char *)bytes, left, record, r->reclen, 1, 0);
}

enum { TRACES_MAX = 8 * CHANNELS_MAX }; /* logs and the state of health are no channels */

/* Collects the records into traces, without gaps, each of which becomes a channel. */
static Status read_traces(Record *r, const char *path, const char *bytes, size_t n, Err *err)
{
    const Lines l = {.path = path, .number = 1};
    MSRecord *record = NULL;
    Status status = STATUS_OK;
#pragma omp critical(libmseed) /* records are read side by side, and the library keeps this for all of them */
    ms_loginit(say_nothing, NULL, say_nothing, NULL);
    MSTraceGroup *group = mst_initgroup(NULL);
    if (!group)
        return fail(err, STATUS_NO_MEMORY, "%s: no memory for its traces", path);
    for (size_t at = 0; at + 48 < n && status == STATUS_OK; at += record->reclen) {
        if (parse_record(bytes + at, n - at, &record) != 0) {
            if (at == 0 || MS_ISVALIDHEADER(bytes + at)) /* else padding behind the records */
                status = bad_data(err, "%s: miniSEED: no usable record at byte %zu", path, at);
            break;
        }
        if (group->numtraces > TRACES_MAX) /* each record is compared with all of them */
            status = bad_data(err, "%s: miniSEED: more than %d channels", path, CHANNELS_MAX);
        else if (!mst_addmsrtogroup(group, record, 0, -1, -1))
            status = bad_data(err, "%s: miniSEED: the record at byte %zu fits no trace", path, at);
    }
    msr_free(&record);

    /* Logs, which have no numbers, and the state of health, which is sampled slowly, are no channels. */
    for (const MSTrace *t = group->traces; t && status == STATUS_OK; t = t->next) {
        Channel *c;
        if (!t->datasamples || !strchr("ifd", t->sampletype) || t->numsamples < 2 ||
            !(t->samprate >= 1 / MOTION_STEP_MAX_S && t->samprate <= 1e5))
            continue;
        status = record_channel(r, &l, &c, err);
        if (status != STATUS_OK)
            break;
        channel_named(c, "%s.%s.%s.%s", t->network, t->station, t->location, t->channel);
        c->counts = 1;
        c->dt = 1 / t->samprate;
        c->n = t->numsamples;
        for (int64_t i = 0; i < t->numsamples && status == STATUS_OK; i++) {
            const double a = t->sampletype == 'i'   ? ((const int32_t *)t->datasamples)[i]
                             : t->sampletype == 'f' ? ((const float *)t->datasamples)[i]
                                                    : ((const double *)t->datasamples)[i];
            status = record_add(r, (Row){.a = a, .line = 1}, err);
        }
    }
    mst_freegroup(&group);
    return status == STATUS_OK && r->n_channels == 0 ? bad_data(err, "%s: miniSEED without samples", path) : status;
}

const BinaryFormat FORMAT_MSEED = {"mseed", recognise, read_traces};
