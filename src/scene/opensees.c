#include "scene/opensees.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* The program that reads models: beside this program or library, or in a folder above, or in bin there. */
static int find_reader(char path[PATH_MAX])
{
    enum { FOLDERS = 4 };
    static const char *const PLACES[] = {"imtet-opensees", "bin/imtet-opensees"};
    Dl_info about;
    char own[PATH_MAX];
    const int is_library = dladdr((void *)(uintptr_t)opensees_read, &about) && strstr(about.dli_fname, ".so");
    if (!realpath(is_library ? about.dli_fname : "/proc/self/exe", own))
        return 0;
    for (int i = 0; i < FOLDERS && strrchr(own, '/'); i++) {
        *strrchr(own, '/') = 0;
        for (size_t k = 0; k < N_OF(PLACES); k++)
            if (snprintf(path, PATH_MAX, "%s/%s", own, PLACES[k]) < PATH_MAX && access(path, X_OK) == 0)
                return 1;
    }
    return 0;
}

/* Executes it with the file as standard output, and waits for its end. *how: as waitpid has it. Returns errno. */
static int run_reader(const char *program, char *const words[], int file, int *how)
{
    posix_spawn_file_actions_t actions;
    pid_t pid;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, file, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    const int why = posix_spawn(&pid, program, &actions, NULL, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    *how = 0;
    while (!why && waitpid(pid, how, 0) < 0 && errno == EINTR)
        ;
    return why;
}

/* The frame of an answer, part by part. */
static Status take_frame(Frame *f, FILE *in, Err *err)
{
    char kind[8];
    Status status = STATUS_OK;
    while (status == STATUS_OK && fscanf(in, "%7s", kind) == 1) {
        FrameNode node = {0};
        FrameElement e = {0};
        FrameSection s = {.E = 1};
        int a, b, dof[FRAME_DOFS] = {0}, d = 0;
        const int n_nodes = f->n[FRAME_NODES];
        if (kind[0] == 'n' &&
            fscanf(in, "%47s %lf %lf %d %d %d %lf %lf %lf", node.name, &node.x, &node.z, &node.fixed[0], &node.fixed[1],
                   &node.fixed[2], &node.mass[0], &node.mass[1], &node.mass[2]) == 9) {
            status = frame_add_node(f, &node, err);
        } else if (kind[0] == 'h') {
            f->has_no_heights = 1;
        } else if (kind[0] == 't' && fscanf(in, "%d %d %d", &a, &b, &d) == 3 && a >= 0 && b >= 0 && a < n_nodes &&
                   b < n_nodes && d >= 1 && d <= FRAME_DOFS) {
            dof[d - 1] = 1;
            status = frame_tie(f, a, b, dof, err);
        } else if (kind[0] == 'e' &&
                   fscanf(in, "%47s %d %d %lf %lf %lf %lf %lf %d %d %lf %lf %lf %lf %d %lf %lf %lf %lf %lf", e.name,
                          &e.node[0], &e.node[1], &s.area, &s.inertia, &s.shear_area, &s.mass_per_m, &e.added_mass,
                          &e.pinned[0], &e.pinned[1], &e.offset[0][0], &e.offset[0][1], &e.offset[1][0],
                          &e.offset[1][1], &e.is_spring, &e.spring[0], &e.spring[1], &e.spring[2], &e.axis[0],
                          &e.axis[1]) == 20 &&
                   MIN_OF(e.node[0], e.node[1]) >= 0 && MAX_OF(e.node[0], e.node[1]) < n_nodes) {
            s.shear_area *= 2; /* GA is E / 2 times that where Poisson's ratio is 0 */
            e.section = f->n[FRAME_SECTIONS];
            memcpy(s.name, e.name, sizeof s.name);
            status = frame_add_element(f, &e, err);
            THEN(status, frame_add_section(f, &s, err));
        } else {
            status = fail(err, STATUS_INTERNAL, "imtet-opensees is not of this version: '%s'", kind);
        }
    }
    return status;
}

Status opensees_read(Frame *f, const char *path, double length_m, double force_n, int takes_initial, Err *err)
{
    char program[PATH_MAX], length[40], force[40];
    char *const words[] = {program, (char *)(uintptr_t)path, length, force, takes_initial ? "1" : "0", NULL};
    int how;
    memset(f, 0, sizeof *f);
    if (access(path, R_OK) != 0)
        return fail(err, STATUS_MISSING, "%s: %s", path, strerror(errno));
    if (!find_reader(program))
        return fail(err, STATUS_MISSING,
                    "%s: imtet-opensees, the program that reads OpenSees models, is not beside this one nor in bin",
                    path);
    snprintf(length, sizeof length, "%.17g", length_m);
    snprintf(force, sizeof force, "%.17g", force_n);
    const int file = memfd_create("opensees", MFD_CLOEXEC);
    const int why = file < 0 ? errno : run_reader(program, words, file, &how);
    if (why) {
        close(file);
        return fail(err, STATUS_INTERNAL, "%s: %s", program, strerror(why));
    }

    /* The answer, or the line under way and why there is none. */
    char word[8] = "", text[sizeof err->text] = "", line[UNDER_WAY_MAX] = "";
    FILE *in = fdopen(file, "r");
    Status status = STATUS_OK;
    const int sign = WIFSIGNALED(how) ? WTERMSIG(how) : 0;
    if (pread(file, line, sizeof line - 1, 0) <= 0 || !line[0])
        snprintf(line, sizeof line, "%.400s", path);
    if (sign == SIGALRM || sign == SIGXCPU)
        status = bad_data(err, "%s: takes more than %d s", line, OPENSEES_SECONDS);
    else if (!in || how != 0 || fseek(in, UNDER_WAY_MAX, SEEK_SET) != 0 || fscanf(in, "%7s%479[^\n]", word, text) < 1)
        status =
            bad_data(err, "%s: needs more than 1 GB or fills the stack; the program that read the model was ended (%s)",
                     line, sign ? strsignal(sign) : "exit");
    else if (word[0] == 'r')
        status = bad_data(err, "%s", text + 1);
    else
        status = take_frame(f, in, err);
    if (word[0] == 'n')
        snprintf(f->note, sizeof f->note, "%.399s", text);
    if (in)
        fclose(in);
    return status;
}
