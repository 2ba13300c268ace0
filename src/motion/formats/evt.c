/* Kinemetrics EVT (K2, Makalu, Etna and others), as the Altus manual lays it out: a tag of 16 bytes and a header of
 * 2040 for 12 channels, then for each tenth of a second a tag, a frame header of 32 bytes and the samples of that
 * tenth, channel by channel. All numbers have the byte order that the tag names; only the most significant byte first
 * is read, the one of the instruments themselves.
 *
 *   tag       0 'K'   1 byte order   4 type: 1 header, 2 frame   8 length of what follows   10 length of the samples
 *   header    0x234 frames   0x24e channels   0x250 station   0x2c8 + 76 k: channel k: name (5), 32 full scale [V],
 *             36 sensitivity [V/g]
 *   frame     0 type (3: up to 12 channels)   10 bit map of the channels   12 samples per second (12 bits)
 *             14 bytes of a sample less one (2 bits from the top)
 *
 *   a [g] = counts / 2^23 full scale / sensitivity       (samples of 3 or 4 bytes, 24 bits) */

#include "motion/formats/record.h"

enum { TAG = 16, HEADER = 2040, FRAME = 32, CHANNELS = 12, TAG_HEADER = 1, TAG_FRAME = 2, FRAME_OF_12 = 3 };

static unsigned u16(const unsigned char *b)
{
    return (unsigned)b[0] << 8 | b[1];
}

static uint32_t u32(const unsigned char *b)
{
    return u16(b) << 16 | u16(b + 2);
}

static double f32(const unsigned char *b)
{
    const uint32_t bits = u32(b);
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static int recognise(const unsigned char b[], size_t n)
{
    return n > TAG && b[0] == 'K' && b[1] <= 1 && b[2] <= 2 && b[3] < 64;
}

typedef struct {
    unsigned channels, rate, bytes; /* bit map; [Hz]; of a sample */
} Form;

static Form form_of(const unsigned char *frame)
{
    return (Form){u16(frame + 10) & 0xfff, u16(frame + 12) & 0xfff, (frame[14] >> 6) + 1u};
}

static Status check_form(const char *path, size_t at, const Form *f, const unsigned char *frame, size_t samples,
                         Err *err)
{
    if (frame[0] != FRAME_OF_12 || f->bytes < 3 || f->bytes > 4 || !f->channels || f->rate < 10 || f->rate % 10)
        return bad_data(
            err,
            "%s: Kinemetrics EVT: the frame at byte %zu is of type %d with samples of %u bytes, channels %#x, "
            "%u Hz; type 3 with 3 or 4 bytes is read",
            path, at, frame[0], f->bytes, f->channels, f->rate);
    const size_t wanted = (size_t)f->rate / 10 * f->bytes * __builtin_popcount(f->channels);
    return samples == wanted
               ? STATUS_OK
               : bad_data(err, "%s: Kinemetrics EVT: %zu bytes of samples in the frame at byte %zu, %zu are expected",
                          path, samples, at, wanted);
}

static Status add_channels(Record *r, const Lines *l, const unsigned char *header, const Form *f, Err *err)
{
    size_t stride = __builtin_popcount(f->channels), place = 0;
    for (int k = 0; k < CHANNELS; k++) {
        const unsigned char *about = header + 0x2c8 + 76 * k;
        const double full_scale = f32(about + 32), sensitivity = f32(about + 36);
        Channel *c;
        if (!(f->channels >> k & 1u))
            continue;
        TRY(record_channel(r, l, &c, err));
        channel_named(c, "%d %.5s", k + 1, (const char *)about);
        c->first = place++;
        c->stride = stride;
        c->dt = 1.0 / f->rate;
        if (full_scale > 0 && sensitivity > 0 && full_scale < 1e6 && sensitivity < 1e6) {
            c->unit = UNIT_G;
            c->scale = full_scale / 8388608 / sensitivity;
        } else
            c->counts = 1;
    }
    return STATUS_OK;
}

/* Samples of one frame: scan after scan, in each every channel. */
static Status add_samples(Record *r, const unsigned char *b, size_t n, unsigned bytes, Err *err)
{
    for (size_t i = 0; i < n; i += bytes) {
        const uint32_t top = bytes == 4 ? u32(b + i) : (u16(b + i) << 8 | b[i + 2]) << 8;
        const double value = bytes == 4 ? (int32_t)top : ((int32_t)top / 256);
        TRY(record_add(r, (Row){.a = value, .line = 1}, err));
    }
    return STATUS_OK;
}

static Status read_frames(Record *r, const char *path, const unsigned char *b, size_t n, Err *err)
{
    const Lines l = {.path = path, .number = 1};
    const uint32_t wanted = u32(b + TAG + 0x234);
    size_t at = TAG + HEADER;
    uint32_t frames = 0;
    Form first = {0};
    while (n - at >= TAG + FRAME && b[at] == 'K') {
        const size_t samples = u16(b + at + 10);
        const unsigned char *frame = b + at + TAG;
        if (u32(b + at + 4) != TAG_FRAME || u16(b + at + 8) != FRAME || n - at < TAG + FRAME + samples)
            break;
        const Form form = form_of(frame);
        TRY(check_form(path, at, &form, frame, samples, err));
        if (frames == 0)
            TRY(add_channels(r, &l, b + TAG, &form, err));
        first = frames == 0 ? form : first;
        if (memcmp(&form, &first, sizeof form) != 0)
            return bad_data(err, "%s: Kinemetrics EVT: channels or rate change at byte %zu", path, at);
        TRY(add_samples(r, frame + FRAME, samples, form.bytes, err));
        frames++;
        at += TAG + FRAME + samples;
    }
    if (n - at >= TAG + HEADER && b[at] == 'K' && u32(b + at + 4) == TAG_HEADER)
        return bad_data(err, "%s: Kinemetrics EVT: a second record begins at byte %zu; keep one of them", path, at);
    if (frames == 0 || frames != wanted)
        return bad_data(err,
                        "%s: Kinemetrics EVT: holds %u frames of a tenth of a second, its header "
                        "announces %u",
                        path, frames, wanted);
    for (size_t k = 0; k < r->n_channels; k++)
        r->channel[k].n = r->n / r->n_channels;
    return STATUS_OK;
}

static Status read(Record *r, const char *path, const char *bytes, size_t n, Err *err)
{
    const unsigned char *b = (const unsigned char *)bytes;
    if (b[1] != 1 || u32(b + 4) != TAG_HEADER || u16(b + 8) != HEADER || n < TAG + HEADER)
        return bad_data(
            err, "%s: Kinemetrics EVT %s is not read; convert it to miniSEED, SAC or text (K2COSMOS, kw2asc)", path,
            b[1] != 1 ? "with the least significant byte first" : "without a header of 2040 bytes (12 channels)");
    return read_frames(r, path, b, n, err);
}

const BinaryFormat FORMAT_EVT = {"evt", recognise, read};
