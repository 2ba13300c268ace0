/* Texts that are known and hold no ground acceleration that could be read: refused by name. */
#include "motion/formats/record.h"

static const struct {
    const char *begins, *has, *name;
} KNOWN[] = {
    {"Response and Fourier amplitude spectra", "", "response and Fourier spectra of CSMIP (V3); take its V2 or V1"},
    {"RESPONSE", "FOURIER", "response and Fourier spectra (volume 3); take the accelerogram"},
    {"<?xml", "", "XML (StationXML, QuakeML or the like)"},
    {"<!DOCTYPE html", "", "a web page, perhaps of a log-in, in the place of the record"},
    {"<html", "", "a web page, perhaps of a log-in, in the place of the record"},
    {"WID2", "", "GSE2; export it as miniSEED, SAC or text"},
    {"BEGIN GSE2", "", "GSE2; export it as miniSEED, SAC or text"},
    {"version https://git-lfs", "", "a pointer of git-lfs in the place of the record"},
};

static const char *name_of(const Lines *l)
{
    for (size_t i = 0; i < sizeof KNOWN / sizeof KNOWN[0]; i++)
        if (line_begins(l, KNOWN[i].begins) && line_has(l, KNOWN[i].has))
            return KNOWN[i].name;
    return NULL;
}

static int recognise(Lines l)
{
    return lines_next(&l) && name_of(&l);
}

static Status read(Record *r, Lines *l, const ReadHints *hints, Err *err)
{
    (void)r;
    (void)hints;
    lines_next(l);
    return fail(err, STATUS_BAD_DATA, "%s: is not read: %s", l->path, name_of(l));
}

const MotionFormat FORMAT_REFUSED = {"refused", recognise, read};
