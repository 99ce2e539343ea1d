/* A corpus of shapes: a directory of mesh files, and manifest.csv with the class of each file.
 *
 *   file,class
 *   horse-01.off,horse
 *   dog-a-stripes-pose2.ply,dog/stripes
 *
 * A directory of meshes without that file is a corpus, too. The header line is fixed. Files lie in
 * the directory or below it. The part of a class before its slash is the wider class: two shapes
 * with different coats have the same wider class. Fields hold no commas, quotes or control
 * characters. No file is listed twice. */
#ifndef SIM_SHAPES_MAKE_MANIFEST_H
#define SIM_SHAPES_MAKE_MANIFEST_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

enum { SIM_SHAPE_NAME_MAX = 192 };

struct sim_shape_row {
    char file[SIM_SHAPE_NAME_MAX], class_name[SIM_SHAPE_NAME_MAX];
};

struct sim_shape_manifest {
    int32_t n, n_classes, n_wider;
    struct sim_shape_row *rows; /* [n] */
    /* [n] class numbers in the order of first occurrence: 0..n_classes - 1, 0..n_wider - 1. */
    int32_t *class_of, *wider_of;
    const char **class_name; /* [n_classes], into rows */
};

/* Reads DIRECTORY/manifest.csv. Without that file, lists the meshes in the directory and below it;
 * then the class of a file is its folder. It does not check that the meshes exist. -ENOENT also for
 * a directory without a mesh, -EBADMSG with a fault "file:line: what is wrong", -ENOMEM, or the
 * errno of open and read. */
int sim_shape_manifest_read(const char *directory, struct sim_shape_manifest **out,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

/* Parses a manifest from a text; `name` stands for the file in faults. -EBADMSG, -ENOMEM. */
int sim_shape_manifest_parse(const char *name, const char *text, struct sim_shape_manifest **out,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

/* Lists every mesh in a directory and below it, by rising name, without hidden files. The class of
 * a file is its folder's path below the directory: the wider class of "dog/young/a.off" is "dog".
 * Files in the directory itself have its name as their class. Errors of reading directories,
 * -ENAMETOOLONG, -ELOOP for over eight directories in each other, -EFBIG, -ENOENT if there is no
 * mesh; each with a fault. */
int sim_shape_manifest_list(const char *directory, struct sim_shape_manifest **out,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

/* Makes a manifest of n rows, at least one, which are copied. -ENOMEM. */
int sim_shape_manifest_of(const struct sim_shape_row *rows, int32_t n,
                          struct sim_shape_manifest **out) __attribute__((warn_unused_result));

/* Takes the first rows of every class in turn, then the second ones, and so on, up to `wanted` rows
 * or all of them for 0. `rows` receives their numbers, [manifest->n], and *n how many. -ENOMEM. */
int sim_shape_manifest_turns(const struct sim_shape_manifest *manifest, size_t wanted,
                             int32_t *rows, int32_t *n) __attribute__((warn_unused_result));

/* Removes the rows whose keep[row] is 0, and numbers the classes again. */
void sim_shape_manifest_keep(struct sim_shape_manifest *manifest, const uint8_t *keep);

/* Frees it and what it holds. NULL is accepted. */
void sim_shape_manifest_free(struct sim_shape_manifest *manifest);

/* Writes the manifest. -EIO or the errno of opening the file. */
int sim_shape_manifest_write(const char *directory, const struct sim_shape_row *rows, int32_t n,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
