#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/fault.h"
#include "core/shape/mesh/mesh_build.h"

void iso_coloured_mesh_done(struct iso_coloured_mesh *mesh)
{
    iso_mesh_free(mesh->mesh);
    free(mesh->colour);
    *mesh = (struct iso_coloured_mesh){NULL, NULL};
}

const char *iso_mesh_format_suffix(enum iso_mesh_format format)
{
    static const char *const names[ISO_MESH_FORMATS] = {"off", "obj", "ply", "stl", "vert", "xyz"};
    return (unsigned)format < ISO_MESH_FORMATS ? names[format] : NULL;
}

static int read_contents(enum iso_mesh_format format, struct iso__mesh_build *build, char *bytes,
                         size_t size, char *tri)
{
    switch (format) {
    case ISO_MESH_FORMAT_OFF:
        return iso__mesh_read_off(build, bytes);
    case ISO_MESH_FORMAT_OBJ:
        return iso__mesh_read_obj(build, bytes);
    case ISO_MESH_FORMAT_PLY:
        return iso__mesh_read_ply(build, bytes, size);
    case ISO_MESH_FORMAT_STL:
        return iso__mesh_read_stl(build, bytes, size);
    case ISO_MESH_FORMAT_XYZ:
        return iso__mesh_read_xyz(build, bytes);
    default:
        return iso__mesh_read_tosca(build, bytes, tri);
    }
}

static int parse(enum iso_mesh_format format, const char *name, char *bytes, size_t size, char *tri,
                 bool points, struct iso_coloured_mesh *out, struct iso_fault *fault)
{
    struct iso__mesh_build build;
    int error = iso__mesh_build_init(&build, name, fault);
    if (error) {
        return error;
    }
    build.points = points;
    const bool binary = format == ISO_MESH_FORMAT_PLY || format == ISO_MESH_FORMAT_STL;
    if (!binary && memchr(bytes, 0, size)) {
        error = iso_fault_set(fault, -EBADMSG, "%s: not a text file (it holds a NUL byte)", name);
    } else {
        error = read_contents(format, &build, bytes, size, tri);
    }
    if (!error) {
        error = iso__mesh_build_finish(&build, out);
    }
    iso__mesh_build_done(&build);
    return error;
}

int iso_mesh_parse(enum iso_mesh_format format, const char *name, char *bytes, size_t size,
                   char *tri, struct iso_coloured_mesh *out, struct iso_fault *fault)
{
    return parse(format, name, bytes, size, tri, false, out, fault);
}

int iso_mesh_or_cloud_parse(enum iso_mesh_format format, const char *name, char *bytes, size_t size,
                            char *tri, struct iso_coloured_mesh *out, struct iso_fault *fault)
{
    return parse(format, name, bytes, size, tri, true, out, fault);
}
