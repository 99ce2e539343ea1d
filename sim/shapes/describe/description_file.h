/* Descriptions as bytes: little-endian, with a check sum. */
#ifndef SIM_SHAPES_DESCRIBE_DESCRIPTION_FILE_H
#define SIM_SHAPES_DESCRIBE_DESCRIPTION_FILE_H

#include "core/base/fault.h"
#include "isotherm/shape_method.h"

/* Writes DIRECTORY/NAME, first under another name, so that a reader never sees a part of it. The
 * errno of writing, with a fault that names the file. */
int sim_description_write(const char *directory, const char *name, int32_t n_vertices,
                          const struct iso_shape_description *description, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads what was written, and the number of vertices that the mesh had. -EBADMSG if it is damaged
 * or from another version, errors of iso_file_read(), -ENOMEM; each with a fault. */
int sim_description_read(const char *path, int32_t *n_vertices, struct iso_shape_description **out,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
