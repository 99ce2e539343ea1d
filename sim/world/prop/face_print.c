#include "sim/world/prop/face_print.h"

#include <errno.h>
#include <stdlib.h>

/* iBUG landmarks of the corners of the subject's right and left eye. */
static const int eye_corners[2][2] = {{36, 39}, {42, 45}};

/* An opening is an ellipse in x and y around an eye. */
struct opening {
    struct iso_vec3 middle_mm;
    double half_width_mm, half_height_mm;
};

static const double height_to_width = 0.62;

static struct opening opening_of(const struct sim_ict *ict, const struct iso_vec3 *vertices_mm,
                                 int eye, double size)
{
    struct iso_vec3 a = vertices_mm[ict->landmarks[eye_corners[eye][0]]];
    struct iso_vec3 b = vertices_mm[ict->landmarks[eye_corners[eye][1]]];
    const double half = 0.5 * size * iso_norm(iso_sub(b, a));
    return (struct opening){iso_scale(0.5, iso_add(a, b)), half, height_to_width * half};
}

static bool in_opening(const struct opening *opening, struct iso_vec3 p)
{
    const double x = (p.x - opening->middle_mm.x) / opening->half_width_mm;
    const double y = (p.y - opening->middle_mm.y) / opening->half_height_mm;
    return p.z > opening->middle_mm.z - 25.0 && x * x + y * y < 1.0;
}

/* Whether a vertex is on the printed surface. Eye sockets and eyeballs are printed unless the eyes
 * are cut out. The inside of the mouth is never printed. */
static bool printed(const struct sim_face_print *print, uint32_t v)
{
    const uint32_t end = print->whole_head ? SIM_ICT_MOUTH_SOCKET : SIM_ICT_NARROW_FACE_END;
    return v < end || (!print->eyes_cut && v >= SIM_ICT_EYE_SOCKETS);
}

struct selection {
    const struct sim_ict *ict;
    const struct iso_vec3 *vertices_mm;
    const struct sim_face_print *print;
    struct opening eyes[2];
};

static bool selected(const struct selection *s, uint32_t t)
{
    for (int k = 0; k < 3; k++) {
        const uint32_t v = s->ict->triangles[t][k];
        if (!printed(s->print, v)) {
            return false;
        }
        for (int eye = 0; s->print->eyes_cut && eye < 2; eye++) {
            if (in_opening(&s->eyes[eye], s->vertices_mm[v])) {
                return false;
            }
        }
    }
    return true;
}

/* Numbers the vertices that selected triangles use, from 1. Returns their number, and the number
 * of these triangles. */
static uint32_t number_vertices(const struct selection *s, uint32_t *number, uint32_t *n_triangles)
{
    uint32_t n = 0, m = 0;
    for (uint32_t t = 0; t < s->ict->n_triangles; t++) {
        if (!selected(s, t)) {
            continue;
        }
        m++;
        for (int k = 0; k < 3; k++) {
            uint32_t *of = &number[s->ict->triangles[t][k]];
            *of = *of ? *of : ++n;
        }
    }
    *n_triangles = m;
    return n;
}

static void fill(const struct selection *s, const uint32_t *number, struct sim_solid *solid)
{
    uint32_t m = 0;
    for (uint32_t v = 0; v < s->ict->n_vertices; v++) {
        if (number[v]) {
            solid->vertices_mm[number[v] - 1] = iso_scale(s->print->scale, s->vertices_mm[v]);
        }
    }
    for (uint32_t t = 0; t < s->ict->n_triangles; t++) {
        if (!selected(s, t)) {
            continue;
        }
        for (int k = 0; k < 3; k++) {
            solid->triangles[m][k] = number[s->ict->triangles[t][k]] - 1;
        }
        m++;
    }
}

int sim_face_print_new(const struct sim_ict *ict, const struct iso_vec3 *vertices_mm,
                       const struct sim_face_print *print, enum sim_material material,
                       struct sim_solid **out)
{
    if (!(print->scale > 0.0) || (print->eyes_cut && !(print->opening > 0.0))) {
        return -EINVAL;
    }
    struct selection s = {.ict = ict, .vertices_mm = vertices_mm, .print = print};
    for (int eye = 0; eye < 2; eye++) {
        s.eyes[eye] = opening_of(ict, vertices_mm, eye, print->opening);
    }
    uint32_t *number = calloc(ict->n_vertices, sizeof *number), n_triangles;
    if (!number) {
        return -ENOMEM;
    }
    const uint32_t n_vertices = number_vertices(&s, number, &n_triangles);
    struct sim_solid *solid;
    int error = sim_solid_new(n_vertices, n_triangles, material, &solid);
    if (error == 0) {
        fill(&s, number, solid);
        error = print->shell_mm > 0.0 ? sim_solid_thicken(solid, print->shell_mm) : 0;
        if (error == 0) {
            *out = solid;
        } else {
            sim_solid_free(solid);
        }
    }
    free(number);
    return error;
}

double sim_face_print_push(const struct iso_vec3 *outer_mm, const struct iso_vec3 *inner_mm,
                           double gap_mm)
{
    double push = -1e9;
    for (uint32_t v = 0; v < SIM_ICT_NARROW_FACE_END; v++) {
        push = fmax(push, inner_mm[v].z - outer_mm[v].z + gap_mm);
    }
    return push;
}
