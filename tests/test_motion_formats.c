/* Ground motions in the forms that people have them: tests/motion holds one small synthetic specimen of each, written
 * after the published descriptions. All hold the same three components, whose 16th sample is their peak. */
#include "check.h"

#include <archive.h>
#include <archive_entry.h>
#include <ctype.h>
#include <dirent.h>

#include "base/csv.h"
#include "motion/formats/record.h"
#include "motion/motion_read.h"

enum { N_SAMPLES = 43, PEAK_AT = 15 };
static const double PEAK_GAL[] = {-123.4, 98.7, 85.6}, DT = 0.01;

typedef struct {
    const char *file, *format;
    MotionHow how;
    int component;
    const char *name;
    double tolerance; /* of digits in the file */
} Specimen;
static const Specimen SPECIMENS[] = {{"equals.at2", "at2", {.channel = "auto"}, 0, "", 1e-6},
                                     {"columns.at2", "at2", {.channel = "auto"}, 0, "", 1e-6},
                                     {"run_together.at2", "at2", {.channel = "auto"}, 0, "", 1e-7},
                                     {"one.cosmos.v1", "cosmos", {.channel = "auto"}, 0, "Other", 1e-9},
                                     {"three.cosmos.v2", "cosmos", {.channel = "340"}, 0, "340 deg", 1e-9},
                                     {"three.cosmos.v2", "cosmos", {.channel = "2"}, 1, "70 deg", 1e-9},
                                     {"three.cosmos.v2", "cosmos", {.channel = "up"}, 2, "Up", 1e-9},
                                     {"three.csmip.v1", "csmip", {.channel = "360 Deg"}, 0, "360 Deg", 1e-5},
                                     {"three.csmip.v1", "csmip", {.channel = "90"}, 1, "90 Deg", 1e-5},
                                     {"three.csmip.v1", "csmip", {.channel = "3"}, 2, "Up", 2e-5},
                                     {"three.csmip.v2", "csmip", {.channel = "1"}, 0, "360 Deg", 1e-9},
                                     {"three.csmip.v2", "csmip", {.channel = "90deg"}, 1, "90 Deg", 1e-9},
                                     {"three.csmip.v2", "csmip", {.channel = "UP"}, 2, "Up", 1e-9},
                                     {"film.csmip.v1", "csmip", {.channel = "auto"}, 0, "360 Deg", 1e-3},
                                     {"one.smc", "smc", {.channel = "auto"}, 0, "360", 1e-9},
                                     {"one.knet", "knet", {.channel = "ns"}, 0, "N-S", 1e-5},
                                     {"one.kiknet", "knet", {.channel = "1"}, 1, "EW2", 1e-5},
                                     {"one.esm", "esm", {.channel = "HNE"}, 0, "HNE", 1e-9},
                                     {"three.v1a", "geonet", {.channel = "N28W"}, 0, "N28W", 1e-9},
                                     {"three.v1a", "geonet", {.channel = "3"}, 2, "Up", 1e-9},
                                     {"three.v2a", "geonet", {.channel = "S62W"}, 1, "S62W", 1e-9},
                                     {"jma.csv", "jma", {.channel = "NS"}, 0, "NS", 1e-9},
                                     {"jma.csv", "jma", {.channel = "EW"}, 1, "EW", 1e-9},
                                     {"jma.csv", "jma", {.channel = "3"}, 2, "UD", 1e-9},
                                     {"end_mark.at2", "at2", {.channel = "auto"}, 0, "", 1e-6},
                                     {"no_format.csmip.v2", "csmip", {.channel = "2"}, 1, "90 Deg", 1e-9},
                                     {"wide.smc", "smc", {.channel = "auto"}, 0, "360", 1e-9},
                                     {"film.smc", "smc", {.channel = "auto"}, 0, "360", 1e-9},
                                     {"old.v1a", "geonet", {.channel = "2"}, 1, "", 1e-9},
                                     {"afad.txt", "afad", {.channel = "E-W"}, 1, "E-W", 1e-9},
                                     {"afad.txt", "afad", {.channel = "ud"}, 2, "U-D", 1e-9},
                                     {"asa.unam", "unam", {.channel = "N00E"}, 0, "N00E", 1e-9},
                                     {"asa.unam", "unam", {.channel = "3"}, 2, "V", 1e-9},
                                     {"cwb.dat", "cwb", {.channel = "N"}, 0, "N", 1e-9},
                                     {"cwb.dat", "cwb", {.channel = "E"}, 1, "E", 1e-9},
                                     {"cwb.dat", "cwb", {.channel = "1"}, 2, "U", 1e-9},
                                     {"three.bhrc", "bhrc", {.channel = "L"}, 0, "L", 1e-6},
                                     {"three.bhrc", "bhrc", {.channel = "V"}, 2, "V", 1e-6},
                                     {"two.usc", "usc", {.channel = "N05W"}, 0, "N05W", 1e-3},
                                     {"two.usc", "usc", {.channel = "S85E"}, 1, "S85E", 1e-3},
                                     {"isesd.cor", "isesd", {.channel = "auto"}, 0, "NS", 1e-6},
                                     {"three.slist", "slist", {.channel = "2"}, 1, "XX_SYN_00_HNE_D", 1e-6},
                                     {"one.tspair", "tspair", {.channel = "auto"}, 0, "XX_SYN_00_HNN_D", 1e-6},
                                     {"one.csmnc", "csmnc", {.channel = "auto"}, 0, "NS", 1e-6},
                                     {"one.csn", "csn", {.channel = "auto"}, 0, "HNN", 1e-9},
                                     {"one_column.txt", "csv", {.channel = "auto"}, 0, "", 1e-9},
                                     {"two_columns.txt", "csv", {.channel = "auto"}, 0, NULL, 1e-9},
                                     {"many_columns.csv", "csv", {.channel = "NS"}, 0, "NS", 1e-9},
                                     {"many_columns.csv", "csv", {.channel = "2"}, 1, "EW", 1e-9},
                                     {"decimal_comma.csv", "csv", {.channel = "auto"}, 0, "NS [cm/s2]", 1e-9},
                                     {"wrapped.txt", "csv", {.channel = "auto"}, 0, "", 1e-9}};
enum { N_SPECIMENS = sizeof SPECIMENS / sizeof *SPECIMENS };

#define SPECIMEN(file) brief("tests/motion/%s", file)

/* Format, samples, step and the largest sample; the channel's name where it is given. */
static void check_specimen(const Specimen *s)
{
    OWNED(motion_free) Motion m;
    CHECK_OK(motion_read(&m, SPECIMEN(s->file), &s->how, &err), &err);
    const double want = 0.01 * PEAK_GAL[s->component];
    if (strcmp(m.format, s->format) != 0 || m.n != N_SAMPLES || fabs(m.dt_s - DT) > 1e-12 ||
        !(fabs(m.accel[PEAK_AT] - want) <= s->tolerance * fabs(want)) || motion_peak(&m) != fabs(m.accel[PEAK_AT]))
        fail_msg("%s: %s, %zu samples every %.9g s, %.9g at the peak of %.9g", s->file, m.format, m.n, m.dt_s,
                 m.accel[PEAK_AT], want);
    if (s->name)
        assert_string_equal(m.channel, s->name);
}

TEST(a_specimen_of_every_format_is_read_to_its_step_length_and_peak)
{
    for (int i = 0; i < N_SPECIMENS; i++)
        check_specimen(&SPECIMENS[i]);
}

/* What is no text, or text whose unit is asked for. */
#define COUNTS .unit = UNIT_COUNTS, .counts_per_m_s2 = 1e5
static const Specimen BINARY[] = {
    {"three.mseed", "mseed", {.channel = "1", COUNTS}, 0, "XX.SYN.00.HNN", 1e-6},
    {"three.mseed", "mseed", {.channel = "XX.SYN.00.HNZ", COUNTS}, 2, "XX.SYN.00.HNZ", 1e-6},
    {"little.sac", "sac", {.unit = UNIT_CM_S2}, 0, "HNN", 1e-6},
    {"little.sac", "sac", {.unit = UNIT_COUNTS, .counts_per_m_s2 = 100}, 0, "HNN", 1e-6},
    {"big.sac", "sac", {.unit = UNIT_G}, 1, "HNE", 1e-6},
    {"text.sac", "sac", {.unit = UNIT_M_S2}, 0, "HNN", 1e-6},
    {"simcenter.json", "simcenter", {.channel = "1"}, 0, "SYN-1 x", 1e-9},
    {"simcenter.json", "simcenter", {.channel = "SYN-1 y"}, 1, "SYN-1 y", 1e-9},
    {"knet.tar.gz", "knet", {.channel = "EW"}, 1, "E-W, knet/SYN0010101010000.EW", 1e-5},
    {"knet.tar.gz", "knet", {.channel = "3"}, 2, "U-D, knet/SYN0010101010000.UD", 1e-5},
    {"cesmd.zip", "csmip", {.channel = "90 deg"}, 1, "90 Deg, SYN01.V2, syn_event.zip", 1e-9}};

TEST(binary_files_and_archives_are_read_to_their_samples)
{
    for (int i = 0; i < (int)N_OF(BINARY); i++)
        check_specimen(&BINARY[i]);
}

/* ---- changed specimens ---------------------------------------------------------------------------------------- */

typedef struct {
    char *text;
    size_t length;
} Text;

static Text read_specimen(const char *file)
{
    Text t;
    CHECK_OK(file_read(SPECIMEN(file), FILE_LARGEST, &t.text, &t.length, &err), &err);
    return t;
}

/* The text with every `from` written as `to` (only the first one unless `all`). */
static Text changed(Text t, const char *from, const char *to, int all)
{
    Text out = {malloc(2 * t.length + 4096), 0};
    assert_non_null(out.text);
    int n = 0;
    for (size_t i = 0; i < t.length;) {
        if ((all || n == 0) && strncmp(t.text + i, from, strlen(from)) == 0) {
            memcpy(out.text + out.length, to, strlen(to));
            out.length += strlen(to);
            i += strlen(from);
            n++;
        } else {
            out.text[out.length++] = t.text[i++];
        }
    }
    out.text[out.length] = 0;
    if (n == 0)
        fail_msg("there is no '%s' to change", from);
    free(t.text);
    return out;
}

/* Refused with these words; the text is released. */
static void refuse(const char *name, Text t, const MotionHow *how, const char *says)
{
    Motion m;
    assert_refused(motion_parse(&m, name, t.text, t.length, how, &err), STATUS_BAD_DATA, says);
    free(t.text);
}

/* Read; the text is released. */
static Motion accept_text(const char *name, Text t, const MotionHow *how)
{
    Motion m;
    CHECK_OK(motion_parse(&m, name, t.text, t.length, how, &err), &err);
    free(t.text);
    return m;
}

/* A text of the test's own, which is read. */
static Motion there(const char *text, const MotionHow *how)
{
    return accept_text("there", (Text){strdup(text), strlen(text)}, how);
}

TEST(line_ends_and_blanks_at_line_ends_do_not_matter)
{
    for (int i = 0; i < N_SPECIMENS; i++)
        FOR_EACH (const char *, each, "\n", "\r\n", "   \r\n", "\t\n", "\r") {
            Text t = read_specimen(SPECIMENS[i].file);
            if (memchr(t.text, '\r', t.length))
                t = changed(t, "\r", "", 1);
            t = changed(t, "\n", *each, 1);
            t.text[t.length++] = 0x1a; /* the end mark of DOS */
            OWNED(motion_free)
            Motion m = accept_text(SPECIMENS[i].file, t, &SPECIMENS[i].how);
            assert_int_equal(m.n, N_SAMPLES);
        }
}

#define NO_STEP       "no usable time step (above 0, at most 1 s) above this line "
#define NO_UNIT(unit) "the unit '" unit "' of its acceleration is not known"
static const struct {
    const char *file, *from, *to, *says;
} WRONG[] = {
    {"equals.at2", "43,", "44,", ":13: ends after 43 samples, but its header announces 44"},
    {"equals.at2", "43,", "42,", ":13: more samples than the 42"},
    {"columns.at2", "43 ", "4.5 ", ":4: no usable number of points"},
    {"columns.at2", "0.0100", "-.0100", ":4: no usable time step"},
    {"equals.at2", "DT=", "  =", ":4: no usable time step"},
    {"columns.at2", "0.0100", "99999.", ":4: no usable time step"},
    {"columns.at2", " .3465851E-02", " 0x1p-3", ":5: '0x1p-3' is not a number"},
    {"decimal_comma.csv", "-123,4", "-0x7B", ":17: '-0x7B' is not a number"},
    {"run_together.at2", "-1.29459735E-02", "***************", "-3.37410805' is not a number"},
    {"three.cosmos.v2", "(8F10.5)", "(8F10.5)\n 1.0", ":53: more samples than the 43 that its header announces"},
    {"three.cosmos.v2", "43 acceleration pts", "44 acceleration pts", ":52: ends after 43 samples"},
    {"three.cosmos.v2", "  10.000000", "9999.000000", ":46: no usable time step"},
    {"one.cosmos.v1", "x    0 secs", "x   50 secs", ":46: a length of 50 s, but 43 samples every 0.01 s are 0.43 s"},
    {"one.cosmos.v1", "units=cm/sec2(04)", "units=counts (50)", "set motion.unit (--unit) to counts=VALUE"},
    {"one.cosmos.v1", "units=cm/sec2(04)", "units=inches (99)", NO_UNIT("inches") "; convert it"},
    {"one.cosmos.v1", "units=cm/sec2(04)", "units=KMX (99)",
     NO_UNIT("KMX") "; set motion.unit (--unit) to counts=VALUE, its counts per m/s2"},
    {"one.cosmos.v1", "ed acceleration", "ed velocity", ":1: not an acceleration"},
    {"one.cosmos.v1", "follow on  17 lines", "fellow", ":25: '100 Real-header values"},
    {"one.cosmos.v1", "with 13", "with 12", ":13: 'Values used when"},
    {"one.cosmos.v1", "with 13", "with -1", ":1: "},
    {"one.cosmos.v1", "with 13", "with 9999", ":1: "},
    {"one.cosmos.v1", "17 lines", "-7 lines", "Real-header values"},
    {"one.cosmos.v1", "17 lines", "7e9 lines", "Real-header values"},
    {"three.csmip.v1", "43 Accelerogram", "48 Accelerogram", ":34: ends after 43 samples, but its header announces 48"},
    {"three.csmip.v1", "43 Accelerogram", "40 Accelerogram", ":34: more samples than the 40"},
    {"three.csmip.v1", "at 100 pts", "at 000 pts", ":28: " NO_STEP "(spaced intervals of)"},
    {"three.csmip.v2", "43 points of accel", "xx points of accel", ":46: no usable number of points"},
    {"three.csmip.v2", "of accel data", "of veloc data", ":46: not an acceleration"},
    {"film.csmip.v1", "=     43 ", "=     44 ", ": ends after 43 samples, but its header announces 44"},
    {"film.csmip.v1", "  0.150 -1", "  0.950 -1", "does not come after 0.95 s"},
    {"film.csmip.v1", "  0.150 -1", "  0.158 -1", "digitized from film, where its trace bends; have it resampled"},
    {"film.csmip.v1", "SEC AND G/10", "SEC AND INCHES", NO_UNIT("INCHES")},
    {"three.csmip.v1", "in units of g .      ", "in units of mg .     ", NO_UNIT("mg")},
    {"three.bhrc", "AND G/10", "AND INCHES", NO_UNIT("INCHES")},
    {"two.usc", "AND G/10", "AND FEET", NO_UNIT("FEET")},
    {"asa.unam", "Gal (cm/s/s)", "pulgadas", NO_UNIT("pulgadas")},
    {"one.csmnc", "CM/SEC/SEC", "INCHES", NO_UNIT("INCHES")},
    {"film.csmip.v1", "=     43 ", "=      1 ", "no usable number of points"},
    {"film.csmip.v1", "=     43 ", "=    9e9 ", "no usable number of points"},
    {"one.smc", "  1.0000000E+02", "  1.0000000E+09", ":30: no usable time step"},
    {"one.smc", "2 CORRECTED ACCELEROGRAM", "3 VELOCITY", ":1: not an acceleration"},
    {"one.smc", "        43", "    -32768", ":30: no usable number of points"},
    {"one.smc", "        43", "        44", ":36: ends after 43 samples, but its header announces 44"},
    {"one.smc", "  1.0000000E+02", "  0.0000000E+00", ":30: no usable time step"},
    {"one.smc", "         3", "         2", ":29: ends after 0 samples"},
    {"one.knet", "3920(gal)/6182761", "3920(gal)", ":14: no usable Scale Factor, as 3920(gal)/6182761"},
    {"one.knet", "3920(gal)/6182761", "3920(gal)/0", ":14: no usable Scale Factor, as 3920(gal)/6182761"},
    {"one.knet", "100Hz", "9e9Hz", ":17: " NO_STEP "(Sampling Freq(Hz))"},
    {"one.knet", "100Hz", "Hz", ":17: " NO_STEP "(Sampling Freq(Hz))"},
    {"one.knet", "0.43", "0.44", ":23: ends after 43 samples, but its header announces 44"},
    {"one.knet", "0.43", "0.42", ":23: more samples than the 42"},
    {"one.knet", "Scale Factor", "Scale", ":17: no usable Scale Factor"},
    {"one.knet", "Memo.", "", "the file ends before its line 'Memo.'"},
    {"one.esm", "NDATA: 43", "NDATA: 44", ":68: ends after 43 samples, but its header announces 44"},
    {"one.esm", "NDATA: 43", "NDATA: many", ":25: no usable number of points above this line (NDATA:)"},
    {"one.esm", "NDATA: 43", "NDAT: 43", ":25: no usable number of points above this line (NDATA:)"},
    {"one.esm", "DATA_TYPE: ACC", "DATA_TYPE: DISPL", ":19: not an acceleration"},
    {"one.esm", "UNITS: cm/s^2", "UNITS: furlongs", NO_UNIT("furlongs")},
    {"three.v1a", "43       0       0", "44       0       0",
     ":31: ends after 43 samples, but its header announces 44"},
    {"three.v1a", "43       0       0      43", " 0       0       0      43", ":26: no usable number of points"},
    {"three.v1a", "0.0100  0.0100", "0.0100  0.0000", ":26: a step of 0 s in the numbers of the header, 0.01 s"},
    {"three.v1a", "1.00 mm/s/s", "1.00 counts", "set motion.unit"},
    {"three.v2a", "43      43      43", "43      43      53", ":42: velocities and displacements end before"},
    {"jma.csv", "100Hz", "none", ": " NO_STEP "(SAMPLING RATE)"},
    {"jma.csv", "gal(cm/s/s)", "counts", "set motion.unit (--unit) to counts=VALUE"},
    {"cwb.dat", "gal. DCoffset(corr)", "volts", NO_UNIT("volts")},
    {"jma.csv", "NS,EW,UD", "NS,EW", ":7: names 2 columns, but 3 follow"},
    {"jma.csv", "  -123.400,", "", ":23: has 2 columns where the lines above have 3"},
    {"jma.csv", "-123.400", "-123.4.0", ":23: '-123.4.0' is not a number"},
    {"afad.txt", ": 43", ": 44", ": 43 rows, but its header announces 44"},
    {"afad.txt", "(sec) : 0.01", "(sec) : none", NO_STEP "(SAMPLING INTERVAL:)"},
    {"afad.txt", "(N-S) 123.4", "(N-S) 12.34", "its samples peak at 123.4 cm_s2, its header says 12.34"},
    {"asa.unam", "/43/43/43", "/44/43/43", ": 43 rows, but its header announces 44 for channel 1"},
    {"asa.unam", "/0.01/0.01/0.01", "/x/0.01/0.01", ": " NO_STEP "(INTERVALO DE MUESTREO, C1:)"},
    {"asa.unam", "/-123.40", "/-223.40", "its samples peak at 123.4 cm_s2, its header says 223.4"},
    {"asa.unam", "DATOS DE ACELERACION:", "DATOS:", "ends before its line 'DATOS DE ACELERACION:'"},
    {"cwb.dat", "Time U(+)", "Time", ":12: names 3 columns, but 4 follow"},
    {"cwb.dat", "(Hz): 100", "(Hz): ", NO_STEP "(#SampleRate(Hz))"},
    {"cwb.dat", "85.600~", "185.60~", "its samples peak at 85.6 cm_s2, its header says 185.6"},
    {"three.bhrc", "=     43 ", "=     44 ", ": ends after 43 samples, but its header announces 44"},
    {"three.bhrc", "=     43 ", "=     42 ", ": more samples than the 42"},
    {"two.usc", "=     43 ", "=     49 ", ": ends after 43 samples, but its header announces 49"},
    {"isesd.cor", "samples:             43", "samples:             44", ": ends after 43 samples"},
    {"isesd.cor", "sampling period", "sampling", ":16: " NO_STEP "(sampling period:)"},
    {"isesd.cor", "-> corrected acceleration", "-> corrected velocity", ": not an acceleration"},
    {"isesd.cor", " m/s*s,", " mm/s*s,", NO_UNIT("mm/s*s")},
    {"equals.at2", "OF G", "OF FEET", NO_UNIT("FEET")},
    {"one.tspair", "m/s**2", "mm/s**2", NO_UNIT("mm/s**2")},
    {"simcenter.json", ": 43", ": 50", "'SYN-1' has 43 samples, but numSteps announces 50"},
    {"simcenter.json", "\"type\"", "\"scale_factor\": 9.81, \"type\"", "\"scale_factor\" is not 1; multiply the"},
    {"simcenter.json", "\"Seismic\"", "\"Wind\"", "not an acceleration: \"type\" is \"Wind\""},
    {"one.cosmos.v1", "cm/sec2(04)", "cm/sec2(02)", ":46: the unit in words, 'cm/sec2', is not the one of its code 2"},
    {"one.cosmos.v1", "cm/sec2(04)", "cm/sec2(05)", ":46: the unit in words, 'cm/sec2', is not the one of its code 5"},
    {"cwb.dat", "(sec): 0", "(sec): 2", "43 rows, but its header announces 2 s every 0.01 s"},
    {"cwb.dat", "     0.150 ", "     0.170 ", "time 0.16 s does not come after 0.17 s"},
    {"equals.at2", "SEC", "MIN", ":4: no usable time step"},
    {"one.tspair", "100 sps", "200 sps", "its header says a step of 0.005 s, its times one of 0.01 s"},
    {"cwb.dat", "(Hz): 100", "(Hz): 200", "its header says a step of 0.005 s, its times one of 0.01 s"},
    {"three.v2a", "0.010 sec", "0.020 sec", "a step of 0.01 s in the numbers of the header, 0.02 s in its words"},
    {"one.esm", "L_S: 0.01", "L_S: 0.02", ":13: a length of 0.42 s, but 43 samples every 0.02 s are 0.86 s"},
    {"three.slist", "43 samples", "44 samples", ": ends after 43 samples"},
    {"three.slist", "FLOAT, cm/s**2", "INTEGER, Counts", "set motion.unit (--unit) to counts=VALUE"},
    {"one.tspair", "43 samples", "44 samples", ": ends after 43 samples"},
    {"one.tspair", "100 sps", "0 sps", ":1: no usable time step"},
    {"film.smc", "        86", "        96", ": ends after 43 samples, but its header announces 48"},
    {"three.csmip.v2", "=   -123.400", "=   -223.400", "its samples peak at 123.4 cm_s2, its header says 223.4"},
    {"one.esm", "PGA_CM/S^2: -123.4", "PGA_CM/S^2: -223.4", "its header says 223.4"},
    {"three.v1a", "Peak  -1234.0", "Peak  -2234.0", "its header says 223.4"},
    {"one.csmnc", "     43  EQ", "     44  EQ", ": ends after 43 samples, but its header announces 44"},
    {"one.csmnc", "-123.400", "-223.400", "its samples peak at 123.4 cm_s2, its header says 223.4"},
    {"one.csmnc", "UNCORRECTED ACCELERATION", "CORRECTED VELOCITY", ":11: not an acceleration"},
    {"one.csn", "muestras: 43", "muestras: 44", ": ends after 43 samples, but its header announces 44"},
    {"one.csn", "muestreo: 100.0", "muestreo: 0.0", ":6: " NO_STEP "(# Tasa de muestreo:)"},
    {"one.csn", "m/seg/seg", "cuentas", "set motion.unit"},
    {"one_column.txt", "dt = 0.01 s", "", ":2: has one column and does not say its step; set motion.dt_s"},
    {"many_columns.csv", "0.15,-123.4", "0.15", ":18: has 4 columns where the lines above have 5"},
    {"cwb.dat", "     0.150 ", "     0.140 ", "time 0.14 s does not come after 0.14 s"},
    {"many_columns.csv", "0.15,", "0.14,", ":18: time 0.14 s does not come after 0.14 s"},
    {"decimal_comma.csv", "-123,4", "-123,,4", ":17: '-123,,4' is not a number"},
    {"wrapped.txt", "dt:", "at:", ":7: has 3 columns where the lines above have 8"}};

/* What a wrong specimen is asked for: its first channel, unless several are the point. */
static const MotionHow FIRST = {.channel = "1"};

TEST(a_specimen_wrong_in_one_way_is_refused_with_line_and_reason)
{
    int n_accepted = 0;
    for (size_t i = 0; i < sizeof WRONG / sizeof *WRONG; i++) {
        Text t = changed(read_specimen(WRONG[i].file), WRONG[i].from, WRONG[i].to, 0);
        OWNED(motion_free) Motion m;
        err = (Err){0};
        const Status s = motion_parse(&m, WRONG[i].file, t.text, t.length, &FIRST, &err);
        if (s != STATUS_BAD_DATA || m.accel || strncmp(err.text, WRONG[i].file, strlen(WRONG[i].file)) != 0 ||
            !strstr(err.text, WRONG[i].says))
            print_error("%s with '%s': the message should contain '%s' and is '%s'\n", WRONG[i].file, WRONG[i].to,
                        WRONG[i].says, s == STATUS_OK ? "(none)" : err.text);
        n_accepted += s != STATUS_BAD_DATA || !strstr(err.text, WRONG[i].says);
        free(t.text);
    }
    assert_int_equal(n_accepted, 0);
}

/* The specimen `copies` times behind itself. */
static Text repeated(Text one, size_t copies)
{
    Text all = {malloc(copies * one.length + 1), 0};
    assert_non_null(all.text);
    for (size_t i = 0; i < copies; i++, all.length += one.length)
        memcpy(all.text + all.length, one.text, one.length);
    all.text[all.length] = 0;
    free(one.text);
    return all;
}

TEST(a_file_of_too_many_channels_is_refused)
{
    FOR_EACH (const char *, file, "one.cosmos.v1", "three.csmip.v1", "three.v1a") {
        Text t = repeated(read_specimen(*file), 129);
        refuse(*file, t, &FIRST, "more than 128 channels");
    }
    char row[400] = "";
    for (int i = 0; i < 130; i++)
        strcat(row, "1 ");
    assert_refused(motion_parse(&(Motion){0}, "row", row, strlen(row), &FIRST, &err), STATUS_BAD_DATA,
                   "row:1: more than 128 channels");
}

TEST(words_without_numbers_are_no_known_format_and_their_first_line_is_quoted)
{
    FOR_EACH (const char *, text, "W. 12 garbage\n", "alpha\nbeta\n", "time acceleration\nabc def\n",
              "W. station foo\n what\n1 2 3\n") {
        err = (Err){0};
        FREED char *quoted = formatted("first line is '%.*s'", (int)strcspn(*text, "\n"), *text);
        assert_int_equal(motion_parse(&(Motion){0}, "text", *text, strlen(*text), &FIRST, &err), STATUS_BAD_DATA);
        assert_words(err.text, "in no format that is known here", quoted);
    }
}

TEST(a_file_of_nothing_but_a_byte_order_mark_is_refused)
{
    assert_refused(motion_parse(&(Motion){0}, "mark", "\xef\xbb\xbf", 3, &FIRST, &err), STATUS_BAD_DATA,
                   "mark: holds 0 samples");
}

/* ---- channels, steps, units ----------------------------------------------------------------------------------- */

static void refused(const char *file, const MotionHow *how, const char *says)
{
    assert_refused(motion_read(&(Motion){0}, SPECIMEN(file), how, &err), STATUS_BAD_DATA, says);
}

TEST(counts_are_refused_without_a_gain_and_what_is_no_record_by_its_name)
{
    Motion m;
    refused("three.mseed", &(MotionHow){.channel = "1"}, "set motion.unit (--unit) to counts=VALUE");
    refused("little.sac", &(MotionHow){0}, "set motion.unit (--unit) to counts=VALUE");
    refused("three.mseed", &(MotionHow){0}, "holds 3 channels: 1 'XX.SYN.00.HNN', 2 'XX.SYN.00.HNE'");
    refused("knet.tar.gz", &(MotionHow){0}, "holds 3 channels: 1 'N-S, knet/SYN0010101010000.NS'");
    Text t = read_specimen("knet.tar.gz");
    assert_refused(motion_parse(&m, "cut.tar.gz", t.text, t.length / 2, &(MotionHow){0}, &err), STATUS_BAD_DATA,
                   "cut.tar.gz: a damaged archive");
    free(t.text);
}

/* Integers of little.sac [place] written over. */
TEST(a_sac_header_of_velocities_or_of_fewer_samples_is_refused)
{
    static const struct {
        int place;
        char value;
        const char *says;
    } CASES[] = {{16, 7, "not an acceleration: IDEP in its SAC header says velocity"},
                 {16, 6, "says displacement"},
                 {9, 30, "holds 43 samples, not the 30 that its header announces"}};
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        Text t = read_specimen("little.sac");
        memcpy(t.text + (size_t)4 * (size_t)(70 + CASES[i].place), (char[4]){CASES[i].value}, 4);
        refuse("little.sac", t, &(MotionHow){.unit = UNIT_M_S2}, CASES[i].says);
    }
}

/* A tar of n members; the second one cut to `length`. */
static Text members(int n, const char *const names[], const Text *content, size_t length)
{
    const size_t room = (size_t)(n + 4) * (content->length + 2048);
    Text out = {calloc(1, room), 0};
    struct archive *a = archive_write_new();
    struct archive_entry *entry = archive_entry_new();
    assert_true(out.text && a && entry);
    archive_write_set_format_ustar(a);
    assert_int_equal(archive_write_open_memory(a, out.text, room, &out.length), ARCHIVE_OK);
    for (int i = 0; i < n; i++) {
        archive_entry_clear(entry);
        archive_entry_set_pathname(entry, names[i]);
        archive_entry_set_filetype(entry, AE_IFREG);
        archive_entry_set_size(entry, (la_int64_t)(i == 1 ? length : content->length));
        assert_int_equal(archive_write_header(a, entry), ARCHIVE_OK);
        archive_write_data(a, content->text, i == 1 ? length : content->length);
    }
    archive_entry_free(entry);
    archive_write_free(a);
    return out;
}

TEST(a_damaged_member_of_an_archive_is_named_and_files_of_one_name_have_their_folders)
{
    Text one = read_specimen("one.knet");
    Text broken = members(2, (const char *const[]){"a.NS", "b.NS"}, &one, one.length - 60);
    Text twins = members(2, (const char *const[]){"x/a.NS", "y/a.NS"}, &one, one.length);
    assert_refused(motion_parse(&(Motion){0}, "two.tar", broken.text, broken.length, &(MotionHow){0}, &err),
                   STATUS_BAD_DATA, "two.tar: a member of this archive is damaged: b.NS:");
    assert_refused(motion_parse(&(Motion){0}, "two.tar", twins.text, twins.length, &(MotionHow){0}, &err),
                   STATUS_BAD_DATA, "1 'N-S, x/a.NS', 2 'N-S, y/a.NS'");
    free(one.text);
    free(broken.text);
    free(twins.text);
}

TEST(of_many_channels_of_an_archive_the_first_are_listed_and_how_many_there_are)
{
    enum { N = 26 };
    static char names[N][64];
    const char *list[N];
    for (int k = 0; k < N; k++) {
        snprintf(names[k], sizeof names[k], "CE.23497.CHAN%c.20160224.acceleration.NS", 'A' + k);
        list[k] = names[k];
    }
    Text one = read_specimen("one.knet"), all = members(N, list, &one, one.length);
    assert_int_equal(motion_parse(&(Motion){0}, "a.tar", all.text, all.length, &(MotionHow){0}, &err), STATUS_BAD_DATA);
    assert_words(err.text, "holds 26 channels: 1 'N-S", "3 'N-S",
                 "... 26; choose one by motion.channel (--set motion.channel=NAME)");
    free(one.text);
    free(all.text);
}

TEST(a_channel_must_be_chosen_where_there_are_several)
{
    refused("jma.csv", &(MotionHow){0}, "holds 3 channels: 1 'NS', 2 'EW', 3 'UD'; choose one by motion.channel");
    refused("jma.csv", &(MotionHow){.channel = "4"}, "'4' is not exactly one of its channels: 1 'NS'");
    refused("jma.csv", &(MotionHow){.channel = "vertical"}, "'vertical' is not exactly one of its channels");
    refused("many_columns.csv", &(MotionHow){.channel = "velocity"}, "its channel 'velocity' is not an acceleration");
    refused("one.knet", &(MotionHow){.channel = "E-W"}, "'E-W' is not exactly one of its channels: 1 'N-S'");
}

TEST(a_column_of_velocities_is_not_taken_for_an_acceleration)
{
    static const char text[] = "time_s,accel_m_s2,velocity\n0.00,1.0,0.0\n0.02,2.0,0.1\n";
    OWNED(motion_free) Motion m = there(text, &(MotionHow){0});
    assert_string_equal(m.channel, "accel_m_s2");
    assert_close(m.accel[1], 2, 0);
}

TEST(unequal_steps_are_resampled_by_straight_lines_only_when_asked)
{
    refused("irregular.csv", &(MotionHow){0}, "breaks the uniform step");
    refused("irregular.csv", &(MotionHow){.dt_s = 1e-9}, "would make");
    static const char text[] = "t,a_m_s2\n0,0\n0.1,1\n0.3,3\n0.4,0\n1.0,6\n";
    OWNED(motion_free) Motion m = there(text, &(MotionHow){.dt_s = 0.05});
    assert_int_equal(m.n, 21);
    assert_string_equal(m.processed, "resampled every 0.05 s by straight lines");
    for (size_t i = 0; i < m.n; i++) {
        const double t = 0.05 * (double)i;
        const double want = t < 0.3 ? 10 * t : t < 0.4 ? 3 - 30 * (t - 0.3) : 10 * (t - 0.4);
        assert_less(fabs(m.accel[i] - want), 1e-12);
    }
}

TEST(an_equal_step_is_left_alone_by_a_request_to_resample)
{
    OWNED(motion_free) Motion m;
    CHECK_OK(motion_read(&m, "tests/motion/two_columns.txt", &(MotionHow){.dt_s = 0.5}, &err), &err);
    assert_close(m.dt_s, DT, 0);
    assert_string_equal(m.processed, "");
}

TEST(the_step_of_a_bare_column_can_be_given_and_of_no_other)
{
    static const char text[] = "1\n2\n-3\n0\n";
    Motion m;
    const MotionHow how = {.unit = UNIT_M_S2, .dt_s = 0.02};
    m = there(text, &how);
    assert_int_equal(m.n, 4);
    assert_close(m.dt_s, 0.02, 0);
    assert_string_equal(m.warning, "");
    motion_free(&m);
    static const char timed[] = "t,a_g\n0,1\n0.01,-1\n";
    m = there(timed, &(MotionHow){.dt_s = 0.02});
    assert_close(m.dt_s, 0.01, 0);
    assert_string_equal(m.warning, "motion.dt_s = 0.02 is not used: the file says 0.01 s");
    motion_free(&m);
}

TEST(a_setting_may_not_contradict_the_unit_of_any_format)
{
    for (int i = 0; i < N_SPECIMENS; i++) {
        const int in_g = strstr(SPECIMENS[i].file, ".at2") || strstr(SPECIMENS[i].file, "csmip.v1") ||
                         strstr(SPECIMENS[i].file, "bhrc") || strstr(SPECIMENS[i].file, "usc");
        refused(SPECIMENS[i].file,
                &(MotionHow){.channel = SPECIMENS[i].how.channel, .unit = in_g ? UNIT_CM_S2 : UNIT_G},
                "motion.unit is");
    }
}

/* ---- mutations ------------------------------------------------------------------------------------------------ */

static uint64_t next_random(uint64_t *x)
{
    uint64_t z = *x += 0x9e3779b97f4a7c15u; /* SplitMix64, Steele et al. 2014 */
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

/* A byte changed, a stretch taken out, doubled or overwritten, the end cut off. The result ends where its memory
 * ends, so that a step beyond is seen by the address sanitizer. */
static Text mutated(const Text *t, uint64_t *random)
{
    static const char *const WORDS[] = {"-", "9e99", "\n",      ",",    "1e-300",  "NPTS=2, DT=1",
                                        "|", "nan",  "(9F1.0)", "\xff", "99999999"};
    const size_t at = next_random(random) % t->length, room = t->length - at;
    const size_t some = next_random(random) % 90 % room;
    const char *word = WORDS[next_random(random) % (sizeof WORDS / sizeof *WORDS)];
    const int kind = (int)(next_random(random) % 5);
    const size_t cut = kind == 1 ? some : kind == 3 ? strlen(word) < room ? strlen(word) : room : kind == 4 ? room : 0;
    const char *put = kind == 2 ? t->text + at : word;
    const size_t n_put = kind == 2 ? some : kind == 0 || kind == 3 ? strlen(word) : 0;
    const size_t length = t->length - cut + n_put;
    Text out = {malloc(length ? length : 1), length};
    assert_non_null(out.text);
    memcpy(out.text, t->text, at);
    memcpy(out.text + at, put, n_put);
    memcpy(out.text + at + n_put, t->text + at + cut, t->length - at - cut);
    return out;
}

static void check_mutant(const char *file, const Text *t, const MotionHow *how)
{
    OWNED(motion_free) Motion m;
    err = (Err){0};
    const Status s = motion_parse(&m, file, t->text, t->length, how, &err);
    if (s == STATUS_OK) {
        assert_true(m.n >= 2 && m.dt_s > 0 && isfinite(m.dt_s));
        assert_at_most(motion_peak(&m), 20 * 9.81 * (1 + 1e-12));
        for (size_t i = 0; i < m.n; i++)
            assert_true(isfinite(m.accel[i]));
    } else {
        assert_int_equal(s, STATUS_BAD_DATA);
        assert_null(m.accel);
        assert_same_number(strncmp(err.text, file, strlen(file)), 0);
    }
}

TEST(five_thousand_mutants_are_read_or_refused)
{
    enum { EACH = 170 };
    uint64_t random = 1;
    for (int i = 0; i < N_SPECIMENS; i++) {
        const Text t = read_specimen(SPECIMENS[i].file);
        for (int k = 0; k < EACH; k++) {
            const MotionHow how = {.channel = k % 3 ? "1" : "auto", .dt_s = k % 2 * 0.01};
            Text one = mutated(&t, &random);
            for (int more = k % 4; more > 0 && one.length; more--) {
                const Text next = mutated(&one, &random);
                free(one.text);
                one = next;
            }
            check_mutant(SPECIMENS[i].file, &one, &how);
            free(one.text);
        }
        free(t.text);
    }
}

TEST(a_mutated_binary_file_or_archive_is_read_or_refused)
{
    uint64_t random = 2;
    for (int i = 0; i < (int)N_OF(BINARY); i++) {
        const Text t = read_specimen(BINARY[i].file);
        for (int k = 0; k < 100; k++) {
            Text one = mutated(&t, &random);
            check_mutant(BINARY[i].file, &one, &BINARY[i].how);
            free(one.text);
        }
        free(t.text);
    }
}

TEST(the_offset_of_a_recorder_is_subtracted_and_said)
{
    OWNED(motion_free) Motion m;
    CHECK_OK(motion_read(&m, "tests/motion/one.knet", &(MotionHow){0}, &err), &err);
    double sum = 0;
    for (size_t i = 0; i < m.n; i++)
        sum += m.accel[i];
    assert_at_most(fabs(sum), 1e-12 * (double)m.n);
    assert_string_equal(m.processed, "mean of 3.248 cm_s2 subtracted"); /* 5123 counts of 3920/6182761 gal */
    assert_string_equal(m.warning, "");
}

/* The header's 123.4 gal written as another. */
static Status read_with_peak(const char *stated, Motion *m, Err *why)
{
    Text t = changed(read_specimen("one.knet"), "123.400", stated, 0);
    const Status status = motion_parse(m, "one.knet", t.text, t.length, &(MotionHow){0}, why);
    free(t.text);
    return status;
}

TEST(a_peak_that_misses_the_header_is_warned_about_above_1_percent_and_refused_above_5)
{
    Motion m;
    CHECK_OK(read_with_peak("124.400", &m, &err), &err); /* 0.8 % */
    assert_string_equal(m.warning, "");
    motion_free(&m);
    CHECK_OK(read_with_peak("126.000", &m, &err), &err); /* 2 % */
    assert_string_equal(m.warning, "its samples peak at 123.4 cm_s2, its header says 126");
    motion_free(&m);
    assert_int_equal(read_with_peak("132.000", &m, &err), STATUS_BAD_DATA); /* 6.5 % */
    assert_words(err.text, "peak at 123.4 cm_s2, its header says 132; more than 5 % apart");
}

static Status parse_text(Motion *m, const char *text, Err *why)
{
    return motion_parse(m, "there", text, strlen(text), &(MotionHow){0}, why);
}

/* Rows of `width` values a_k = sin k [m/s2] below a first line. */
static Text rows_of(const char *first, int rows, int width)
{
    Text t = {NULL, 0};
    FILE *f = open_memstream(&t.text, &t.length);
    fputs(first, f);
    for (int k = 0; k < rows * width; k++)
        fprintf(f, "%.12f%c", sin(k), (k + 1) % width ? ' ' : '\n');
    fclose(f);
    return t;
}

TEST(columns_without_names_are_asked_about_and_joined_only_where_a_count_fits)
{
    static const struct {
        const char *first, *channel, *says; /* says: of the refusal */
        size_t n;
        double second; /* sample 1 */
    } CASES[] = {{"# units: m/s2, dt=0.01\n", NULL, ":2: has 20 rows of 4 columns without names: choose one", 0, 0},
                 {"# units: m/s2, dt=0.01\n", "3", NULL, 20, 6},
                 {"# units: m/s2, dt=0.01, npts=80\n", NULL, NULL, 80, 1},
                 {"# units: m/s2, dt=0.01, npts=79\n", NULL, "columns without names", 0, 0},
                 {"# units: m/s2\n", NULL,
                  ":2: has 4 columns without names, and the first holds no times; set motion.dt_s", 0, 0},
                 {"! units: m/s2\n80 0.01\n", NULL, NULL, 80, 1}};
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        OWNED(motion_free) Motion m;
        err = (Err){0};
        Text t = rows_of(CASES[i].first, 20, 4);
        const Status s = motion_parse(&m, "rows", t.text, t.length, &(MotionHow){.channel = CASES[i].channel}, &err);
        if (CASES[i].says) {
            assert_int_equal(s, STATUS_BAD_DATA);
            if (!strstr(err.text, CASES[i].says))
                fail_msg("'%s' should be in '%s'", CASES[i].says, err.text);
        } else {
            CHECK_OK(s, &err);
            assert_int_equal(m.n, CASES[i].n);
            assert_close(m.dt_s, 0.01, 1e-15);
            assert_close(m.accel[1], sin(CASES[i].second), 1e-10);
        }
        free(t.text);
    }
}

TEST(first_rows_of_number_and_step_are_no_samples)
{
    static const struct {
        const char *first;
        int is_right;
    } CASES[] = {{"A record of somewhere\n30 0.02\n", 1}, {"30\n0.02\n", 1}, {"30\n", 1}, {"31 0.02\n", 0}};
    for (size_t i = 0; i < 2 * sizeof CASES / sizeof *CASES; i++) {
        const int width = (int)(i & 1) + 1, in_two = width == 2 && strcmp(CASES[i / 2].first, "30\n0.02\n") == 0;
        OWNED(motion_free) Motion m;
        err = (Err){0};
        Text t = {NULL, 0};
        FILE *f = open_memstream(&t.text, &t.length);
        fputs(in_two ? "30\n" : CASES[i / 2].first, f);
        for (int k = 0; k < 30; k++)
            width == 1 ? fprintf(f, "%.12f\n", sin(k)) : fprintf(f, "%.2f %.12f\n", 0.02 * k, sin(k));
        fclose(f);
        const Status s =
            motion_parse(&m, "there", t.text, t.length, &(MotionHow){.unit = UNIT_M_S2, .dt_s = 0.02}, &err);
        if (CASES[i / 2].is_right) {
            CHECK_OK(s, &err);
            assert_int_equal(m.n, 30);
            assert_close(m.dt_s, 0.02, 1e-12);
            assert_close(m.accel[29], sin(29), 1e-10);
            assert_at_most(motion_peak(&m), 1);
        } else if (width == 1) {
            assert_int_equal(s, STATUS_BAD_DATA);
            assert_words(err.text, "if that line states the number of samples, 30 lines follow it");
        }
        free(t.text);
    }
}

static void expect_refusal(const char *text, const char *says)
{
    Motion m;
    assert_refused(parse_text(&m, text, &err), STATUS_BAD_DATA, says);
}

TEST(an_unknown_format_is_said_to_be_unknown_and_its_first_line_is_quoted)
{
    expect_refusal("A title of some agency\n16628 W. LOST CANYON RD.\n1 2 3\n",
                   "in no format that is known here (docs/motions.md lists them), and no plain columns of numbers (a "
                   "list of motions has a name that ends in list.txt); the first line is 'A title of some agency'");
    expect_refusal("Response and Fourier amplitude spectra (86 periods)\n1 2\n",
                   "is not read: response and Fourier spectra of CSMIP (V3); take its V2 or V1");
    expect_refusal("<!DOCTYPE html>\n<p>Log in</p>\n", "a web page, perhaps of a log-in");
    expect_refusal("WID2 2001/01/01\nSTA2\n", "GSE2");
}

/* Twelve channels of one building, as CSMIP writes them. */
TEST(the_location_tells_the_channels_of_a_building_apart)
{
    Text t = {NULL, 0};
    OWNED(motion_free) Motion m;
    FILE *f = open_memstream(&t.text, &t.length);
    for (int k = 1; k <= 12; k++) {
        Text one = changed(read_specimen("three.csmip.v2"), "Chan  1: 360 Deg", "Chan  1: 360 Deg", 0);
        FREED char *name = formatted("\nChan %2d: %3d Deg   (Sta Chn: %2d)   Location: %s\n", k, k % 2 ? 360 : 90, k,
                                     k < 3    ? "Ground floor"
                                     : k < 11 ? "Fifth floor"
                                              : "Roof");
        one = changed(one, "\nChan  1: 360 Deg", name, 0);
        one.length = (size_t)(strstr(one.text + 100, "Corrected accelerogram") - one.text);
        fwrite(one.text, 1, one.length, f);
        free(one.text);
    }
    fclose(f);
    assert_int_equal(motion_parse(&m, "building", t.text, t.length, &(MotionHow){0}, &err), STATUS_BAD_DATA);
    assert_words(err.text, "2 '90 Deg, Ground floor'", "12 '90 Deg, Roof'");
    m = accept_text("building", t, &(MotionHow){.channel = "90 Deg, Roof"});
    assert_string_equal(m.channel, "90 Deg, Roof");
}

TEST(quoted_cells_are_read)
{
    Motion m;
    assert_int_equal(parse_text(&m, "\"time [s]\",\"acc [m/s^2]\"\n\"0.00\",\"0.1\"\n\"0.01\",\"-1.25\"\n", &err),
                     STATUS_OK);
    assert_int_equal(m.n, 2);
    assert_close(m.dt_s, 0.01, 1e-15);
    assert_close(m.accel[1], -1.25, 1e-15);
    motion_free(&m);
    assert_refused(parse_text(&m, "\"time [s]\",\"acc [g]\"\n\"0\",\"0.1\"\n\"1\",\"one\"\n", &err), STATUS_BAD_DATA,
                   "there:3: 'one' is not a number");
}

TEST(units_in_other_words_are_taken_or_named)
{
    Motion m;
    assert_int_equal(parse_text(&m, "A\nB\nUNITS OF CM/SEC**2\nNPTS= 2, DT= .01 SEC\n1. 2.\n", &err), STATUS_OK);
    assert_close(m.accel[1], 0.02, 1e-15);
    motion_free(&m);
    assert_int_equal(parse_text(&m, "A\nB\nACCELERATION IN G\nNPTS= 2, DT= .01 SEC\n1. 2.\n", &err), STATUS_OK);
    assert_close(m.accel[1], 2 * 9.80665, 1e-3);
    motion_free(&m);
    for (int i = 0; i < 2; i++) {
        Text t = i ? changed(read_specimen("one.csn"), "m/seg/seg", "cm/seg/seg", 0)
                   : changed(read_specimen("isesd.cor"), " m/s*s,", "cm/s*s,", 0);
        OWNED(motion_free) Motion in_cm = accept_text("in cm", t, &(MotionHow){0});
        assert_close(in_cm.accel[PEAK_AT], 1e-4 * PEAK_GAL[0], 1e-8);
    }
    assert_refused(parse_text(&m, "time_s,accel [mg]\n0,1\n0.01,2\n", &err), STATUS_BAD_DATA,
                   "unit 'mg' of its acceleration is not known");
}

/* A miniSEED of floats holds whatever four bytes are. */
TEST(a_sample_of_a_binary_file_that_is_no_number_is_refused)
{
    static const unsigned char NOT_A_NUMBER[] = {0x7f, 0xc0, 0, 0};
    Text t = read_specimen("three.mseed");
    memcpy(t.text + 64 + 4 * 40, NOT_A_NUMBER, 4);
    const MotionHow how = {.channel = "1", .unit = UNIT_COUNTS, .counts_per_m_s2 = 1e5};
    refuse("a.mseed", t, &how, "a.mseed: sample 41 of the channel is not a finite number");
}

TEST(a_miniseed_record_that_announces_more_samples_than_it_has_room_for_is_refused)
{
    for (int second = 0; second < 2; second++) {
        Text t = read_specimen("three.mseed");
        t.text[30 + (second ? 512 : 0)] = 0x7f; /* the number of samples, first byte */
        const MotionHow how = {.channel = "1", .unit = UNIT_COUNTS, .counts_per_m_s2 = 1e5};
        refuse("a.mseed", t, &how, second ? "no usable record at byte 512" : "no usable record at byte 0");
    }
}

/* ---- peaks of headers, format by format ------------------------------------------------------------------------- */

/* Every format whose header states a peak: the stated one made 2 % and 8 % larger, in the width of the file. */
TEST(every_format_with_a_peak_in_its_header_is_checked_against_it)
{
    static const struct {
        const char *file, *from, *by_2, *by_8;
    } PEAKS[] = {{"one.knet", "123.400", "125.868", "133.272"},
                 {"one.esm", "PGA_CM/S^2: -123.4", "PGA_CM/S^2: -125.9", "PGA_CM/S^2: -133.3"},
                 {"afad.txt", "(N-S) 123.4", "(N-S) 125.9", "(N-S) 133.3"},
                 {"asa.unam", "/-123.40", "/-125.87", "/-133.27"},
                 {"cwb.dat", "85.600~", "87.312~", "92.448~"},
                 {"three.v1a", "Peak  -1234.0", "Peak  -1258.7", "Peak  -1332.7"},
                 {"three.v2a", "Peak  -1234.0", "Peak  -1258.7", "Peak  -1332.7"},
                 {"one.csmnc", "-123.400", "-125.868", "-133.272"},
                 {"one.cosmos.v1", "Max =   -123.400", "Max =   -125.868", "Max =   -133.272"},
                 {"three.cosmos.v2", "Max =   -123.400", "Max =   -125.868", "Max =   -133.272"},
                 {"three.csmip.v1", "Max  =   -.126 g", "Max  =   -.129 g", "Max  =   -.136 g"},
                 {"three.csmip.v2", "=   -123.400", "=   -125.868", "=   -133.272"}};
    for (size_t i = 0; i < sizeof PEAKS / sizeof *PEAKS; i++)
        for (int refused_ = 0; refused_ < 2; refused_++) {
            Text t = changed(read_specimen(PEAKS[i].file), PEAKS[i].from, refused_ ? PEAKS[i].by_8 : PEAKS[i].by_2, 0);
            OWNED(motion_free) Motion m;
            err = (Err){0};
            const Status status = motion_parse(&m, PEAKS[i].file, t.text, t.length, &FIRST, &err);
            if (status != (refused_ ? STATUS_BAD_DATA : STATUS_OK) ||
                (!refused_ && !strstr(m.warning, "its header says")) ||
                (refused_ && !strstr(err.text, "more than 5 % apart")))
                fail_msg("%s, %d %%: status %d, '%s'", PEAKS[i].file, refused_ ? 8 : 2, status,
                         refused_ ? err.text : m.warning);
            free(t.text);
        }
}

static void write_over(char *at, const char *text)
{
    while (*text)
        *at++ = *text++;
}

/* Real numbers 30 and 32 of an SMC header are the extremes. */
TEST(the_extremes_in_an_smc_header_are_checked)
{
    for (int by_8 = 0; by_8 < 2; by_8++) {
        Text t = read_specimen("one.smc");
        char *at = t.text;
        for (int i = 0; i < 29; i++) /* real number 2 is the rate */
            at = strstr(at + 1, "1.7000000E+38");
        write_over(at - 1, by_8 ? "-1.332720E+02 " : "-1.258680E+02 ");
        at = strstr(strstr(at, "1.7000000E+38") + 1, "1.7000000E+38");
        write_over(at, "7.8200000E+01");
        OWNED(motion_free) Motion m;
        err = (Err){0};
        const Status status = motion_parse(&m, "one.smc", t.text, t.length, &FIRST, &err);
        assert_int_equal(status, by_8 ? STATUS_BAD_DATA : STATUS_OK);
        assert_non_null(
            strstr(by_8 ? err.text : m.warning, by_8 ? "its header says 133.27" : "its header says 125.87"));
        free(t.text);
    }
}

/* ---- what spreadsheets and data loggers write --------------------------------------------------------------------- */

TEST(decimal_commas_are_read_whatever_parts_the_columns)
{
    FOR_EACH (const char *, text, "time_s;a_m_s2\n0,00;3,1\n0,01;0,5\n0,02;-1\n",
              "time_s\ta_m_s2\n0,00\t3,1\n0,01\t0,5\n0,02\t-1\n", "# units: m/s2\n0,00  3,1\n0,01  0,5\n0,02  -1\n",
              "\"time_s\",\"a_m_s2\"\n\"0,00\",\"3,1\"\n\"0,01\",\"0,5\"\n\"0,02\",\"-1\"\n",
              "# dt = 0.01\na_m_s2\n3,1\n0,5\n-1,0\n", "# dt = 0,01\nacc [m/s2]\n3,1\n0,5\n-1\n",
              "# units: m/s2\n0.00, 3.1\n0.01, 0.5\n0.02, -1\n",
              "time_s;a_m_s2\n0,00;3,1\n;\n0,01;0,5\n0,02;-1\n;\n;\n", "# dt = 10 ms, units: m/s2\n3.1\n0.5\n-1\n",
              "# fs: 100, units: m/s2\n3.1\n0.5\n-1\n", "acceleration (in m/s2)\n3 0,01\n3,1\n0,5\n-1,0\n") {
        OWNED(motion_free) Motion m = there(*text, &(MotionHow){0});
        if (m.n != 3 || fabs(m.dt_s - 0.01) > 1e-15 || m.accel[0] != 3.1 || m.accel[1] != 0.5 || m.accel[2] != -1)
            fail_msg("%s: %zu samples every %g s: %g %g", *text, m.n, m.dt_s, m.accel[0], m.accel[1]);
    }
}

TEST(marks_of_thousands_and_commas_of_two_meanings_are_refused)
{
    expect_refusal("t;a_cm_s2\n0,00;1.234,5\n0,01;0,5\n", "there:2: '1.234,5' has a point and a comma");
    expect_refusal("t\ta_cm_s2\n0,00\t1.234,5\n0,01\t0,5\n", "there:2: '1.234,5' has a point and a comma");
    expect_refusal("# dt = 0.01\na_m_s2\n0.1\n#N/A\n0.2\n", "there:4: '#N/A' is not a number");
    expect_refusal("time_s;a_g\n0,00;0,1\xc2\xa0\n", "there:2: '0,1<U+00A0>' is not a number");
    expect_refusal("time,a_g\n00:00:00.00,0.1\n", "there:2: '00:00:00.00' is not a number");
    expect_refusal("\xff\xfet\n", "is written in UTF-16; save it as UTF-8");
    expect_refusal("t;a_cm_s2\n0.00;1,234.5\n0.01;0.5\n", "there:2: '1,234.5' has a point and a comma");
    expect_refusal("t;a_cm_s2\n0,00;1,5\n0.01;0.5\n",
                   "there:3: decimal points and decimal commas are mixed; line 2 has the other");
    expect_refusal("# dt = 0.01, units: m/s2\n3,1\n0,5\n1,2\n0,3\n",
                   "there:2: has 4 rows of 2 columns without names: choose one by motion.channel (1 to 2); if "
                   "they are one motion written row by row, --text per_line=2; if they are one column with "
                   "decimal commas, put its name above it");
}

/* Nothing is taken from prose: a unit stands in a column's name or behind the key "unit" or "units". */
TEST(a_unit_counts_where_it_is_stated_and_is_asked_for_elsewhere)
{
    static const char *const UNKNOWN[][2] = {{"acceleration (milli-g)", "'milli-g'"},
                                             {"# units: mg", "'mg'"},
                                             {"# units: 0.1 g", "'0.1 g'"},
                                             {"a [m/s2 x 1000]", "'m/s2 x 1000'"},
                                             {"A (% g)", "'% g'"},
                                             {"acc (% of g)", "'% of g'"},
                                             {"acc [1/g]", "'1/g'"},
                                             {"acc [g/10]", "'g/10'"},
                                             {"acc [0.2 g]", "'0.2 g'"},
                                             {"acc_x1000_m_s2", "does not say the unit"}};
    FOR_EACH (const char *, in_g, "# units: g", "# acc [g]\nacc [g]", "units=g", "# unit = g; x", "Acceleration (g)",
              "acceleration (in g)", "acc_x1_g", "# Units = G", "npts=3 units=g", "% acceleration units: g, filtered") {
        OWNED(motion_free) Motion m = there(brief("# dt=0.01 s\n%s\n1\n2\n-3\n", *in_g), &(MotionHow){0});
        assert_close(m.accel[2], -3 * 9.81, 1e-12);
    }
    FOR_EACH (const char *, in_none, "# by G. Smith", "# Record G", "# ground type G", "# in g", "# scaled by g",
              "St. G, a title", "# station: G", "# peak 0.35 g", "# (G)", "# acc [g]", "a G",
              "Acceleration in g of St. 5") {
        FREED char *text = formatted("# dt=0.01 s\n%s\n1\n2\n-3\n", *in_none);
        expect_refusal(text, "does not say the unit of its acceleration; set motion.unit (--unit)");
    }
    for (size_t i = 0; i < sizeof UNKNOWN / sizeof UNKNOWN[0]; i++)
        expect_refusal(brief("# dt=0.01 s\n%s\n1\n2\n-3\n", UNKNOWN[i][0]), UNKNOWN[i][1]);
    expect_refusal("npts=4 dt=0.01 units=g\n1\n2\n-3\n", "there:4: ends after 3 samples, but its header announces 4");
}

/* 2^20 columns are refused, and repeated records told apart, in a time that grows with their length. */
TEST(a_long_line_and_many_records_take_no_square_of_their_length)
{
    enum { COLUMNS = 1 << 20 };
    FREED char *row = malloc(2 * COLUMNS + 16);
    const clock_t began = clock();
    assert_non_null(row);
    for (int with_names = 0; with_names < 2; with_names++) {
        char *p = row;
        for (int i = 0; i < COLUMNS; i++, p += 2)
            memcpy(p, with_names ? "a," : "0 ", 2);
        memcpy(p, with_names ? "a\n1,2,\n" : "0\n1 2\n", 7);
        assert_int_equal(motion_parse(&(Motion){0}, "row", row, strlen(row), &FIRST, &err), STATUS_BAD_DATA);
    }
    Text t = repeated(read_specimen("three.mseed"), 4096);
    refuse("six.mseed", t, &FIRST, "more than 128 channels");
    t = repeated((Text){strdup("\n"), 1}, 1 << 20);
    memcpy(t.text, "Origin Time", strlen("Origin Time"));
    assert_int_equal(motion_parse(&(Motion){0}, "blank", t.text, t.length, &FIRST, &err), STATUS_BAD_DATA);
    t.text[t.length - 1] = 'x';
    assert_int_equal(motion_parse(&(Motion){0}, "blank", t.text, t.length, &FIRST, &err), STATUS_BAD_DATA);
    free(t.text);
    assert_less((double)(clock() - began) / CLOCKS_PER_SEC, 2); /* 0.1 s; by the square minutes */
}

TEST(steps_are_read_in_their_unit_and_contradictions_are_refused)
{
    FOR_EACH (const char *, step, "dt = 1/200 s", "dt=.5D-2", "dt = 5 ms", "dt=5000 us", "dt = 0,005 s", "fs: 0.2 kHz",
              "sampling rate: 200 samples/s", "npts = 3; dt = 0.005", "dt=0.005 s; sampling rate: 200 Hz") {
        OWNED(motion_free) Motion m = there(brief("# %s\n# units: cm/s2\n1\n2\n-3\n", *step), &(MotionHow){0});
        assert_close(m.dt_s, 0.005, 1e-15);
    }
    Text t = changed(read_specimen("equals.at2"), "SEC", "MSEC", 0);
    OWNED(motion_free) Motion m = accept_text("at2", t, &(MotionHow){0});
    assert_close(m.dt_s, 1e-5, 1e-15);
    expect_refusal("# dt = 0.005 min; units: cm/s2\n1\n2\n",
                   "there:1: the step in '# dt = 0.005 min; units: cm/s2' is not in seconds");
    expect_refusal("# units: m/s2\n# dt=0.01\n# dt=0.02\n1\n2\n",
                   "there:3: states a step of 0.02, elsewhere in the file it is 0.01");
    expect_refusal("# dt=0.02\n# units: m/s2\n3 0.01\n1\n2\n-3\n",
                   "there:3: states a step of 0.01, elsewhere in the file it is 0.02");
    expect_refusal("# npts=4; units: m/s2\n3 0.01\n1\n2\n-3\n",
                   "states a number of samples of 3, elsewhere in the file it is 4");
    expect_refusal("# npts=30, dt=0.01; units: m/s2\n1\n2\n-3\n", "announces 30 samples, but has 3 rows");
    expect_refusal("# dt = 0.02\nt,a_m_s2\n0,1\n.01,2\n.02,-3\n",
                   "its header says a step of 0.02 s, its times one of 0.01 s");
    expect_refusal("t,a_m_s2\n0,00,1,5\n0,01,-2,5\n",
                   "2 columns are named, but the rows have 4 numbers: are its commas");
}

TEST(numbers_of_samples_are_no_seconds)
{
    FOR_EACH (const char *, given, "# units: m/s2\n%s0 1\n1 2\n2 -3\n", "# units: m/s2\n%s7,1\n8,2\n9,-3\n",
              "%si,a_m_s2\n1,1\n2,2\n3,-3\n", "%sNo.;a [m/s2]\n0;1\n1;2\n2;-3\n") {
        Motion m;
        FREED char *text = formatted(*given, "");
        expect_refusal(text,
                       "are these samples? Give their step (--set motion.dt_s=0.01); if they are seconds, name the "
                       "column time_s");
        m = there(text, &(MotionHow){.dt_s = 0.02});
        assert_close(m.dt_s, 0.02, 0);
        assert_close(m.accel[2], -3, 0);
        motion_free(&m);
        m = there(brief(*given, "# dt = 0.02\n"), &(MotionHow){0});
        assert_close(m.dt_s, 0.02, 0);
        motion_free(&m);
    }
    OWNED(motion_free) Motion m = there("time_s,a_m_s2\n0,1\n1,2\n2,-3\n", &(MotionHow){0});
    assert_close(m.dt_s, 1, 0);
}

TEST(the_column_of_times_is_found_by_its_name)
{
    FOR_EACH (const char *, text, "acc_g,time_s\n0.1,0\n0.2,0.01\n-.3,0.02\n",
              "acc (g) t [s]\n0.1 0\n0.2 0.01\n-.3 0.02\n", "NS_g;Time (sec);EW_g\n.1;0;1\n.2;.01;2\n-.3;.02;3\n") {
        OWNED(motion_free) Motion m = there(*text, &FIRST);
        assert_close(m.dt_s, 0.01, 1e-15);
        assert_close(m.accel[2], -.3 * 9.81, 1e-12);
    }
    expect_refusal("acc_g,time_ms\n0.1,0\n0.2,10\n", "the column of times is 'time_ms'; times must be in seconds");
}

/* ---- names and headers that people have --------------------------------------------------------------------------- */

TEST(kiknet_numbers_are_directions_and_what_is_no_direction_is_refused)
{
    static const char *const NAMES[] = {"NS1", "EW1", "UD1", "NS2", "EW2", "UD2"};
    for (int k = 0; k < 6; k++) {
        Text t = changed(read_specimen("one.kiknet"), "Dir.              5", brief("Dir.              %d", k + 1), 0);
        OWNED(motion_free) Motion m = accept_text("one.kiknet", t, &(MotionHow){0});
        assert_string_equal(m.channel, NAMES[k]);
    }
    for (int k = 0; k < 2; k++) {
        Text t =
            changed(read_specimen("one.kiknet"), "Dir.              5", k ? "Dir.              SW" : "Dir.      7", 0);
        refuse("one.kiknet", t, &(MotionHow){0},
               k ? "one.kiknet:13: the direction 'SW' is none of N-S, E-W, U-D (K-NET), 1 to 6 (KiK-net)"
                 : "the direction '7' is none");
    }
    refused("old.v1a", &(MotionHow){0}, "holds 3 channels: 1 (no name), 2 (no name), 3 (no name); choose one");
}

TEST(five_columns_without_a_step_ask_for_the_step_and_not_for_a_channel)
{
    Motion m;
    Text t = rows_of("", 20, 5);
    assert_int_equal(motion_parse(&m, "opensees.txt", t.text, t.length, &(MotionHow){.unit = UNIT_G}, &err),
                     STATUS_BAD_DATA);
    assert_words(err.text, "set motion.dt_s", "!channels");
    free(t.text);
}

TEST(the_body_of_a_file_of_three_components_is_asked_about_and_not_joined)
{
    for (int width = 2; width <= 4; width++) {
        Text t = rows_of("# units: m/s2, dt=0.01\n", 40, width);
        refuse("body", t, &(MotionHow){0}, "columns without names");
    }
}

TEST(a_step_in_the_first_line_above_words_is_found)
{
    OWNED(motion_free)
    Motion m = there("Time Step: 0.005\nAcceleration (g)\n0.0\n0.01\n-0.02\n0.005\n", &(MotionHow){0});
    assert_close(m.dt_s, 0.005, 1e-15);
    assert_int_equal(m.n, 4);
    assert_close(m.accel[2], -0.02 * 9.81, 1e-12);
}

TEST(names_too_long_for_a_message_lose_their_middle)
{
    char out[64];
    name_shorten(out, 20, "360 Deg, CE.23497.HNE.20160224.V2");
    assert_string_equal(out, "360 De...20160224.V2");
    name_shorten(out, 40, "360 Deg, CHAN001.V2");
    assert_string_equal(out, "360 Deg, CHAN001.V2");
}

/* ---- what was taken for something else -------------------------------------------------------------------------- */

/* Rows "0.01 k, sin k" below a header. */
static Text table_below(const char *header)
{
    Text t = {NULL, 0};
    FILE *f = open_memstream(&t.text, &t.length);
    fprintf(f, "%s\n", header);
    for (int k = 0; k < 50; k++)
        fprintf(f, "%.2f,%.9f\n", 0.01 * k, sin(k));
    fclose(f);
    return t;
}

/* NULL: read to its samples in the unit of how; else refused with these words. */
static void expect(const char *header, const MotionHow *how, const char *says)
{
    OWNED(motion_free) Motion m;
    err = (Err){0};
    Text t = table_below(header);
    const Status s = motion_parse(&m, "there", t.text, t.length, how, &err);
    if (says ? s != STATUS_BAD_DATA || !strstr(err.text, says) : s != STATUS_OK || m.n != 50 || m.dt_s != 0.01)
        fail_msg("%s: '%s' and not '%s'", header, s == STATUS_OK ? "(read)" : err.text, says ? says : "(read)");
    free(t.text);
}

TEST(a_spectrum_is_no_motion_with_any_option)
{
    static const MotionHow HOWS[] = {{0}, {.dt_s = 0.02}, {.dt_s = 0.02, .channel = "2"}, {.channel = "1"}};
    FOR_EACH (const char *, spectra, "T [s],PSa [m/s^2]", "Period (s),SA (g)", "T(s),Sa(g)",
              "Period [s],5% Damped Spectral Acceleration [g]", "frequency_hz,amplitude [g]", "f [Hz],a_g", "T,psa_g",
              "Tn [s],acc_m_s2", "omega_rad_s,acc_m_s2", "freq,Fourier amplitude [g]", "\xe5\x91\xa8\xe6\x9c\x9f,acc_g")
        for (size_t k = 0; k < sizeof HOWS / sizeof HOWS[0]; k++)
            expect(*spectra, &HOWS[k], "there:");
    expect("frequency_hz,amplitude [g]", &HOWS[1], "there:1: 'frequency_hz,amplitude [g]' heads a spectrum");
    expect("T [s],PSa [m/s^2]", &HOWS[3], "its channel 'PSa [m/s^2]' is not an acceleration");
    expect("lag,a_g", &HOWS[0],
           "there:1: the first column is 'lag', which is no time: name the one of the times time_s");
    FOR_EACH (const char *, time, "T [s],a_g", "Zeit;a_g", "elapsed time,a_g", "x [s],a_g", ",a_g", "TIEMPO,a_g",
              "\xe6\x99\x82\xe5\x88\xbb,acc_g")
        expect(*time, &HOWS[0], NULL);
    expect("Kobe record", &(MotionHow){.unit = UNIT_G}, NULL); /* a title, as many words as columns */
}

/* Periods without names, as programs for spectra print them, are resampled into a motion by no option. */
TEST(unequal_steps_without_the_name_of_times_are_not_resampled)
{
    Motion m;
    static const char text[] = "# units: g\n0.01 1\n0.02 2\n0.05 3\n0.1 2\n0.2 1\n";
    assert_refused(motion_parse(&m, "there", text, strlen(text), &(MotionHow){.dt_s = 0.01}, &err), STATUS_BAD_DATA,
                   "name the column of its times time_s and set motion.dt_s");
}

/* first, then second, in one text. */
static Text joined(Text first, Text second)
{
    Text t = {malloc(first.length + second.length + 2), 0};
    assert_non_null(t.text);
    t.length = (size_t)sprintf(t.text, "%s\n", first.text);
    memcpy(t.text + t.length, second.text, second.length + 1);
    t.length += second.length;
    free(first.text);
    free(second.text);
    return t;
}

TEST(a_record_behind_a_record_is_a_channel_in_every_format)
{
    for (int i = 0; i < N_SPECIMENS; i++) {
        const int is_plain = strcmp(SPECIMENS[i].format, "csv") == 0;
        Text t = joined(read_specimen(SPECIMENS[i].file), read_specimen("one.knet"));
        Motion m = {0};
        err = (Err){0};
        assert_int_equal(motion_parse(&m, "two", t.text, t.length, &(MotionHow){0}, &err), STATUS_BAD_DATA);
        if (!is_plain &&
            (!strstr(err.text, "channels: 1 ") || !strstr(err.text, "'N-S'; choose one by motion.channel")))
            fail_msg("%s: %s", SPECIMENS[i].file, err.text);
        if (!is_plain) { /* the last channel is that of K-NET */
            const char last[] = {strstr(err.text, "holds ")[6], 0};
            m = accept_text("two", t, &(MotionHow){.channel = last});
            assert_string_equal(m.format, "knet");
            assert_close(m.accel[PEAK_AT], 0.01 * PEAK_GAL[0], 1e-4);
            motion_free(&m);
        } else {
            free(t.text);
        }
    }
}

TEST(numbers_below_other_words_are_not_dropped_in_silence)
{
    Text t = joined(read_specimen("equals.at2"), (Text){strdup("Some words\n 1.0 2.0\n"), 20});
    refuse("there", t, &FIRST, "more numbers, below words, than the header announces");
    t = joined(read_specimen("one_column.txt"), read_specimen("one_column.txt"));
    refuse("there", t, &FIRST, "below the first sample; is it a second record?");
}

TEST(rows_that_are_missing_or_swapped_are_refused_where_they_carry_times)
{
    static const char *const EDITS[][2] = {{"     0.150   ", "     0.160   "}, {"     0.150   ", "     0.140   "}};
    for (size_t i = 0; i < sizeof EDITS / sizeof EDITS[0]; i++) {
        Text t = changed(read_specimen("cwb.dat"), EDITS[i][0], EDITS[i][1], 0);
        refuse("there", t, &FIRST, "does not come after");
    }
    Text t = read_specimen("cwb.dat");
    char *row = strstr(t.text, "     0.150 "), *next = strchr(row, '\n') + 1;
    memmove(row, next, strlen(next) + 1);
    assert_refused(motion_parse(&(Motion){0}, "there", t.text, strlen(t.text), &FIRST, &err), STATUS_BAD_DATA,
                   "breaks the uniform step of 0.01 s");
    free(t.text);
}

TEST(a_stated_foreign_quantity_is_not_overruled_by_an_option)
{
    FOR_EACH (const char *, foreign, "Base shear [kN]", "Interstorey drift [-]", "v [cm/s]", "Arias [m/s]", "v_cm_s",
              "shear_kN", "acc [mg]", "acc [0.01 g]", "u (mm)", "acc (milli-g)", "acc_m/s/s/s (%)") {
        FREED char *header = formatted("time_s,%s", *foreign);
        expect(header, &(MotionHow){.unit = UNIT_G},
               "of its acceleration is not known; convert it to m/s2, cm/s2 or g");
        expect(header, &(MotionHow){.unit = UNIT_M_S2}, "of its acceleration is not known");
    }
    FOR_EACH (const char *, remark, "NS (filtered)", "acc (N)", "acc (N-S)", "acc [channel 1]", "NS") {
        FREED char *header = formatted("time_s,%s", *remark);
        expect(header, &(MotionHow){0}, "does not say the unit");
        expect(header, &(MotionHow){.unit = UNIT_G}, NULL);
    }
    Text t = changed(read_specimen("three.slist"), "FLOAT, cm/s**2", "FLOAT, M/S", 1);
    refuse("there", t, &(MotionHow){.unit = UNIT_M_S2, .channel = "1"},
           "the unit 'M/S' of its acceleration is not known");
    const MotionHow gain = {.channel = "1", .unit = UNIT_COUNTS, .counts_per_m_s2 = 100};
    OWNED(motion_free) Motion m;
    t = changed(read_specimen("three.slist"), "FLOAT, cm/s**2", "FLOAT, ADC", 1);
    m = accept_text("there", t, &gain);
    assert_close(m.accel[PEAK_AT], 0.01 * PEAK_GAL[0], 1e-6);
}

TEST(two_units_in_one_file_are_refused)
{
    expect("# units: cm/s2\ntime_s,acc_g", &(MotionHow){0},
           "there:2: the column 'acc_g' is in g, but the header above says cm_s2");
    expect("# units: cm/s2\ntime_s,acc [m/s2]", &(MotionHow){.unit = UNIT_M_S2}, "is in m_s2, but the header above");
    expect("# units: cm/s2\n# units: g\ntime_s,acc", &(MotionHow){0}, "states another unit than a line above");
    expect("# units: s, g\ntime_s,acc (g)", &(MotionHow){0}, NULL);
}

/* Headers that programs write, and what their rows are by the first samples of the specimens. */
TEST(what_other_programs_write_is_read)
{
    static const struct {
        const char *file, *from, *to, *channel, *warning;
        double factor;
    } CASES[] = {{"three.slist", "XX_SYN_00_HNN_D", "XX_SA_00_HNN_D", "XX_SA", "", 1},
                 {"one.smc", "2 CORRECTED ACCELEROGRAM", "0 UNKNOWN", "1", "UNKNOWN, does not say what it holds", 1},
                 {"simcenter.json", ": 43", ": 42", "1", "its numSteps is one less than its samples", 1},
                 {"simcenter.json", "\"dT\"", "\"factor\": 2.5, \"dT\"", "1", "multiplied by the factor", 2.5}};
    for (size_t i = 0; i < sizeof CASES / sizeof CASES[0]; i++) {
        OWNED(motion_free) Motion m;
        Text t = changed(read_specimen(CASES[i].file), CASES[i].from, CASES[i].to, 0);
        m = accept_text("there", t, &(MotionHow){.channel = CASES[i].channel});
        assert_int_equal(m.n, N_SAMPLES);
        assert_close(m.accel[PEAK_AT], 0.01 * PEAK_GAL[0] * CASES[i].factor, 1e-9);
        assert_non_null(strstr(m.warning, CASES[i].warning));
    }
    FOR_EACH (const char *, table, ",time_s,acc_m_s2\n0,0.00,1\n1,0.01,2\n2,0.02,-3\n",
              "i,time_s,acc_m_s2\n0,0.00,1\n1,0.01,2\n2,0.02,-3\n", "npts=3 dt=0.01 units=m/s2\n1\n2\n-3\n",
              "npts= 3 dt= 0.01 units= m/s2\n1 2\n-3\n", "npts=3, dt=0.01, units=m/s2\n1 2 -3\n") {
        OWNED(motion_free) Motion m = there(*table, &(MotionHow){0});
        assert_true(m.n == 3 && m.accel[0] == 1 && m.accel[1] == 2 && m.accel[2] == -3);
        assert_close(m.dt_s, 0.01, 1e-15);
    }
}

/* OpenSees' .g3 and .dat: five or eight numbers a row, fewer in the last, sometimes a word behind them. */
TEST(rows_with_a_shorter_last_one_are_one_motion_where_the_step_is_given)
{
    for (int width = 5; width <= 8; width += 3)
        for (int with_word = 0; with_word < 2; with_word++) {
            OWNED(motion_free) Motion m;
            Text t = rows_of("", 20, width);
            t.length -= 30; /* two numbers */
            memcpy(t.text + t.length, with_word ? "\nend\n" : "\n", with_word ? 6 : 2);
            const MotionHow how = {.unit = UNIT_M_S2, .dt_s = 0.02};
            t.length = strlen(t.text);
            CHECK_OK(motion_parse(&m, "rows", t.text, t.length, &how, &err), &err);
            assert_true(m.n < (size_t)(20 * width) && m.n >= (size_t)(20 * width - 3));
            for (size_t k = 0; k + 1 < m.n; k++)
                assert_close(m.accel[k], sin((double)k), 1e-10);
            refuse("rows", t, &(MotionHow){.unit = UNIT_M_S2},
                   "and its step ('# dt = 0.01 s', or --set motion.dt_s=0.01)");
        }
}

TEST(a_record_that_its_agency_corrected_is_not_called_uncorrected)
{
    static const char *const CORRECTED[] = {"three.csmip.v2", "three.v2a", "three.cosmos.v2", "one.smc", "isesd.cor"};
    static const char *const RAW[] = {"three.csmip.v1", "three.v1a", "one.cosmos.v1", "one.csmnc", "equals.at2"};
    for (int i = 0; i < 10; i++) {
        OWNED(motion_free) Motion m;
        const char *file = i < 5 ? CORRECTED[i] : RAW[i - 5];
        CHECK_OK(motion_read(&m, SPECIMEN(file), &FIRST, &err), &err);
        if (m.is_corrected != (i < 5))
            fail_msg("%s: %d", file, m.is_corrected);
    }
}

SUITE(NULL, NULL)
