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
    static const char *const names[ISO_MESH_FORMATS] = {"off", "obj", "ply", "stl", "vert"};
    return (unsigned)format < ISO_MESH_FORMATS ? names[format] : NULL;
}

int iso_mesh_parse(enum iso_mesh_format format, const char *name, char *bytes, size_t size,
                   char *tri, struct iso_coloured_mesh *out, struct iso_fault *fault)
{
    struct iso__mesh_build build;
    int error = iso__mesh_build_init(&build, name, fault);
    if (error) {
        return error;
    }
    const bool binary = format == ISO_MESH_FORMAT_PLY || format == ISO_MESH_FORMAT_STL;
    if (!binary && memchr(bytes, 0, size)) {
        error = iso_fault_set(fault, -EBADMSG, "%s: not a text file (it holds a NUL byte)", name);
    } else if (format == ISO_MESH_FORMAT_OFF) {
        error = iso__mesh_read_off(&build, bytes);
    } else if (format == ISO_MESH_FORMAT_OBJ) {
        error = iso__mesh_read_obj(&build, bytes);
    } else if (format == ISO_MESH_FORMAT_PLY) {
        error = iso__mesh_read_ply(&build, bytes, size);
    } else if (format == ISO_MESH_FORMAT_STL) {
        error = iso__mesh_read_stl(&build, bytes, size);
    } else {
        error = iso__mesh_read_tosca(&build, bytes, tri);
    }
    if (!error) {
        error = iso__mesh_build_finish(&build, out);
    }
    iso__mesh_build_done(&build);
    return error;
}
