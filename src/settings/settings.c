#include "settings/settings.h"

#include <errno.h>
#include <limits.h>

#include "base/keyed.h"
#include "base/list.h"
#include "base/text.h"
#include "motion/builtin.h"
#include "motion/suite.h"
#include "scene/foundation.h"
#include "settings/rules.h"
#include "settings/table.h"

typedef enum { KIND_REAL, KIND_WHOLE, KIND_CHOICE, KIND_SHARES, KIND_LIST, KIND_TEXT, KIND_PATH, KIND_PATH_LIST } Kind;

typedef struct {
    const char *key;
    Kind kind;
    size_t offset;
    const char *standard; /* default, as one would type it */
    const char *unit;     /* REAL and WHOLE */
    double min, max;
    const char
        *words;    /* CHOICE: "a|b|c", in the order of its enum; SHARES: the names of its numbers, likewise; PATH: names
                          that are no path, or NULL; REAL, WHOLE: the one that stands for OPTION_WORD, or NULL */
    int count;     /* LIST: numbers, in ascending order; 0: any number of them. SHARES: of words */
    size_t number; /* CHOICE: the field of a number that is taken in the place of a word, as the default is; 0: none */
    const char *help;
    unsigned flags; /* SettingFlags */
} Option;

/* The place of a field; compiles only where the field is of that type. */
#define AT(field)             offsetof(Settings, field)
#define AT_TYPED(field, type) (AT(field) + 0 * sizeof(&((Settings *)0)->field == (type *)0))
typedef char OptionText[OPTION_TEXT_MAX];

/* A line of the table by its kind. The key is the path of the field; what follows the named columns is the help, and
 * .flags = ... where there are some. */
/* clang-format off */
#define OPTION(kind_, field, type, standard_, ...) \
    {.key = #field, .kind = kind_, .offset = AT_TYPED(field, type), .standard = standard_, .help = __VA_ARGS__}
#define REAL(field, unit_, standard_, min_, max_, ...) \
    OPTION(KIND_REAL, field, double, standard_, __VA_ARGS__, .unit = unit_, .min = min_, .max = max_)
#define WHOLE(field, standard_, min_, max_, ...) \
    OPTION(KIND_WHOLE, field, long, standard_, __VA_ARGS__, .unit = "-", .min = min_, .max = max_)
#define CHOICE(field, type, list_, standard_, ...) \
    OPTION(KIND_CHOICE, field, type, standard_, __VA_ARGS__, .words = CHOICE_WORDS(list_), .unit = "-")
#define SHARES(field, type, words_, max_, standard_, ...) \
    OPTION(KIND_SHARES, field, type, standard_, __VA_ARGS__, .words = words_, .unit = "-", .max = max_, \
           .count = sizeof(type) / sizeof(double))
#define LIST(field, unit_, standard_, min_, max_, ...) \
    OPTION(KIND_LIST, field, NumberList, standard_, __VA_ARGS__, .unit = unit_, .min = min_, .max = max_)
#define BOUNDS(field, unit_, standard_, min_, max_, ...) \
    LIST(field, unit_, standard_, min_, max_, __VA_ARGS__, .count = 2)
#define PATH(field, standard_, words_, ...) \
    OPTION(KIND_PATH, field, OptionText, standard_, __VA_ARGS__, .words = words_)
#define PATH_LIST(field, standard_, ...) OPTION(KIND_PATH_LIST, field, OptionText, standard_, __VA_ARGS__)
#define TEXT(field, standard_, ...) OPTION(KIND_TEXT, field, OptionText, standard_, __VA_ARGS__)
/* clang-format on */

/* In the order of the fields of RepairOptions, DegradationOptions, PriceOptions, UncertainOptions. */
enum { SHARES_MAX = 7 };
static const char REPAIR_WORDS[] = "structure|drift_sensitive|acceleration_sensitive";
static const char DEGRADATION_WORDS[] = "strength|stiffness";
static const char PRICE_WORDS[] = "gap|bumper|link|tuned_mass_t|core_t|anchor_mn";
static const char UNCERTAIN_WORDS[] =
    "restitution|contact_stiffness|core_stiffness|building_stiffness|damping|ground_stiffness|strength";

static const Option OPTIONS[] = {
    PATH(building.model, "guyan", "guyan|appendix",
         "a built-in building, an OpenSees model (FILE.tcl), or a folder with K.csv and M.csv, storeys.csv or a frame "
         "(docs/building.md)",
         .flags = SETTING_BASIC | SETTING_FREE),
    CHOICE(building.units, BuildingUnits, BUILDING_UNITS_LIST, "auto",
           "units of K.csv and M.csv, or of an OpenSees model; auto: N/m and kg, if these are plausible",
           .flags = SETTING_BASIC),
    CHOICE(building.damping_model, DampingModel, DAMPING_MODEL_LIST, "modal",
           "modal: building.damping mode by mode; rayleigh: its first ratio in two modes"),
    LIST(building.damping, "-", "0.03", 0, 10,
         "damping ratios of the building, mode by mode; the last for all further modes", .flags = SETTING_BASIC),
    BOUNDS(building.rayleigh_modes, "-", "1, 3", 1, 128,
           "rayleigh: the two modes that have the damping ratio building.damping"),
    LIST(building.heights_m, "m", "5.4864, 3.9624", 0.1, 100,
         "heights of the storeys from the bottom, if the files have none; the last for all further storeys"),
    CHOICE(building.rigid_floors, Switch, SWITCH_LIST, "on",
           "frames: on: the nodes of a floor move sideways together; off: beams stretch"),
    CHOICE(building.elastic, Elastic, ELASTIC_LIST, "only",
           "OpenSees models: only: materials that yield are refused; initial: their initial stiffness is taken"),
    WHOLE(building.modes, "0", 0, 100000,
          "frames: fixed-interface modes kept beside the floors (Craig-Bampton), 100000: all degrees of freedom; 0: "
          "condensed to the floors (Guyan)"),
    CHOICE(building.p_delta, Switch, SWITCH_LIST, "off",
           "on: the weights of the storeys soften the building (P-delta)"),
    REAL(building.yield_drift, "-", "0", 0, 1,
         "interstorey drift over height at which a storey yields, unless storeys.csv says; 0: no storey yields"),
    REAL(building.hardening, "-", "0.05", 0, 0.999,
         "share of a storey's stiffness left after yielding; raised, with a warning, if the building would fall"),
    CHOICE(building.hysteresis, Hysteresis, HYSTERESIS_LIST, "bilinear",
           "law of storeys that yield: bilinear; bouc_wen: rounded, and it may degrade"),
    REAL(building.bouc_wen_exponent, "-", "10", 0.1, 100,
         "bouc_wen: sharpness of yielding; a large number is nearly bilinear"),
    SHARES(building.degradation, DegradationOptions, DEGRADATION_WORDS, 10, "none",
           "bouc_wen: losses for an input of twice the elastic energy at yield, such as strength=0.02 stiffness=0.05 "
           "(docs/theory.md)"),

    PATH(core.model, "none", "none|guyan|appendix",
         "another building in place of the core, a neighbour that pounds: values of building.model, with no more "
         "floors (docs/building.md); none: the cantilever of the settings below"),
    CHOICE(core.section, CoreSection, CORE_SECTION_LIST, "box",
           "box: square tube of outer side width_m; plate: solid, width_m wide; effective: areas and inertias given",
           .flags = SETTING_BASIC),
    CHOICE(core.theory, CoreTheory, CORE_THEORY_LIST, "timoshenko",
           "timoshenko: with shear deformation and rotary inertia; euler_bernoulli: bending alone, as in the paper"),
    CHOICE(core.wall, CoreWall, CORE_WALL_LIST, "full",
           "stiffness of the box: full; effective: reduced where walls buckle under their largest stress (EN "
           "1993-1-5, several simulations for one); or the share that is left",
           .number = AT_TYPED(core.wall_factor, double), .min = 0.01, .max = 1),
    REAL(core.stiffeners, "-", "0", 0, 2,
         "mass of the box's stiffeners over that of its walls; they raise its buckling stress (docs/theory.md)"),
    REAL(core.width_m, "m", "11.3", 0.1, 200, "outer side of the box, width of the plate", .flags = SETTING_BASIC),
    REAL(core.damping, "-", "0.03", 0, 10, "damping ratio of every mode of the core"),
    REAL(core.youngs_modulus_pa, "Pa", "2.1e11", 1, 1e14, "Young's modulus of the core"),
    REAL(core.poisson, "-", "0.3", 0, 0.5, "Poisson's ratio of the core, for its shear modulus"),
    REAL(core.density_kg_m3, "kg/m3", "7850", 1, 1e5, "density of the core"),
    TEXT(core.foundation, "fixed",
         "ground under the core: fixed, or a rigid disc on soil=A..D (site class of ASCE 7) or g=PA with radius=M "
         "[nu=0.3 density=2000 weight=N], or springs rotation=N_m_rad translation=N_m with rotation_dashpot= "
         "translation_dashpot=. With radius= the disc lifts above anchors=FACTOR times the moment that the weight "
         "holds; default: 1, weight alone; anchors=inf: it never lifts (docs/theory.md)"),
    REAL(core.foundation_factor, "-", "1", 1e-6, 1e6, "factor on the stiffness of that ground, to bound it"),
    LIST(core.areas_m2, "m2", "1.567, 0.811", 1e-9, 1e4,
         "effective: areas of the first and the last storey, or of every storey from the bottom"),
    LIST(core.inertias_m4, "m4", "25.6201, 24.0503", 1e-9, 1e6, "effective: second moments of area, in the same way"),
    LIST(core.shear_areas_m2, "m2", "0", 0, 1e4, "effective: shear areas, in the same way; 0: no shear deformation"),
    LIST(core.masses_kg, "kg", "none", 1e-9, 1e9,
         "effective: masses of the storeys, in the same way; none: density times area"),

    CHOICE(contact.law, ContactLaw, CONTACT_LAW_LIST, "paper",
           "paper: a = 1.5 (1 - r); exact: a such that an isolated impact rebounds with r; the others by their authors "
           "(docs/theory.md)"),
    REAL(contact.restitution, "-", "0.7", 0, 1, "coefficient of restitution r of the contact law",
         .flags = SETTING_BASIC),
    REAL(contact.radius_m, "m", "0.1", 1e-6, 1e3, "radius of the contacting body"),
    REAL(contact.youngs_modulus_pa, "Pa", "2.1e11", 1, 1e14, "Young's modulus of both bodies, of Poisson's ratio 0.3"),
    REAL(contact.bumper_stiffness_n_m, "N/m", "0", 0, 1e14,
         "stiffness of a bumper in series with the steel, at every floor and side; 0: none, steel on steel"),
    REAL(contact.bumper_damping, "-", "0.1", 0, 0.9, "damping ratio of the bumper (docs/theory.md)"),
    REAL(contact.bumper_thickness_m, "m", "0.2", 1e-4, 10,
         "thickness of the bumper; the gap is the clearance in front of it"),
    REAL(contact.bumper_strain_max, "-", "0.5", 1e-3, 1,
         "a bumper that is compressed by more than this share of its thickness bottoms out; results say so"),
    LIST(contact.eccentricity, "-", "0", 0, 10,
         "distance of contacts from the centre of the floors, across the motion, over the plan's side along it; then "
         "the ratio of the sides across and along (1.2). Floors turn, and peaks are those of their edges "
         "(docs/theory.md)"),

    PATH(motion.record, "builtin:kobe-like", CHOICE_WORDS(BUILTIN_MOTION_LIST),
         "ground motion: a built-in one, a file, or none: the ground rests, with motion.forces (docs/motions.md)",
         .flags = SETTING_BASIC | SETTING_FREE),
    PATH_LIST(motion.records, "none",
              "further records of the same study, a comma list of files, folders, *list.txt or builtin:suite: every "
              "design is simulated under each (sim.robust, docs/motions.md)",
              .flags = SETTING_FREE),
    REAL(motion.pga_g, "g", "0", 0, 1e6, "scale the motion to this peak ground acceleration; 0: as recorded",
         .flags = SETTING_BASIC),
    REAL(motion.factor, "-", "1", 1e-6, 1e6, "multiply the motion by this; 1: as recorded"),
    REAL(motion.sa_g, "g", "0", 0, 1e6,
         "scale the motion to this pseudo-acceleration (5 % damping) at motion.sa_period_s; 0: as recorded"),
    REAL(motion.sa_period_s, "s", "1", 1e-3, 1e3, "period of motion.sa_g, after motion.stretch"),
    TEXT(motion.target, "none",
         "scale the motion to a code spectrum: none | eurocode8 ag=0.3 soil=A..E [s= tb= tc= td=] | asce7 sds=1 "
         "sd1=0.6 [tl=8], each with [from=0.2 to=2], the periods between which it is fitted; [g, s], type 1"),
    REAL(motion.stretch, "-", "1", 1e-3, 1e3, "multiply the times of the record by this"),
    CHOICE(motion.baseline, MotionBaseline, MOTION_BASELINE_LIST, "none",
           "subtract from the recorded acceleration its mean, or the straight line or parabola nearest to it"),
    REAL(motion.highpass_hz, "Hz", "0", 0, 1e3,
         "cutoff of a zero-phase Butterworth high-pass of 4th order on the record, before motion.stretch; 0: none"),
    REAL(motion.lowpass_hz, "Hz", "0", 0, 1e4, "cutoff of the same as a low-pass; 0: none"),
    TEXT(motion.unit, "from_file",
         "unit of the acceleration, if the file does not say it: from_file | m_s2 | cm_s2 | g | counts=VALUE, the "
         "counts per m/s2 of the instrument"),
    TEXT(motion.channel, "auto", "component by name or number (from 1) of a file with several; auto: the only one"),
    REAL(motion.dt_s, "s", "0", 0, 100,
         "time step of a file without step and times; unequal steps are resampled to it linearly; 0: as in the file"),

    TEXT(motion.text, "auto",
         "how to read a plain text that is not understood: skip=LINES, columns=time:1,value:3, per_line=8 (one motion "
         "row by row), pairs=yes (t a t a ...), factor=9.81 (docs/motions.md)"),

    PATH(motion.forces, "none", NULL,
         "forces on floors over time, beside the ground motion or with motion.record = none: a CSV with time_s and a "
         "column floor_01_n, ... per floor, in N (docs/motions.md)",
         .flags = SETTING_FREE),

    CHOICE(sim.model, ModelUse, MODEL_USE_LIST, "given",
           "auto: a study simulates three designs with every effect of docs/ladder.md that the settings leave open, "
           "and keeps those that the scene needs; given: the effects of the settings",
           .flags = SETTING_BASIC),
    CHOICE(sim.engine, Engine, ENGINE_LIST, "fast",
           "integrator: fast, or cvode (SUNDIALS, another method, slower) for a cross-check"),
    CHOICE(sim.accuracy, Accuracy, ACCURACY_LIST, "standard",
           "preset of step and tolerances, or the relative error allowed in J3 and the energy shares: less error "
           "takes more time (docs/trust.md)",
           .number = AT_TYPED(sim.tolerance, double), .min = 1e-6, .max = 0.2, .flags = SETTING_BASIC),
    REAL(sim.duration_s, "s", "0", 0, 1e6, "end of the simulation; 0: end of the motion"),
    WHOLE(sim.replicates, "1", 1, 1000,
          "simulations of a design under each record, with perturbed gaps; objectives are their means"),
    REAL(sim.gap_tolerance_m, "m", "0", 0, 1, "standard deviation of a gap as built; needs sim.replicates >= 2"),
    CHOICE(sim.forces, Forces, FORCES_LIST, "auto",
           "yes: store forces, stresses, base shears and filtered accelerations of every design; auto: only those "
           "that an objective or a limit needs"),
    REAL(sim.filter_hz, "Hz", "25", 0.01, 1000,
         "low-pass cutoff of j3_filtered_g, the acceleration that equipment feels"),
    CHOICE(sim.robust, Robust, ROBUST_LIST, "worst",
           "how several simulations become one number: worst or mean over the records, of means over the replicates; "
           "over all replicates of all records mean_plus_sd, cvar (mean of the worst, sim.tail) or a quantile, 0.9: "
           "nine in ten are better. p(NAME>NUMBER) of search.objectives is the share of all in every case",
           .number = AT_TYPED(sim.quantile, double), .min = 1e-6, .max = 1),
    REAL(sim.tail, "-", "0.2", 1e-3, 1, "cvar: share of all simulations, the worst ones, whose mean counts"),
    SHARES(sim.repair, RepairOptions, REPAIR_WORDS, 1,
           "structure=0.192 drift_sensitive=0.329 acceleration_sensitive=0.479",
           "loss: repair cost of destroyed parts, as shares of the building's; the default is offices by Hazus; in a "
           "hospital more breaks by acceleration"),

    SHARES(
        sim.uncertain, UncertainOptions, UNCERTAIN_WORDS, 1, "none",
        "standard deviations of the structure as built, such as restitution=0.05 damping=0.3: of contact.restitution; "
        "relative ones of the stiffness of contact (with bumper), core, building and ground (core.foundation), of the "
        "damping ratios and of the strength (building.yield_drift); needs sim.replicates >= 2"),

    TEXT(design.variables, "gaps, thickness",
         "what is designed: gaps, thickness, and further bumper (stiffness, on a logarithmic scale), side (of the "
         "box), anchors (of its mat, from 1 to the anchors= of core.foundation), links (dashpots between floors and "
         "core), friction (links of a constant force), tuned_mass (at the roof: mass, frequency, damping ratio)"),
    CHOICE(design.gap_sides, GapSides, GAP_SIDES_LIST, "both",
           "both: one gap for both sides of a floor; each: two variables, gap_left_01_m.. and gap_right_01_m..; left, "
           "right: contacts on this side alone. A floor closes its right gap when it moves right (u > v)"),
    WHOLE(design.gap_zones, "0", 0, 128, "number of zones of floors with one gap each; 0: a gap for every floor"),
    WHOLE(design.bumper_zones, "1", 0, 128,
          "number of zones of floors whose bumpers differ; 1: all are alike; 0: by floor"),
    BOUNDS(design.gap_m, "m", "0.001, 0.5", 0, 10, "bounds of the search: smallest and largest gap",
           .flags = SETTING_BASIC),
    BOUNDS(design.thickness_m, "m", "0.004, 0.04", 1e-6, 10, "bounds of the search: core thickness",
           .flags = SETTING_BASIC),
    REAL(design.step_gap_m, "m", "0", 0, 1,
         "round gaps to multiples of this, such as 0.005, as they are set on site; 0: any gap"),
    LIST(design.step_thickness_m, "m", "none", 1e-6, 10,
         "stock thicknesses of the core, ascending, in place of design.thickness_m; none: any"),
    BOUNDS(design.bumper_n_m, "N/m", "1e7, 1e10", 1e3, 1e14, "bounds of the search: stiffness of a bumper"),
    BOUNDS(design.width_m, "m", "6, 15", 0.1, 200,
           "bounds of the search: side of the box (core.width_m), by the footprint that is available"),
    TEXT(design.devices, "all",
         "devices among which the search chooses for a floor: gap (a stop), bumper, link, friction, none. The roof's "
         "tuned mass is a choice then too, and the search begins with tuned links and a tuned mass. all: no choice, "
         "every floor has what design.variables names"),
    WHOLE(design.device_zones, "0", 0, 128,
          "number of zones of floors with one choice each; 0: a choice for every floor"),
    WHOLE(design.link_zones, "0", 0, 128,
          "number of zones of floors whose links (friction links) differ; 0: a link for every floor"),
    REAL(design.link_exponent, "", "1", 0.1, 2,
         "a in the force c v^a of a link; 1: linear, 0.3: typical of products; c is then in N (s/m)^a"),
    BOUNDS(design.link_n_s_m, "N s/m", "1e4, 1e7", 1e-3, 1e12,
           "bounds of the search: c of a link; force of a friction link, in N"),
    BOUNDS(design.mass_kg, "kg", "1e4, 5e5", 1e-3, 1e9, "bounds of the search: tuned mass"),
    BOUNDS(design.mass_hz, "Hz", "0.1, 2", 1e-3, 1e3, "bounds of the search: frequency of the tuned mass"),
    BOUNDS(design.mass_damping, "", "0.01, 0.5", 1e-4, 2, "bounds of the search: damping ratio of the tuned mass"),
    SHARES(
        design.prices, PriceOptions, PRICE_WORDS, 1e9, "gap=3 bumper=4 link=25 tuned_mass_t=10 core_t=4 anchor_mn=2",
        "prices for cost: of a stop, its bumper, a link (friction link), a tonne of tuned mass and of the core, a MN "
        "of anchor force; the default is an example, in thousands of euros"),

    CHOICE(problem.kind, ProblemKind, PROBLEM_KIND_LIST, "tower",
           "tower: gaps and core thickness of the scene; external: your own simulator"),
    TEXT(problem.command, "none",
         "external: command of the simulator, started without a shell once per thread (docs/external.md)"),
    REAL(problem.timeout_s, "s", "600", 1e-3, 1e7,
         "external: a simulator that does not answer for so long has failed and is restarted", .flags = SETTING_LIMIT),
    WHOLE(problem.variables, "22", 1, 10000, "external: number of design variables"),
    WHOLE(problem.objectives, "7", 1, 100, "external: number of objectives"),
    TEXT(problem.lower, "0", "external: lower bounds, one number for all or a comma list"),
    TEXT(problem.upper, "1", "external: upper bounds, one number for all or a comma list"),
    TEXT(problem.kinds, "real",
         "external: real, log, int, list:4|5|8 or choice:WORD|WORD, one for all or a comma list"),
    TEXT(problem.senses, "min", "external: min or max, one for all objectives or a comma list"),
    TEXT(problem.variable_names, "auto", "external: a comma list of names; auto: x1, x2, ..."),
    TEXT(problem.objective_names, "auto", "external: a comma list of names; auto: f1, f2, ..."),
    CHOICE(problem.noisy, Noisy, NOISY_LIST, "auto", "whether repeated evaluations of a design differ; auto: no"),

    WHOLE(search.seed, "1", 0, 4294967295.0, "seed of the random streams: same seed and settings, same bytes"),
    WHOLE(search.threads, "0", 0, 1024, "number of threads; 0: one per processor", .flags = SETTING_FREE),
    WHOLE(search.population, "92", 4, 100000, "designs of a population; this is no batch size, search.ahead is"),
    WHOLE(search.initial, "0", 0, 1000000,
          "designs of the initial Latin hypercube, at most max_evals; 0: by the number of variables"),
    PATH_LIST(search.start, "none",
              "initial designs: CSVs with a column per variable, folders of runs (their fronts), or a list",
              .flags = SETTING_FREE),
    WHOLE(search.max_evals, "2000", 4, 1e8, "stop after so many simulations", .flags = SETTING_BASIC | SETTING_LIMIT),
    REAL(search.max_hours, "h", "0", 0, 1e4,
         "stop after so many hours; 0: no limit; auto: two minutes before the Slurm job around it ends",
         .words = "auto", .flags = SETTING_LIMIT),
    WHOLE(search.stop_after, "0", 0, 1e6,
          "stop after so many simulations without a gain in hypervolume above its standard error; 0: never",
          .flags = SETTING_LIMIT),
    WHOLE(search.failures_max, "50", 0, 1e9,
          "stop when so many simulations in a row have failed, because something is wrong with all of them; 0: never",
          .flags = SETTING_FREE),
    CHOICE(search.surrogate, SurrogateUse, SURROGATE_USE_LIST, "on", "off: evolutionary search without a surrogate"),
    WHOLE(search.ahead, "auto", 0, 1e4,
          "batch size: designs that may be under way when the next ones are chosen; raise it above the number of "
          "workers. auto: a 24th of the designs so far, at least 5 for each objective (3 with noise, replicates or "
          "records; 3 in all with int or choice; an eighth of max_evals if less), at most 240; 0: one by one",
          .words = "auto"),
    CHOICE(search.fidelity, Fidelity, FIDELITY_LIST, "off",
           "which part of most designs is simulated at first: replicates: the first replicate (tower, sim.replicates "
           ">= 2); records: a fifth of motion.records, four at most. The rest follows where it promises most"),
    REAL(search.replicate_share, "-", "0.1", 0, 0.9,
         "noisy evaluations: share of the simulations that repeat designs of the front (docs/noise.md)"),
    WHOLE(search.replicates_max, "4", 1, 1000,
          "noisy evaluations: largest number of simulations of a design; 1: no replicates"),
    WHOLE(search.polish, "3", 0, 32,
          "designs polished at the end, with a tenth more simulations; none if these are too few or noisy"),
    TEXT(search.objectives, "auto",
         "tower: results to optimize, a comma list of columns (results/README.md); paper: its seven; auto: those of "
         "them that the building has; also p(NAME>NUMBER), the probability that one is exceeded",
         .flags = SETTING_BASIC),
    TEXT(search.limits, "none", "constraints on objectives and other results, such as j3_g<=5,drift_ratio<=0.02; none",
         .flags = SETTING_BASIC),
    TEXT(search.aspire, "none",
         "aspiration levels, such as j1_m 0.5,j3_g 3: the search turns to the part of the front that comes nearest to "
         "them, or is beyond them (docs/search.md); none"),

    CHOICE(run.isolate, Switch, SWITCH_LIST, "off",
           "on: the tower is simulated in separate processes; one that crashes ends its design alone",
           .flags = SETTING_FREE),
    PATH(run.out, "results/study", NULL, "folder of the run", .flags = SETTING_BASIC | SETTING_FREE | SETTING_OUTPUT),
};

enum { N_OPTIONS = N_OF(OPTIONS) };

_Static_assert(sizeof(PriceOptions) == 6 * sizeof(double), "a price for each of PRICE_WORDS");
_Static_assert(sizeof(RepairOptions) == 3 * sizeof(double), "a share for each of REPAIR_WORDS");
_Static_assert(sizeof(UncertainOptions) == SHARES_MAX * sizeof(double), "a share for each of UNCERTAIN_WORDS");
_Static_assert(sizeof(CoreSection) == sizeof(int), "a choice is stored as an int");
_Static_assert(N_OPTIONS <= (int)TABLE_MAX && (int)TABLE_MAX == 8 * sizeof((Settings *)0)->given,
               "a place for every setting");
_Static_assert(OPTION_TEXT_MAX == (int)LIST_MAX, "a list of the settings can be changed");

const char *settings_key(int i)
{
    return i < N_OPTIONS ? OPTIONS[i].key : NULL;
}

const char *settings_words(int i)
{
    return OPTIONS[i].words;
}

static void *field_of(Settings *s, const Option *o)
{
    return (char *)s + o->offset;
}

/* Index of value in "a|b|c", or -1. */
static int word_index(const char *words, const char *value)
{
    for (int i = 0; words; i++) {
        const size_t n = strcspn(words, "|");
        if (n == strlen(value) && strncmp(words, value, n) == 0)
            return i;
        words = words[n] ? words + n + 1 : NULL;
    }
    return -1;
}

static void format_word(char text[OPTION_TEXT_MAX], const char *words, int index)
{
    while (index-- > 0)
        words = strchr(words, '|') + 1;
    snprintf(text, OPTION_TEXT_MAX, "%.*s", (int)strcspn(words, "|"), words);
}

/* A number within the range of its setting. */
static Status parse_number(const Option *o, const char *value, double *number, Err *err)
{
    const char *unit = strcmp(o->unit, "-") == 0 ? "" : o->unit;
    char *end;
    errno = 0;
    *number = strtod(value, &end);
    if (end == value || *end)
        return bad_data(err, "%s: '%s' is not a number%s%s%s", o->key, value, *unit ? " [" : "", unit,
                        *unit ? "]" : "");
    if (!(*number >= o->min && *number <= o->max)) /* also rejects NaN */
        return bad_data(err, "%s: %s is outside %.10g..%.10g%s%s", o->key, value, o->min, o->max, *unit ? " " : "",
                        unit);
    if (o->kind == KIND_WHOLE && *number != (long)*number)
        return bad_data(err, "%s: %s is not a whole number", o->key, value);
    return STATUS_OK;
}

/* A comma list of numbers; of bounds two. */
static Status assign_list(Settings *s, const Option *o, const char *value, Err *err)
{
    NumberList *list = field_of(s, o), found = {0};
    char item[OPTION_TEXT_MAX];
    const size_t n = list_is_given(value) ? list_count(value) : 0;
    if (n > OPTION_LIST_MAX)
        return bad_data(err, "%s: %zu numbers; at most %d are supported", o->key, n, OPTION_LIST_MAX);
    for (; found.n < (int)n; found.n++) {
        if (!list_item(value, found.n, item, sizeof item))
            return bad_data(err, "%s: item %d of '%.60s' is empty", o->key, found.n + 1, value);
        TRY(parse_number(o, item, &found.at[found.n], err));
    }
    if (n == 0 && strcmp(o->standard, "none") != 0)
        return bad_data(err, "%s: needs a number", o->key);
    if (o->count && (found.n != 2 || !(found.at[0] < found.at[1])))
        return bad_data(err, "%s: '%.60s' is not two numbers, the first below the second", o->key, value);
    *list = found;
    return STATUS_OK;
}

/* A word, or the number that may stand in its place. */
static Status assign_choice(Settings *s, const Option *o, const char *value, Err *err)
{
    enum { WORDS_MAX = 24 };
    double number = 0;
    const int is_switch = strcmp(o->words, CHOICE_WORDS(SWITCH_LIST)) == 0; /* as TOML writes it */
    int i = is_switch ? word_index("off|on|false|true|no|yes", value) % 2 : word_index(o->words, value);
    if (i < 0 && !(o->number && strchr("-0123456789.", value[0]))) {
        char copy[512], *rest = copy, range[64] = "";
        const char *list[WORDS_MAX];
        int n = 0;
        text_copy(copy, o->words);
        for (char *word; n < WORDS_MAX && (word = strsep(&rest, "|"));)
            list[n++] = word;
        const char *near = nearest_word(value, list, n);
        if (o->number)
            snprintf(range, sizeof range, ", or a number from %g to %g", o->min, o->max);
        return bad_data(err, "%s: '%.60s' is not one of %s%s%s%s%s", o->key, value, o->words, range,
                        near ? "; did you mean " : "", near ? near : "", near ? "?" : "");
    }
    if (i < 0) {
        TRY(parse_number(o, value, &number, err));
        i = word_index(o->words, o->standard);
    }
    memcpy(field_of(s, o), &i, sizeof i); /* an enumeration */
    if (o->number)
        memcpy((char *)s + o->number, &number, sizeof number);
    return STATUS_OK;
}

/* "NAME=NUMBER NAME=NUMBER ..."; none and what is not named are 0. */
static Status assign_shares(Settings *s, const Option *o, const char *value, Err *err)
{
    char names[SHARES_MAX][OPTION_TEXT_MAX];
    KeyedNumber keys[SHARES_MAX];
    double shares[SHARES_MAX] = {0};
    if (!*value)
        return bad_data(err, "%s: is empty", o->key);
    for (int i = 0; i < o->count; i++) {
        format_word(names[i], o->words, i);
        keys[i] = (KeyedNumber){names[i], 1, o->min, o->max, 0};
    }
    if (strcmp(value, "none") != 0)
        TRY(keyed_numbers(o->key, value, 1, o->count, keys, shares, err));
    memcpy(field_of(s, o), shares, o->count * sizeof *shares);
    return STATUS_OK;
}

/* The quotes between which a settings file gives a value back, best none; NULL: with neither kind it does. A bracket
 * would begin an array, which goes on over further lines. */
static const char *quotes_of(const char *value)
{
    static const char *const QUOTES[] = {"", "\"", "'"};
    for (size_t i = *value == '['; i < N_OF(QUOTES); i++) {
        char line[OPTION_TEXT_MAX + 4], plain[OPTION_TEXT_MAX] = "";
        snprintf(line, sizeof line, " %s%s%s", QUOTES[i], value, QUOTES[i]);
        if (strcmp(table_value(line, plain), value) == 0)
            return QUOTES[i];
    }
    return NULL;
}

static Status assign_text(Settings *s, const Option *o, const char *value, Err *err)
{
    if (!*value)
        return bad_data(err, "%s: is empty", o->key);
    if (strlen(value) >= OPTION_TEXT_MAX)
        return bad_data(err, "%s: is longer than %d characters", o->key, OPTION_TEXT_MAX - 1);
    if (strpbrk(value, "\r\n") || is_blank(*value) || is_blank(value[strlen(value) - 1]) || !quotes_of(value))
        return bad_data(err,
                        "%s: '%.60s' cannot be kept in a settings file (line ends, blanks around it, ' ;', ' #' or a "
                        "bracket beside quotes)",
                        o->key, value);
    snprintf(field_of(s, o), OPTION_TEXT_MAX, "%s", value);
    return STATUS_OK;
}

Status table_assign(Settings *s, int at, const char *value, Err *err)
{
    const Option *o = &OPTIONS[at];
    double number;
    s->given[at / 8] |= (unsigned char)(1 << at % 8);
    switch (o->kind) {
    case KIND_REAL:
    case KIND_WHOLE:
        number = OPTION_WORD;
        if (!o->words || strcmp(value, o->words) != 0)
            TRY(parse_number(o, value, &number, err));
        if (o->kind == KIND_REAL)
            *(double *)field_of(s, o) = number;
        else
            *(long *)field_of(s, o) = (long)number;
        return STATUS_OK;
    case KIND_CHOICE:
        return assign_choice(s, o, value, err);
    case KIND_SHARES:
        return assign_shares(s, o, value, err);
    case KIND_LIST:
        return assign_list(s, o, value, err);
    case KIND_TEXT:
    case KIND_PATH:
    case KIND_PATH_LIST:
        return assign_text(s, o, value, err);
    }
    return STATUS_INTERNAL;
}

void settings_defaults(Settings *s)
{
    memset(s, 0, sizeof *s);
    for (int i = 0; i < N_OPTIONS; i++)
        table_assign(s, i, OPTIONS[i].standard, NULL);
    memset(s->given, 0, sizeof s->given);
}

int settings_gives(const Settings *s, const char *key)
{
    int i = 0;
    return table_find(key, &i, &(Err){0}) == STATUS_OK && s->given[i / 8] >> i % 8 & 1;
}

/* Keys of earlier versions, which stand in their runs, and what is to be known of them today. One that changed results
 * still has the value that they are computed with now. */
static const struct {
    const char *key;
    double value; /* NAN: any */
    const char *note;
} FORMER[] = {
    {"search.asynchronous", NAN, "every search looks ahead (search.ahead)"},
    {"search.generations", NAN, "search.max_evals limits a search"},
    {"search.blas", NAN, "OPENBLAS_CORETYPE in the environment chooses other kernels"},
    {"search.nondominated_share", NAN, "search.stop_after ends a search that gains nothing"},
    {"problem.noise", NAN, "textbook problems are in imtet-bench"},
    {"contact.v0_min_m_s", 1e-3, "the contact law is never given an approach speed below 1e-3 m/s"},
    {"contact.yield_stress_pa", 3.45e8, "contact_yields is of steel of 345 MPa; contact_pressure_pa says it of any"},
    {"contact.poisson", 0.3, "it is 0.3; contact.youngs_modulus_pa times 0.91/(1 - nu^2) is a contact of another nu"},
    {"building.strength_degradation", 0, "it is strength= of building.degradation"},
    {"building.stiffness_degradation", 0, "it is stiffness= of building.degradation"},
};

static size_t find_former(const char *key)
{
    size_t i = 0;
    while (i < N_OF(FORMER) && strcmp(key, FORMER[i].key) != 0)
        i++;
    return i;
}

int table_passes(const char *key, const char *value)
{
    const size_t i = find_former(key);
    return i < N_OF(FORMER) && (isnan(FORMER[i].value) || strtod(value, NULL) == FORMER[i].value);
}

Status table_find(const char *key, int *found, Err *err)
{
    const char *names[N_OPTIONS]; /* behind the section where the key has none */
    const char *near;
    for (int i = 0; i < N_OPTIONS; i++) {
        names[i] = OPTIONS[i].key + (strchr(key, '.') ? 0 : strcspn(OPTIONS[i].key, ".") + 1);
        if (strcmp(key, OPTIONS[i].key) == 0) {
            *found = i;
            return STATUS_OK;
        }
    }
    const size_t former = find_former(key);
    if (former < N_OF(FORMER))
        return bad_data(err, "%s is no setting any more: %s", key, FORMER[former].note);
    near = nearest_word(key, names, N_OPTIONS);
    for (int i = 0; near && i < N_OPTIONS; i++)
        if (near == names[i])
            near = OPTIONS[i].key;
    return near ? bad_data(err, "%s: no such setting; did you mean %s?", key, near)
                : bad_data(err, "%s: no such setting; `imtet settings` lists all", key);
}

typedef struct {
    ListItemFn change;
    void *user;
} Change;

/* builtin:NAME and none are no files; what is said of a record behind its path stays there. */
static void change_file(char path[OPTION_TEXT_MAX], void *user)
{
    const Change *c = user;
    char words[OPTION_TEXT_MAX];
    const size_t n = source_path_length(path);
    if (builtin_name(path) || strcmp(path, "none") == 0)
        return;
    memcpy(words, path + n, strlen(path + n) + 1);
    path[n] = 0;
    c->change(path, c->user);
    text_join(path, OPTION_TEXT_MAX, "", "%s", words);
}

void table_change_files(Settings *s, int i, ListItemFn change, void *user)
{
    const Option *o = &OPTIONS[i];
    char *value = field_of(s, o);
    if (o->flags & SETTING_OUTPUT)
        return;
    if (o->kind == KIND_PATH_LIST)
        list_change(value, change_file, &(Change){change, user});
    else if (o->kind == KIND_PATH && !(o->words && word_index(o->words, value) >= 0))
        change_file(value, &(Change){change, user});
}

static void make_absolute(char path[OPTION_TEXT_MAX], void *user)
{
    (void)user;
    char *absolute = realpath(path, NULL);
    if (absolute && strlen(absolute) < OPTION_TEXT_MAX)
        snprintf(path, OPTION_TEXT_MAX, "%s", absolute);
    free(absolute);
}

void settings_make_absolute(Settings *s)
{
    for (int i = 0; i < N_OPTIONS; i++)
        table_change_files(s, i, make_absolute, NULL);
}

/* From folder, which is absolute as realpath makes it; what begins with a point is no word of the program. */
static void make_relative(char path[OPTION_TEXT_MAX], void *folder)
{
    const char *from = folder;
    char *to = path[0] == '/' ? NULL : realpath(path, NULL), relative[2 * PATH_MAX] = "";
    size_t same = 0;
    if (!to)
        return;
    for (size_t i = 0;; i++) { /* the folder that both have in common */
        if ((!from[i] || from[i] == '/') && (!to[i] || to[i] == '/'))
            same = i;
        if (!from[i] || from[i] != to[i])
            break;
    }
    for (const char *c = from + same; (c = strchr(c, '/')); c++)
        text_join(relative, sizeof relative, "/", "..");
    text_join(relative, sizeof relative, "", "%s%s", *relative ? "" : ".", to + same);
    if (strlen(relative) < OPTION_TEXT_MAX)
        memcpy(path, relative, strlen(relative) + 1);
    free(to);
}

void settings_make_relative(Settings *s, char *folder)
{
    for (int i = 0; i < N_OPTIONS; i++)
        table_change_files(s, i, make_relative, folder);
}

typedef struct {
    const char *key;
    SettingFn take;
    void *user;
} EachPath;

static void take_path(char path[OPTION_TEXT_MAX], void *user)
{
    const EachPath *e = user;
    e->take(e->key, path, e->user);
}

void settings_each_path(const Settings *s, SettingFn take, void *user)
{
    Settings copy = *s;
    for (int i = 0; i < N_OPTIONS; i++)
        table_change_files(&copy, i, take_path, &(EachPath){OPTIONS[i].key, take, user});
}

Status settings_put(Settings *s, const char *key, const char *value, Err *err)
{
    int i = 0;
    TRY(table_find(key, &i, err));
    TRY(table_assign(s, i, value, err));
    if (field_of(s, &OPTIONS[i]) == s->core.foundation)
        s->design.anchors_max = foundation_complete(s->core.foundation, 0);
    return STATUS_OK;
}

Status settings_set(Settings *s, const char *assignment, Err *err)
{
    char key[128];
    const char *equals = strchr(assignment, '=');
    if (!equals || equals == assignment || (size_t)(equals - assignment) >= sizeof key)
        return misused(err, "--set %s: write --set section.key=value", assignment);
    snprintf(key, sizeof key, "%.*s", (int)(equals - assignment), assignment);
    return settings_put(s, key, equals + 1, err);
}

static void keep_first(const char *text, void *user)
{
    Err *first = user;
    if (first->code == STATUS_OK)
        fail(first, STATUS_BAD_DATA, "%s", text);
}

Status settings_check(const Settings *s, Err *err)
{
    Err first = {0};
    rules_check(s, keep_first, &first);
    return first.code == STATUS_OK ? STATUS_OK : fail(err, first.code, "%s", first.text);
}

/* The fewest digits that read back as the same number. */
static void format_real(double value, char text[OPTION_TEXT_MAX])
{
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, OPTION_TEXT_MAX, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
}

/* A setting as one would type it. */
static void format_value(const Settings *s, const Option *o, char text[OPTION_TEXT_MAX])
{
    const void *field = (const char *)s + o->offset;
    const double *share = field;
    const NumberList *list = field;
    char name[OPTION_TEXT_MAX], item[OPTION_TEXT_MAX];
    double number = 0;
    int word;
    *text = 0;
    switch (o->kind) {
    case KIND_REAL:
    case KIND_WHOLE:
        number = o->kind == KIND_REAL ? *share : (double)*(const long *)field;
        if (o->words && number == OPTION_WORD)
            snprintf(text, OPTION_TEXT_MAX, "%s", o->words);
        else if (o->kind == KIND_WHOLE)
            snprintf(text, OPTION_TEXT_MAX, "%ld", *(const long *)field);
        else
            format_real(number, text);
        break;
    case KIND_CHOICE:
        memcpy(&word, field, sizeof word);
        if (o->number)
            memcpy(&number, (const char *)s + o->number, sizeof number);
        if (number > 0)
            format_real(number, text);
        else
            format_word(text, o->words, word);
        break;
    case KIND_SHARES:
        for (int i = 0; i < o->count; i++) {
            if (share[i] == 0)
                continue;
            format_word(name, o->words, i);
            format_real(share[i], item);
            text_join(text, OPTION_TEXT_MAX, " ", "%s=%s", name, item);
        }
        break;
    case KIND_LIST:
        for (int i = 0; i < list->n; i++) {
            format_real(list->at[i], item);
            text_join(text, OPTION_TEXT_MAX, ", ", "%s", item);
        }
        break;
    case KIND_TEXT:
    case KIND_PATH:
    case KIND_PATH_LIST:
        snprintf(text, OPTION_TEXT_MAX, "%s", (const char *)field);
        return; /* may be empty */
    }
    if (!*text) /* no number in the list or among the shares */
        snprintf(text, OPTION_TEXT_MAX, "none");
}

static int is_meant(const Option *o, const char *word)
{
    return !word ||
           (strchr(word, '.') ? strcmp(o->key, word) == 0 : strcasestr(o->key, word) || strcasestr(o->help, word));
}

void settings_each(const Settings *s, const char *word, SettingFn take, void *user)
{
    char value[OPTION_TEXT_MAX];
    for (int i = 0; i < N_OPTIONS; i++) {
        format_value(s, &OPTIONS[i], value);
        if (is_meant(&OPTIONS[i], word))
            take(OPTIONS[i].key, value, user);
    }
}

void settings_compare(const Settings *was, const Settings *is, SettingsDiffFn differs, void *user)
{
    char before[OPTION_TEXT_MAX], after[OPTION_TEXT_MAX];
    for (int i = 0; i < N_OPTIONS; i++) {
        format_value(was, &OPTIONS[i], before);
        format_value(is, &OPTIONS[i], after);
        if (strcmp(before, after) != 0)
            differs(OPTIONS[i].key, OPTIONS[i].flags, before, after, user);
    }
}

void settings_write(const Settings *s, FILE *out, SettingsForm form, const char *word)
{
    const char *section = "";
    char value[OPTION_TEXT_MAX], standard[OPTION_TEXT_MAX];
    Settings defaults;
    settings_defaults(&defaults);
    for (int i = 0; i < N_OPTIONS; i++) {
        const Option *o = &OPTIONS[i];
        const int n = (int)strcspn(o->key, ".");
        format_value(s, o, value);
        format_value(&defaults, o, standard);
        if (!is_meant(o, word) ||
            (form == SETTINGS_BASIC && !(o->flags & SETTING_BASIC) && strcmp(value, standard) == 0))
            continue;
        if (strncmp(section, o->key, n + 1) != 0)
            fprintf(out, "%s[%.*s]\n", *section ? "\n" : "", n, o->key);
        section = o->key;
        if (form != SETTINGS_PLAIN) {
            fprintf(out, "; %s", o->help);
            if (o->kind == KIND_REAL || o->kind == KIND_WHOLE)
                fprintf(out, " [%s, %.10g..%.10g]", o->unit, o->min, o->max);
            if (o->kind == KIND_LIST)
                fprintf(out, " [%s, %.10g..%.10g,%s comma list]", o->unit, o->min, o->max,
                        o->count ? " from and to in a" : " a");
            if (o->kind == KIND_CHOICE && o->number)
                fprintf(out, " (%s|%g..%g)", o->words, o->min, o->max);
            else if (o->kind == KIND_CHOICE)
                fprintf(out, " (%s)", o->words);
            if (o->kind == KIND_SHARES)
                fprintf(out, " (none or %s, each =%g..%g)", o->words, o->min, o->max);
            if (o->kind == KIND_PATH)
                fprintf(out, " (%s%sFILE)", o->words ? o->words : "", o->words ? "|" : "");
            fputs(o->kind == KIND_PATH_LIST ? " (FILE,...)\n" : "\n", out);
        }
        /* A path that became an absolute one may hold what no quotes keep. */
        const char *found = quotes_of(value), *quote = found ? found : "";
        fprintf(out, "%s = %s%s%s\n", o->key + n + 1, quote, value, quote);
    }
}

char *settings_text(const Settings *s)
{
    size_t length;
    char *text = NULL;
    FILE *f = text_open(&text, &length);
    if (f)
        settings_write(s, f, SETTINGS_PLAIN, NULL);
    if (f && text_close(f) == 0)
        return text;
    free(text);
    return NULL;
}

int settings_screens(const Settings *s)
{
    const SearchOptions *search = &s->search;
    const int repeats = s->problem.noisy == NOISY_YES && search->replicates_max > 1 && search->replicate_share > 0;
    const int has_cheap = search->fidelity == FIDELITY_REPLICATES
                              ? s->sim.replicates > 1
                              : search->fidelity == FIDELITY_RECORDS && suite_count(&s->motion) > 1;
    return has_cheap && !repeats && s->problem.kind == PROBLEM_TOWER;
}
