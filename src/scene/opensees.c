#include "scene/opensees.h"

#include <errno.h>
#include <limits.h>
#include <locale.h>
#include <signal.h>
#include <stdarg.h>
#include <tcl.h>
#include <time.h>

/* ---- what is being read --------------------------------------------------------------------------------------- */

/* No model needs as many; one that does runs in a circle. */
enum { COMMANDS_MAX = 1000000, SECONDS_MAX = 10 };

typedef struct {
    const char *path;
    char folder[PATH_MAX]; /* of the model, without links */
    Tcl_Interp *tcl;
    double length, force; /* units in m, in N */
    Frame *frame;
    Frame library; /* sections "section 7", "uniaxialMaterial 1", "geomTransf 1" of what has such a tag, in the units of
                    * the model; of the last two the modulus alone counts, or nothing */
    int has_model, is_wiped, has_analysed, has_failed, has_ended;
    const char *command; /* that is read */
    char said[200];      /* by Tcl, where it failed */
    Err refused;         /* of the first command that is not read; code STATUS_OK: none yet */
    Err why;             /* a part is not taken by the frame */
} Reader;

typedef Tcl_Obj *const Words[];

/* The functions that take words return whether all is well; if not the model is refused, whether the script catches
 * it or not. The name of the command stands before the text. */
__attribute__((format(printf, 2, 3))) static int refuse(Reader *r, const char *format, ...)
{
    static const char WHERE[] =
        "set frame [info frame -1]; return -level 0 [dict get $frame file]:[dict get $frame line]";
    char text[300];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (r->refused.code == STATUS_OK) {
        const int known = Tcl_Eval(r->tcl, WHERE) == TCL_OK;
        fail(&r->refused, STATUS_BAD_DATA, "%s: %s%s%s", known ? Tcl_GetStringResult(r->tcl) : r->path, r->command,
             !*r->command || *text == ' ' ? "" : ": ", text);
    }
    return 0;
}

/* ---- words of a command --------------------------------------------------------------------------------------- */

static int is_word(Tcl_Obj *word, const char *text)
{
    return strcmp(Tcl_GetString(word), text) == 0;
}

/* Did the frame take the part that the command adds? */
static int is_taken(Reader *r, Status status)
{
    return status == STATUS_OK || refuse(r, "%s", r->why.text);
}

static int read_numbers(Reader *r, Words w, int first, int n, double values[])
{
    for (int i = 0; i < n; i++)
        if (Tcl_GetDoubleFromObj(NULL, w[first + i], &values[i]) != TCL_OK || !isfinite(values[i]))
            return refuse(r, "'%.60s' is no number", Tcl_GetString(w[first + i]));
    return 1;
}

/* A name from a tag, behind what it is of where that is not NULL. */
static int read_tag(Reader *r, Tcl_Obj *word, const char *what, char name[TABLE_NAME_MAX])
{
    int tag;
    if (Tcl_GetIntFromObj(NULL, word, &tag) != TCL_OK)
        return refuse(r, "'%.60s' is no tag, a whole number", Tcl_GetString(word));
    snprintf(name, TABLE_NAME_MAX, "%s%s%d", what ? what : "", what ? " " : "", tag);
    return 1;
}

/* What has the tag: a node of the frame, or of the library what it is called. */
static int find(Reader *r, Tcl_Obj *word, const char *what, int *index)
{
    char name[TABLE_NAME_MAX];
    if (!read_tag(r, word, what, name))
        return 0;
    *index = what ? frame_find(&r->library, FRAME_SECTIONS, name) : frame_find(r->frame, FRAME_NODES, name);
    return *index >= 0 || refuse(r, "there is no %s%s above", what ? "" : "node ", name);
}

/* Into the library, under the tag behind the two words of its kind. */
static int define(Reader *r, Words w, FrameSection s)
{
    return read_tag(r, w[2], r->command, s.name) && is_taken(r, frame_add_section(&r->library, &s, &r->why));
}

/* ---- nodes and what they are given ---------------------------------------------------------------------------- */

/* Only plane models of three unknowns per node are frames. */
static int check_model(Reader *r, int n, Words w)
{
    int dimensions = 0, unknowns = FRAME_DOFS;
    for (int i = 1; i + 1 < n; i++)
        if (is_word(w[i], "-ndm") || is_word(w[i], "-ndf"))
            Tcl_GetIntFromObj(NULL, w[i + 1], is_word(w[i], "-ndm") ? &dimensions : &unknowns);
    r->has_model = 1;
    return (dimensions == 2 && unknowns == FRAME_DOFS) || refuse(r, "only -ndm 2 -ndf 3 is read");
}

/* A later mass of a node replaces the earlier one (OpenSees: Node::setMass); that of elements adds to it at the end. */
static int set_mass(Reader *r, int node, Words w, int first)
{
    double m[FRAME_DOFS];
    if (!read_numbers(r, w, first, FRAME_DOFS, m))
        return 0;
    for (int d = 0; d < FRAME_DOFS; d++)
        m[d] *= r->force / r->length * (d == FRAME_ROT ? r->length * r->length : 1);
    return is_taken(r, frame_set_mass(r->frame, node, m, &r->why));
}

/* Adds a node, with a mass where it says so. */
static int add_node(Reader *r, int n, Words w)
{
    double xy[2];
    FrameNode node = {0};
    if (!r->has_model || r->is_wiped)
        return refuse(r, r->is_wiped ? "the model above was wiped; keep one of the two"
                                     : "'model BasicBuilder -ndm 2 -ndf 3' must stand above");
    if (!read_numbers(r, w, 2, 2, xy) || !read_tag(r, w[1], NULL, node.name))
        return 0;
    node.x = xy[0] * r->length;
    node.z = xy[1] * r->length;
    if (!is_taken(r, frame_add_node(r->frame, &node, &r->why)))
        return 0;
    return n == 4 ||
           (n == 5 + FRAME_DOFS && is_word(w[4], "-mass") ? set_mass(r, r->frame->n[FRAME_NODES] - 1, w, 5)
                                                          : refuse(r, "behind TAG x y only -mass mx my mr is read"));
}

/* Holds displacements of a node. */
static int fix_node(Reader *r, int n, Words w)
{
    double fixed[FRAME_DOFS];
    int node;
    (void)n;
    if (!find(r, w[1], NULL, &node) || !read_numbers(r, w, 2, FRAME_DOFS, fixed))
        return 0;
    for (int d = 0; d < FRAME_DOFS; d++)
        r->frame->node[node].fixed[d] |= fixed[d] != 0;
    return 1;
}

static int replace_mass(Reader *r, int n, Words w)
{
    int node;
    (void)n;
    return find(r, w[1], NULL, &node) && set_mass(r, node, w, 2);
}

/* Ties displacements of the second node to the first. */
static int tie_nodes(Reader *r, int n, Words w)
{
    int node, same_as, dof, dofs[FRAME_DOFS] = {0};
    if (!find(r, w[1], NULL, &same_as) || !find(r, w[2], NULL, &node))
        return 0;
    for (int i = 3; i < n; i++) {
        if (Tcl_GetIntFromObj(NULL, w[i], &dof) != TCL_OK || dof < 1 || dof > FRAME_DOFS)
            return refuse(r, "'%.60s' is no degree of freedom 1 to 3", Tcl_GetString(w[i]));
        dofs[dof - 1] = 1;
    }
    return is_taken(r, frame_tie(r->frame, node, same_as, dofs, &r->why));
}

/* ---- elements ------------------------------------------------------------------------------------------------- */

static int add_transformation(Reader *r, int n, Words w)
{
    return n == 3 && (is_word(w[1], "Linear") || is_word(w[1], "PDelta"))
               ? define(r, w, (FrameSection){.area = 1, .inertia = 1, .E = 1})
               : refuse(r, "only Linear and PDelta TAG are read; building.p_delta decides between them");
}

/* section Elastic TAG E A I, uniaxialMaterial Elastic TAG E */
static int add_elastic(Reader *r, int n, Words w)
{
    const int is_section = is_word(w[0], "section"), numbers = is_section ? 3 : 1;
    double value[3] = {1, 1, 1};
    if (!is_word(w[1], "Elastic") || n < 3 + numbers)
        return refuse(r, " %.60s: only Elastic TAG E%s is read", Tcl_GetString(w[1]), is_section ? " A I" : "");
    return read_numbers(r, w, 3, numbers, value) &&
           define(r, w, (FrameSection){.E = value[0], .area = value[1], .inertia = value[2]});
}

/* The elements that are read, and what stands behind their nodes: numbers A, E, I; tags of a Section, a Material, a
 * Transformation; a number that does nothing. */
static const struct {
    const char *type, *words;
} MEMBERS[] = {{"elasticBeamColumn", "AEIT"},  {"elasticBeamColumn", "ST"}, {"forceBeamColumn", "-ST"},
               {"nonlinearBeamColumn", "-ST"}, {"dispBeamColumn", "-ST"},   {"truss", "AM"}};

/* Takes the words behind the nodes into a section in the units of the model. *options: where they begin. */
static int read_member(Reader *r, int n, Words w, FrameSection *s, int *options)
{
    size_t form = 0;
    for (*options = 5; *options < n && Tcl_GetString(w[*options])[0] != '-';)
        ++*options;
    while (form < N_OF(MEMBERS) &&
           (!is_word(w[1], MEMBERS[form].type) || strlen(MEMBERS[form].words) != (size_t)(*options - 5)))
        form++;
    if (form == N_OF(MEMBERS))
        return refuse(r,
                      " %.60s: read are elasticBeamColumn TAG i j A E I TRANSF (or SECTION TRANSF), truss TAG i "
                      "j A MATERIAL, forceBeamColumn and dispBeamColumn TAG i j POINTS SECTION TRANSF",
                      Tcl_GetString(w[1]));
    *s = (FrameSection){.inertia = 1}; /* of a bar, whose ends are pinned, it does nothing */
    for (int i = 5; i < *options; i++) {
        const char word = MEMBERS[form].words[i - 5];
        const char *what = word == 'S' ? "section" : word == 'M' ? "uniaxialMaterial" : "geomTransf";
        double *const number = word == 'A' ? &s->area : word == 'E' ? &s->E : word == 'I' ? &s->inertia : NULL;
        int found;
        if (number ? !read_numbers(r, w, i, 1, number) : word != '-' && !find(r, w[i], what, &found))
            return 0;
        if (word == 'S')
            *s = r->library.section[found];
        if (word == 'M')
            s->E = r->library.section[found].E;
    }
    return 1;
}

/* A mass that is not consistent goes to both ends in halves, as OpenSees lumps it: added_mass until all is read. */
static int add_element(Reader *r, int n, Words w)
{
    Frame *f = r->frame;
    const double L = r->length, F = r->force;
    FrameSection s;
    FrameElement e = {.section = f->n[FRAME_SECTIONS]};
    int at, is_consistent = 0;
    double mass = 0, release = 0;
    if (!find(r, w[3], NULL, &e.node[0]) || !find(r, w[4], NULL, &e.node[1]) || !read_member(r, n, w, &s, &at))
        return 0;
    for (; at < n; at++) {
        const int is_mass = is_word(w[at], "-mass") || is_word(w[at], "-rho");
        if (is_word(w[at], "-cMass") || is_word(w[at], "-lMass"))
            is_consistent = is_word(w[at], "-cMass");
        else if ((!is_mass && !is_word(w[at], "-release")) || at + 1 == n)
            return refuse(r, " %s: '%.60s' is not read", Tcl_GetString(w[1]), Tcl_GetString(w[at]));
        else if (!read_numbers(r, w, ++at, 1, is_mass ? &mass : &release))
            return 0;
    }
    if (mass < 0)
        return refuse(r, "a mass of %g; it must not be negative", mass);
    if (release != 0 && release != 1 && release != 2 && release != 3)
        return refuse(r, "-release %g is none of 0 (none), 1 (end i), 2 (end j), 3 (both)", release);
    if (!read_tag(r, w[2], NULL, e.name))
        return 0;

    /* From the units of the model, where a mass is one per length, to those of a frame. */
    const FrameNode *a = &f->node[e.node[0]], *b = &f->node[e.node[1]];
    const int is_bar = is_word(w[1], "truss");
    mass *= F / (L * L);
    s.mass_per_m = is_consistent ? mass : 0;
    s.area *= L * L;
    s.inertia *= L * L * L * L;
    s.E *= F / (L * L);
    snprintf(s.name, sizeof s.name, "of %.40s", e.name);
    e.added_mass = is_consistent ? 0 : mass * hypot(b->x - a->x, b->z - a->z);
    e.pinned[0] = is_bar || (int)release & 1;
    e.pinned[1] = is_bar || release >= 2;
    return is_taken(r, frame_add_element(f, &e, &r->why)) && is_taken(r, frame_add_section(f, &s, &r->why));
}

/* ---- what is skipped, and the rest of a script ---------------------------------------------------------------- */

/* Loads, damping, analysis, output: no part of the structure. */
static const char SKIPPED[] =
    "algorithm analysis analyze close constraints display eigen eleLoad eleResponse file flush "
    "getTime groundMotion imposedMotion initialize integrator load loadConst logFile "
    "modalDamping modalProperties nodeAccel nodeDisp nodeEigenvector nodeReaction nodeVel "
    "numberer open parameter pattern print printA puts rayleigh reactions record recorder "
    "region remove reset setTime sp system test timeSeries wipeAnalysis";

/* Names the command once in the note; puts is none worth a word. A result of an analysis is 0; eigen has as many
 * eigenvalues of 1 as it was asked for. */
static int skip(Reader *r, int n, Words w)
{
    char listed[64], *note = r->frame->note;
    int count = 0;
    const size_t used = strlen(note);
    const int is_eigen = is_word(w[0], "eigen");
    snprintf(listed, sizeof listed, " %s,", r->command);
    if (!strstr(note, listed) && !is_word(w[0], "puts"))
        snprintf(note + used, sizeof r->frame->note - used, "%s", listed);
    r->has_analysed |= is_eigen || is_word(w[0], "analyze");
    if (is_eigen)
        Tcl_GetIntFromObj(NULL, w[n - 1], &count);
    Tcl_Obj *result = Tcl_NewStringObj(is_eigen ? "" : "0", -1);
    for (int i = 0; i < count && i < 1000; i++)
        Tcl_ListObjAppendElement(NULL, result, Tcl_NewIntObj(1));
    Tcl_SetObjResult(r->tcl, result);
    return 1;
}

/* A script often ends so, and OpenSees forgets the model. */
static int note_wipe(Reader *r, int n, Words w)
{
    (void)n, (void)w;
    r->is_wiped = r->frame->n[FRAME_NODES] > 0;
    return 1;
}

static int end_script(Reader *r, int n, Words w)
{
    (void)n, (void)w;
    r->has_ended = 1;
    return 0;
}

static int refuse_unknown(Reader *r, int n, Words w)
{
    r->command = "";
    return refuse(r, "'%.60s' is not among the commands that are read (docs/building.md)", Tcl_GetString(w[n > 1]));
}

/* The first command of a script that is part of a structure, or a procedure with one in it; NULL: there is none. depth:
 * of procedures that call each other. */
static const char *find_building(Reader *r, const char *text, int depth)
{
    static const char BUILDING[] = " model node fix mass equalDOF geomTransf section uniaxialMaterial element source ";
    int begins = 1; /* a command */
    for (const char *c = text; *c; c++) {
        const size_t n = strcspn(c, " \t\r\n;{}[]\"");
        char word[48];
        if (begins && *c == '#') {
            c += strcspn(c, "\n");
            c -= !*c;
        } else if (n == 0) {
            begins = strchr("\n;{[", *c) || (begins && strchr(" \t\r", *c));
        } else {
            snprintf(word, sizeof word, " %.*s ", (int)n, c);
            if (begins && strstr(BUILDING, word))
                return c;
            if (begins && depth > 0 && Tcl_VarEval(r->tcl, "info body ", word, NULL) == TCL_OK) {
                Tcl_Obj *body = Tcl_GetObjResult(r->tcl);
                Tcl_IncrRefCount(body);
                const char *found = find_building(r, Tcl_GetString(body), depth - 1);
                Tcl_DecrRefCount(body);
                if (found)
                    return c;
            }
            begins = 0;
            c += n - 1;
        }
    }
    return NULL;
}

/* The line, from that one on, where a file goes on with its structure; 0: none. */
static int line_that_builds(Reader *r, const char *path, int line)
{
    enum { DEPTH = 4, LARGEST = 1 << 24 };
    char *text;
    size_t length;
    int at = 1;
    if (file_read(path, LARGEST, &text, &length, &(Err){0}) != STATUS_OK)
        return line;
    const char *from = text;
    while (at < line && (from = strchr(from, '\n')) != NULL && ++at)
        from++;
    const char *found = from ? find_building(r, from, DEPTH) : NULL;
    for (; found && from < found; from++)
        at += *from == '\n';
    free(text);
    return found ? at : 0;
}

/* A fault of Tcl's own is one of the script; where that has asked for an analysis, whose results are not there, and
 * adds nothing to the model from there on, the model is complete and the script ends there. */
static int run_file(Reader *r, const char *path)
{
    Tcl_Obj *name = Tcl_NewStringObj(path, -1);
    Tcl_IncrRefCount(name);
    const int result = Tcl_FSEvalFileEx(r->tcl, name, "utf-8");
    Tcl_DecrRefCount(name);
    const int line = Tcl_GetErrorLine(r->tcl);
    if (result == TCL_OK || r->refused.code != STATUS_OK || r->has_ended || Tcl_LimitExceeded(r->tcl))
        return result == TCL_OK;
    if (!r->has_failed)
        snprintf(r->said, sizeof r->said, "%s", Tcl_GetStringResult(r->tcl));
    r->said[strcspn(r->said, "\n")] = 0;
    const size_t used = strlen(r->frame->note);
    const int builds = r->has_analysed ? line_that_builds(r, path, line + r->has_failed) : line;
    if (builds > line)
        fail(
            &r->refused, STATUS_BAD_DATA,
            "%s:%d: %s, after an analysis, whose results are not there; line %d goes on with the structure, which must "
            "stand before",
            path, line, r->said, builds);
    else if (builds)
        fail(&r->refused, STATUS_BAD_DATA, "%s:%d: %s", path, line, r->said);
    else if (!r->has_failed)
        snprintf(r->frame->note + used, sizeof r->frame->note - used, " all from %.100s:%d on,", path, line);
    r->has_failed = 1;
    return 0;
}

/* Runs a file below the folder of the model, and no other: a model may come from anywhere. */
static int source_file(Reader *r, int n, Words w)
{
    char path[PATH_MAX], whole[PATH_MAX];
    const size_t length = strlen(r->folder);
    const char *name = Tcl_GetString(w[n - 1]);
    const int n_path =
        snprintf(path, sizeof path, "%s%s%s", *name == '/' ? "" : r->folder, *name == '/' ? "" : "/", name);
    if (n_path >= (int)sizeof path || !realpath(path, whole))
        return refuse(r, "%.200s: %s", name, strerror(errno));
    if (strncmp(whole, r->folder, length) != 0 || whole[length] != '/')
        return refuse(r, "%.200s is not below the folder of the model", name);
    return run_file(r, whole);
}

/* ---- the interpreter ------------------------------------------------------------------------------------------ */

typedef struct {
    const char *word;
    int least; /* words, the command's own among them */
    int (*take)(Reader *r, int n, Words w);
    const char *usage;
} TclCommand;

static const TclCommand COMMANDS[] = {
    {"model", 2, check_model, "BasicBuilder -ndm 2 -ndf 3"},
    {"node", 4, add_node, "TAG x y"},
    {"fix", 2 + FRAME_DOFS, fix_node, "TAG x y rot"},
    {"mass", 2 + FRAME_DOFS, replace_mass, "TAG mx my mr"},
    {"equalDOF", 4, tie_nodes, "NODE NODE DOF ..."},
    {"geomTransf", 3, add_transformation, "Linear TAG"},
    {"section", 4, add_elastic, "Elastic TAG E A I"},
    {"uniaxialMaterial", 4, add_elastic, "Elastic TAG E"},
    {"element", 7, add_element, "TYPE TAG i j ..."},
    {"wipe", 1, note_wipe, ""},
    {"source", 2, source_file, "FILE"},
    {"exit", 1, end_script, ""},
    {"unknown", 1, refuse_unknown, ""},
    {"", 1, skip, ""}, /* those of SKIPPED */
};

static int run_command(ClientData command, Tcl_Interp *tcl, int n, Words w)
{
    const TclCommand *c = command;
    Reader *r = Tcl_GetAssocData(tcl, "reader", NULL);
    r->command = Tcl_GetString(w[0]);
    return (n < c->least ? refuse(r, "wants %s", c->usage) : c->take(r, n, w)) ? TCL_OK : TCL_ERROR;
}

/* Runs the script with the commands of COMMANDS alone and within the limits, then lumps the masses of elements. */
static Status run_model(Reader *r, Err *err)
{
    /* by which a script could wait for ever, or run outside the limits */
    static const char *const REMOVED[] = {"interp", "after", "vwait", "update"};
    const TclCommand *skipped = &COMMANDS[N_OF(COMMANDS) - 1];
    Frame *f = r->frame;
    char words[sizeof SKIPPED], *rest = words;
    Tcl_SetAssocData(r->tcl, "reader", NULL, r);
    if (Tcl_MakeSafe(r->tcl) != TCL_OK)
        return fail(err, STATUS_INTERNAL, "%s: Tcl has no safe interpreter", r->path);
    memcpy(words, SKIPPED, sizeof words);
    for (char *word; (word = strsep(&rest, " "));)
        Tcl_CreateObjCommand(r->tcl, word, run_command, (ClientData)skipped, NULL);
    for (const TclCommand *c = COMMANDS; c < skipped; c++)
        Tcl_CreateObjCommand(r->tcl, c->word, run_command, (ClientData)c, NULL);
    for (size_t i = 0; i < N_OF(REMOVED); i++)
        Tcl_DeleteCommand(r->tcl, REMOVED[i]);
    Tcl_CreateAlias(r->tcl, "pset", r->tcl, "set", 0, NULL); /* a parameter of OpenSees */
    Tcl_LimitSetCommands(r->tcl, COMMANDS_MAX);
    Tcl_LimitTypeSet(r->tcl, TCL_LIMIT_COMMANDS);
    Tcl_LimitSetTime(r->tcl, &(Tcl_Time){.sec = time(NULL) + SECONDS_MAX});
    Tcl_LimitTypeSet(r->tcl, TCL_LIMIT_TIME);
    run_file(r, r->path);
    if (Tcl_LimitExceeded(r->tcl))
        return bad_data(err, "%s: takes more than %d s or %d commands", r->path, SECONDS_MAX, COMMANDS_MAX);
    if (r->refused.code != STATUS_OK)
        return fail(err, r->refused.code, "%s", r->refused.text);
    if (f->n[FRAME_ELEMENTS] == 0)
        return bad_data(err, "%s: holds no element", r->path);
    for (FrameElement *e = f->element; e < f->element + f->n[FRAME_ELEMENTS]; e++) {
        for (int k = 0; k < 2; k++)
            for (int d = FRAME_X; d <= FRAME_Z; d++)
                f->node[e->node[k]].mass[d] += 0.5 * e->added_mass;
        e->added_mass = 0;
    }
    return STATUS_OK;
}

/* Tcl changes the locale of its process and what SIGPIPE does. */
static Tcl_Interp *create_tcl(void)
{
    struct sigaction pipe;
    char locale[200];
    snprintf(locale, sizeof locale, "%s", setlocale(LC_ALL, NULL));
    sigaction(SIGPIPE, NULL, &pipe);
    Tcl_FindExecutable(NULL);
    Tcl_Interp *tcl = Tcl_CreateInterp();
    sigaction(SIGPIPE, &pipe, NULL);
    setlocale(LC_ALL, locale);
    return tcl;
}

Status opensees_read(Frame *f, const char *path, double length_m, double force_n, Err *err)
{
    memset(f, 0, sizeof *f);
    Reader *r;
    TRY_ROOM(r, 1, "a model", err);
    r->path = path;
    r->length = length_m;
    r->force = force_n;
    r->frame = f;
    char *last = realpath(path, r->folder) ? strrchr(r->folder, '/') : NULL;
    Status status = last ? STATUS_OK : fail(err, STATUS_MISSING, "%s: %s", path, strerror(errno));
    if (last) {
        *last = 0;
        r->tcl = create_tcl();
        status = run_model(r, err);
        Tcl_DeleteInterp(r->tcl);
    }
    frame_free(&r->library);
    free(r);
    return status;
}
