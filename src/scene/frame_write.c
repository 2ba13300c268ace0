#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "scene/frame.h"

typedef void (*PrintFn)(const Frame *f, FILE *out);

static void print_nodes(const Frame *f, FILE *out)
{
    fprintf(out, "node,x_m,z_m,fix_x,fix_z,fix_rot\n");
    for (int i = 0; i < f->n_nodes; i++) {
        const FrameNode *n = &f->node[i];
        fprintf(out, "%s,%.15g,%.15g,%d,%d,%d\n", n->name, n->x, n->z, n->fixed[FRAME_X], n->fixed[FRAME_Z],
                n->fixed[FRAME_ROT]);
    }
}

static void print_sections(const Frame *f, FILE *out)
{
    fprintf(out, "section,A_m2,I_m4,E_pa,mass_kg_per_m\n");
    for (int i = 0; i < f->n_sections; i++) {
        const FrameSection *s = &f->section[i];
        fprintf(out, "%s,%.17g,%.17g,%.17g,%.17g\n", s->name, s->area, s->inertia, s->E, s->mass_per_m);
    }
}

static void print_elements(const Frame *f, FILE *out)
{
    fprintf(out, "element,node_i,node_j,section,pin_i,pin_j\n");
    for (int i = 0; i < f->n_elements; i++) {
        const FrameElement *e = &f->element[i];
        fprintf(out, "%s,%s,%s,%s,%d,%d\n", e->name, f->node[e->node[0]].name, f->node[e->node[1]].name,
                f->section[e->section].name, e->pinned[0], e->pinned[1]);
    }
}

static void print_masses(const Frame *f, FILE *out)
{
    fprintf(out, "node,mass_kg,mass_z_kg,rotary_kg_m2\n");
    for (int i = 0; i < f->n_nodes; i++) {
        const double *m = f->node[i].mass;
        if (m[FRAME_X] != 0 || m[FRAME_Z] != 0 || m[FRAME_ROT] != 0)
            fprintf(out, "%s,%.17g,%.17g,%.17g\n", f->node[i].name, m[FRAME_X], m[FRAME_Z], m[FRAME_ROT]);
    }
}

static void print_ties(const Frame *f, FILE *out)
{
    fprintf(out, "node,same_as,x,z,rot\n");
    for (int i = 0; i < f->n_ties; i++) {
        const FrameTie *t = &f->tie[i];
        fprintf(out, "%s,%s,%d,%d,%d\n", f->node[t->node].name, f->node[t->same_as].name, t->dof[FRAME_X],
                t->dof[FRAME_Z], t->dof[FRAME_ROT]);
    }
}

static Status write_sheet(const Frame *f, const char *folder, const char *name, PrintFn print, Err *err)
{
    char path[600];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *out = fopen(path, "wx");
    if (!out)
        return fail(err, STATUS_IO, "%s: %s", path, strerror(errno));
    print(f, out);
    const int broken = ferror(out);
    return fclose(out) != 0 || broken ? fail(err, STATUS_IO, "%s: cannot be written", path) : STATUS_OK;
}

static int has_mass(const Frame *f)
{
    double sum = 0;
    for (int i = 0; i < f->n_nodes; i++)
        for (int d = 0; d < FRAME_DOFS; d++)
            sum += f->node[i].mass[d];
    return sum > 0;
}

Status frame_write(const Frame *f, const char *folder, Err *err)
{
    TRY(write_sheet(f, folder, "nodes.csv", print_nodes, err));
    TRY(write_sheet(f, folder, "sections.csv", print_sections, err));
    TRY(write_sheet(f, folder, "elements.csv", print_elements, err));
    if (has_mass(f))
        TRY(write_sheet(f, folder, "masses.csv", print_masses, err));
    return f->n_ties ? write_sheet(f, folder, "ties.csv", print_ties, err) : STATUS_OK;
}
