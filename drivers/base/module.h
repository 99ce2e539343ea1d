/* Modules: shared objects with the back ends that pull in other libraries (OpenCV, libcamera, the
 * TPM software stack). A program loads a module if its configuration needs it; otherwise it runs
 * without these libraries.
 *
 * A module is next to the libisotherm-core.so that the process already uses, and is called
 * isotherm-NAME.so: /usr/lib/x86_64-linux-gnu/isotherm/isotherm-stereo.so. There is no search path,
 * and no variable of the environment or key of the configuration names another place. A person who
 * can write to that folder can also replace the library, so loading a module from it adds no risk.
 *
 * A module exports one symbol, `iso_module`: a struct that begins with a struct iso_module and
 * continues with pointers to its functions. It must have exactly the version of the program. A
 * module stays loaded until the process ends. */
#ifndef ISO_DRIVERS_BASE_MODULE_H
#define ISO_DRIVERS_BASE_MODULE_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Rises when this struct or the table of a module changes its meaning. */
enum { ISO_MODULE_ABI = 1 };

/* The beginning of every module's table. The first two members never change. */
struct iso_module {
    uint32_t abi;        /* ISO_MODULE_ABI */
    uint32_t size_bytes; /* of the whole table */
    const char *name;    /* "stereo" */
    const char *version; /* of the project */
};

/* Initialises the beginning of a table. */
#define ISO_MODULE(NAME, TABLE)                                             \
    {                                                                       \
        .abi = ISO_MODULE_ABI, .size_bytes = sizeof(TABLE), .name = (NAME), \
        .version = ISOTHERM_VERSION                                         \
    }

#define ISO_MODULE_EXPORT __attribute__((visibility("default")))

/* A module that a program needs, and the result of loading it. The program sets the first two
 * members; all others are zero at the beginning. */
struct iso_module_slot {
    const char *name;  /* the package that contains it is called isotherm-NAME */
    size_t size_bytes; /* of the table */

    /* Set by iso_module_load. */
    bool tried;
    int error;
    struct iso_fault fault;
    const struct iso_module *table;
};

/* Loads a module at the first call; later calls return the result of the first one. Any thread may
 * call it. After 0 slot->table is set. *fault holds one line for every error: -ENOENT there is no
 * such file (the line names the package to install); -EBADMSG it is not a regular file, anybody may
 * write to it, it cannot be loaded, or it is not this module in this version; and the errors of
 * iso_module_path. */
int iso_module_load(struct iso_module_slot *slot, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Loads the module `name` from the file `path`, at each call anew, and checks that its table has
 * size_bytes bytes. *out stays valid until the process ends. The errors of iso_module_load. For
 * iso_module_load and for tests. */
int iso_module_read(const char *path, const char *name, size_t size_bytes,
                    const struct iso_module **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes the path at which the module `name` has to be. -ENOENT the folder of libisotherm-core.so
 * is not known, -ENAMETOOLONG; both with a fault. */
int iso_module_path(const char *name, char path[PATH_MAX], struct iso_fault *fault)
    __attribute__((warn_unused_result));

#ifdef __cplusplus
}
#endif
#endif
