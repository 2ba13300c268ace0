/* opensees/main.c -- the program that reads an OpenSees model for scene/opensees.c, which executes it: a model is a
 * program and may crash, wait or fill the memory. It has limits of memory, processor time and clock, reads files below
 * the model's folder, writes into its standard output alone, and ends with the program that started it. model.tcl,
 * which is part of it, does the reading.
 *
 *   imtet-opensees MODEL METRES_PER_UNIT NEWTONS_PER_UNIT 0|1 (what yields is taken by its initial stiffness) */
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <tcl.h>
#include <unistd.h>

#include "scene/opensees.h"

extern const char _binary_src_opensees_model_tcl_start[], _binary_src_opensees_model_tcl_end[];

/* What an endless recursion or a huge string does is the same with and without a sanitizer. */
#ifdef __SANITIZE_ADDRESS__
const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
    return "hard_rss_limit_mb=1024:max_allocation_size_mb=1024:detect_leaks=0:handle_segv=0:handle_abort=0";
}
#endif

static void set_limits(void)
{
    static const struct {
        int what;
        rlim_t most;
    } LIMITS[] = {
#if !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
        {RLIMIT_AS, (rlim_t)1 << 30},
#endif
        {RLIMIT_CPU, OPENSEES_SECONDS},
        {RLIMIT_FSIZE, (rlim_t)1 << 29},
        {RLIMIT_CORE, 0}
    };
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, NULL);
    signal(SIGALRM, SIG_DFL);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (size_t i = 0; i < N_OF(LIMITS); i++)
        setrlimit(LIMITS[i].what, &(struct rlimit){LIMITS[i].most, LIMITS[i].most});
    alarm(OPENSEES_SECONDS);
}

/* level: of the commands of the innermost file; 0: none of them has run; -1: nor has the one that runs the file. Says
 * the line under way, for the case that it is the last. */
static int level;
static int say_line(ClientData around, Tcl_Interp *tcl, int deep, const char *text, Tcl_Command command, int n,
                    Tcl_Obj *const words[])
{
    char place[UNDER_WAY_MAX] = "";
    (void)around, (void)text, (void)command, (void)n, (void)words;
    if (level <= 0)
        level = level < 0 ? 0 : deep;
    if (deep != level)
        return TCL_OK;
    Tcl_Obj *at[2] = {NULL, NULL};
    const Tcl_InterpState state = Tcl_SaveInterpState(tcl, TCL_OK);
    if (Tcl_Eval(tcl, "info frame -1") == TCL_OK)
        for (int i = 0; i < 2; i++)
            Tcl_DictObjGet(NULL, Tcl_GetObjResult(tcl), Tcl_NewStringObj(i ? "line" : "file", -1), &at[i]);
    if (at[0] && at[1])
        snprintf(place, sizeof place, "%s:%s", Tcl_GetString(at[0]), Tcl_GetString(at[1]));
    Tcl_RestoreInterpState(tcl, state);
    return pwrite(STDOUT_FILENO, place, sizeof place, 0) == sizeof place ? TCL_OK : TCL_ERROR;
}

static int watch(ClientData data, Tcl_Interp *tcl, int n, Tcl_Obj *const words[])
{
    (void)data;
    Tcl_Interp *model = Tcl_GetSlave(tcl, Tcl_GetString(words[n - 1]));
    Tcl_CreateObjTrace(model, 0, 0, say_line, NULL, NULL);
    return TCL_OK;
}

int main(int argc, char *argv[])
{
    static const char *const GIVEN[] = {"path", "length", "force", "initial"};
    char file[PATH_MAX], folder[PATH_MAX];
    if (argc != 5 || !realpath(argv[1], file))
        return EXIT_FAILURE;
    strcpy(folder, file);
    strrchr(folder, '/')[folder == strrchr(folder, '/')] = 0;
    set_limits();
    if (chdir(folder) != 0 || lseek(STDOUT_FILENO, UNDER_WAY_MAX, SEEK_SET) != UNDER_WAY_MAX)
        return EXIT_FAILURE;
    Tcl_FindExecutable(NULL);
    Tcl_Interp *tcl = Tcl_CreateInterp();
    for (size_t i = 0; i < N_OF(GIVEN); i++)
        Tcl_SetVar(tcl, GIVEN[i], argv[1 + i], 0);
    Tcl_SetVar(tcl, "file", file, 0);
    Tcl_SetVar(tcl, "folder", folder, 0);
    Tcl_LinkVar(tcl, "level", (char *)&level, TCL_LINK_INT);
    Tcl_CreateObjCommand(tcl, "watch", watch, NULL, NULL);
    if (Tcl_EvalEx(tcl, _binary_src_opensees_model_tcl_start,
                   (int)(_binary_src_opensees_model_tcl_end - _binary_src_opensees_model_tcl_start), 0) != TCL_OK ||
        Tcl_Eval(tcl, "read_model; flush stdout") != TCL_OK) {
        fprintf(stderr, "%s\n", Tcl_GetVar(tcl, "errorInfo", TCL_GLOBAL_ONLY));
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
