#include "sim/shapes/mesh/mesh_writer.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/base/bytes.h"

typedef void body_writer(const struct iso_coloured_mesh *mesh, FILE *out);

static uint8_t colour_byte(float channel)
{
    return (uint8_t)lrintf(255.0f * channel);
}

static void write_off(const struct iso_coloured_mesh *coloured, FILE *out)
{
    const struct iso_mesh *mesh = coloured->mesh;
    fprintf(out, "%s\n%d %d 0\n", coloured->colour ? "COFF" : "OFF", mesh->n_vertices,
            mesh->n_triangles);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        struct iso_vec3 p = mesh->vertices_mm[v];
        fprintf(out, "%.9g %.9g %.9g", p.x, p.y, p.z);
        if (coloured->colour) {
            const float *c = coloured->colour[v].channel;
            fprintf(out, " %d %d %d 255", colour_byte(c[0]), colour_byte(c[1]), colour_byte(c[2]));
        }
        fputc('\n', out);
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *c = mesh->triangles[t];
        fprintf(out, "3 %d %d %d\n", c[0], c[1], c[2]);
    }
}

static void write_ply(const struct iso_coloured_mesh *coloured, FILE *out)
{
    const struct iso_mesh *mesh = coloured->mesh;
    fprintf(out,
            "ply\nformat binary_little_endian 1.0\nelement vertex %d\n"
            "property float x\nproperty float y\nproperty float z\n%s"
            "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
            mesh->n_vertices,
            coloured->colour ? "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                             : "",
            mesh->n_triangles);
    uint8_t bytes[16];
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        struct iso_vec3 p = mesh->vertices_mm[v];
        uint8_t *at = iso_put_f32(bytes, (float)p.x);
        at = iso_put_f32(iso_put_f32(at, (float)p.y), (float)p.z);
        for (int k = 0; coloured->colour && k < 3; k++) {
            *at++ = colour_byte(coloured->colour[v].channel[k]);
        }
        fwrite(bytes, 1, (size_t)(at - bytes), out);
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        uint8_t *at = bytes;
        *at++ = 3;
        for (int k = 0; k < 3; k++) {
            at = iso_put_u32(at, (uint32_t)mesh->triangles[t][k]);
        }
        fwrite(bytes, 1, (size_t)(at - bytes), out);
    }
}

static void write_vert(const struct iso_coloured_mesh *coloured, FILE *out)
{
    for (int32_t v = 0; v < coloured->mesh->n_vertices; v++) {
        struct iso_vec3 p = coloured->mesh->vertices_mm[v];
        fprintf(out, "%.9g %.9g %.9g\n", p.x, p.y, p.z);
    }
}

static void write_tri(const struct iso_coloured_mesh *coloured, FILE *out)
{
    for (int32_t t = 0; t < coloured->mesh->n_triangles; t++) {
        const int32_t *c = coloured->mesh->triangles[t];
        fprintf(out, "%d %d %d\n", c[0] + 1, c[1] + 1, c[2] + 1);
    }
}

static int write_file(const char *path, body_writer *body, const struct iso_coloured_mesh *mesh,
                      struct iso_fault *fault)
{
    FILE *out = fopen(path, "we");
    if (!out) {
        return iso_fault_set(fault, -errno, "%s: %m", path);
    }
    body(mesh, out);
    const int failed = ferror(out);
    return fclose(out) != 0 || failed ? iso_fault_set(fault, -EIO, "%s: cannot be written", path)
                                      : 0;
}

int sim_mesh_write(const char *path, const struct iso_coloured_mesh *mesh, struct iso_fault *fault)
{
    const char *dot = strrchr(path, '.');
    if (dot && strcmp(dot, ".off") == 0) {
        return write_file(path, write_off, mesh, fault);
    }
    if (dot && strcmp(dot, ".ply") == 0) {
        return write_file(path, write_ply, mesh, fault);
    }
    if (!dot || strcmp(dot, ".vert") != 0) {
        return iso_fault_set(fault, -ENOTSUP, "%s: not named .off, .ply or .vert", path);
    }
    char tri[PATH_MAX];
    const int n = snprintf(tri, sizeof tri, "%.*stri", (int)(dot + 1 - path), path);
    if (n < 0 || n >= (int)sizeof tri) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: name too long", path);
    }
    const int error = write_file(path, write_vert, mesh, fault);
    if (error) {
        return error;
    }
    return write_file(tri, write_tri, mesh, fault);
}
