#include "sim/shapes/mesh/mesh_file.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "drivers/file/file.h"
#include "drivers/file/text.h"

static const size_t bytes_most = (size_t)1 << 30;

static int format_of(const char *path, bool clouds, enum iso_mesh_format *out,
                     struct iso_fault *fault)
{
    const char *dot = strrchr(path, '.');
    for (int f = 0; dot && !strchr(dot, '/') && f < ISO_MESH_FORMATS; f++) {
        if (strcasecmp(dot + 1, iso_mesh_format_suffix((enum iso_mesh_format)f)) == 0) {
            *out = (enum iso_mesh_format)f;
            return f != ISO_MESH_FORMAT_XYZ || clouds
                       ? 0
                       : iso_fault_set(fault, -ENOTSUP,
                                       "%s: a cloud of points, and a mesh is wanted here", path);
        }
    }
    return iso_fault_set(fault, -ENOTSUP, "%s: not named .off, .obj, .ply, .stl%s .vert%s", path,
                         clouds ? "," : " or", clouds ? " or .xyz" : "");
}

/* Reads the text of the .tri that belongs to a .vert. */
static int read_tri(const char *path, char **text, struct iso_fault *fault)
{
    char beside[PATH_MAX];
    const int n = snprintf(beside, sizeof beside, "%.*stri", (int)(strlen(path) - strlen("vert")),
                           path);
    if (n < 0 || n >= (int)sizeof beside) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: name too long", path);
    }
    return iso_text_read(beside, bytes_most, text, fault);
}

static int mend(const char *path, struct iso_coloured_mesh *mesh, struct iso_mesh_mended *report,
                struct iso_fault *fault)
{
    const int error = iso_mesh_mend(mesh, report);
    return error ? iso_fault_set(fault, error, "%s: %s", path,
                                 error == -ENOMEM ? "out of memory" : "no triangle is left of it")
                 : 0;
}

static int read_any(const char *path, bool clouds, struct iso_coloured_mesh *out,
                    struct iso_mesh_mended *report, struct iso_fault *fault)
{
    enum iso_mesh_format format = ISO_MESH_FORMAT_OFF;
    struct iso_coloured_mesh read = {NULL, NULL};
    char *bytes = NULL, *tri = NULL;
    size_t size = 0;
    int error = format_of(path, clouds, &format, fault);
    if (!error) {
        error = iso_file_read(path, bytes_most, &bytes, &size, fault);
    }
    if (!error && format == ISO_MESH_FORMAT_TOSCA) {
        error = read_tri(path, &tri, fault);
    }
    if (!error) {
        error = (clouds ? iso_mesh_or_cloud_parse : iso_mesh_parse)(format, path, bytes, size, tri,
                                                                    &read, fault);
    }
    free(bytes);
    free(tri);
    if (!error) {
        error = mend(path, &read, report, fault);
    }
    if (error) {
        iso_coloured_mesh_done(&read);
        return error;
    }
    *out = read;
    return 0;
}

int iso_mesh_file_read(const char *path, struct iso_coloured_mesh *out, struct iso_fault *fault)
{
    return read_any(path, false, out, NULL, fault);
}

int iso_mesh_file_read_report(const char *path, struct iso_coloured_mesh *out,
                              struct iso_mesh_mended *report, struct iso_fault *fault)
{
    return read_any(path, false, out, report, fault);
}

int iso_mesh_or_cloud_file_read(const char *path, struct iso_coloured_mesh *out,
                                struct iso_mesh_mended *report, struct iso_fault *fault)
{
    return read_any(path, true, out, report, fault);
}
