/* motion/formats/record.h -- what the readers of the file formats hand over: every channel of a file, as written there.
 *
 * Life cycle  Record r = {0} -> read -> record_free      (also after a failure)
 * Ownership   row belongs to the Record
 * Units       of the file: a sample is scale * row[first + i stride].a in the channel's unit */
#pragma once

#include "motion/formats/text.h"
#include "motion/text_form.h"

#define MOTION_STEP_MAX_S 1.0 /* accelerographs take 50 samples a second or more: a longer step is a mistake */

enum { CHANNELS_MAX = 128, CHANNEL_NAME_MAX = 64, UNIT_SHOWN = 32 };

typedef struct {
    double t, a;  /* [s] where the file has times, [unit of the file] */
    int line;     /* where it stands */
    int decimals; /* of the time as printed */
} Row;

typedef struct {
    char name[CHANNEL_NAME_MAX]; /* as in the file; may be empty */
    MotionUnit unit;             /* UNIT_FROM_FILE: none that is known */
    char stated[UNIT_SHOWN];     /* a unit that is not known; else empty */
    int counts;                  /* numbers of a recorder: motion.unit must say what they are */
    double scale;
    double dt;           /* [s] 0: the rows have times */
    double other_dt;     /* [s] of printed times beside dt, or of the header beside times; 0: there is only one */
    double peak;         /* [m/s2] largest |acceleration| that the header states; 0: it states none */
    double peak_slack;   /* [m/s2] half a unit of its last digit */
    int subtract_mean;   /* the agency's own peak is that of the record without its mean */
    int digitized;       /* from film, its steps are not equal */
    int is_timed;        /* the column of its times is named so */
    int is_bare;         /* its times stand in a column without a name */
    int is_corrected;    /* the agency has corrected its base line */
    const char *format;  /* static; of the file, or of the member of an archive, that holds it */
    const char *warning; /* static; NULL: none */
    size_t first, stride, n;
} Channel;

typedef struct {
    const MotionHow *how; /* channel NULL: none was named */
    int deep;             /* in so many archives */
    Row *row;
    size_t n, capacity;
    Channel channel[CHANNELS_MAX];
    size_t n_channels;
    int is_known;  /* what could not be read is a record of a known format */
    int is_broken; /* a member of this archive is such a one */
} Record;

/* Text: r->is_known where it is of a format that says what it is; else a table of numbers. */
Status text_read(Record *r, Lines *l, Err *err);

/* The last resort of it: plain columns. */
Status columns_read(Record *r, Lines *l, Err *err);

/* Files that are no text, and JSON; the first that recognises the bytes reads them. */
typedef struct {
    const char *name;
    int (*recognise)(const char bytes[], size_t n);
    Status (*read)(Record *r, const char *path, const char *bytes, size_t n, Err *err);
} BinaryFormat;
extern const BinaryFormat FORMAT_MSEED, FORMAT_SAC, FORMAT_SIMCENTER;

/* Alphanumeric SAC. */
int sac_text_is(Lines l);
Status sac_text_read(Record *r, Lines *l, Err *err);

/* ---- archives ---------------------------------------------------------------------------------------------------- */

/* Zip, tar, and gzip, bzip2, xz with or without tar, in memory: all of a member at a time, ARCHIVE_BYTES_MAX of all
 * members. What unpacks to more is refused. */
#define ARCHIVE_BYTES_MAX ((size_t)1 << 28)

int archive_is(const char bytes[], size_t n);

/* Calls take for every file in the order of the archive; name: with folders. */
typedef Status (*ArchiveFn)(const char *name, const char *bytes, size_t n, void *user, Err *err);
Status archive_each(const char *path, const char *bytes, size_t n, ArchiveFn take, void *user, Err *err);

/* ---- rows and channels ------------------------------------------------------------------------------------------- */

Status record_add(Record *r, Row row, Err *err);
void record_free(Record *r);

/* Numbers of a line, one Row each; *n is how many. with_comma: 1,5 is one and a half. */
Status record_add_cells(Record *r, Lines *l, int with_comma, size_t *n, Err *err);

/* The times of column k of `width` go into every row from the first one on. */
void record_set_times(Record *r, size_t first, size_t width, size_t k);

/* A channel without a name that begins with the next row. */
Status record_channel(Record *r, const Lines *l, Channel **out, Err *err);
void channel_name(Channel *c, const char *from, const char *to); /* blanks and quotes around it dropped, ASCII only */
__attribute__((format(printf, 2, 3))) void channel_named(Channel *c, const char *format, ...);

/* The name in `room` bytes and a NUL: what is too long loses its middle, for beginning and end tell names apart. */
void name_shorten(char *out, size_t room, const char *name);

/* Channels and rows of `from` behind those of r; ", MEMBER" with its folders is added to their names, shortened to
 * fit. */
Status record_append(Record *r, const Record *from, const char *path, const char *member, Err *err);

/* The unit that from..to begins with, as "g/10." or "gal. DCoffset"; one that is not known, up to a comma, a bracket
 * or two blanks, becomes `stated`; numbers of a recorder become counts. */
void channel_unit(Channel *c, const char *from, const char *to);

/* ---- samples ----------------------------------------------------------------------------------------------------- */

/* `count` samples into the last channel, at equal steps of its dt, or, digitized, pairs of time and acceleration, from
 * the line after l's; width: of columns of numbers that run together, 0: none. A line of words ends them early; a
 * further number is an error, behind `lines_behind` lines that are skipped. */
Status record_block(Record *r, Lines *l, double count, int width, size_t lines_behind, Err *err);

int line_has_letters(const Lines *l); /* beside those of exponents */

/* Begins like a word, a comment or an end marker ("*** End Data ***"), and not like nan, inf or Fortran's stars. */
int line_is_marker(const Lines *l);

/* n numbers in columns of `width`, on as many lines as they need. */
Status header_numbers(Lines *l, int width, size_t n, double x[], Err *err);

Status fail_too_short(const Lines *l, const char *what, Err *err);
