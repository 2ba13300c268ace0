/* motion/formats/record.h -- what the readers of the file formats hand over: every channel of a file, as written there.
 *
 * Life cycle  Record r = {0} -> read -> record_free      (also after a failure)
 * Ownership   row belongs to the Record
 * Units       of the file: a sample is scale * row[first + i stride].a in the channel's unit */
#ifndef IMTET_MOTION_FORMATS_RECORD_H
#define IMTET_MOTION_FORMATS_RECORD_H

#include "motion/formats/text.h"

#define MOTION_STEP_MAX_S 1.0 /* accelerographs take 50 samples a second or more: a longer step is a mistake */

enum { CHANNELS_MAX = 128, CHANNEL_NAME_MAX = 64 };

typedef struct {
    double t, a;  /* [s] where the file has times, [unit of the file] */
    int line;     /* where it stands */
    int decimals; /* of the time as printed */
} Row;

typedef struct {
    char name[CHANNEL_NAME_MAX]; /* as in the file; may be empty */
    char full[CHANNEL_NAME_MAX]; /* in an archive: the name with the folder of its file; else empty */
    unsigned units;              /* that the file names, one bit (1 << MotionUnit) each */
    char unit[UNIT_SHOWN];       /* as stated, where units does not know it; else empty */
    double scale;
    double dt;           /* [s] 0: the rows have times */
    double other_dt;     /* [s] of printed times beside dt, or of the header beside times; 0: there is only one */
    double peak;         /* [m/s2] largest |acceleration| that the header states; 0: it states none */
    double peak_slack;   /* [m/s2] half a unit of its last digit */
    int subtract_mean;   /* the agency's own peak is that of the record without its mean */
    int counts;          /* numbers without a unit: motion.counts_per_m_s2 or motion.unit must say what they are */
    const char *format;  /* static; of the file, or of the member of an archive, that holds it */
    int digitized;       /* from film, its steps are not equal */
    const char *warning; /* static; NULL: none */
    size_t first, stride, n;
} Channel;

typedef struct {
    Row *row;
    size_t n, capacity;
    Channel channel[CHANNELS_MAX];
    size_t n_channels;
    int is_known;  /* what could not be read is a record of a known format */
    int is_broken; /* a member of this archive is such a one */
} Record;

typedef struct {
    double dt_s;         /* of a file that has neither times nor a step; 0: none was given */
    const char *channel; /* the one that is wanted; NULL: none was named */
} ReadHints;

/* One way in which people have ground motions. */
typedef struct {
    const char *name;
    int (*recognise)(Lines l); /* by what the first lines hold */
    Status (*read)(Record *r, Lines *l, const ReadHints *hints, Err *err);
} MotionFormat;

/* Pairs of time and acceleration in columns of `width`, `count` of them, into the last channel. */
Status record_pairs(Record *r, Lines *l, double count, int width, Err *err);

extern const MotionFormat FORMAT_AT2, FORMAT_COSMOS, FORMAT_CSMIP, FORMAT_SMC, FORMAT_KNET, FORMAT_ESM, FORMAT_GEONET,
    FORMAT_JMA, FORMAT_CWB, FORMAT_AFAD, FORMAT_UNAM, FORMAT_CSMNC, FORMAT_CSN, FORMAT_ISESD, FORMAT_BHRC, FORMAT_USC,
    FORMAT_SLIST, FORMAT_TSPAIR, FORMAT_REFUSED, FORMAT_COLUMNS;

/* Files that are no text. */
typedef struct {
    const char *name;
    int (*recognise)(const unsigned char bytes[], size_t n);
    Status (*read)(Record *r, const char *path, const char *bytes, size_t n, Err *err);
} BinaryFormat;

extern const BinaryFormat FORMAT_MSEED, FORMAT_SAC, FORMAT_EVT;
extern const MotionFormat FORMAT_SAC_TEXT, FORMAT_SIMCENTER;

/* The name in `room` bytes and a NUL: what is too long loses its middle, for beginning and end tell names apart. */
void name_shorten(char *out, size_t room, const char *name);

/* Channels and rows of `from` behind those of r; ", MEMBER" is added to their names, without folders in name and with
 * them in full, the member shortened to fit. */
Status record_append(Record *r, const Record *from, const char *path, const char *member, Err *err);

Status record_add(Record *r, const Lines *l, Row row, Err *err);
void record_free(Record *r);

/* A channel without a name that begins with the next row. */
Status record_channel(Record *r, const Lines *l, Channel **out, Err *err);
void channel_name(Channel *c, const char *from, const char *to); /* blanks and quotes around it dropped, ASCII only */

/* The unit that a header states, colon or equals sign before it dropped. */
void channel_unit(Channel *c, const char *from, const char *to);

/* The units that a line names, or tenths of g (g/10) by the channel's scale; where it names none, what it states as one behind `word`, up to a comma, a bracket or two
 * blanks. */
void channel_unit_in(Channel *c, const Lines *l, const char *word);

/* The value behind the first colon of a line "key : value"; 0: no colon. */
int value_behind_colon(const Lines *l, const char **from);

typedef struct {
    double count, dt; /* as read: whole and positive ones are accepted */
    int width;        /* columns of numbers that run together; 0: none */
} BlockForm;

/* Takes the number behind `word` in from..to, if it is there, as the peak that the header states. */
void channel_peak(Channel *c, const char *from, const char *to, const char *word, double m_s2);

/* Exactly `count` samples into the last channel, from the line after l's; a line of words ends them early. */
Status record_block(Record *r, Lines *l, const BlockForm *form, Err *err);

/* Begins like a word, a comment or an end marker ("*** End Data ***"), and not like nan, inf or Fortran's stars. */
int line_is_marker(const Lines *l);

/* No further number may stand behind a block. */
Status record_block_ends(const Lines *l, double count, Err *err);

/* n numbers in columns of `width`, on as many lines as they need. */
Status header_numbers(Lines *l, int width, size_t n, double x[], Err *err);

Status fail_too_short(const Lines *l, const char *what, Err *err);

#endif
