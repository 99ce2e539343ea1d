/* A corpus without manifest.csv: every file of a mesh or of points below a directory. */
#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "drivers/base/path.h"
#include "sim/shapes/make/manifest.h"
#include "sim/shapes/mesh/mesh_file.h"

enum { DEPTH_MAX = 8, FILES_MAX = 100000 };

struct listing {
    struct sim_shape_row *rows;
    int32_t n, capacity;
    const char *top_class; /* of files in the directory itself */
    struct iso_fault *fault;
};

static bool is_mesh(const char *name)
{
    const char *dot = strrchr(name, '.');
    for (int f = 0; dot && f < ISO_MESH_FORMATS; f++) {
        if (strcasecmp(dot + 1, iso_mesh_format_suffix((enum iso_mesh_format)f)) == 0) {
            return true;
        }
    }
    return false;
}

static int add_file(struct listing *listing, const char *below, const char *name)
{
    if (listing->n == FILES_MAX) {
        return iso_fault_set(listing->fault, -EFBIG, "%s: more than %d meshes", below,
                             (int)FILES_MAX);
    }
    if (listing->n == listing->capacity) {
        const int32_t capacity = 2 * listing->capacity + 64;
        void *moved = realloc(listing->rows, (size_t)capacity * sizeof *listing->rows);
        if (!moved) {
            return iso_fault_set(listing->fault, -ENOMEM, "out of memory");
        }
        listing->rows = moved;
        listing->capacity = capacity;
    }
    struct sim_shape_row *row = &listing->rows[listing->n++];
    const int file = snprintf(row->file, sizeof row->file, "%s%s%s", below, below[0] ? "/" : "",
                              name);
    const int class_name = snprintf(row->class_name, sizeof row->class_name, "%s",
                                    below[0] ? below : listing->top_class);
    if (file >= (int)sizeof row->file || class_name >= (int)sizeof row->class_name) {
        return iso_fault_set(listing->fault, -ENAMETOOLONG, "%s/%s: the name has over %d bytes",
                             below, name, (int)sizeof row->file - 1);
    }
    return 0;
}

static int list_directory(struct listing *listing, const char *path, const char *below, int depth);

/* Hidden files, and everything that is no mesh and no directory, are left out. */
static int list_entry(struct listing *listing, const char *path, const char *below,
                      const char *name, int depth)
{
    char entry[PATH_MAX], deeper[PATH_MAX];
    struct stat status;
    if (name[0] == '.') {
        return 0;
    }
    int error = iso_path_join(path, name, entry, listing->fault);
    if (error) {
        return error;
    }
    if (stat(entry, &status) == 0 && S_ISDIR(status.st_mode)) {
        if (!below[0]) {
            return list_directory(listing, entry, name, depth + 1);
        }
        error = iso_path_join(below, name, deeper, listing->fault);
        return error ? error : list_directory(listing, entry, deeper, depth + 1);
    }
    return is_mesh(name) ? add_file(listing, below, name) : 0;
}

static int list_directory(struct listing *listing, const char *path, const char *below, int depth)
{
    struct dirent **entry = NULL;
    if (depth > DEPTH_MAX) {
        return iso_fault_set(listing->fault, -ELOOP, "%s: over %d directories deep", path,
                             (int)DEPTH_MAX);
    }
    const int n = scandir(path, &entry, NULL, alphasort);
    if (n < 0) {
        return iso_fault_set(listing->fault, -errno, "%s: %s", path, strerror(errno));
    }
    int error = 0;
    for (int i = 0; i < n; i++) {
        if (!error) {
            error = list_entry(listing, path, below, entry[i]->d_name, depth);
        }
        free(entry[i]);
    }
    free(entry);
    return error;
}

int sim_shape_manifest_list(const char *directory, struct sim_shape_manifest **out,
                            struct iso_fault *fault)
{
    char real[PATH_MAX];
    if (!realpath(directory, real)) {
        return iso_fault_set(fault, -errno, "%s: %s", directory, strerror(errno));
    }
    const char *slash = strrchr(real, '/');
    struct listing listing = {.top_class = slash && slash[1] ? slash + 1 : "/", .fault = fault};
    int error = list_directory(&listing, directory, "", 0);
    if (!error && listing.n == 0) {
        error = iso_fault_set(
            fault, -ENOENT,
            "%s: no manifest.csv, and no mesh or cloud (.off, .obj, .ply, .stl, .vert, .xyz)",
            directory);
    }
    if (!error) {
        error = sim_shape_manifest_of(listing.rows, listing.n, out);
        if (error) {
            (void)iso_fault_set(fault, error, "%s: out of memory", directory);
        }
    }
    free(listing.rows);
    return error;
}
